"""What makers print of a bearing, and tables of it as CSV: one line a designation, lines of a size belong together."""

import csv
import math
from functools import cache
from importlib.resources import files
from pathlib import Path

import attrs
import numpy as np

from raceway import Mistake, SceneError
from raceway.extend import nearest, size_of, why_unreadable

#: Bytes of the largest table.
_LARGEST = 2**24
#: Columns that a table needs, and what it may have beside them, with the size of the unit.
_NEEDED = {
    "name": 0.0,
    "bore_mm": 1e-3,
    "outer_diameter_mm": 1e-3,
    "width_mm": 1e-3,
    "contact_angle_deg": 1.0,
    "dynamic_rating_n": 1.0,
    "static_rating_n": 1.0,
}
_OPTIONAL = {"static_factor": 1.0, "ball_count": 1.0, "ball_diameter_mm": 1e-3, "pitch_diameter_mm": 1e-3}
_PAIR = {"preload": "preload_{}_n", "stiffness": "stiffness_{}_n_per_um", "radial": "radial_stiffness_{}_n_per_um"}
#: Static over dynamic rating of ball bearings, generously: outside, one of the two is no rating.
_RATIO = 0.15, 3.0


@attrs.frozen
class Rating:
    """Basic load ratings [N] at a contact angle [deg]; f_0 [N/mm2] of ISO 76 where it is printed."""

    contact_angle_deg: float
    dynamic: float
    static: float
    static_factor: float | None = None


@attrs.frozen
class PairStiffness:
    """Axial stiffness [N/m] of a pair back to back or face to face under a preload [N]; radial, tilt locked, where it is printed."""

    contact_angle_deg: float
    preload: float
    stiffness: float
    radial: float | None = None


@attrs.frozen
class _Internals:
    """Balls as a maker prints them: count, diameter and, where it is printed, pitch diameter [m]."""

    ball_count: int
    ball_diameter: float
    pitch_diameter: float | None


@attrs.frozen
class Printed:
    """All that is printed of one size: lengths [m], ratings at each contact angle, stiffnesses of pairs.

    SceneError: Numbers that no bearing has, each with the rule.
    """

    bore: float
    outer_diameter: float
    ratings: tuple[Rating, ...]
    width: float | None = None
    pairs: tuple[PairStiffness, ...] = ()
    names: tuple[str, ...] = ()
    internals: _Internals | None = None

    def __attrs_post_init__(self) -> None:
        numbers = [("bore", self.bore), ("outer diameter", self.outer_diameter), ("width", self.width or 1.0)]
        for rating in self.ratings:
            at = f"{rating.contact_angle_deg:g} deg"
            numbers += [(f"dynamic rating, {at}", rating.dynamic), (f"static rating, {at}", rating.static)]
        for pair in self.pairs:
            numbers += [("angle of a pair", pair.contact_angle_deg), ("preload of a pair", pair.preload)]
            numbers += [("stiffness of a pair", pair.stiffness)]
            numbers += [] if pair.radial is None else [("radial stiffness of a pair", pair.radial)]
        rule = "must be a finite number above 0"
        mistakes = [Mistake(f"{self.title}: {name}", x, rule) for name, x in numbers if not 0.0 < x < math.inf]
        if mistakes:
            raise SceneError(list(dict.fromkeys(mistakes)))
        if not self.bore < self.outer_diameter < 10.0:
            rule = 'must exceed the bore and be below 10 m: write a unit, "110 mm"'
            mistakes.append(Mistake(f"{self.title}: outer diameter", self.outer_diameter, rule))
        for rating in self.ratings:
            if not 0.0 <= rating.contact_angle_deg <= 45.0:
                rule = "must be from 0 to 45 deg"
                mistakes.append(Mistake(f"{self.title}: contact angle", rating.contact_angle_deg, rule))
            if not _RATIO[0] < rating.static / rating.dynamic < _RATIO[1]:
                rule = f"contradicts the dynamic rating {rating.dynamic:g} N: C0 is {_RATIO[0]:g} to {_RATIO[1]:g} of C in ball bearings"
                mistakes.append(Mistake(f"{self.title}: static rating", rating.static, rule))
        if mistakes:
            raise SceneError(mistakes)

    @property
    def title(self) -> str:
        """Designations, or the dimensions where there are none."""
        return ", ".join(self.names) or f"{1e3 * self.bore:g} x {1e3 * self.outer_diameter:g} mm"

    @property
    def deep_groove(self) -> bool:
        """Whether it is a deep-groove bearing: no contact angle."""
        return all(rating.contact_angle_deg == 0.0 for rating in self.ratings)

    @property
    def mean_diameter(self) -> float:
        """(bore + outer diameter) / 2 [m]."""
        return 0.5 * (self.bore + self.outer_diameter)

    @property
    def section(self) -> float:
        """Outer diameter less bore [m]."""
        return self.outer_diameter - self.bore

    @property
    def angles(self) -> np.ndarray:
        """(n,) contact angles of the ratings [rad]."""
        return np.radians([rating.contact_angle_deg for rating in self.ratings])

    @property
    def dynamic(self) -> np.ndarray:
        """(n,) dynamic ratings [N]."""
        return np.array([rating.dynamic for rating in self.ratings])

    @property
    def static(self) -> np.ndarray:
        """(n,) static ratings [N]."""
        return np.array([rating.static for rating in self.ratings])


