"""Makers' designations: ``7206 CD/P4A``, ``HCB7014-C-T-P4S``, ``6205-2RS/C3``, and their names of sets of rows of balls: ``DB``.

The words of the former are in ``raceway/data/designations.toml``.  A row of a set faces one of two ways: "+" is seated by a positive
axial motion of the inner ring, "-" by a negative one.  Rows that face alike are in tandem and share a load; rows that face each
other's way brace each other under a preload.
"""

import csv
import re
import tomllib
from functools import cache
from importlib.resources import files

import attrs

from raceway.errors import SceneError
from raceway.framework.options import Rule, nearest, worded
from raceway.storage.tables import Tables

#: Letters of the catalogue's angular-contact bearings by contact angle [deg]: without a prefix, and with B.
_ANGLES = {15: "C", 25: "A5", 30: "A"}, {15: "C", 25: "E"}
#: Deep-groove series of Japanese makers that have another number at ISO: 6805 is 61805, 685 is 618/5.
_SERIES = {"68": "618", "69": "619"}
_NUMBER = re.compile(
    r"(?P<prefix>[A-Z]*)[ -]?(?P<number>6[0123]/\d{2,3}|61[89]/\d+|61[89]\d\d|6[02389]\d\d?|719\d\d|7[029]\d\d)(?=\D|$)(?P<rest>.*)"
)
_ROLLERS = re.compile(r"(?P<prefix>NU|NJ|NUP|N)[ -]?(?P<number>(?:10|2)\d\d)(?=\D|$)(?P<rest>.*)")
_SEPARATORS = " -/.,_"
#: Groups of parts that set a number; the others are named as ignored.
_SETTING = ("clearance", "tolerance", "ceramic", "angle")


@attrs.frozen
class Designation:
    """What a designation says."""

    #: of the bearing in the catalogue, the nearest first; none where its contact angle is not known, as ``words`` say
    names: tuple[str, ...]
    #: clearance, tolerance : classes of ISO 5753-1 and ISO 492, or ""
    clearance: str
    tolerance: str
    ceramic: str  # material of the balls, or ""
    words: str  # each part, and whether it is used


@cache
def _groups() -> Tables:
    return tomllib.loads(files("raceway").joinpath("data/designations.toml").read_text(encoding="utf-8"))


def read_designation(text: str) -> Designation | None:
    """A maker's designation; None where it is no number of a bearing that the catalogue could have.

    SceneError: A kind of bearing that is not computed.
    """
    word = text.strip().upper()
    for pattern, bearing in _groups()["refused"].items():
        if re.match(rf"(?:{pattern})(?!\d)", word):
            raise SceneError.at("bearing.preset", text, f"is {bearing}, which Raceway does not compute")
    rollers = _ROLLERS.fullmatch(word)
    match = rollers or _NUMBER.fullmatch(word)
    if match is None:
        return None
    prefix, number, rest = match["prefix"], match["number"], match["rest"]
    kind = "roller" if rollers else "angular" if number.startswith("7") else "ball"
    parts = [*_parts("" if prefix == "NU" else prefix.removesuffix("B"), kind), *_parts(rest, kind)]
    if parts and not parts[-1][1] and rest[:1] not in _SEPARATORS:
        return None
    values = {group: _groups()[group]["parts"][part] for part, group in parts if group in _SETTING}
    series = None if rollers or "/" in number else _SERIES.get(number[:2])
    iso = number if series is None else f"{series}{number[2:]}" if len(number) == 4 else f"{series}/{number[2:]}"
    names: tuple[str, ...] = (f"NU{number}" if rollers else iso,)
    if kind == "angular":
        names = _angular_names(number, prefix.endswith("B"), values.get("angle"))
        own = (f"{number}{part}" for part, group in parts if group == "angle")
        names = (*own, *names) if names else ()  # a maker's own designation goes first
    words = "; ".join(_words(part, group) for part, group in parts)
    words = f"{text}: {words}" if words else ""
    if not names:
        angle = values.get("angle")
        words = "C is 15, AC or A5 25, A 30 deg: say which" if angle is None else f"{angle} deg is not in the catalogue"
    clearance, tolerance, ceramic = (str(values.get(group, "")) for group in ("clearance", "tolerance", "ceramic"))
    return Designation(names, clearance, tolerance, ceramic, words)


def unlisted(text: str) -> str:
    """What a designation is of which the catalogue has no balls; "" for others."""
    word = text.strip().upper()
    return next((words for pattern, words in _groups()["unlisted"].items() if re.fullmatch(pattern, word)), "")


def _parts(text: str, kind: str) -> list[tuple[str, str]]:
    """(part, name of its group) in their order; what the table does not have with an empty name."""
    groups = {name: group for name, group in _groups().items() if "parts" in group and kind in group.get("kinds", [kind])}
    names = {part: name for name, group in reversed(groups.items()) for part in group["parts"]}
    parts = list[tuple[str, str]]()
    for chunk in filter(None, re.split(f"[{re.escape(_SEPARATORS)}]+", text)):
        remainder, inside = chunk, list[tuple[str, str]]()
        while part := max((part for part in names if remainder.startswith(part)), key=len, default=""):
            inside.append((part, names[part]))
            remainder = remainder[len(part) :]
        parts += [(chunk, "")] if remainder else inside
    return parts


def _words(part: str, group: str) -> str:
    if not group:
        return f"{part}: not known, ignored"
    words = _groups()[group]["words"]
    if group not in _SETTING:
        return f"{part}: {words}, ignored"
    return f"{part}: {words.format(_groups()[group]['parts'][part])}"


