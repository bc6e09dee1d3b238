"""A sweep's coefficients as files for Nastran and Ansys, and as tables, for Python and the command line alike."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from raceway.cli.frame import slug
from raceway.errors import SceneError
from raceway.framework.doors import door
from raceway.studies.ross.coefficients import coefficients
from raceway.studies.ross.front import chosen, data_of, name_of
from raceway.studies.rotor_files.ansys import ansys_notes, ansys_text
from raceway.studies.rotor_files.file import CoefficientFile
from raceway.studies.rotor_files.nastran import nastran_notes, nastran_text
from raceway.studies.rotor_files.numbers import csv_text, json_text, numbers_notes
from raceway.studies.sweep.selection import select
from raceway.studies.sweep.store_command import head

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
