"""K of a pair over speed, preload and contact angle, and the designs that no other one beats in radial and axial stiffness."""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from scipy.optimize import differential_evolution

import raceway as rw

scene = rw.Scene.from_toml(Path(__file__).with_name("steady_orbit.toml"))
pair = {"bearing.arrangement": "DB", "bearing.row_distance": 0.016, "bearing.preload": 1.0, "load.axial": 0.0}
axes = {
    "bearing.preload": ("preload", np.geomspace(100, 1000, 60), "N"),
    "excitation.speed_rpm": ("speed", np.linspace(1000, 24000, 60), "r/min"),
    "bearing.contact_angle_deg": ("angle", [15.0, 20.0, 25.0], "deg"),
}
columns = [xr.DataArray(x, dims=name, coords={name: (name, x, {"units": unit})}) for name, x, unit in axes.values()]
grid = rw.function(rw.evolve(scene, pair), axes, ["K"])(*columns)
picture = (1e-6 * grid.equivalent_stiffness).assign_attrs(long_name="K", units="N/µm")
picture.plot(x="speed", y="preload", col="angle", yscale="log").fig.savefig("design-map.png")

# The radially stiffest design of every axial stiffness whose pressures stay below 1.5 GPa; generations of the optimiser are columns.
bounds = {
    "bearing.contact_angle_deg": (12, 40),
    "bearing.conformity_inner": (0.51, 0.54),
    "bearing.conformity_outer": (0.51, 0.54),
    "load.axial": (300, 3000),
}
at_rest = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1.0}, "kinematics": {"spin_speed_rpm": 12000.0}}
f = rw.function(at_rest, bounds, ["kxx", "kyy", "p0"])


def optimum(least_kxx):
    def objective(design):
        kxx, kyy, p0 = f.arrays(*design)
        return -1e-6 * kyy + 1e4 * (np.maximum(1.0 - kxx / least_kxx, 0.0) + np.maximum(p0 / 1.5e9 - 1.0, 0.0))

    return differential_evolution(
        objective, list(bounds.values()), vectorized=True, updating="deferred", polish=False, seed=1, maxiter=50
    ).x


front = f(*np.transpose([optimum(least) for least in np.linspace(130e6, 330e6, 9)]))
rng = np.random.default_rng(1)
designs = f(*(rng.uniform(*ends, 20_000) for ends in bounds.values()))
within = designs["p0"] <= 1.5e9
figure, plot = plt.subplots()
plot.plot(1e-6 * designs["kxx"][within], 1e-6 * designs["kyy"][within], ".", ms=1, color="0.7", label="designs at random")
plot.plot(1e-6 * front["kxx"], 1e-6 * front["kyy"], "o-", label="no design is better in both")
plot.set(xlabel="axial stiffness kxx [N/µm]", ylabel="radial stiffness kyy [N/µm]")
plot.legend()
figure.savefig("design-front.png")
