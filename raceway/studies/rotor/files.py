"""A bearing's coefficients as a file, for programs that read text."""

from __future__ import annotations

import csv
import io
import json
import textwrap
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import attrs
import numpy as np

from raceway.errors import RacewayError
from raceway.framework.shown import Fact, Shown
from raceway.storage.files import write_whole
from raceway.storage.tables import Tables
from raceway.studies.rotor.coefficients import SPEED, SPIN, Coefficients
from raceway.studies.sweep.variables import DOF


@attrs.frozen(eq=False, repr=False)
class CoefficientFile(Shown):
    """Coefficients of one bearing, written for one program.

    Attributes
    ----------
    kind : "nastran", "ansys", "csv" or "json"
    coefficients : ``speed``, ``frequency`` (n,) [rad/s], ``stiffness`` (..., 2, 2) [N/m], ``damping`` (..., 2, 2) [N s/m] over y, z,
        and ``tangent``, ``tangent_damping`` (..., 5, 5) of the equilibria
    tag : the bearing's name
    notes : what the reader of the numbers has to know, a sentence each; the file begins with them
    text : the file

    Examples
    --------
    >>> import raceway as rw
    >>> scene = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}
    >>> found = rw.export_coefficients(rw.sweep(scene, {"kinematics.spin_speed_rpm": "0:20000:5"}), kind="ansys", number=3)
    >>> [line for line in found.text.splitlines() if line.startswith(("ET", "KEYOPT", "R,"))]
    ['ET,3,COMBI214', 'KEYOPT,3,2,1', 'R,3,%K11_3%,%K22_3%,0,0,0,0']
    """

    kind: str
    coefficients: Coefficients
    tag: str
    notes: tuple[str, ...]
    text: str

    @property
    def program(self) -> str:
        """Whom the file is for."""
        return {"nastran": "Nastran", "ansys": "Ansys"}.get(self.kind, self.kind.upper())

    def to_dict(self) -> Tables:
        """The numbers by our names, and the notes, as plain tables."""
        return {"programs": [self.program], "tag": self.tag, **self.coefficients.to_dict(), "notes": list(self.notes)}

    def write(self, path: str | Path) -> Path:
        """Write the file, whole or not at all.

        Raises
        ------
        RacewayError
            A folder that cannot be written.
        """
        return write_whole(self.text.encode(), Path(path))

    def _shown(self) -> tuple[str, list[Fact]]:
        lines = self.text.count("\n")
        return f"{self.tag}, coefficients for {self.program}\n{lines} lines", [("note", "", note) for note in self.notes]


LINEAR = "linear: that the stiffness depends on the amplitude is left out"
#: Parts of the largest entry of its kind below which an entry is rounding.
ROUNDING = 1e-9
#: Characters of a comment's line: bulk data has no more.
_WIDTH = 72


def comments(sentences: Iterable[str], sign: str) -> list[str]:
    """Lines of ASCII, which is all that old readers take."""
    plain = (one.replace("µ", "u").encode("ascii", "replace").decode() for one in sentences)
    return [line for one in plain for line in textwrap.wrap(one, _WIDTH, initial_indent=sign, subsequent_indent=f"{sign}  ")]


def cross_terms(table: Coefficients) -> str:
    """Of the directions across the axis; empty where there are none."""
    found = []
    for letter, matrix in (("k", table.stiffness), ("c", table.damping)):
        along = np.sqrt(np.abs(matrix[..., 0, 0] * matrix[..., 1, 1]))
        across = np.maximum(np.abs(matrix[..., 0, 1]), np.abs(matrix[..., 1, 0]))
        share = float(np.max(across / np.where(along > 0.0, along, 1.0)))
        if share > ROUNDING and along.any():
            found.append(f"{letter}yz, {letter}zy (up to {share:.2g} of the diagonal)")
    return f"left out: {' and '.join(found)}" if found else ""


def tilt_coupling(table: Coefficients) -> str:
    """Forces that a tilt makes, beside a diagonal with the tilt held; empty where there are none."""
    matrix = table.tangent
    if not matrix.any():
        return ""
    size = np.sqrt(np.abs(np.einsum("...ii->...i", matrix)))
    share = np.abs(matrix[..., :3, 3:]) / (size[..., :3, None] * size[..., None, 3:])
    largest = float(np.max(share))
    return (
        f"left out: the forces that a tilt makes, and the moments of a displacement, up to {largest:.2g} of the geometric mean of "
        "their diagonal entries"
        if largest > ROUNDING
        else ""
    )


def csv_text(table: Coefficients, head: Sequence[str]) -> str:
    """A line each point; the head's lines begin with #, and the line behind them names the columns and their units."""
    axes = table.axes
    points = np.meshgrid(*axes.values(), indexing="ij")
    columns = {f"{name} [rad/s]": values for name, values in zip(axes, points, strict=True)}
    columns |= {f"{name} [{'N/m' if name[0] == 'k' else 'N s/m'}]": values for name, values in table.columns().items()}
    columns |= dict(_entries("K", table.tangent)) | dict(_entries("C", table.tangent_damping))
    text = io.StringIO()
    text.writelines(f"# {sentence}\n" for sentence in head)
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*(values.ravel().tolist() for values in columns.values()), strict=True))
    return text.getvalue()


def json_text(table: Coefficients, head: Sequence[str], tag: str) -> str:
    """The same as one object; the matrices are lists over points, rows and columns."""
    content: Tables = {
        "tag": tag,
        "notes": list(head),
        "source": table.source,
        "definition": table.definition,
        **{name: {"unit": "rad/s", "values": values.tolist()} for name, values in table.axes.items()},
        "coefficients": {
            name: {"unit": "N/m" if name[0] == "k" else "N s/m", "values": values.tolist()}
            for name, values in table.columns().items()
        },
        "coordinates": list(DOF),
        "K": {"unit": [[_unit("K", a, b) for b in DOF] for a in DOF], "values": table.tangent.tolist()},
        "C": {"unit": [[_unit("C", a, b) for b in DOF] for a in DOF], "values": table.tangent_damping.tolist()},
    }
    return json.dumps(content, indent=1, allow_nan=False) + "\n"


def numbers_notes() -> list[str]:
    """What the reader of the file has to know."""
    return [
        "SI; coordinates x (the axis), y, z, tilt_y, tilt_z (about y, z) of the bearing",
        "kyy ... czz, kxx: the tilts held, or, by their names, following; x as told; K, C: 5x5 of the contacts at the equilibrium, every other motion held: "
        "small motions, without shaft, rotor and supports",
    ]


def _entries(letter: str, matrix: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
    for i, a in enumerate(DOF):
        for j, b in enumerate(DOF):
            yield f"{letter} {a} {b} [{_unit(letter, a, b)}]", matrix[..., i, j]


def _unit(letter: str, row: str, column: str) -> str:
    """Of force or moment over displacement or tilt, or over their rates."""
    force, over = ("N m" if "tilt" in row else "N"), ("rad" if "tilt" in column else "m")
    return f"{force}{' s' if letter == 'C' else ''}/{over}"


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
