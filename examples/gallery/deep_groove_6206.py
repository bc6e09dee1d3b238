"""
A 6206 in a pump: clearance
===========================

Life of a deep-groove bearing, by its number, over its radial clearance in operation, under the radial load of a pump.
More clearance leaves the load to fewer balls; the middles of the classes of ISO 5753-1 are marked.
"""

import matplotlib.pyplot as plt
import numpy as np

import raceway as rw

pump = {
    "bearing": {"preset": "6206"},
    "load": {"radial": ["3 kN", 0.0]},
    "kinematics": {"spin_speed_rpm": 2950.0},
}
clearance = np.linspace(0.0, 45e-6, 91)  # m
hours = rw.function(pump, ["bearing.radial_clearance"], ["l10r_hours"])(clearance)["l10r_hours"]

plt.figure(layout="constrained")
plt.plot(1e6 * clearance, hours, color="0.5")
for designation in ("6206/C2", "6206", "6206/C3", "6206/C4"):
    result = rw.run(rw.evolve(pump, {"bearing.preset": designation})).to_dict()
    middle = result["scene"]["bearing"]["radial_clearance"]
    plt.plot(1e6 * middle, result["life"]["l10r_hours"], "o", label=designation)
plt.xlabel("radial clearance [µm]")
plt.ylabel("life L10r [h]")
plt.ylim(0, None)
plt.legend()
share = result["life"]["l10r_hours"] / hours[0]
print(f"6206/C4: {100 * share:.0f} % of the life without clearance")
