"""
Folds of an orbit
=================

Under a light axial load K depends on the amplitude, and the response over speed folds back.
The branch is followed through both folds; between their speeds three orbits exist.
"""

import matplotlib.pyplot as plt
import numpy as np

import raceway as rw

scene = {
    "bearing": {"preset": "B7206C"},
    "supports": {"tilt": "free"},
    "rotor": {"mass": "2 kg", "damping": 200.0},
    "load": {"axial": "400 N"},
    "excitation": {
        "kind": "unidirectional",
        "speed_rpm": 12000.0,
        "amplitude": "constant",
        "force": "40 N",
    },
    "kinematics": {"ball_inertia": False},
}
branch = rw.follow(scene, "excitation.speed_rpm=15000:22000")
speed = np.array([orbit.parameter for orbit in branch.rows])
amplitude = 1e6 * np.array([orbit.amplitude for orbit in branch.rows])
stable = np.array([orbit.multiplier <= 1.0 for orbit in branch.rows])

plt.figure(layout="constrained")
plt.plot(speed, amplitude, color="0.7")
plt.plot(speed[stable], amplitude[stable], ".", label="stable")
plt.plot(speed[~stable], amplitude[~stable], ".", label="unstable")
plt.xlabel("speed [r/min]")
plt.ylabel("amplitude [µm]")
plt.legend()
folds = [label.row.parameter for label in branch.labels if label.kind == "fold"]
print("folds at", ", ".join(f"{fold:.0f} r/min" for fold in folds))
