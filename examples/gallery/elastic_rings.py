"""
Elastic rings and balls
=======================

Finite elements of rings and balls, condensed to the contacts, beside rigid bodies over the axial load.
In a stiff housing they are stiffer than Hertz's half-spaces; in a soft one (500 N/mm³) softer.
"""

import matplotlib.pyplot as plt
import numpy as np

import raceway as rw

loads = np.linspace(100, 2000, 10)  # N
bearing = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}
seats = {"rigid": {}, "condensed": {}, "condensed, soft housing": {"supports.outer_seat": 5e11}}

plt.figure(layout="constrained")
for label, changes in seats.items():
    scene = rw.evolve(bearing, {"bodies.kind": label.split(",")[0], **changes})
    swept = rw.sweep(scene, {"load.axial": loads})
    stiffness = 1e-6 * swept.stiffness.sel(dof="y", dof2="y").values
    plt.plot(loads, stiffness, "o-", label=label)
    print(f"{label}: kyy {stiffness[-1]:.0f} N/µm under 2 kN")
plt.xlabel("axial load [N]")
plt.ylabel("kyy [N/µm]")
plt.legend()
