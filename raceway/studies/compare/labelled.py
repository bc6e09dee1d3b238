"""A comparison as a labelled data set."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from raceway.errors import RacewayError, extra
from raceway.studies.compare.findings import QUANTITIES, Findings
from raceway.studies.sweep.dataset import axis_labels

if TYPE_CHECKING:
    from xarray import Dataset


def labelled(found: Findings) -> Dataset:
    """Numbers and states of all runs, a dimension for each key.

    Raises
    ------
    RacewayError
        xarray is missing.
    """
    try:
        import xarray
    except ImportError as why:
        raise RacewayError(f"labelled results need xarray: {extra('sweep')} ({why})") from None
    keys = [axis.key for axis in found.axes]
    shape = tuple(len(axis.values) for axis in found.axes)
    numbers = {name: np.full(shape, np.nan) for name in (*QUANTITIES, "equivalent_stiffness_error", "equivalent_damping")}
    status = np.full(shape, "waiting", dtype=object)
    for row in found.rows:
        place = tuple(axis.values.index(row.point[axis.key]) for axis in found.axes)
        status[place] = row.result["status"] if row.failed else "done"
        values = {name: row.value(name) for name in QUANTITIES} | {"equivalent_damping": row.damping}
        if row.estimated and values["dynamic_stiffness"] is not None:
            values["equivalent_stiffness_error"] = row.error * values["dynamic_stiffness"]
        for name, value in values.items():
            numbers[name][place] = np.nan if value is None else value
    words = {
        "equivalent_stiffness": "K = Re Z + m w^2",
        "dynamic_stiffness": "size of Z = F/x",
        "equivalent_stiffness_error": "estimated error of K",
        "equivalent_damping": "C = Im Z / w",
    }
    variables = {
        name: (keys, values, {"units": "N s/m" if name == "equivalent_damping" else "N/m", "long_name": words[name]})
        for name, values in numbers.items()
    }
    coordinates = {axis.key: (axis.key, axis_labels(axis.values)) for axis in found.axes}
    return xarray.Dataset({**variables, "status": (keys, status)}, coordinates, {"title": found.title})
