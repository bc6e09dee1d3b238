"""A swept bearing's coefficients for rotor programs: ``raceway.export_ross``, ``raceway.export_coefficients``, and their answers."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated


from raceway import RacewayError, SceneError, at_least, door
from raceway.extend import (
    KEY_VALUES, PATH, Tables, default_registry, head, numbers_at, open_store, parse_at, parse_value, select, slug, tidy,
)  # fmt: skip
from raceway_rotor.coefficient_file import CoefficientFile, RossTable
from raceway_rotor.coefficients import LEAST_POINTS, Coefficients, coefficients
from raceway_rotor.files import PROGRAMS
from raceway_rotor.ross_file import GENERATIONS, check_name, installed_generation, ross_content, ross_notes, ross_toml

if TYPE_CHECKING:
    from xarray import Dataset

#: File endings of the kinds that have one of their own.
_ENDINGS = {".csv": "csv", ".json": "json"}


def ross_table(table: Coefficients, generation: int, tag: str, node: int, origin: tuple[str, ...]) -> RossTable:
    """A table of coefficients for ROSS; ``origin``: sentences about where the numbers come from."""
    content, notes = ross_content(table, generation, tag, node), (*origin, *ross_notes(table, generation))
    return RossTable("ross", table, tag, notes, ross_toml(tag, content, notes), generation, content)


@door
def export_ross(
    data: Dataset | str | Path,
    path: Annotated[str | Path | None, PATH] = None,
    *,
    at: Annotated[Mapping[str, object] | Iterable[str], KEY_VALUES] = (),
    source: str | None = None,
    damping: float = 0.0,
    ross_version: int | str | None = None,
    node: Annotated[int, at_least(0)] = 0,
    tag: str | None = None,
) -> RossTable:
    """Linearised coefficients kyy, kyz, kzy, kzz, cyy ... of a swept bearing, for ROSS.

    Parameters
    ----------
    data : what ``raceway.sweep`` gave (xarray.Dataset), or the folder of its store; at least 5 speeds
    path : .toml or .json file that ROSS reads; None: nothing is written
    at : key -> value of every other axis of the sweep, for instance ``{"load.axial": 1000}``
    source : "rotating", "directions" or "tangent"; by default what the sweep's excitation gives
    damping : cyy and czz [N s/m] where the sweep's own is smaller than its error
    ross_version : 2 or 3; None: of the ROSS that is installed, else 3
    node : of the rotor, where the bearing stands
    tag : the element's name; None: of the bearing's preset

    Returns
    -------
    RossTable
        ``coefficients`` [N/m, N s/m, rad/s], ``notes``, ``write(path)``, and ``element()``, the ross.BearingElement

    Raises
    ------
    SceneError
        Axes that are to be chosen first, too few speeds, or a value that the sweep does not have.
    RacewayError
        A bearing that such coefficients do not describe, points without result, a file that cannot be written.

    Examples
    --------
    The stiffness from standstill on, as tangent of the equilibrium:

    >>> import raceway as rw
    >>> scene = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}
    >>> bearing = rw.export_ross(rw.sweep(scene, {"kinematics.spin_speed_rpm": "0:20000:5"}))
    >>> bearing.tag, (1e-6 * bearing.coefficients.stiffness[:, 0, 0]).round(1).tolist()  # kyy [N/um]
    ('B7206C', [238.2, 238.3, 237.6, 233.5, 223.8])
    """
    if path is not None:
        check_name(Path(path))
    table, tag, origin = _swept(data, at, source, damping, LEAST_POINTS, tag)
    if ross_version is None:
        generation = installed_generation() or GENERATIONS[-1]
    elif str(ross_version) in map(str, GENERATIONS):
        generation = int(ross_version)
    else:
        raise SceneError.at("ross_version", ross_version, f"must be one of {', '.join(map(str, GENERATIONS))}")
    bearing = ross_table(table, generation, tag, node, origin)
    if path is not None:
        bearing.write(path)
    return bearing


@door
def export_coefficients(
    data: Dataset | str | Path,
    path: Annotated[str | Path | None, PATH] = None,
    *,
    kind: str | None = None,
    at: Annotated[Mapping[str, object] | Iterable[str], KEY_VALUES] = (),
    source: str | None = None,
    damping: float = 0.0,
    number: Annotated[int, at_least(1)] = 1,
    node: Annotated[int, at_least(0)] = 0,
    tag: str | None = None,
) -> CoefficientFile:
    """Linearised coefficients of a swept bearing for Nastran (PBUSHT) or Ansys (COMBI214), or as CSV or JSON.

    Parameters
    ----------
    data : what ``raceway.sweep`` gave (xarray.Dataset), or the folder of its store; at least 2 speeds
    path : of the file; None: nothing is written
    kind : "nastran", "ansys", "csv" or "json"; None: by the path's ending, .csv or .json
    at : key -> value of every other axis of the sweep, for instance ``{"load.axial": 1000}``
    source : "rotating", "directions" or "tangent"; by default what the sweep's excitation gives
    damping : cyy and czz [N s/m] where the sweep's own is smaller than its error
    number : of Nastran's property, whose tables have the next twelve; of Ansys' element type and real constants
    node : Nastran's grid point on the shaft, joined to ground; 0: the element is a comment to complete
    tag : the bearing's name; None: of its preset

    Returns
    -------
    CoefficientFile
        ``text``, ``notes``, ``write(path)``

    Raises
    ------
    SceneError
        Axes that are to be chosen first, too few speeds, a value that the sweep does not have, or an unknown kind.
    RacewayError
        Coefficients that the format has no place for, points without result, a file that cannot be written.

    Examples
    --------
    >>> import raceway as rw
    >>> scene = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}
    >>> bearing = rw.export_coefficients(rw.sweep(scene, {"kinematics.spin_speed_rpm": "0:20000:3"}), kind="csv")
    >>> bearing.text.splitlines()[len(bearing.notes)].split(",")[:3]
    ['speed [rad/s]', 'kyy [N/m]', 'kyz [N/m]']
    """
    kind = kind_of(kind, path)
    table, tag, origin = _swept(data, at, source, damping, 2, tag)
    program = PROGRAMS[kind]
    notes = (*origin, table.definition, *program.notes(table, number), *table.notes)
    bearing = CoefficientFile(kind, table, tag, notes, program.text(table, notes, number, node, tag))
    if path is not None:
        bearing.write(path)
    return bearing


def kind_of(kind: str | None, path: str | Path | None) -> str:
    """The kind as given, or by the path's ending; SceneError where it is unknown."""
    if kind is None and path is not None:
        kind = _ENDINGS.get(Path(path).suffix.lower())
        if kind is None:
            raise SceneError.at("path", str(path), f"states its kind by the ending: one of {', '.join(_ENDINGS)}")
    if kind not in PROGRAMS:
        raise SceneError.at("kind", kind, f"must be one of {', '.join(PROGRAMS)}")
    return kind


