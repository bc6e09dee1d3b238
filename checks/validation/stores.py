"""Results of a sweep made up from formulas, in the layout that a sweep gives: known numbers for plots and tables."""

import json
from typing import Any

import numpy as np
import xarray

from raceway.extend import STIFFNESS
from raceway.testing import b7206c

DOFS = ["x", "y", "z", "tilt_y", "tilt_z"]
MASS = 2.061
UNITS = {
    "excitation.speed_rpm": "r/min", "load.axial": "N", "excitation.direction_deg": "deg",
    "kinematics.spin_speed_rpm": "r/min",
}  # fmt: skip
SPEEDS = np.linspace(2000.0, 30000.0, 9)


def stiffness(speed_rpm: Any, axial: Any) -> Any:
    """K [N/m], smooth in both."""
    return 1e8 * (1.0 + (axial / 1000.0) ** 0.4 - 0.3 * (speed_rpm / 30000.0) ** 2)


def damping(speed_rpm: Any) -> Any:
    """C [N s/m], far below the bound of a smoothing spline."""
    return 0.4 + 0.2 * np.sin(speed_rpm / 2000.0)


def scene(**tables: Any) -> dict[str, Any]:
    """A scene's tables with what the readers look at."""
    tables = {"excitation": {"kind": "bidirectional", "speed_rpm": 12000.0}, **tables}
    found = b7206c(supports={"tilt": "locked", "axial": "force"}, rotor={"mass": 2.0}, **tables)
    return {**found, "title": "made up"}


def made(axes: dict[str, Any], tables: dict[str, Any] | None = None, **changed: Any) -> xarray.Dataset:
    """A finished grid over ``axes``; keywords replace variables by functions of the axes' values."""
    names = list(axes)
    grids = np.meshgrid(*(np.asarray(values) for values in axes.values()), indexing="ij")
    at = dict(zip(names, grids, strict=True))
    shape = grids[0].shape
    speed = at.get("excitation.speed_rpm", np.full(shape, 12000.0))
    axial = at.get("load.axial", np.full(shape, 1000.0))
    w = speed * np.pi / 30.0
    k, c = stiffness(speed, axial), damping(speed)
    spring = np.zeros((*shape, 5, 5))
    for n, value in enumerate((6e7, 2e8, 3e8, 2e4, 3e4)):
        spring[..., n, n] = value
    values = {
        "z_real": ("N/m", k - MASS * w**2), "z_imag": ("N/m", w * c), "equivalent_stiffness": ("N/m", k),
        "equivalent_damping": ("N s/m", c), "force_amplitude": ("N", 3.195e-4 * w**2),
        "frequency": ("Hz", w / (2.0 * np.pi)), "mass": ("kg", np.full(shape, MASS)),
        "forward_amplitude": ("m", 1e-6 + 0.0 * w), "backward_amplitude": ("m", 1e-14 + 0.0 * w),
        "p0": ("Pa", 1.5e9 + 0.0 * w), "error_total": ("1", 1e-7 + 0.0 * w),
    }  # fmt: skip
    values |= {name: (values[name][0], function(at)) for name, function in changed.items() if name in values}
    variables: dict[str, Any] = {
        name: (names, array, {"units": unit, "long_name": name.replace("_", " ")}) for name, (unit, array) in values.items()
    }
    spring = changed["stiffness"](at) if "stiffness" in changed else spring
    variables["stiffness"] = ([*names, "dof", "dof2"], spring, STIFFNESS.labels)
    variables["status"] = (names, np.full(shape, "run", dtype=object))
    coords: dict[str, Any] = {
        key: (key, list(values), {"units": UNITS.get(key, "1"), "long_name": key}) for key, values in axes.items()
    }
    attributes = {"scene": json.dumps(tables or scene()), "schema": 1}
    return xarray.Dataset(variables, {**coords, "dof": DOFS, "dof2": DOFS}, attributes)


def as_list(dataset: xarray.Dataset) -> xarray.Dataset:
    """The same points as a sweep over a list gives them: one dimension, the keys as coordinates, in another order."""
    keys = [str(name) for name in dataset.dims if "." in str(name)]
    flat = dataset.stack(point=keys).transpose("point", ...)
    plain = {key: ("point", flat[key].values, dataset[key].attrs) for key in keys}
    flat = flat.drop_vars(["point", *keys]).assign_coords(plain)
    return flat.isel(point=np.random.default_rng(4).permutation(flat.sizes["point"]))
