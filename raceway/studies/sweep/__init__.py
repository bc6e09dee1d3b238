"""One scene at thousands of points: labelled results in a store that survives whatever stops the sweep.

design      the points: a grid or a list;  survey: mistakes, plug-ins and files in them, before anything is computed
identity    versions and plug-ins that decide the numbers
work        one chain of points, computed wherever an executor wants it;  variables: what is kept of a point
store       states and values on disk;  dataset: the store as xarray data set, NetCDF and CSV
engine      from a design to a finished store
"""

from __future__ import annotations

from raceway.studies.sweep.design import Design, design_file, grid, point_list
from raceway.studies.sweep.engine import Sweep, prepare, sweep
from raceway.studies.sweep.store import Store, open_store

__all__ = ["Design", "Store", "Sweep", "design_file", "grid", "open_store", "point_list", "prepare", "sweep"]