def _swept(
    data: Dataset | str | Path,
    at: Mapping[str, object] | Iterable[str],
    source: str | None,
    damping: float,
    least: int,
    tag: str | None,
) -> tuple[Coefficients, str, tuple[str, ...]]:
    """Coefficients of a sweep, the bearing's name, and sentences on where they come from."""
    dataset = _dataset(data)
    selection = select(dataset, _values_at(at, dataset))
    table = coefficients(selection, source, damping, least)
    name = tag if tag is not None else str(selection.value("bearing.preset") or selection.title.partition("\n")[0])
    return table, slug(name), head(selection)


def _values_at(at: Mapping[str, object] | Iterable[str], data: Dataset) -> Tables:
    """Key -> value, numbers in the units of the keys."""
    if not isinstance(at, Mapping):
        return parse_at(at)
    values = {key: parse_value(value) if isinstance(value, str) else value for key, value in tidy(at).items()}
    return numbers_at(json.loads(data.attrs["scene"]), values, default_registry())


def _dataset(data: Dataset | str | Path) -> Dataset:
    """The labelled results of a sweep, as such or in the folder of its store."""
    if isinstance(data, str | Path):
        with open_store(data) as store:
            return store.to_xarray()
    with suppress(Exception):  # whatever a foreign object makes of being asked
        if hasattr(data, "data_vars") and "scene" in data.attrs:
            return data
    raise RacewayError(f"{type(data).__name__} is no sweep: give what raceway.sweep returned, or the folder of its store")
