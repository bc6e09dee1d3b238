"""K over axial load, speed and contact angle, and the designs that no other one beats in both K and ball load: design-map.png."""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr

import raceway as rw

scene = rw.Scene.from_toml(Path(__file__).with_name("steady_orbit.toml"))
keys = ["load.axial", "excitation.speed_rpm", "bearing.contact_angle_deg"]
loads = xr.DataArray(np.geomspace(300, 3000, 60), dims="load", attrs={"units": "N", "long_name": "axial load"})
speeds = xr.DataArray(np.linspace(1000, 24000, 60), dims="speed", attrs={"units": "r/min", "long_name": "speed"})
angles = xr.DataArray([15.0, 20.0, 25.0], dims="angle", attrs={"units": "deg", "long_name": "contact angle"})
grid = rw.function(scene, keys, ["K"])(
    *(values.assign_coords({values.dims[0]: values}) for values in (loads, speeds, angles))
)
picture = (
    (1e-6 * grid.equivalent_stiffness)
    .assign_attrs(long_name="K", units="N/µm")
    .plot(x="speed", y="load", col="angle", yscale="log")
)
picture.fig.savefig("design-map.png")

# A million designs at random; on the front no other one is stiffer at no larger a load.
rng = np.random.default_rng(1)
n = 1_000_000
design = {
    "bearing.contact_angle_deg": rng.uniform(12, 30, n),
    "bearing.conformity_inner": rng.uniform(0.51, 0.54, n),
    "load.axial": rng.uniform(300, 3000, n),
}
answer = rw.function(scene, design, ["kyy", "largest_ball_load"])(**design)
order = np.argsort(answer["largest_ball_load"])
stiffest = np.maximum.accumulate(np.nan_to_num(answer["kyy"][order]))
front = order[answer["kyy"][order] >= stiffest]
figure, axes = plt.subplots()
axes.plot(answer["largest_ball_load"][:5000], 1e-6 * answer["kyy"][:5000], ".", ms=1, color="0.7")
axes.plot(answer["largest_ball_load"][front], 1e-6 * answer["kyy"][front], label="no design is better in both")
axes.set(xlabel="largest ball load [N]", ylabel="radial stiffness kyy [N/µm]")
axes.legend()
figure.savefig("design-front.png")
