"""A precision study as a labelled data set."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from raceway.plugins.labelled import labelled_dataset, labels

if TYPE_CHECKING:
    from xarray import Dataset

    from raceway.studies.precision.result import Precision


def labelled(found: Precision) -> Dataset:
    """Error, time and value of every setting.

    Raises
    ------
    RacewayError
        xarray is missing.
    """
    content = found.to_dict()
    about = {
        "value": ("N/m", "size of Z, or of the tangent where nothing is identified"),
        "error": ("1", "relative error against the reference of the row's model"),
        "own_error": ("1", "relative error that the run estimates itself"),
        "time_s": ("s", "of the fastest repeat, compiling apart"),
    }
    rows = content["rows"]
    variables = {
        name: (
            "setting",
            np.array([np.nan if row[name] is None else row[name] for row in rows], dtype=float),
            labels(name, unit, words),
        )
        for name, (unit, words) in about.items()
    }
    names = np.array([text["setting"].lstrip("* ") for text in found.table()], dtype=object)
    more = {name: ("setting", np.array([row[name] for row in rows], dtype=object)) for name in ("family", "status")}
    return labelled_dataset({**variables, **more}, {"setting": names}, {"title": found.title})
