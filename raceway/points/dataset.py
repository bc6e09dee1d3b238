"""A store as a labelled data set, as NetCDF, and as CSV."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Iterator, Sequence
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING
from warnings import warn

import attrs
import numpy as np
from numpy.typing import ArrayLike

from raceway.answers.quantities import COLUMNS, ERROR_BODIES, Quantity, named
from raceway.errors import ConvergenceError, RacewayError, extra
from raceway.framework.loading.registry import Registry, default_registry
from raceway.pipeline.result import Result
from raceway.plugins.formats import labelled_dataset
from raceway.points.axes import Design, is_number
from raceway.points.column_quantities import MOVING
from raceway.points.function import PointStatus
from raceway.points.store import DAMAGED, POINTS, Store, connected, told
from raceway.points.workload import key_facts
from raceway.scene.scene import Scene, scene_from_dict
from raceway.storage.files import scratch_file, write_whole
from raceway.storage.tables import ReadTables, Tables

if TYPE_CHECKING:
    from sqlite3 import Connection

    import xarray

#: Coordinates of the ring, in the order of ``displacement`` and ``stiffness``.
DOF = ("x", "y", "z", "tilt_y", "tilt_z")

#: Arrays over ``DOF`` among the columns.
_ARRAYS = {name: quantity for name, quantity in COLUMNS.items() if quantity.dims}
_NUMBERS = [name for name in COLUMNS if name not in _ARRAYS]
_WARNINGS = Quantity("warnings", "1", "number of warnings of the point; texts in the JSON and the CSV")


def values_of(result: Result) -> Tables:
    """Plain numbers and lists of a result; what it does not have is absent."""
    values: Tables = {}
    for name, quantity in (COLUMNS | named(ERROR_BODIES)).items():
        value = quantity.of(result)
        if quantity.dims:
            values[name] = value.tolist()
        elif value is not None and math.isfinite(value):
            values[name] = float(value)
    return values | {name: v for name, v in result.quantities.items() if isinstance(v, float) and math.isfinite(v)}


#: Status of points that have numbers.
FINISHED = ("computed", "run")
#: What runs say of a point beyond the columns.
NOT_CHECKED = "Not checked at computed points: stability of orbits, further orbits, warnings; raceway run does"
RESULTS, TABLE = "results.nc", "results.csv"
#: Dimensions, values and attributes of a variable.
Labelled = tuple[tuple[str, ...], np.ndarray, dict[str, str]]


class SweepStore(Store):
    """The store of a sweep: a row for each point of its design; ``open_store`` reads one.

    design : points, in the order of their numbers
    facts : scene (all keys, at the first point), given (what of it was said), design, labels of plug-ins' quantities, identity (versions and plug-ins), files, schema, created
    """

    def __init__(self, path: Path, connection: Connection) -> None:
        super().__init__(path, connection)
        if "design" not in self.facts:
            raise RacewayError(f"`{path}` is no store of a sweep: it holds the rows of another command")
        self.design = Design.from_dict(self.facts["design"])

    @property
    def title(self) -> str:
        return str(self.facts["scene"]["title"])

    @property
    def scene(self) -> Tables:
        """Every key of the scene at the first point."""
        return dict(self.facts["scene"])

    @property
    def labels(self) -> dict[str, dict[str, str]]:
        """Of the quantities with one number a point: attributes by name."""
        return {name: COLUMNS[name].labels for name in _NUMBERS} | dict(self.facts["quantities"])

    def status(self) -> dict[str, int]:
        """Number of points in each state, and ``total``; of those that are done, how many the compiled loop ``in_loops``."""
        counts, total, blocks = self.counts(), self.design.size, self.costs(str)
        in_loops, refusals = (sum(cost[how.name] for cost in blocks) for how in (PointStatus.COMPUTED, PointStatus.REFUSED))
        finished, failures = counts["done"] - len(blocks) + in_loops, counts["failed"] + refusals
        left = total - finished - failures
        return {"waiting": left, "done": finished, "failed": failures, "computed": in_loops, "total": total}

    def rows(self) -> Iterator[Tables]:
        """``{point, status, reason, values, warnings}`` of every point, in the order of the design."""
        return points_of(self).rows()

    def to_xarray(self) -> xarray.Dataset:
        """The labelled results: a dimension for each axis of a grid, or ``point`` for a list."""
        return dataset(self)


def block_edges(size: int, length: int) -> dict[str, tuple[int, int]]:
    """Key of each block's row -> its first point and that after its last one; none where points are rows (``length`` 0)."""
    edges = ((first, min(first + length, size)) for first in (range(0, size, length) if length else ()))
    return {f"{first}:{last}": (first, last) for first, last in edges}


