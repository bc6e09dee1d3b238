"""Coefficients as a file that ROSS reads by itself: ``ross.BearingElement.load(FILE)``.

ROSS is an open program for rotors (github.com/petrobras/ross).  Its axes (X, Y, Z) are (y, z, x) here, so that its kxx is
kyy, kxy is kyz, kyx is kzy, kyy is kzz and its axial kzz is kxx.  What its two generations take differs:

============  ==========================================  =========================================================
ROSS          table over                                  between the points
============  ==========================================  =========================================================
2.x           speed, under the name ``frequency``         smoothing cubic spline (scipy's UnivariateSpline)
3.0 or later  ``speed``, ``frequency``, or both of them   PCHIP through the points, linear beyond the ends
============  ==========================================  =========================================================
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import attrs
import numpy as np

from raceway.errors import RacewayError
from raceway.storage.files import write_whole
from raceway.storage.tables import Tables
from raceway.studies.ross.coefficients import SPEED, SPIN, Coefficients

DISTRIBUTION = "ross-rotordynamics"
GENERATIONS = (2, 3)
#: Our entry -> ROSS's.
NAMES = {
    "kyy": "kxx", "kyz": "kxy", "kzy": "kyx", "kzz": "kyy",
    "cyy": "cxx", "cyz": "cxy", "czy": "cyx", "czz": "cyy", "kxx": "kzz",
}  # fmt: skip
_LOST = (
    "ROSS carries translations only: moments on the ring by its motion, and forces by its tilt, are left out; how the tilt is "
    "held belongs to the numbers above",
    "ROSS is linear: that the stiffness depends on the amplitude is left out",
)


@attrs.frozen(eq=False)
class RossFile:
    """Content of the file.

    Attributes
    ----------
    generation : of ROSS, 2 or 3
    content : the keyword arguments of ``ross.BearingElement`` but for ``notes``, which it leaves alone
    notes : sentences in the file's head
    """

    tag: str
    generation: int
    content: Tables
    notes: tuple[str, ...]

    def write(self, path: Path) -> Path:
        """Write TOML or JSON, by the ending.

        Raises
        ------
        RacewayError
            Another ending, or a folder that cannot be written.
        """
        check_name(path)
        text = self.toml() if path.suffix.lower() == ".toml" else self.json()
        return write_whole(text.encode(), path)

    @property
    def section(self) -> str:
        """ROSS takes the class from the word before the underscore."""
        return f"BearingElement_{self.tag}"

    def json(self) -> str:
        return json.dumps({self.section: {**self.content, "notes": list(self.notes)}}, indent=1, allow_nan=False) + "\n"

    def toml(self) -> str:
        lines = [*(f"# {note}" for note in self.notes), "", f"[{json.dumps(self.section)}]"]
        # JSON's numbers, strings and lists of them are TOML's, and its shortest decimal gives every bit back.
        lines += [f"{name} = {json.dumps(value, allow_nan=False)}" for name, value in self.content.items()]
        return "\n".join(lines) + "\n"


def check_name(path: Path) -> None:
    """Refuse a file that ROSS would not read.

    Raises
    ------
    RacewayError
        For an ending other than .toml and .json.
    """
    if path.suffix.lower() not in (".toml", ".json"):
        raise RacewayError(f"`{path}`: ROSS reads .toml and .json, and tells them by the ending: choose one of them")


def installed_generation() -> int | None:
    """Of the ROSS that is installed here; it is not imported."""
    try:
        major = int(version(DISTRIBUTION).partition(".")[0])
    except PackageNotFoundError:
        return None
    return GENERATIONS[0] if major < GENERATIONS[1] else GENERATIONS[1]


def ross_file(table: Coefficients, generation: int, tag: str, node: int, head: tuple[str, ...]) -> RossFile:
    """The file of a table of coefficients.

    Parameters
    ----------
    generation : 2 or 3
    tag : the element's name in ROSS;  node : of the rotor, where it stands
    head : sentences about where the numbers come from

    Raises
    ------
    RacewayError
        A table over speed and frequency for ROSS 2, which has one axis.
    """
    axes = _axes(table, generation)
    columns = table.columns()
    content: Tables = {"n": node, "tag": tag}
    content |= {ross: columns[ours + table.ending].tolist() for ours, ross in NAMES.items()}
    content |= {name: values.tolist() for name, values in axes.items()}
    notes = (
        *head,
        f"{table.definition}; N/m, N s/m, rad/s",
        "axes: ROSS's X, Y, Z are y, z, x of the bearing",
        *table.notes,
        *_LOST,
    )
    return RossFile(tag, generation, content, (*notes, *_reading_notes(table, generation)))


def _axes(table: Coefficients, generation: int) -> dict[str, np.ndarray]:
    both = table.speed is not None and table.frequency is not None
    if generation < 3:
        if both:
            raise RacewayError(
                f"ROSS 2 takes one axis, and this table goes over speed (`{SPIN}`) and frequency (`{SPEED}`): choose a value of "
                f"one of them with --at, or write it for ROSS 3 with --ross-version 3"
            )
        axis = table.speed if table.speed is not None else table.frequency
        assert axis is not None
        return {"frequency": axis}
    return table.axes


def _reading_notes(table: Coefficients, generation: int) -> list[str]:
    if generation >= 3:
        return ["ROSS 3 passes through every point; beyond the ends it goes on in a straight line"]
    worst = smoothing(table)
    told = ", ".join(f"{name} {_part(value)}" for name, value in worst.items() if value > 1e-12) or "none"
    return [
        "ROSS 2 does not pass through the points: it smooths with a bound of 1 N/m, or 1 N s/m, a point, which is a lot for a "
        f"damping; largest change, of the largest value of its kind: {told}. raceway.export_ross(STORE).element() gives a bearing "
        "that passes through them",
        "beyond the ends ROSS 2 goes on as a cubic, and modal analyses ask at speed 0: let the table begin low",
    ]


def _part(value: float) -> str:
    return f"{value:.1e}" if value < 1e-3 else f"{value:.1%}"


def smoothing(table: Coefficients) -> Mapping[str, float]:
    """Largest change at a point by ROSS 2's own interpolation, over the largest coefficient of its kind; by our names."""
    from raceway.studies.ross.reading import smoothed

    axis = table.speed if table.speed is not None else table.frequency
    assert axis is not None
    columns = table.columns()
    size = {letter: max(float(np.max(np.abs(v))) for name, v in columns.items() if name[0] == letter) for letter in "kc"}
    return {
        name: float(np.max(np.abs(smoothed(axis, values) - values))) / (size[name[0]] or 1.0)
        for name, values in columns.items()
    }