def _angular_names(number: str, prefix_b: bool, angle: int | None) -> tuple[str, ...]:
    """Of the catalogue, for a number as 7014 or 71914 (its 7914) and an angle; with a prefix B the maker's own first."""
    number = number.replace("719", "79", 1) if len(number) == 5 else number
    bare, maker = _ANGLES
    if angle not in bare:
        return ()
    name = f"{number}{bare[angle]}"
    return (f"B{number}{maker[angle]}", name) if prefix_b and angle in maker else (name,)


#: Classes of ISO 5753-1 from the smallest; CN is the normal one and not written in designations.
CLASSES = ("C2", "CN", "C3", "C4")


@cache
def _ranges() -> list[dict[str, str]]:
    lines = files("raceway").joinpath("data/clearances.csv").read_text(encoding="utf-8").splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def clearance_range(kind: str, bore: float, name: str = "CN") -> tuple[float, float] | None:
    """Least and largest radial internal clearance [m], on the diameter; None where the standard has no such bore.

    kind : "ball" (deep groove) or "roller" (cylindrical), with cylindrical bores
    bore : [m];  name : one of ``CLASSES``

    References
    ----------
    ISO 5753-1:2009, as printed by two makers (named in the file).
    """
    millimetres = round(1e3 * bore, 6)
    for row in _ranges():
        if row["kind"] == kind and float(row["over"]) < millimetres <= float(row["up_to"]):
            return float(row[f"{name}_min"]) * 1e-6, float(row[f"{name}_max"]) * 1e-6
    return None


#: Rows that face "+" and "-", and how they stand: with the "+" rows on the side of -x the pressure lines diverge towards the
#: axis, back to back; the other way round they stand face to face.
#: References: NSK, Super Precision Bearings (DB to DFF); SKF, Super-precision bearings (TBT to PT); NTN, Precision Rolling
#: Bearings (DTBT, DTFT).
_NAMES = {
    "single": ("+", True),
    "DB": ("+-", True), "DF": ("+-", False), "DT": ("++", True),
    "DBD": ("++-", True), "TBT": ("++-", True), "DFD": ("++-", False), "TFT": ("++-", False),
    "DTD": ("+++", True), "TT": ("+++", True),
    "DBB": ("++--", True), "QBC": ("++--", True), "DTBT": ("++--", True),
    "DFF": ("++--", False), "QFC": ("++--", False), "DTFT": ("++--", False),
    "QBT": ("+++-", True), "QFT": ("+++-", False), "QT": ("++++", True),
    "PBC": ("+++--", True), "PFC": ("+++--", False), "PBT": ("++++-", True), "PFT": ("++++-", False), "PT": ("+++++", True),
}  # fmt: skip
NAMES = tuple(_NAMES)
#: Names that makers use differently: rows by one maker's count and by another's.
_AMBIGUOUS = {
    "DBT": "three rows in NTN's catalogue and four in NSK's: write 'TBT' (2 + 1) or 'QBT' (3 + 1)",
    "DFT": "three rows in NTN's catalogue and four in NSK's: write 'TFT' (2 + 1) or 'QFT' (3 + 1)",
    "DTT": "three rows in NTN's catalogue and four in NSK's: write 'TT' (3) or 'QT' (4)",
}
_SIGNS = "+-"


def arrangement() -> Rule:
    """Rule: a name of a set, or a sign for each row."""
    listed = ", ".join(repr(name) for name in NAMES)
    words = f"one of {listed}, or a sign for each row from -x to +x, such as '++-'"

    def check(_instance: object, _attribute: object, value: str) -> None:
        if value in _AMBIGUOUS:
            raise ValueError(f"is ambiguous: {_AMBIGUOUS[value]}")
        if value not in _NAMES and not (value and set(value) <= set(_SIGNS)):
            raise ValueError(f"must be {words}{nearest(value, NAMES)}")

    return worded(check, words, {"words": list(NAMES), "pattern": "^[+-]+$"})


def travel() -> Rule:
    """Rule: a distance that a spring can be pressed by."""

    def check(_instance: object, _attribute: object, value: float) -> None:
        if not 0.0 < value < 1e3:
            remedy = "a spring without travel is no spring; leave the key out for any travel, or take preload_kind = 'rigid'"
            raise ValueError(f"must be greater than 0: {remedy}")

    return worded(check, "greater than 0", {"exclusiveMinimum": 0})


def signs_of(word: str) -> str:
    """A sign for each row of an arrangement, in the order of the rows."""
    return _NAMES[word][0] if word in _NAMES else word


def places_of(word: str, distance: float) -> tuple[tuple[float, float], ...]:
    """(side, axial place [m]) of each row, neighbours at a distance [m], their middle at 0; side is +1 or -1.

    Rows of a name begin with those that a positive load seats; rows of signs go from -x to +x.
    """
    signs, rising = _NAMES.get(word, (word, True))
    middle = 0.5 * (len(signs) - 1)
    places = [(k - middle) * distance + 0.0 for k in range(len(signs))]
    sides = [1.0 if sign == "+" else -1.0 for sign in signs]
    return tuple(zip(sides, places if rising else places[::-1], strict=True))


#: Keys of a row that describe its bearing: those of [bearing] where a row leaves them out.
GEOMETRY = (
    "ball_diameter", "pitch_diameter", "ball_count", "conformity_inner", "conformity_outer", "contact_angle_deg", "bore",
    "outer_diameter", "width", "dynamic_rating", "static_rating", "first_ball_azimuth_deg",
)  # fmt: skip
#: Keys of printed load ratings.
RATINGS = "dynamic_rating", "static_rating"
