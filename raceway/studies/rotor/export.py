"""A sweep's coefficients for the rotor program ROSS, for Python and the command line alike: ``raceway.export_ross``."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from raceway.cli.frame import slug
from raceway.errors import RacewayError, SceneError
from raceway.framework.doors import door
from raceway.framework.registry import default_registry
from raceway.scene.changes import parse_value
from raceway.scene.given import tidy
from raceway.storage.tables import Tables
from raceway.studies.many.points import numbers_at
from raceway.studies.rotor.coefficients import coefficients
from raceway.studies.rotor.files import (
    CoefficientFile,
    ansys_notes,
    ansys_text,
    csv_text,
    json_text,
    nastran_notes,
    nastran_text,
    numbers_notes,
)
from raceway.studies.rotor.ross_table import GENERATIONS, RossTable, check_name, installed_generation, ross_file
from raceway.studies.sweep.selection import parse_at, select
from raceway.studies.sweep.store import open_store
from raceway.studies.sweep.store_command import head

if TYPE_CHECKING:
    from xarray import Dataset

    from raceway.studies.sweep.selection import Selection


@door
def export_ross(
    data: Any,
    path: str | Path | None = None,
    *,
    at: Mapping[str, Any] | Iterable[str] = (),
    source: str | None = None,
    damping: float = 0.0,
    ross_version: int | str | None = None,
    node: int = 0,
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
    >>> found = rw.export_ross(rw.sweep(scene, {"kinematics.spin_speed_rpm": "0:20000:5"}))
    >>> found.tag, (1e-6 * found.coefficients.stiffness[:, 0, 0]).round(1).tolist()  # kyy [N/um]
    ('B7206C', [238.2, 238.1, 236.8, 231.5, 218.9])
    """
    if path is not None:
        check_name(Path(path))
    labelled = data_of(data)
    found = select(labelled, chosen(at, labelled))
    table = coefficients(found, source, damping)
    name = slug(tag if tag is not None else name_of(found))
    made = RossTable(table, ross_file(table, _generation(ross_version), name, node, head(found)))
    if path is not None:
        made.write(path)
    return made


def chosen(at: Mapping[str, Any] | Iterable[str], data: Dataset) -> Tables:
    """Key -> value, numbers in the units of the keys."""
    if not isinstance(at, Mapping):
        return parse_at(at)
    given = {key: parse_value(value) if isinstance(value, str) else value for key, value in tidy(at).items()}
    return numbers_at(json.loads(data.attrs["scene"]), given, default_registry())


def data_of(data: Any) -> Dataset:
    """The labelled results of a sweep, as such or in the folder of its store.

    Raises
    ------
    RacewayError
        Something else, or a folder without a store.
    """
    if isinstance(data, str | Path):
        with open_store(data) as store:
            return store.to_xarray()
    if hasattr(data, "data_vars") and "scene" in data.attrs:
        return data
    raise RacewayError(f"{type(data).__name__} is no sweep: give what raceway.sweep returned, or the folder of its store")


def name_of(found: Selection) -> str:
    """The bearing's name: its preset, or the first line of the scene's title where it has none."""
    preset = found.value("bearing.preset")
    return str(preset) if preset else found.title.partition("\n")[0]


def _generation(given: int | str | None) -> int:
    if given is None:
        return installed_generation() or GENERATIONS[-1]
    if str(given) not in {str(one) for one in GENERATIONS}:
        raise SceneError.at("ross_version", given, f"must be one of {', '.join(map(str, GENERATIONS))}")
    return int(given)


#: File endings that tell a kind by themselves.
ENDINGS = {".csv": "csv", ".json": "json"}
KINDS = ("nastran", "ansys", "csv", "json")
_LEAST = 2


@door
def export_coefficients(
    data: Any,
    path: str | Path | None = None,
    *,
    kind: str | None = None,
    at: Mapping[str, Any] | Iterable[str] = (),
    source: str | None = None,
    damping: float = 0.0,
    number: int = 1,
    node: int = 0,
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
    >>> found = rw.export_coefficients(rw.sweep(scene, {"kinematics.spin_speed_rpm": "0:20000:3"}), kind="csv")
    >>> found.text.splitlines()[len(found.notes)].split(",")[:3]
    ['speed [rad/s]', 'kyy [N/m]', 'kyz [N/m]']
    """
    kind = kind_of(kind, path)
    labelled = data_of(data)
    selection = select(labelled, chosen(at, labelled))
    table = coefficients(selection, source, damping, _LEAST)
    name = slug(tag if tag is not None else name_of(selection))
    own = {"nastran": lambda: nastran_notes(table, number), "ansys": lambda: ansys_notes(table, number)}.get(
        kind, numbers_notes
    )()
    notes = (*head(selection), table.definition, *own, *table.notes)
    text = {
        "nastran": lambda: nastran_text(table, notes, number, node),
        "ansys": lambda: ansys_text(table, notes, number),
        "csv": lambda: csv_text(table, notes),
        "json": lambda: json_text(table, notes, name),
    }[kind]()
    made = CoefficientFile(kind, table, name, notes, text)
    if path is not None:
        made.write(path)
    return made


def kind_of(kind: str | None, path: str | Path | None) -> str:
    """The kind as given, or by the path's ending.

    Raises
    ------
    SceneError
        An unknown one.
    """
    if kind is None and path is not None and Path(path).suffix.lower() not in ENDINGS:
        raise SceneError.at("path", str(path), f"tells its kind by the ending: one of {', '.join(ENDINGS)}")
    if kind is None and path is not None:
        kind = ENDINGS.get(Path(path).suffix.lower())
    if kind not in KINDS:
        raise SceneError.at("kind", kind, f"must be one of {', '.join(KINDS)}")
    return kind
