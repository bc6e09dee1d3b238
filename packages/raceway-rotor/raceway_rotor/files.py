"""Coefficients of one bearing as a file: bulk data for Nastran, commands for Ansys, CSV and JSON of all numbers.

Nastran
    A bushing whose stiffness and damping depend on the frequency: PBUSH holds nominal values, PBUSHT the numbers of tables over the
    frequency [Hz], TABLED1 the tables.  Fields as in the references of Autodesk Nastran (entries PBUSHT, TABLED1) and OptiStruct
    (entries CBUSH, PBUSH, PBUSHT, TABLED1); large fields of 16 characters for real numbers.

Ansys Mechanical APDL
    The bearing element COMBI214 with real constants that are tables over OMEGS, the amplitude of the rotational velocity, in the
    order of the element: K11, K22, K12, K21, C11, C22, C12, C21.  KEYOPT(2) = 1 lays the element in the YZ plane, so that 1, 2 are
    y, z, and x is the axis.

https://help.autodesk.com/cloudhelp/2022/ENU/NSTRN-Reference/files/GUID-A544DE9B-E51F-45D5-99AB-DCA1D308A7FF.htm (PBUSHT)
https://help.autodesk.com/cloudhelp/2022/DEU/NSTRN-Reference/files/GUID-F7947A2D-E28B-40DC-B721-37405D08ECE5.htm (TABLED1)
https://help.altair.com/hwsolvers/os/topics/solvers/os/pbusht_bulk_r.htm
Mechanical APDL, Rotordynamic Analysis Guide, 3.3.2.1, "User-Defined Stiffness and Damping Characteristics", and Theory Reference,
13.214, "COMBI214"; command reference, *DIM (OMEGS takes positive values and applies to COMBI214 only).  The order of the constants and
KEYOPT(3) = 1 as in another exporter, https://github.com/FE-Berserker/Baffalo (Bearingprint.m, Tableprint.m).
"""

import json
import textwrap
from collections.abc import Callable, Iterable, Iterator, Sequence

import attrs
import numpy as np

from raceway import RacewayError
from raceway.extend import DOF, Tables, csv_text
from raceway_rotor.coefficients import SPEED, SPIN, Coefficients, unit

#: Numbers of a Nastran file: the property's, then its tables'; the next bearing's may begin behind them.
_NUMBERS = 13
_LARGEST_PROPERTY = 99_999_999 - _NUMBERS  # of a field of 8 characters
_LARGEST_TYPE = 99_999
_NASTRAN_COMMENT, _APDL_COMMENT = "$ ", "! "
#: Units of Nastran's directions 1 to 3 and 4 to 6.
_UNITS = {"K": ("N/m", "N m/rad"), "B": ("N s/m", "N m s/rad")}
#: Ansys' real constants in their order -> our entries.
_CONSTANTS = {
    "K11": "kyy", "K22": "kzz", "K12": "kyz", "K21": "kzy",
    "C11": "cyy", "C22": "czz", "C12": "cyz", "C21": "czy",
}  # fmt: skip
#: Values of a line, which APDL assigns to successive rows; it takes up to ten.
_VALUES = 4
_LINEAR = "linear: that the stiffness depends on the amplitude is left out"
#: Parts of the largest entry of its kind below which an entry is rounding.
_ROUNDING = 1e-9
#: Characters of a comment's line: bulk data has no more.
_WIDTH = 72


