"""Coefficients as commands of Ansys Mechanical APDL: the bearing element COMBI214 with tables over the speed of the shaft.

Real constants that are tables over OMEGS, the amplitude of the rotational velocity, in the order of the element:
K11, K22, K12, K21, C11, C22, C12, C21.  KEYOPT(2) = 1 lays the element in the YZ plane, so that 1, 2 are y, z, and x is the axis.

References
----------
Mechanical APDL, Rotordynamic Analysis Guide, 3.3.2.1, "User-Defined Stiffness and Damping Characteristics", and Theory Reference,
13.214, "COMBI214"; command reference, *DIM (OMEGS takes positive values and applies to COMBI214 only).  The order of the constants and
KEYOPT(3) = 1 as in another exporter, https://github.com/FE-Berserker/Baffalo (Bearingprint.m, Tableprint.m).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from raceway.errors import RacewayError
from raceway.studies.ross.coefficients import SPEED, SPIN, Coefficients
from raceway.studies.rotor_files.lost import LINEAR, ROUNDING, comments

#: Real constants in their order -> our entries.
CONSTANTS = {
    "K11": "kyy", "K22": "kzz", "K12": "kyz", "K21": "kzy",
    "C11": "cyy", "C22": "czz", "C12": "cyz", "C21": "czy",
}  # fmt: skip
_APDL_COMMENT = "! "
#: Values of a line, which APDL assigns to successive rows; it takes up to ten.
_VALUES = 4
_LARGEST_TYPE = 99_999


def ansys_text(table: Coefficients, head: Sequence[str], number: int) -> str:
    """The file.

    Parameters
    ----------
    head : sentences for the first lines
    number : of the element type and of the set of real constants, and in the names of the tables

    Raises
    ------
    RacewayError
        A table over the frequency, which COMBI214 does not depend on; a number out of range.
    """
    if not 0 < number <= _LARGEST_TYPE:
        raise RacewayError(f"number {number}: give an element type of Ansys from 1 to {_LARGEST_TYPE}")
    speed = _speed(table)
    columns = table.columns()
    largest = {"K": float(np.max(np.abs(table.stiffness))), "C": float(np.max(np.abs(table.damping)))}
    lines = comments(head, _APDL_COMMENT)
    constants = []
    for constant, ours in CONSTANTS.items():
        ours += table.ending
        values, name = columns[ours], f"{constant}_{number}"
        unit = "N/m" if constant[0] == "K" else "N s/m"
        there = bool(np.max(np.abs(values)) > ROUNDING * largest[constant[0]])
        constants.append(f"%{name}%" if there else "0")
        if there:
            lines += [f"{_APDL_COMMENT}{constant}, {ours} [{unit}] over rad/s", f"*DIM,{name},TABLE,{len(speed)},1,1,OMEGS"]
            lines += [*_assigned(name, 0, speed), *_assigned(name, 1, values)]
    lines += [f"ET,{number},COMBI214", f"KEYOPT,{number},2,1"]
    if not _symmetric(table):
        lines.append(f"KEYOPT,{number},3,1")
    lines += [f"R,{number},{','.join(constants[:6])}", f"RMORE,{','.join(constants[6:])}"]
    lines += [
        *comments(["the element, to complete: nodes on the shaft and on the housing"], _APDL_COMMENT),
        f"{_APDL_COMMENT}TYPE,{number}",
        f"{_APDL_COMMENT}REAL,{number}",
        f"{_APDL_COMMENT}E,SHAFT,HOUSING",
    ]
    return "\n".join(lines) + "\n"


def ansys_notes(table: Coefficients, number: int) -> list[str]:
    """What the reader of the file has to know."""
    return [
        "N, m, s, rad; in a model of N, mm, s: all of them times 1e-3",
        "frame: KEYOPT(2) = 1, the YZ plane of the nodal systems, whose Y, Z are y, z of the bearing and whose X is its axis",
        f"element type {number}, real constants {number}, tables K11_{number} ... C21_{number} over OMEGS, the speed of the shaft",
        "COMBI214 carries y and z only: kxx, moments, and the coupling of x, y, z with tilts are left out; how the tilt is held "
        "belongs to the numbers",
        LINEAR,
    ]


def _speed(table: Coefficients) -> np.ndarray:
    """(n,) [rad/s]."""
    if table.frequency is None:
        assert table.speed is not None
        return table.speed
    remedy = f"choose one with --at {SPEED}=..." if table.speed is not None else f"sweep over `{SPIN}` instead"
    raise RacewayError(
        f"tables of COMBI214 go over the speed of the shaft (`{SPIN}`), and these coefficients go over the frequency (`{SPEED}`): "
        f"{remedy}"
    )


def _symmetric(table: Coefficients) -> bool:
    """To rounding of the largest entry."""
    return all(
        bool(np.allclose(one, np.swapaxes(one, -1, -2), rtol=0.0, atol=ROUNDING * float(np.max(np.abs(one)))))
        for one in (table.stiffness, table.damping)
    )


def _assigned(name: str, column: int, values: np.ndarray) -> list[str]:
    """Rows 1 to n of a column; column 0 holds the speeds."""
    texts = [f"{float(value):.15g}" for value in values]
    return [f"{name}({k + 1},{column})={','.join(texts[k : k + _VALUES])}" for k in range(0, len(texts), _VALUES)]
