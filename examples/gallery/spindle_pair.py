"""
Spindle pair: spacer or spring
==============================

Two B7206C back to back carry a spindle.  Rigid spacers and a spring give the same preload at rest, and another stiffness at speed.
"""

import matplotlib.pyplot as plt
import numpy as np

import raceway as rw

spindle = {
    "bearing": {
        "preset": "B7206C",
        "arrangement": "DB",
        "preload": "300 N",
        "preload_kind": "rigid",
    },
    "mounting": {"shaft_interference": "5 um"},
    "kinematics": {"ring_growth": True},
    "rotor": {"mass": 3.0},
    "excitation": {
        "kind": "bidirectional",
        "speed_rpm": 12000.0,
        "amplitude": "constant",
        "force": "10 N",
    },
}
swept = rw.sweep(
    spindle,
    {
        "bearing.preload_kind": ["rigid", "spring"],
        "excitation.speed_rpm": np.linspace(1000, 30000, 15),
    },
)
stiffness = 1e-6 * swept.equivalent_stiffness

figure, axes = plt.subplots(layout="constrained")
for kind, words in (("rigid", "rigid spacers"), ("spring", "spring")):
    axes.plot(
        swept["excitation.speed_rpm"],
        stiffness.sel({"bearing.preload_kind": kind}),
        "o-",
        label=words,
    )
axes.set(xlabel="speed [r/min]", ylabel="K [N/µm]", ylim=(0, None))
axes.legend()

fastest = stiffness.isel({"excitation.speed_rpm": -1}).values
print(f"K at 30 000 r/min: {fastest[0]:.0f} N/µm with spacers, {fastest[1]:.0f} N/µm with a spring")
