"""
Hybrid ceramic against steel
============================

A 7014C pair, back to back, with balls of steel and of silicon nitride.
Light balls press less on the outer races at speed: the hybrid pair stays stiffer, and its largest ball load is half that of steel.
"""

import matplotlib.pyplot as plt
import numpy as np

import raceway as rw

pair = rw.Scene.from_toml("""
[bearing]
preset = "7014C"
arrangement = "DB"
preload = 290.0      # N

[kinematics]
spin_speed_rpm = 1000.0
""")
speeds = np.linspace(0, 24000, 49)  # r/min

figure, axes = plt.subplots(1, 2, figsize=(8.0, 3.8), layout="constrained")
for material, words in (("100Cr6", "steel"), ("Si3N4", "hybrid")):
    scene = rw.evolve(pair, {"bearing.balls.material": material})
    answer = rw.function(scene, ["kinematics.spin_speed_rpm"], ["kyy", "largest_ball_load"])(speeds)
    axes[0].plot(speeds, 1e-6 * answer["kyy"], label=words)
    axes[1].plot(speeds, answer["largest_ball_load"], label=words)
    print(f"{words}: largest ball load at 24 000 r/min {answer['largest_ball_load'][-1]:.0f} N")
axes[0].set(xlabel="speed [r/min]", ylabel="kyy [N/µm]", ylim=(0, None))
axes[1].set(xlabel="speed [r/min]", ylabel="largest ball load [N]", ylim=(0, None))
axes[0].legend()
