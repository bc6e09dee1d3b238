"""Ten lines from import to a plot of K(speed), in k-over-speed.png."""

import matplotlib.pyplot as plt
import numpy as np

import raceway as rw

turning = {"kind": "bidirectional", "speed_rpm": "12000 rpm", "unbalance": "320 g mm"}
scene = rw.Scene.from_dict({"bearing": {"preset": "B7206C"}, "excitation": turning})
dataset = rw.sweep(scene, {"excitation.speed_rpm": np.linspace(3000, 18000, 6), "load.axial": [400, 1000]})
plt.figure(layout="constrained")
(dataset.equivalent_stiffness * 1e-6).plot(hue="load.axial", marker="o")
plt.ylabel("equivalent stiffness K [N/µm]")
plt.savefig("k-over-speed.png")
