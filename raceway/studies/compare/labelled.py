"""A comparison as a labelled data set."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from raceway.plugins.labelled import labelled_dataset, labels
from raceway.studies.compare.findings import MOVING, Findings
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
    keys = [axis.key for axis in found.axes]
    shape = tuple(len(axis.values) for axis in found.axes)
    moving = found.quantities is MOVING
    extra_words = {
        "equivalent_stiffness_error": ("N/m", "estimated error of K"),
        "equivalent_damping": ("N s/m", "C = Im Z / w"),
    }
    words = {name: (one.si, one.words) for name, one in found.quantities.items()} | (extra_words if moving else {})
    numbers = {name: np.full(shape, np.nan) for name in words}
    status = np.full(shape, "waiting", dtype=object)
    for row in found.rows:
        place = tuple(axis.values.index(row.point[axis.key]) for axis in found.axes)
        status[place] = row.result["status"] if row.failed else "done"
        values = {name: row.value(name) for name in found.quantities}
        if moving:
            z = values["dynamic_stiffness"] if row.estimated else None
            values |= {"equivalent_damping": row.damping, "equivalent_stiffness_error": None if z is None else row.error * z}
        for name, value in values.items():
            numbers[name][place] = np.nan if value is None else value
    variables = {name: (keys, values, labels(name, *words[name])) for name, values in numbers.items()}
    coordinates = {axis.key: (axis.key, axis_labels(axis.values)) for axis in found.axes}
    return labelled_dataset({**variables, "status": (keys, status)}, coordinates, {"title": found.title})
