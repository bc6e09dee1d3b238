"""
An own quantity
===============

The difference of a ball's contact angles, which makes it spin in its groove, as a new output of compiled functions.
A plug-in of a few lines computes it for thousands of points at once.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import raceway as rw

file = Path(tempfile.mkdtemp(), "angle_difference.py")
file.write_text("""
import attrs, numpy as np
from raceway import Quantity, hookimpl

@attrs.frozen
class Angles:
    name = "angles"
    numbers = (Quantity("angle_difference", "deg", "difference of contact angles", "angles.difference"),)

    def why_not(self, problem):
        return ""

    def compute(self, points):
        inner, outer = points.contact_angle[:, 0], points.contact_angle[:, 1]
        return {"angle_difference": np.degrees(inner - outer).max(axis=1)}

@hookimpl
def raceway_quantities():
    return [Angles]
""")

scene = {
    "bearing": {"preset": "7014C"},
    "load": {"axial": 1.0},
    "kinematics": {"spin_speed_rpm": 1.0},
}
keys = ["load.axial", "kinematics.spin_speed_rpm"]
loads, speeds = np.linspace(200, 3000, 60), np.linspace(0, 24000, 60)
compiled = rw.function(scene, keys, ["angle_difference"], plugins=[file])
difference = compiled(loads[:, None], speeds)["angle_difference"]

plt.figure(layout="constrained")
lines = plt.contour(speeds, loads, difference, levels=[1, 2, 5, 10, 15, 20])
plt.clabel(lines, fmt="%g deg")
plt.xlabel("speed [r/min]")
plt.ylabel("axial load [N]")
print(f"7014C, 200 N, 24 000 r/min: inner less outer contact angle {difference[0, -1]:.1f} deg")
