"""One scene at thousands of points: labelled results in a store that survives whatever stops the sweep.

design      the points: a grid or a list;  survey: mistakes, plug-ins and files in them, before anything is computed
work        one chain of points, computed wherever an executor wants it;  variables: what is kept of a point
store       states and values on disk;  dataset: the store as xarray data set, NetCDF and CSV
engine      from a design to a finished store, through ``raceway.studies.many.engine``
front       ``raceway.sweep``;  command: ``raceway sweep``;  store_command: ``raceway plot``;  screen: what a sweep prints
selection   the part of a store that is drawn or exported;  plotting: how it is laid out;  picture: drawn

Names below are imported when they are first used: the commands stand here, and ``raceway --help`` loads no solver.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

_PUBLIC = {
    **dict.fromkeys(("Design", "design_file", "grid", "point_list"), "design"),
    **dict.fromkeys(("Sweep", "prepare", "sweep"), "engine"),
    **dict.fromkeys(("Store", "open_store"), "store"),
}
__all__ = sorted(_PUBLIC)


def __getattr__(name: str) -> Any:
    if name in _PUBLIC:
        return getattr(import_module(f"{__name__}.{_PUBLIC[name]}"), name)
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
