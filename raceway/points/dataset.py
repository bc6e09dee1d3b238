"""A store as a labelled data set, as NetCDF, and as CSV."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Iterator, Mapping
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Protocol
from warnings import warn

import attrs
import numpy as np

from raceway.errors import RacewayError, extra
from raceway.framework.registry import Registry, default_registry
from raceway.plugins.labelled import labelled_dataset, labels
from raceway.points.axes import is_number
from raceway.points.store import DAMAGED
from raceway.points.survey import key_facts
from raceway.scene.reading import scene_from_dict
from raceway.scene.scene import Scene
from raceway.storage.files import scratch_file, write_whole
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from collections.abc import Sequence

    import h5netcdf
    import xarray

    from raceway.pipeline.result import Result
    from raceway.points.axes import Design


#: Coordinates of the ring, in the order of ``displacement`` and ``stiffness``.
DOF = ("x", "y", "z", "tilt_y", "tilt_z")

#: Numbers: name -> (unit, words).
NUMBERS: dict[str, tuple[str, str]] = {
    "z_real": ("N/m", "real part of the dynamic stiffness Z = F/x"),
    "z_imag": ("N/m", "imaginary part of the dynamic stiffness Z = F/x, w C"),
    "equivalent_stiffness": ("N/m", "K = Re Z + m w^2"),
    "equivalent_damping": ("N s/m", "C = Im Z / w"),
    "force_amplitude": ("N", "amplitude of the 1x force"),
    "frequency": ("Hz", "of the 1x line"),
    "mass": ("kg", "m of K = Re Z + m w^2"),
    "forward_amplitude": ("m", "forward part of the 1x orbit"),
    "backward_amplitude": ("m", "backward part of the 1x orbit"),
    "orbit_major": ("m", "major semi-axis of the 1x orbit"),
    "orbit_minor": ("m", "minor semi-axis of the 1x orbit"),
    "residual": ("1", "motion that is not 1x, rms over rms of 1x"),
    "axial_displacement": ("m", "mean axial displacement"),
    "kyy_tilts_follow": ("N/m", "radial tangent with tilts that follow as supports.tilt lets them, x and z held"),
    "peak_ball_load": ("N", "largest load of a ball, of both races"),
    "peak_ball_load_inner": ("N", "largest load of a ball on the inner race"),
    "peak_ball_load_outer": ("N", "largest load of a ball on the outer race"),
    "min_ball_load": ("N", "least load of a ball on the inner race, 0 where one is loose"),
    "p0": ("Pa", "largest Hertz pressure, of both races"),
    "p0_inner": ("Pa", "largest Hertz pressure on the inner race"),
    "p0_outer": ("Pa", "largest Hertz pressure on the outer race"),
    "error_total": ("1", "estimated relative error of Z"),
    "error_time_step": ("1", "part of the time step in the relative error of Z"),
    "error_transient": ("1", "part of the transient in the relative error of Z"),
    "error_mesh": ("1", "part of the mesh in the relative error of Z"),
    "error_contact": ("1", "part of the contact law in the relative error of Z"),
    "error_identification": ("1", "part of the identification in the relative error of Z"),
    "error_model_bound": ("1", "upper estimate of the change of kyy by hypotheses of [kinematics] left at their defaults"),
}
#: Arrays over ``dof``: name -> (dimensions, unit, words).
ARRAYS: dict[str, tuple[tuple[str, ...], str, str]] = {
    "displacement": (("dof",), "m, rad", "equilibrium under the constant loads"),
    "stiffness": (
        ("dof", "dof2"),
        "N/m, N/rad, N m/m, N m/rad",
        "tangent of the contacts at the equilibrium: kyy is y, y, tilts held",
    ),
    "damping": (("dof", "dof2"), "N s/m, N s/rad, N m s/m, N m s/rad", "damping of the contacts at the equilibrium"),
}


def values_of(result: Result) -> Tables:
    """Plain numbers and lists of a result; what it does not have is absent."""
    from raceway.pipeline.plausible import closed_bound

    found, still = result.identification, result.equilibrium
    values: Tables = {}
    if found is not None:
        z = found.dynamic_stiffness
        values |= {
            "z_real": z.real,
            "z_imag": z.imag,
            "frequency": found.frequency_hz,
            "mass": found.mass_used,
            **{name: getattr(found, name) for name in NUMBERS if hasattr(found, name)},
        }
    values |= {"kyy_tilts_follow": result.kyy_tilts_follow, **_loads(result)}
    values |= {f"error_{name}": size for name, size in result.error.items() if name not in ("how", "unresolved")}
    values["error_model_bound"] = closed_bound(result.model, still)
    values = {name: float(value) for name, value in values.items() if value is not None and math.isfinite(value)}
    return values | {name: getattr(still, name).tolist() for name in ARRAYS}


def _loads(result: Result) -> Tables:
    """Of the motion where there is one, else of the equilibrium."""
    from raceway.pipeline.equilibrium import largest_contacts, motion_table, pressures

    model, z = result.model, result.model.system.ball_count
    if result.simulation is not None:
        record = result.simulation.record
        told, loads = motion_table(model, record), record.contact_force
    else:
        loads = result.equilibrium.contact_force
        told = largest_contacts(loads, pressures(model, loads), "peak")
    return {
        "axial_displacement": told.get("axial_displacement_m", result.equilibrium.displacement[0]),
        "min_ball_load": loads[..., :z].min(),
        "peak_ball_load": told["peak_ball_load_n"],
        "p0": told["peak_pressure_pa"],
        **{f"peak_ball_load_{race}": told[f"peak_ball_load_{race}_n"] for race in ("inner", "outer")},
        **{f"p0_{race}": told[f"peak_pressure_{race}_pa"] for race in ("inner", "outer")},
    }


RESULTS, TABLE = "results.nc", "results.csv"
#: Words of any length, as HDF5 has them.
_WORDS = np.dtype("O", metadata={"vlen": str})
#: Dimensions, values and attributes of a variable.
Labelled = tuple[tuple[str, ...], np.ndarray, dict[str, str]]


class Rows(Protocol):
    """A store as it is read."""

    design: Design
    facts: Tables
    path: Path

    @property
    def title(self) -> str: ...
    @property
    def scene(self) -> Tables: ...
    def rows(self) -> Iterator[Tables]: ...
    def to_xarray(self) -> xarray.Dataset: ...


@attrs.frozen
class Table:
    """The labelled results of a store, before any library of arrays has them.

    Attributes
    ----------
    variables, coordinates : name -> its dimensions, values and attributes
    attributes : of the whole
    """

    variables: dict[str, Labelled]
    coordinates: dict[str, Labelled]
    attributes: dict[str, str | int]


def dataset(store: Rows, registry: Registry | None = None) -> xarray.Dataset:
    """The data set of a store: states, and the variables that its scenes have.

    Raises
    ------
    RacewayError
        xarray is missing.
    """
    found = table_of(store, registry)
    return labelled_dataset(found.variables, found.coordinates, found.attributes)


def table_of(store: Rows, registry: Registry | None = None) -> Table:
    """The same as plain arrays: xarray, and what it imports, takes longer than a hundred points."""
    design = store.design
    dims = design.keys if design.axes else ("point",)
    columns, status, warnings, damaged = _columns(store)
    variables: dict[str, Labelled] = {"status": (dims, status.reshape(design.shape), {"long_name": "state of the point"})}
    if columns:
        about = labels("warnings", "1", "number of warnings of the point: their words are in the JSON and the CSV")
        variables["warnings"] = (dims, warnings.reshape(design.shape), about)
    for name, column in columns.items():
        more, unit, words = ARRAYS[name] if name in ARRAYS else ((), *NUMBERS[name])
        shape = (*design.shape, *column.shape[1:])
        variables[name] = ((*dims, *more), column.reshape(shape), labels(name, unit, words))
    attributes = {
        "title": store.title,
        "scene": json.dumps(store.scene),
        "plugins": json.dumps(store.facts["identity"]["plugins"]),
        "raceway": store.facts["identity"]["raceway"],
        "program": store.facts["identity"]["program"],
        "schema": store.facts["schema"],
        "created": store.facts["created"],
        "note": "NaN: not finished, or not estimated; see status",
        "damaged_rows": damaged,
    }
    if damaged:
        warn(
            f"`{store.path}`: {damaged} of {design.size} rows are damaged and read as waiting; --resume computes them again",
            stacklevel=3,
        )
    return Table(variables, _coordinates(store, registry or default_registry()), attributes)


def _columns(store: Rows) -> tuple[dict[str, np.ndarray], np.ndarray, np.ndarray, int]:
    """Variable -> (points, ...) float64, those that a finished point has; states and numbers of warnings (points,); damaged rows."""
    size, damaged, found = store.design.size, 0, dict[str, np.ndarray]()
    status, warnings = np.full(size, "waiting", dtype=object), np.full(size, np.nan)
    for number, row in enumerate(store.rows()):
        status[number] = row["status"]
        damaged += row["reason"] == DAMAGED
        if row["status"] == "done":
            warnings[number] = len(row["warnings"])
        for name, value in row["values"].items():
            if name not in found:
                found[name] = np.full((size, *np.shape(value)), np.nan)
            found[name][number] = value
    order = [*NUMBERS, *ARRAYS]
    return {name: found[name] for name in order if name in found}, status, warnings, damaged


def _coordinates(store: Rows, registry: Registry) -> dict[str, Labelled]:
    design = store.design
    try:
        scene: Scene | None = scene_from_dict(store.scene, registry)
    except RacewayError:  # its plug-ins are not installed here: values are there, units of its keys are not
        scene = None
    names = np.array(DOF, dtype=object)
    found: dict[str, Labelled] = {"dof": (("dof",), names, {}), "dof2": (("dof2",), names, {})}
    for key in design.keys:
        values = next(a.values for a in design.axes if a.key == key) if design.axes else [p[key] for p in design.listed]
        unit, words = ("", "") if scene is None else key_facts(scene, key)
        dim = key if design.axes else "point"
        found[key] = ((dim,), axis_labels(values), {"units": unit or "1", "long_name": key, "description": words})
    if not design.axes:
        found["point"] = (("point",), np.arange(design.size), {"long_name": "number of the point in the list"})
    return found


def axis_labels(values: Sequence[object]) -> np.ndarray:
    """Numbers as numbers, booleans as booleans; anything else as text."""
    if all(is_number(value) for value in values) or all(isinstance(value, bool) for value in values):
        return np.array(values)
    return np.array([value if isinstance(value, str) else json.dumps(value) for value in values], dtype=object)


def write_netcdf(store: Rows) -> Path:
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
    table, memory = table_of(store), io.BytesIO()
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


def write_csv(store: Rows, path: Path) -> Path:
    """All points and their numbers as CSV, a line each.

    Raises
    ------
    RacewayError
        A file that cannot be written.
    """
    with scratch_file(path, "Choose another place.") as scratch, scratch.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows(_lines(store))
    return path


def _lines(store: Rows) -> Iterator[list[object]]:
    places = {name: list(product(DOF, repeat=len(dims))) for name, (dims, _, _) in ARRAYS.items()}
    heads = [f"{name}_{'_'.join(place)}" for name in ARRAYS for place in places[name]]
    yield [*store.design.keys, "status", "reason", "warnings", *NUMBERS, *heads]
    for row in store.rows():
        values = row["values"]
        arrays = [np.ravel(values[name]).tolist() if name in values else [""] * len(places[name]) for name in ARRAYS]
        point = [v if isinstance(v, str) or is_number(v) else json.dumps(v) for v in row["point"].values()]
        words = [row["status"], row["reason"], "; ".join(row["warnings"])]
        yield [*point, *words, *(values.get(n, "") for n in NUMBERS), *(v for a in arrays for v in a)]