@cache
def printed_by(maker: str) -> tuple[Printed, ...]:
    """One entry a designation of a table that comes with the package: the name of its file in raceway/data/printed."""
    text = files("raceway_catalogue").joinpath(f"data/printed/{maker}.csv").read_text(encoding="utf-8")
    return table_in_text(text, f"{maker}.csv").lines


@attrs.frozen
class Table:
    """The lines of a table, and what is wrong with those that are no bearing."""

    lines: tuple[Printed, ...]
    faults: tuple[Mistake, ...]


def read_table(path: Path) -> Table:
    """The lines of a CSV file; SceneError: unreadable, columns missing or unknown, no line that is a bearing."""
    try:
        size_of(path, _LARGEST)
        text = path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise SceneError.at(str(path), None, "no such file") from None
    except (OSError, ValueError) as why:
        raise SceneError.at(str(path), None, f"cannot be read: {why_unreadable(why)}") from None
    return table_in_text(text, str(path))


def table_in_text(text: str, name: str) -> Table:
    """One ``Printed`` a line of a CSV text; lines that start with # are remarks.  Errors as in ``read_table``."""
    lines = [(k, line) for k, line in enumerate(text.splitlines(), 1) if line.strip() and not line.startswith("#")]
    rows = list(csv.reader(line for _, line in lines))
    head = [word.strip() for word in rows[0]] if rows else []
    pairs = [{key: word.format(k) for key, word in _PAIR.items()} for k in range(1, 10)]
    columns = [*_NEEDED, *_OPTIONAL, *(word for pair in pairs for word in pair.values())]
    faults = [Mistake(name, word, f"unknown column{nearest(word, columns)}") for word in head if word not in columns]
    faults += [Mistake(name, None, f"column `{word}` is missing") for word in _NEEDED if word not in head]
    if faults or len(rows) < 2:
        raise SceneError(faults or [Mistake(name, None, "has no line below its head")])
    designations = []
    for (number, _), cells in zip(lines[1:], rows[1:], strict=True):
        try:
            designations.append(_printed_line(dict(zip(head, cells, strict=True)), pairs))
        except SceneError as error:
            faults += [Mistake(f"{name}, line {number}: {m.path}", m.value, m.message) for m in error.mistakes]
        except ValueError as why:
            faults.append(Mistake(f"{name}, line {number}", None, f"is no line of this table: {why}"))
    if not designations:
        raise SceneError(faults)
    return Table(tuple(designations), tuple(faults))


def _printed_line(cells: dict[str, str], pairs: list[dict[str, str]]) -> Printed:
    def number(key: str) -> float:
        return float(cells[key]) * {**_NEEDED, **_OPTIONAL}.get(key, 1.0)

    def optional(key: str) -> float | None:
        return number(key) if cells.get(key) else None

    angle, internals = number("contact_angle_deg"), None
    if cells.get("ball_count") and (diameter := optional("ball_diameter_mm")):
        internals = _Internals(int(cells["ball_count"]), diameter, optional("pitch_diameter_mm"))
    return Printed(
        bore=number("bore_mm"),
        outer_diameter=number("outer_diameter_mm"),
        width=number("width_mm") if cells["width_mm"] else None,
        ratings=(Rating(angle, number("dynamic_rating_n"), number("static_rating_n"), optional("static_factor")),)
        if cells["dynamic_rating_n"] or cells["static_rating_n"]
        else (),
        pairs=tuple(
            PairStiffness(
                angle,
                number(pair["preload"]),
                1e6 * number(pair["stiffness"]),
                1e6 * number(pair["radial"]) if cells.get(pair["radial"]) else None,
            )
            for pair in pairs
            if cells.get(pair["preload"]) and cells.get(pair["stiffness"])
        ),
        names=(cells["name"],) if cells["name"] else (),
        internals=internals,
    )
