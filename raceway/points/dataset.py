"""A store as a labelled data set, as NetCDF, and as CSV."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Iterator, Mapping
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING
from warnings import warn

import attrs
import numpy as np
from numpy.typing import ArrayLike

from raceway.errors import RacewayError, extra
from raceway.framework.registry import Registry, default_registry
from raceway.out.quantities import COLUMNS, ERROR_BODIES, Quantity, named
from raceway.plugins.labelled import labelled_dataset
from raceway.points.axes import Design, is_number
from raceway.points.blocks import block_edges, block_key
from raceway.points.function import PointStatus
from raceway.points.store import DAMAGED, POINTS, Row, Store, connected, told
from raceway.points.survey import key_facts
from raceway.scene.reading import scene_from_dict
from raceway.scene.scene import Scene
from raceway.storage.files import scratch_file, write_whole
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from collections.abc import Sequence
    from sqlite3 import Connection

    import h5netcdf
    import xarray

    from raceway.pipeline.result import Result


#: Coordinates of the ring, in the order of ``displacement`` and ``stiffness``.
DOF = ("x", "y", "z", "tilt_y", "tilt_z")

#: Arrays over ``DOF`` among the columns.
_ARRAYS = {name: quantity for name, quantity in COLUMNS.items() if quantity.dims}
_NUMBERS = [name for name in COLUMNS if name not in _ARRAYS]
_WARNINGS = Quantity("warnings", "1", "number of warnings of the point: their words are in the JSON and the CSV")


def values_of(result: Result) -> Tables:
    """Plain numbers and lists of a result; what it does not have is absent."""
    values: Tables = {}
    for name, quantity in (COLUMNS | named(ERROR_BODIES)).items():
        value = quantity.of(result)
        if quantity.dims:
            values[name] = value.tolist()
        elif value is not None and math.isfinite(value):
            values[name] = float(value)
    return values


#: What runs say of a point beyond the columns.
NOT_LOOKED_AT = "Of computed points the stability of orbits, other orbits and warnings are not looked at: raceway run does"
RESULTS, TABLE = "results.nc", "results.csv"
#: Words of any length, as HDF5 has them.
_WORDS = np.dtype("O", metadata={"vlen": str})
#: Dimensions, values and attributes of a variable.
Labelled = tuple[tuple[str, ...], np.ndarray, dict[str, str]]


class SweepStore(Store):
    """The store of a sweep: a row for each point of its design; ``open_store`` reads one.

    Attributes
    ----------
    design : points, in the order of their numbers
    facts : scene (all keys, at the first point), design, identity (versions and plug-ins), files, schema, created
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

    def status(self) -> dict[str, int]:
        """Number of points in each state, and ``total``; of those that are done, how many the compiled loop ``computed``."""
        counts, total, length = self.counts(), self.design.size, self.facts["block"]
        if length:
            rows = self.costs()
            computed, refused = (sum(cost[how.name] for cost in rows) for how in (PointStatus.COMPUTED, PointStatus.REFUSED))
            counts = {
                "done": counts["done"] - len(rows) + computed,
                "failed": counts["failed"] + refused,
                "computed": computed,
            }
        waiting = total - counts["done"] - counts["failed"]
        return {
            "waiting": waiting,
            "done": counts["done"],
            "failed": counts["failed"],
            "computed": 0,
            **counts,
            "total": total,
        }

    def blocks(self) -> Iterator[tuple[int, int, Row]]:
        """The first point of each block, that after its last one, and its row."""
        for first, last in block_edges(self.design.size, self.facts["block"]):
            yield first, last, self.get(block_key(first, last - first))

    def runs(self) -> Iterator[Row]:
        """The rows of single points; beside blocks those alone that are finished."""
        if not self.facts["block"]:
            return (self.get(number) for number in range(self.design.size))
        return (self.get(key) for key in sorted(k for k in self.keys("done") | self.keys("failed") if isinstance(k, int)))

    def rows(self) -> Iterator[Tables]:
        """``{point, status, reason, values, warnings, cost}`` of every point, in the order of the design."""
        runs = {row.key: row for row in self.runs()} if self.facts["block"] else {}
        for first, last, block in self.blocks():
            reasons = json.loads(block.reason) if block.state == "done" else {}
            status = _status_of(block, last - first)
            for number, word in enumerate(status.tolist(), first):
                if number in runs:
                    yield self._row(runs[number])
                    continue
                k = number - first
                values = {n: v[k].tolist() for n, v in block.content.items() if n != "status"} if word == "computed" else {}
                values = {name: value for name, value in values.items() if isinstance(value, list) or math.isfinite(value)}
                reason = reasons.get(str(number), "")
                yield self._row(Row(number, word, reason, {"values": values}, {}))
        if not self.facts["block"]:
            yield from map(self._row, self.runs())

    def remarks(self) -> Iterator[Tables]:
        """``rows`` of points that failed or that warn, those of blocks first."""
        for _, _, block in self.blocks():
            reasons = json.loads(block.reason) if block.state == "done" else {}
            yield from (self._row(Row(int(number), "refused", reason, {}, {})) for number, reason in reasons.items())
        yield from (self._row(row) for row in self.runs() if row.state == "failed" or row.content.get("warnings"))

    def _row(self, row: Row) -> Tables:
        content = {"values": {}, "warnings": [], **row.content}
        point = self.design.point(int(row.key))
        return {
            "point": point,
            "status": _STATUS.get(row.state, row.state),
            "reason": row.reason,
            **content,
            "cost": row.cost,
        }

    def to_xarray(self) -> xarray.Dataset:
        """The labelled results: a dimension for each axis of a grid, or ``point`` for a list."""
        return dataset(self)


