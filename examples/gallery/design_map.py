"""
Design map of a million points
==============================

Stiffness and peak pressure of a 7014C over axial load, speed and contact angle, by one call that is compiled.
Here each axis has 32 values, some 33 000 points; ``count = 100`` makes it a million, in some 15 seconds.
"""

import time

import matplotlib.pyplot as plt
import numpy as np

import raceway as rw

count = 32  # values of each axis

scene = {
    "bearing": {"preset": "7014C"},
    "load": {"axial": 1.0},
    "kinematics": {"spin_speed_rpm": 1.0},
}
keys = ["load.axial", "kinematics.spin_speed_rpm", "bearing.contact_angle_deg"]
loads, speeds, angles = (
    np.linspace(200, 3000, count),
    np.linspace(0, 20000, count),
    np.linspace(12, 30, count),
)

compiled = rw.function(scene, keys, ["kyy", "p0"])
start = time.perf_counter()
answer = compiled(loads[:, None, None], speeds[None, :, None], angles)
seconds = time.perf_counter() - start

figure, axes = plt.subplots(1, 2, sharey=True, layout="constrained", figsize=(8.0, 3.8))
for plot, index in zip(axes, (count // 6, count - 1), strict=True):
    colours = plot.pcolormesh(speeds, loads, 1e-6 * answer["kyy"][:, :, index], vmin=0, vmax=500)
    limit = plot.contour(
        speeds, loads, 1e-9 * answer["p0"][:, :, index], levels=[1.0, 1.2, 1.4], colors="white"
    )
    plot.clabel(limit, fmt="%g GPa")
    plot.set(xlabel="speed [r/min]", title=f"{angles[index]:.0f} deg")
axes[0].set_ylabel("axial load [N]")
figure.colorbar(colours, label="kyy [N/µm]")

print(
    f"{answer['kyy'].size} points in {seconds:.2f} s, {1e6 * seconds / answer['kyy'].size:.0f} µs per point"
)
