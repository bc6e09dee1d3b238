"""
Contact angle from measured stiffness
=====================================

Five axial stiffnesses with their errors determine the contact angle of a bearing as it was made.
The interval includes the uncertainty of its grooves, which are inferred from printed ratings.
"""

import matplotlib.pyplot as plt
import numpy as np

import raceway as rw

scene = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}
measured = {
    "load.axial [N]": np.array([400.0, 600.0, 1000.0, 1500.0, 2000.0]),
    "kxx [N/µm]": np.array([42.5, 51.2, 66.6, 82.1, 97.3]),
    "kxx error [N/µm]": np.array([0.4, 0.5, 0.7, 0.8, 1.0]),
}
fitted = rw.fit(measured, scene, ["bearing.contact_angle_deg"])
angle, half_width = (
    fitted["bearing.contact_angle_deg"],
    fitted.half_width("bearing.contact_angle_deg"),
)

loads = np.linspace(300, 2200, 50)
compiled = rw.function(scene, ["load.axial", "bearing.contact_angle_deg"], ["kxx"])
plt.figure(layout="constrained")
plt.errorbar(
    *list(measured.values())[:2], yerr=measured["kxx error [N/µm]"], fmt="o", label="measured"
)
for degrees, label in ((15.0, "15 deg, of the catalogue"), (angle, f"{angle:.1f} deg, fitted")):
    plt.plot(loads, 1e-6 * compiled(loads, degrees)["kxx"], label=label)
plt.xlabel("axial load [N]")
plt.ylabel("kxx [N/µm]")
plt.legend()
print(f"contact angle {angle:.1f} ± {half_width:.1f} deg")
