"""Where k(speed) hardens and softens, over axial load, speed, tilt and contact angle: a map of 1020 points in hardening-map.png."""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import raceway as rw

axes = {
    "bearing.contact_angle_deg": [15, 25, 40],
    "supports.tilt": ["locked", "free"],
    "load.axial": [50, 100, 200, 400, 700, 1000, 2000, 4000, 7000, 10000],
    "excitation.speed_rpm": [1000, *np.arange(2500, 20000, 2500), *np.arange(20000, 60001, 5000)],
}
if __name__ == "__main__":  # processes that work for this one import it
    points = rw.sweep(Path(__file__).with_suffix(".toml"), axes, executor="processes", progress=True)
    k = points.equivalent_stiffness
    change = 100 * (k / k.isel({"excitation.speed_rpm": 0}) - 1)
    change = change.assign_attrs(long_name="change of k since 1000 r/min", units="%")
    shown = {
        "row": "supports.tilt",
        "col": "bearing.contact_angle_deg",
        "yscale": "log",
        "vmin": -50,
        "vmax": 50,
        "cmap": "RdBu_r",
    }
    picture = change.plot(x="excitation.speed_rpm", y="load.axial", **shown)
    picture.set_axis_labels("speed [r/min]", "axial load [N]")
    plt.savefig("hardening-map.png")