def _nastran_text(table: Coefficients, head: Sequence[str], number: int, node: int) -> str:
    """Bulk data of Nastran.

    head : sentences for the first lines
    number : of the property, and of the element; its tables have the next twelve
    node : grid point on the shaft that is joined to ground; 0: the element is a comment to complete
    RacewayError: a table over speed and frequency, which PBUSHT has no place for; a number that a field does not hold.
    """
    if not 0 < number <= _LARGEST_PROPERTY:
        raise RacewayError(f"number {number}: Nastran numbers its properties from 1 to {_LARGEST_PROPERTY}")
    if len(table.axes) > 1:
        raise RacewayError(
            f"PBUSHT has tables over one axis, the frequency (`{SPEED}`), and these coefficients go over the speed of the shaft "
            f"(`{SPIN}`) as well: choose one with --at {SPIN}=..."
        )
    hertz = table.axis / (2.0 * np.pi)
    # Stiffness and damping (n, 6) along and about x, y, z
    stiffness, damping = np.zeros((len(table.axial), 6)), np.zeros((len(table.axial), 6))
    stiffness[:, 0] = table.axial
    for diagonal, matrix in ((stiffness, table.stiffness), (damping, table.damping)):
        diagonal[:, 1:3] = np.einsum("nii->ni", matrix)
    if _holds_tilts(table):
        stiffness[:, 4:] = np.einsum("nii->ni", table.tangent)[:, 3:]
        damping[:, [0, 4, 5]] = np.einsum("nii->ni", table.tangent_damping)[:, [0, 3, 4]]
    tables = {("K", k): stiffness[:, k] for k in range(6)} | {("B", k): damping[:, k] for k in range(6)}
    numbers = {entry: number + 1 + k if values.any() else None for k, (entry, values) in enumerate(tables.items())}
    element = [_small("CBUSH", [number, number, node or "GA", None if node else "GB", None, None, None, 0])]
    if not node:
        words = "the element, to complete: GA on the shaft, GB on the housing or blank for ground"
        element = [*_comments([words], _NASTRAN_COMMENT), _NASTRAN_COMMENT + element[0]]
    lines = [*_comments(head, _NASTRAN_COMMENT), *element]
    lines += _large("PBUSH", [number, "K", *stiffness[0], None, "B", *damping[0]])
    rows = [(letter, [numbers[letter, k] for k in range(6)]) for letter in "KB"]
    for k, (letter, row) in enumerate((letter, row) for letter, row in rows if any(row)):
        lines.append(_small("+" if k else "PBUSHT", [None if k else number, letter, *row]))
    for (letter, k), values in tables.items():
        if table_number := numbers[letter, k]:
            pairs = np.stack([hertz, values], axis=-1).ravel()
            lines += [f"{_NASTRAN_COMMENT}{letter}{k + 1} [{_UNITS[letter][k // 3]}] over Hz"]
            lines += _large("TABLED1", [table_number, *[None] * 7, *pairs, "ENDT"])
    return "\n".join(lines) + "\n"


def _nastran_notes(table: Coefficients, number: int) -> list[str]:
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
    # Of the directions across the axis; empty where there are none.
    terms = []
    for letter, matrix in (("k", table.stiffness), ("c", table.damping)):
        along = np.sqrt(np.abs(matrix[..., 0, 0] * matrix[..., 1, 1]))
        across = np.maximum(np.abs(matrix[..., 0, 1]), np.abs(matrix[..., 1, 0]))
        share = float(np.max(across / np.where(along > 0.0, along, 1.0)))
        if share > _ROUNDING and along.any():
            terms.append(f"{letter}yz, {letter}zy (up to {share:.2g} of the diagonal)")
    return [
        "N, m, s, rad; in a model of N, mm, s: entries 1 to 3 times 1e-3, entries 5 and 6 times 1e3",
        "frame: directions 1, 2, 3 of the element are x (the axis), y, z of the bearing; CBUSH with CID = 0 where the basic system is so",
        f"property {number}, its tables {number + 1} to {number + _NUMBERS - 1}",
        over,
        "PBUSH holds the values of the first point: normal modes and statics take them, frequency response takes the tables",
        "TABLED1: straight lines between the points, and beyond the ends",
        tilts,
        *filter(
            None,
            [(f"left out: {' and '.join(terms)}" if terms else ""), _tilt_coupling(table) if with_tilts else "", _LINEAR],
        ),
    ]


def _holds_tilts(table: Coefficients) -> bool:
    return table.source == "tangent" and table.tilt == "locked"


def _tilt_coupling(table: Coefficients) -> str:
    """Forces that a tilt makes, beside a diagonal with the tilt held; empty where there are none."""
    if not table.tangent.any():
        return ""
    size = np.sqrt(np.abs(np.einsum("...ii->...i", table.tangent)))
    largest = float(np.max(np.abs(table.tangent[..., :3, 3:]) / (size[..., :3, None] * size[..., None, 3:])))
    words = f"left out: the forces that a tilt makes, and the moments of a displacement, up to {largest:.2g} of the geometric mean of "
    return f"{words}their diagonal entries" if largest > _ROUNDING else ""


