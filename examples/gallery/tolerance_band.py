"""
Tolerances to a band of stiffness
=================================

Load, contact angle and groove of a bearing are known within tolerances; 512 base samples turn them into a band of K.
Total Sobol' indices name the tolerance to tighten first.
"""

import matplotlib.pyplot as plt
import numpy as np

import raceway as rw

scene = {
    "bearing": {"preset": "B7206C"},
    "load": {"axial": "1 kN"},
    "excitation": {"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": "320 g mm"},
}
tolerances = {
    "load.axial": "±10 %",
    "bearing.contact_angle_deg": "±1 deg",
    "bearing.conformity_inner": "±0.002",
}
band = rw.band(scene, tolerances, count=512)
edges, counts = band.histograms["K"]

figure, axes = plt.subplots(1, 2, figsize=(8.0, 3.8), layout="constrained")
axes[0].stairs(counts, 1e-6 * np.array(edges), fill=True, alpha=0.6)
for limit in (band.low["K"], band.high["K"]):
    axes[0].axvline(1e-6 * limit, color="black", linestyle="--")
axes[0].set(xlabel="K [N/µm]", ylabel="samples", title="95 % between the lines")
axes[1].barh([key.rpartition(".")[2] for key in tolerances], band.total["K"])
axes[1].set(xlabel="total Sobol' index of K", xlim=(0, 1))
print(
    f"K = {1e-6 * band.nominal['K']:.1f} N/µm, 95 % from {1e-6 * band.low['K']:.1f} to {1e-6 * band.high['K']:.1f}"
)