def open_store(path: str | Path) -> SweepStore:
    """The store of a sweep to read; the sweep may be writing to it.

    RacewayError: No such store there, or one of another schema.
    """
    folder = Path(path)
    if not (folder / POINTS).is_file():
        raise RacewayError(f"`{folder}` is no store of a sweep: it has no {POINTS}. `raceway sweep` makes one")
    with told(folder):
        return SweepStore(folder, connected(folder))


#: Words for the status of a block's point: what the loop has left waits for its run.
_STATUS = np.array(["computed", "run", "refused", "waiting"], dtype=object)


@attrs.frozen(eq=False)
class Points:
    """What is stored of all points, by their numbers."""

    design: Design
    columns: dict[str, np.ndarray]  # quantity -> (n, ...), nan where a point has none
    status: np.ndarray  # (n,) words
    #: reasons, warnings : of points that have some
    reasons: dict[int, str]
    warnings: dict[int, list[str]]
    damaged: int  # number of points whose rows are

    def rows(self) -> Iterator[Tables]:
        """``{point, status, reason, values, warnings}`` of every point."""
        for number, status in enumerate(self.status.tolist()):
            values = {name: column[number] for name, column in self.columns.items() if status in FINISHED}
            without_limit = ", ".join(name for name, value in values.items() if np.isposinf(value).any())
            yield {
                "point": self.design.point(number),
                "status": status,
                "reason": self.reasons.get(number, f"{without_limit}: no limit" if without_limit else ""),
                "values": {name: value.tolist() for name, value in values.items() if np.isfinite(value).any()},
                "warnings": self.warnings.get(number, []),
            }


def points_of(store: SweepStore) -> Points:
    """All points of a store."""
    size, length = store.design.size, store.facts["block"]
    points = Points(store.design, {}, np.full(size, "waiting", dtype=object), {}, {}, 0)
    faults, numbers = 0, list(range(size))

    def put(name: str, where: int | slice, value: ArrayLike, shape: tuple[int, ...]) -> None:
        if name not in points.columns:
            points.columns[name] = np.full((size, *shape), np.nan)
        points.columns[name][where] = value

    for key, (first, last) in block_edges(size, length).items():
        numbers, row = [], store.get(key)
        if row.state != "done":
            faults += (last - first) * (row.reason == DAMAGED)
            continue
        points.status[first:last] = _STATUS[row.content.pop("status")]
        for number, reason in ((int(key), words) for key, words in json.loads(row.reason).items()):
            if points.status[number] == "computed":  # with numbers, of which it warns
                points.warnings[number] = [reason]
            else:
                points.reasons[number] = reason
        for name, column in row.content.items():
            put(name, slice(first, last), column, column.shape[1:])
    for number in numbers or sorted(k for k in store.keys("done") | store.keys("failed") if isinstance(k, int)):
        row = store.get(number)
        points.status[number] = "run" if row.state == "done" else row.state
        faults += row.reason == DAMAGED
        points.reasons.update({number: row.reason} if row.reason else {})
        points.warnings.update({number: row.content.get("warnings", [])} if row.state == "done" else {})
        values = dict.fromkeys(row.content.get("unlimited", []), math.inf) | row.content.get("values", {})
        for name, value in values.items():
            put(name, number, value, np.shape(value))
    return attrs.evolve(points, damaged=faults)