def _small(name: str, fields: Sequence[object]) -> str:
    """One line of fields of 8 characters."""
    return "".join([f"{name:8}", *(f"{'' if field is None else field!s:8}" for field in fields)]).rstrip()


def _large(name: str, fields: Sequence[object]) -> list[str]:
    """Lines of four fields of 16 characters; an entry fills pairs of lines."""
    texts = ["" if x is None else f"{float(x):.9E}" if isinstance(x, float | np.floating) else str(x) for x in fields]
    rows = [texts[k : k + 4] for k in range(0, len(texts), 4)]
    rows += [[""]] if len(rows) % 2 else []
    return ["".join([f"{f'{name}*' if k == 0 else '*':8}", *(f"{x:>16}" for x in r)]).rstrip() for k, r in enumerate(rows)]


def ansys_text(table: Coefficients, head: Sequence[str], number: int) -> str:
    """Commands of Ansys.

    head : sentences for the first lines
    number : of the element type and of the set of real constants, and in the names of the tables
    RacewayError: a table over the frequency, which COMBI214 does not depend on; a number out of range.
    """
    if not 0 < number <= _LARGEST_TYPE:
        raise RacewayError(f"number {number}: give an element type of Ansys from 1 to {_LARGEST_TYPE}")
    if table.frequency is not None:
        remedy = f"choose one with --at {SPEED}=..." if table.speed is not None else f"sweep over `{SPIN}` instead"
        raise RacewayError(
            f"tables of COMBI214 go over the speed of the shaft (`{SPIN}`), and these coefficients go over the frequency "
            f"(`{SPEED}`): {remedy}"
        )
    columns = table.columns()
    largest = {"K": float(np.max(np.abs(table.stiffness))), "C": float(np.max(np.abs(table.damping)))}
    lines, constants = _comments(head, _APDL_COMMENT), []
    for constant, entry in _CONSTANTS.items():
        values, name = columns[entry + table.ending], f"{constant}_{number}"
        if not np.max(np.abs(values)) > _ROUNDING * largest[constant[0]]:
            constants.append("0")
            continue
        constants.append(f"%{name}%")
        lines += [
            f"{_APDL_COMMENT}{constant}, {entry}{table.ending} [{unit(entry)}] over rad/s",
            f"*DIM,{name},TABLE,{len(table.axis)},1,1,OMEGS",
            *_assignments(name, 0, table.axis),
            *_assignments(name, 1, values),
        ]
    lines += [f"ET,{number},COMBI214", f"KEYOPT,{number},2,1"]
    if not all(map(_symmetric, (table.stiffness, table.damping))):
        lines.append(f"KEYOPT,{number},3,1")
    lines += [f"R,{number},{','.join(constants[:6])}", f"RMORE,{','.join(constants[6:])}"]
    lines += _comments(["the element, to complete: nodes on the shaft and on the housing"], _APDL_COMMENT)
    lines += [f"{_APDL_COMMENT}{command}" for command in (f"TYPE,{number}", f"REAL,{number}", "E,SHAFT,HOUSING")]
    return "\n".join(lines) + "\n"


def _ansys_notes(table: Coefficients, number: int) -> list[str]:
    """What the reader of the file has to know."""
    return [
        "N, m, s, rad; in a model of N, mm, s: all of them times 1e-3",
        "frame: KEYOPT(2) = 1, the YZ plane of the nodal systems, whose Y, Z are y, z of the bearing and whose X is its axis",
        f"element type {number}, real constants {number}, tables K11_{number} ... C21_{number} over OMEGS, the speed of the shaft",
        "COMBI214 carries y and z only: kxx, moments, and the coupling of x, y, z with tilts are left out; how the tilt is held "
        "belongs to the numbers",
        _LINEAR,
    ]


def _symmetric(matrix: np.ndarray) -> bool:
    """To rounding of the largest entry."""
    bound = _ROUNDING * float(np.max(np.abs(matrix)))
    return bool(np.allclose(matrix, np.swapaxes(matrix, -1, -2), rtol=0.0, atol=bound))