#: What a point's status is called where its row has another word.
_STATUS = {"done": "run"}
_OF_BLOCK = np.array(["computed", "run", "refused", "waiting"], dtype=object)


def _status_of(block: Row, count: int) -> np.ndarray:
    """(n,) of the points of a block: what the loop has left waits for its run."""
    return _OF_BLOCK[block.content["status"]] if block.state == "done" else np.full(count, "waiting", dtype=object)


def open_store(path: str | Path) -> SweepStore:
    """The store of a sweep to read; the sweep may be writing to it.

    Raises
    ------
    RacewayError
        No such store there, or one of another schema.
    """
    folder = Path(path)
    if not (folder / POINTS).is_file():
        raise RacewayError(f"`{folder}` is no store of a sweep: it has no {POINTS}. `raceway sweep` makes one")
    with told(folder):
        return SweepStore(folder, connected(folder))


@attrs.frozen
class _Table:
    """The labelled results of a store, before any library of arrays has them.

    Attributes
    ----------
    variables, coordinates : name -> its dimensions, values and attributes
    attributes : of the whole
    """

    variables: dict[str, Labelled]
    coordinates: dict[str, Labelled]
    attributes: dict[str, str | int]


def dataset(store: SweepStore, registry: Registry | None = None) -> xarray.Dataset:
    """The data set of a store: states, and the variables that its scenes have.

    Raises
    ------
    RacewayError
        xarray is missing.
    """
    table = _table_of(store, registry)
    return labelled_dataset(table.variables, table.coordinates, table.attributes)


def _table_of(store: SweepStore, registry: Registry | None = None) -> _Table:
    """The same as plain arrays: xarray, and what it imports, takes longer than a hundred points."""
    design = store.design
    dims = ("point",) if design.listed else design.keys
    columns, status, warnings, damaged = _columns(store)
    variables: dict[str, Labelled] = {"status": (dims, status.reshape(design.shape), {"long_name": "state of the point"})}
    if columns:
        variables[_WARNINGS.name] = (dims, warnings.reshape(design.shape), _WARNINGS.labels)
    for name, column in columns.items():
        shape, quantity = (*design.shape, *column.shape[1:]), COLUMNS[name]
        variables[name] = ((*dims, *quantity.dims), column.reshape(shape), quantity.labels)
    attributes = {
        "title": store.title,
        "scene": json.dumps(store.scene),
        "plugins": json.dumps(store.facts["identity"]["plugins"]),
        "raceway": store.facts["identity"]["raceway"],
        "program": store.facts["identity"]["program"],
        "schema": store.facts["schema"],
        "created": store.facts["created"],
        "note": "NaN: not finished, or not estimated; see status. " + NOT_LOOKED_AT,
        "damaged_rows": damaged,
    }
    if damaged:
        warn(
            f"`{store.path}`: {damaged} of {design.size} rows are damaged and read as waiting; --resume computes them again",
            stacklevel=3,
        )
    return _Table(variables, _coordinates(store, registry or default_registry()), attributes)


def _columns(store: SweepStore) -> tuple[dict[str, np.ndarray], np.ndarray, np.ndarray, int]:
    """Variable -> (points, ...) float64, those that a finished point has; states and numbers of warnings (points,); damaged rows."""
    size, damaged, columns = store.design.size, 0, dict[str, np.ndarray]()
    status, warnings = np.full(size, "waiting", dtype=object), np.full(size, np.nan)

    def put(name: str, where: int | slice, value: ArrayLike, shape: tuple[int, ...]) -> None:
        if name not in columns:
            columns[name] = np.full((size, *shape), np.nan)
        columns[name][where] = value

    for first, last, block in store.blocks():
        status[first:last] = _status_of(block, last - first)
        damaged += (last - first) * (block.reason == DAMAGED)
        for name, column in block.content.items():
            if name != "status":
                put(name, slice(first, last), column, column.shape[1:])
    for row in store.runs():
        number = int(row.key)
        status[number] = _STATUS.get(row.state, row.state)
        damaged += row.reason == DAMAGED
        if row.state == "done":
            warnings[number] = len(row.content["warnings"])
        for name, value in row.content.get("values", {}).items():
            put(name, number, value, np.shape(value))
    return {name: columns[name] for name in COLUMNS if name in columns}, status, warnings, damaged