def dataset(store: SweepStore, registry: Registry | None = None) -> xarray.Dataset:
    """The data set of a store: states, and the variables that its scenes have; RacewayError without xarray."""
    design = store.design
    dims = ("point",) if design.listed else design.keys
    points, shape = points_of(store), design.shape
    warnings, faults = np.full(design.size, np.nan), points.damaged
    warnings[list(points.warnings)] = [len(texts) for texts in points.warnings.values()]
    variables: dict[str, Labelled] = {"status": (dims, points.status.reshape(shape), {"long_name": "state of the point"})}
    if points.columns:
        variables[_WARNINGS.name] = (dims, warnings.reshape(shape), _WARNINGS.labels)
    forms: dict[str, tuple[tuple[str, ...], dict[str, str]]] = {name: ((), labels) for name, labels in store.labels.items()}
    forms |= {name: (quantity.dims, quantity.labels) for name, quantity in _ARRAYS.items()}
    for name, (further, labels) in forms.items():
        if name in points.columns:
            column = points.columns[name]
            variables[name] = ((*dims, *further), column.reshape(*shape, *column.shape[1:]), labels)
    attributes = {
        "title": store.title,
        "scene": json.dumps(store.scene),
        "given": json.dumps(store.facts["given"]),
        "plugins": json.dumps(store.facts["identity"]["plugins"]),
        "raceway": store.facts["identity"]["raceway"],
        "program": store.facts["identity"]["program"],
        "schema": store.facts["schema"],
        "created": store.facts["created"],
        "note": "NaN: not finished, or not estimated; see status. " + NOT_CHECKED,
        "damaged_rows": faults,
    }
    if faults:
        text = f"{faults} of {design.size} rows are damaged, read as waiting; --resume computes them again"
        warn(f"`{store.path}`: {text}", stacklevel=3)
    try:
        scene: Scene | None = scene_from_dict(store.scene, registry or default_registry())
    except RacewayError:  # its plug-ins are not installed here: values are there, units of its keys are not
        scene = None
    names = np.array(DOF, dtype=object)
    coordinates: dict[str, Labelled] = {"dof": (("dof",), names, {}), "dof2": (("dof2",), names, {})}
    for axis in design.axes:
        unit, words = ("", "") if scene is None else key_facts(scene, axis.key)
        about = {"units": unit or "1", "long_name": axis.key, "description": words}
        coordinates[axis.key] = (("point" if design.listed else axis.key,), axis_labels(axis.values), about)
    if design.listed:
        coordinates["point"] = (("point",), np.arange(design.size), {"long_name": "number of the point in the list"})
    return labelled_dataset(variables, coordinates, attributes)


def all_failed(store: SweepStore) -> ConvergenceError | None:
    """A sweep without any result is none: the error, with the first point's reason."""
    states = store.status()
    if states["failed"] < states["total"]:
        return None
    return ConvergenceError(f"all {states['total']} points failed; the first: {points_of(store).reasons[0]}")


def axis_labels(values: Sequence[object]) -> np.ndarray:
    """Numbers as numbers, booleans as booleans; anything else as text."""
    if all(is_number(value) for value in values) or all(isinstance(value, bool) for value in values):
        return np.array(values)
    return np.array([value if isinstance(value, str) else json.dumps(value) for value in values], dtype=object)


def blank(design: Design, scene: ReadTables) -> xarray.Dataset:
    """Ones in the layout of a sweep's data set, with all quantities that its scenes may have."""
    dims = ("point",) if design.listed else design.keys
    names = [name for name in COLUMNS if scene.get("excitation") is not None or name not in MOVING]
    variables = {}
    for name in names:
        quantity = COLUMNS[name]
        shape = *design.shape, *(len(DOF) for _ in quantity.dims)
        variables[name] = ((*dims, *quantity.dims), np.broadcast_to(1.0, shape), quantity.labels)
    axes = {axis.key: (dims if design.listed else (axis.key,), axis_labels(axis.values)) for axis in design.axes}
    return labelled_dataset(variables, {**axes, "dof": list(DOF), "dof2": list(DOF)}, {"scene": json.dumps(scene)})


def write_netcdf(store: SweepStore) -> Path:
    """``results.nc`` in the store, whole or not at all; RacewayError without a library or room on the disk."""
    try:
        # In memory first: the HDF5 library takes the whole process down where a disk is full.
        content = dataset(store).to_netcdf(engine="h5netcdf")
    except (ImportError, ValueError) as why:
        raise RacewayError(f"NetCDF needs h5netcdf and h5py: {extra('sweep')} ({why})") from None
    return write_whole(content, store.path / RESULTS)


def write_csv(store: SweepStore, path: Path) -> Path:
    """All points and their numbers as CSV, a line each; RacewayError where it cannot be written."""
    with scratch_file(path, "Choose another place.") as scratch, scratch.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows(_lines(store))
    return path


def _lines(store: SweepStore) -> Iterator[list[object]]:
    places = {name: list(product(DOF, repeat=len(quantity.dims))) for name, quantity in _ARRAYS.items()}
    heads = [f"{name}_{'_'.join(entry)}" for name in _ARRAYS for entry in places[name]]
    numbers = list(store.labels)
    yield [*store.design.keys, "status", "reason", "warnings", *numbers, *heads]
    for row in store.rows():
        values = row["values"]
        arrays = [np.ravel(values[name]).tolist() if name in values else [""] * len(places[name]) for name in _ARRAYS]
        point = [v if isinstance(v, str) or is_number(v) else json.dumps(v) for v in row["point"].values()]
        words = [row["status"], row["reason"], "; ".join(row["warnings"])]
        yield [*point, *words, *(values.get(n, "") for n in numbers), *(v for a in arrays for v in a)]