def _assignments(name: str, column: int, values: np.ndarray) -> list[str]:
    """Rows 1 to n of a column; column 0 holds the speeds."""
    texts = [f"{float(value):.15g}" for value in values]
    return [f"{name}({k + 1},{column})={','.join(texts[k : k + _VALUES])}" for k in range(0, len(texts), _VALUES)]


def _comments(sentences: Iterable[str], sign: str) -> list[str]:
    """Lines of ASCII, which is all that old readers take."""
    ascii_only = (text.replace("µ", "u").encode("ascii", "replace").decode() for text in sentences)
    return [
        line
        for text in ascii_only
        for line in textwrap.wrap(text, _WIDTH, initial_indent=sign, subsequent_indent=f"{sign}  ")
    ]


def _csv_text(table: Coefficients, head: Sequence[str]) -> str:
    """A line per point; the head's lines begin with #, and the line behind them names the columns and their units."""
    points = np.meshgrid(*table.axes.values(), indexing="ij")
    columns = {f"{name} [rad/s]": values for name, values in zip(table.axes, points, strict=True)}
    columns |= {f"{name} [{unit(name)}]": values for name, values in table.columns().items()}
    columns |= dict(_entries("K", table.tangent)) | dict(_entries("C", table.tangent_damping))
    columns |= table.stated
    rows = zip(*(values.ravel().tolist() for values in columns.values()), strict=True)
    notes = "".join(f"# {sentence}\n" for sentence in head)
    return notes + csv_text([dict(zip(columns, row, strict=True)) for row in rows])


def _json_text(table: Coefficients, head: Sequence[str], tag: str) -> str:
    """The same as one object; the matrices are lists over points, rows and columns."""
    content: Tables = {
        "tag": tag,
        "notes": list(head),
        "source": table.source,
        "definition": table.definition,
        **{name: {"unit": "rad/s", "values": values.tolist()} for name, values in table.axes.items()},
        "coefficients": {name: {"unit": unit(name), "values": values.tolist()} for name, values in table.columns().items()},
        "quantities": {name: values.tolist() for name, values in table.stated.items()},
        "coordinates": list(DOF),
        "K": {"unit": [[_entry_unit("K", a, b) for b in DOF] for a in DOF], "values": table.tangent.tolist()},
        "C": {"unit": [[_entry_unit("C", a, b) for b in DOF] for a in DOF], "values": table.tangent_damping.tolist()},
    }
    return json.dumps(content, indent=1, allow_nan=False) + "\n"


#: What the reader of CSV and JSON has to know.
_NUMBERS_NOTES = [
    "SI; coordinates x (the axis), y, z, tilt_y, tilt_z (about y, z) of the bearing",
    "kyy ... czz, kxx: the tilts held, or, by their names, following; x as told; K, C: 5x5 of the contacts at the equilibrium, every other motion held: "
    "small motions, without shaft, rotor and supports",
]


def _entries(letter: str, matrix: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
    for i, a in enumerate(DOF):
        for j, b in enumerate(DOF):
            yield f"{letter} {a} {b} [{_entry_unit(letter, a, b)}]", matrix[..., i, j]


def _entry_unit(letter: str, row: str, column: str) -> str:
    """Of force or moment over displacement or tilt, or over their rates."""
    force, over = ("N m" if "tilt" in row else "N"), ("rad" if "tilt" in column else "m")
    return f"{force}{' s' if letter == 'C' else ''}/{over}"


@attrs.frozen
class _Program:
    """A program, or a plain format: its name, notes for the reader of its file, and the file's text.

    ``notes``: of a table with the ``number`` of its first entry;  ``text``: of a table, notes, number, node and tag
    """

    name: str
    notes: Callable[[Coefficients, int], list[str]]
    text: Callable[[Coefficients, Sequence[str], int, int, str], str]


PROGRAMS = {
    "nastran": _Program("Nastran", _nastran_notes, lambda *of: _nastran_text(*of[:4])),
    "ansys": _Program("Ansys", _ansys_notes, lambda table, head, number, *_: ansys_text(table, head, number)),
    "csv": _Program("CSV", lambda *_: _NUMBERS_NOTES, lambda table, head, *_: _csv_text(table, head)),
    "json": _Program("JSON", lambda *_: _NUMBERS_NOTES, lambda table, head, _n, _k, tag: _json_text(table, head, tag)),
}