def _coordinates(store: SweepStore, registry: Registry) -> dict[str, Labelled]:
    design = store.design
    try:
        scene: Scene | None = scene_from_dict(store.scene, registry)
    except RacewayError:  # its plug-ins are not installed here: values are there, units of its keys are not
        scene = None
    names = np.array(DOF, dtype=object)
    coordinates: dict[str, Labelled] = {"dof": (("dof",), names, {}), "dof2": (("dof2",), names, {})}
    for axis in design.axes:
        unit, words = ("", "") if scene is None else key_facts(scene, axis.key)
        dim, about = (
            "point" if design.listed else axis.key,
            {"units": unit or "1", "long_name": axis.key, "description": words},
        )
        coordinates[axis.key] = ((dim,), axis_labels(axis.values), about)
    if design.listed:
        coordinates["point"] = (("point",), np.arange(design.size), {"long_name": "number of the point in the list"})
    return coordinates


def axis_labels(values: Sequence[object]) -> np.ndarray:
    """Numbers as numbers, booleans as booleans; anything else as text."""
    if all(is_number(value) for value in values) or all(isinstance(value, bool) for value in values):
        return np.array(values)
    return np.array([value if isinstance(value, str) else json.dumps(value) for value in values], dtype=object)


def write_netcdf(store: SweepStore) -> Path:
    """``results.nc`` in the store, whole or not at all: what xarray writes of ``dataset(store)``, without it.

    Raises
    ------
    RacewayError
        h5netcdf or h5py is missing, or a disk that takes no more.
    """
    try:
        import h5netcdf
    except ImportError as why:
        raise RacewayError(f"NetCDF needs h5netcdf and h5py: {extra('sweep')} ({why})") from None
    table, memory = _table_of(store), io.BytesIO()
    # In memory first: the HDF5 library takes the whole process down where a disk is full.
    with h5netcdf.File(memory, "w") as file:
        file.attrs.update(table.attributes)
        every = {**table.variables, **table.coordinates}
        sizes = {dim: size for dims, values, _ in every.values() for dim, size in zip(dims, values.shape, strict=True)}
        file.dimensions = sizes
        beside = " ".join(sorted(name for name in table.coordinates if name not in sizes))
        for name, (dims, values, about) in every.items():
            _put(file, name, dims, values, about, beside if name in table.variables else "")
    return write_whole(memory.getvalue(), store.path / RESULTS)


def _put(
    file: h5netcdf.File, name: str, dims: tuple[str, ...], values: np.ndarray, about: Mapping[str, str], coordinates: str
) -> None:
    """One variable by the conventions that xarray follows: a number that is missing is NaN."""
    if values.dtype == bool:  # NetCDF has none
        values, about = values.astype(np.int8), {**about, "dtype": "bool"}
    kind = _WORDS if values.dtype == object else values.dtype
    variable = file.create_variable(name, dims, kind, fillvalue=np.nan if values.dtype.kind == "f" else None)
    variable[...] = values
    variable.attrs.update(about)
    if coordinates:
        variable.attrs["coordinates"] = coordinates


def write_csv(store: SweepStore, path: Path) -> Path:
    """All points and their numbers as CSV, a line each.

    Raises
    ------
    RacewayError
        A file that cannot be written.
    """
    with scratch_file(path, "Choose another place.") as scratch, scratch.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows(_lines(store))
    return path


def _lines(store: SweepStore) -> Iterator[list[object]]:
    places = {name: list(product(DOF, repeat=len(quantity.dims))) for name, quantity in _ARRAYS.items()}
    heads = [f"{name}_{'_'.join(entry)}" for name in _ARRAYS for entry in places[name]]
    yield [*store.design.keys, "status", "reason", "warnings", *_NUMBERS, *heads]
    for row in store.rows():
        values = row["values"]
        arrays = [np.ravel(values[name]).tolist() if name in values else [""] * len(places[name]) for name in _ARRAYS]
        point = [v if isinstance(v, str) or is_number(v) else json.dumps(v) for v in row["point"].values()]
        words = [row["status"], row["reason"], "; ".join(row["warnings"])]
        yield [*point, *words, *(values.get(n, "") for n in _NUMBERS), *(v for a in arrays for v in a)]
