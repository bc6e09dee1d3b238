"""Coefficients as bulk data of Nastran: a bushing whose stiffness and damping depend on the frequency.

PBUSH holds nominal values, PBUSHT the numbers of tables over the frequency, TABLED1 the tables.  Fields as in the references of
Autodesk Nastran (entries PBUSHT, TABLED1) and OptiStruct (entries CBUSH, PBUSH, PBUSHT, TABLED1); large fields of 16 characters for
real numbers.  Frequencies in Hz.

References
----------
https://help.autodesk.com/cloudhelp/2022/ENU/NSTRN-Reference/files/GUID-A544DE9B-E51F-45D5-99AB-DCA1D308A7FF.htm (PBUSHT)
https://help.autodesk.com/cloudhelp/2022/DEU/NSTRN-Reference/files/GUID-F7947A2D-E28B-40DC-B721-37405D08ECE5.htm (TABLED1)
https://help.altair.com/hwsolvers/os/topics/solvers/os/pbusht_bulk_r.htm
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from raceway.errors import RacewayError
from raceway.studies.ross.coefficients import SPEED, SPIN, Coefficients
from raceway.studies.rotor_files.lost import LINEAR, comments, cross_terms, tilt_coupling

#: Numbers of a file: the property's, then its tables'; the next bearing's may begin behind them.
NUMBERS = 13
_LARGEST_PROPERTY = 99_999_999 - NUMBERS  # of a field of 8 characters
_NASTRAN_COMMENT = "$ "


def nastran_text(table: Coefficients, head: Sequence[str], number: int, node: int) -> str:
    """The file.

    Parameters
    ----------
    head : sentences for the first lines
    number : of the property, and of the element; its tables have the next twelve
    node : grid point on the shaft that is joined to ground; 0: the element is a comment to complete

    Raises
    ------
    RacewayError
        A table over speed and frequency, which PBUSHT has no place for; a number that a field does not hold.
    """
    if not 0 < number <= _LARGEST_PROPERTY:
        raise RacewayError(f"number {number}: Nastran numbers its properties from 1 to {_LARGEST_PROPERTY}")
    hertz = _frequency(table)
    stiffness, damping = _diagonals(table)
    tables = {("K", k): stiffness[:, k] for k in range(6)} | {("B", k): damping[:, k] for k in range(6)}
    numbers = {place: number + 1 + k if values.any() else 0 for k, (place, values) in enumerate(tables.items())}
    lines = comments(head, _NASTRAN_COMMENT)
    lines += _element(number, node)
    lines += _large("PBUSH", [number, "K", *stiffness[0], None, "B", *damping[0]])
    lines += _property(number, numbers)
    for place, values in tables.items():
        if numbers[place]:
            pairs = np.stack([hertz, values], axis=-1).ravel()
            lines += [f"{_NASTRAN_COMMENT}{place[0]}{place[1] + 1} [{_UNITS[place[0]][place[1] // 3]}] over Hz"]
            lines += _large("TABLED1", [numbers[place], *[None] * 7, *pairs, "ENDT"])
    return "\n".join(lines) + "\n"


_UNITS = {"K": ("N/m", "N m/rad"), "B": ("N s/m", "N m s/rad")}


def nastran_notes(table: Coefficients, number: int) -> list[str]:
    """What the reader of the file has to know."""
    with_tilts = _holds_tilts(table)
    over = (
        "tables over the frequency of the response, which was the speed of the shaft: for synchronous response (unbalance) only"
        if table.frequency is None
        else "tables over the frequency of the response, at one speed of the shaft"
    )
    tilts = (
        "K5, K6 [N m/rad]: moments of tilts about y and z with x, y, z held, and K1 to K3 with the tilts held"
        if with_tilts
        else "K5 = K6 = 0: no moment by a tilt; how the tilt is held belongs to the numbers"
    )
    return [
        "N, m, s, rad; in a model of N, mm, s: entries 1 to 3 times 1e-3, entries 5 and 6 times 1e3",
        "frame: directions 1, 2, 3 of the element are x (the axis), y, z of the bearing; CBUSH with CID = 0 where the basic system is so",
        f"property {number}, its tables {number + 1} to {number + NUMBERS - 1}",
        over,
        "PBUSH holds the values of the first point: normal modes and statics take them, frequency response takes the tables",
        "TABLED1: straight lines between the points, and beyond the ends",
        tilts,
        *filter(None, [cross_terms(table), tilt_coupling(table) if with_tilts else "", LINEAR]),
    ]


def _holds_tilts(table: Coefficients) -> bool:
    return table.source == "tangent" and table.tilt == "locked"


def _frequency(table: Coefficients) -> np.ndarray:
    """(n,) [Hz]."""
    if table.speed is not None and table.frequency is not None:
        raise RacewayError(
            f"PBUSHT has tables over one axis, the frequency (`{SPEED}`), and these coefficients go over the speed of the shaft "
            f"(`{SPIN}`) as well: choose one with --at {SPIN}=..."
        )
    axis = table.frequency if table.frequency is not None else table.speed
    assert axis is not None
    return axis / (2.0 * np.pi)


def _diagonals(table: Coefficients) -> tuple[np.ndarray, np.ndarray]:
    """Stiffness and damping (n, 6) along and about x, y, z."""
    stiffness, damping = np.zeros((len(table.axial), 6)), np.zeros((len(table.axial), 6))
    stiffness[:, 0] = table.axial
    for found, matrix in ((stiffness, table.stiffness), (damping, table.damping)):
        found[:, 1:3] = np.einsum("nii->ni", matrix)
    if _holds_tilts(table):
        stiffness[:, 4:] = np.einsum("nii->ni", table.tangent)[:, 3:]
        damping[:, [0, 4, 5]] = np.einsum("nii->ni", table.tangent_damping)[:, [0, 3, 4]]
    return stiffness, damping


def _element(number: int, node: int) -> list[str]:
    """CBUSH to ground in the basic system."""
    if node:
        return [_small("CBUSH", [number, number, node, None, None, None, None, 0])]
    return [
        *comments(["the element, to complete: GA on the shaft, GB on the housing or blank for ground"], _NASTRAN_COMMENT),
        _NASTRAN_COMMENT + _small("CBUSH", [number, number, "GA", "GB", None, None, None, 0]),
    ]


def _property(number: int, numbers: dict[tuple[str, int], int]) -> list[str]:
    lines, first = [], True
    for letter in "KB":
        row = [numbers[letter, k] or None for k in range(6)]
        if any(row):
            lines.append(_small("PBUSHT" if first else "+", [number if first else None, letter, *row]))
            first = False
    return lines


def _small(name: str, fields: Sequence[object]) -> str:
    """One line of fields of 8 characters."""
    return "".join([f"{name:8}", *(f"{'' if one is None else one!s:8}" for one in fields)]).rstrip()


def _large(name: str, fields: Sequence[object]) -> list[str]:
    """Lines of four fields of 16 characters; an entry fills pairs of lines."""
    texts = [_field(one) for one in fields]
    rows = [texts[k : k + 4] for k in range(0, len(texts), 4)]
    rows += [[""]] if len(rows) % 2 else []
    return [
        "".join([f"{f'{name}*' if k == 0 else '*':8}", *(f"{text:>16}" for text in row)]).rstrip()
        for k, row in enumerate(rows)
    ]


def _field(value: object) -> str:
    if value is None:
        return ""
    return f"{float(value):.9E}" if isinstance(value, float | np.floating) else str(value)
