"""Sets of rows of balls: their names in makers' catalogues, signs, and rows one by one.

A row faces one of two ways: "+" is seated by a positive axial motion of the inner ring, "-" by a negative one.  Rows that face
alike are in tandem and share a load; rows that face each other's way brace each other under a preload.
"""

from __future__ import annotations

import attrs

from raceway.framework.options import (
    Rule,
    at_least,
    between,
    finite,
    inside,
    length,
    nearest,
    one_of,
    option,
    optional,
    positive,
    worded,
)

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
            raise ValueError(
                "must be greater than 0: a spring without travel is no spring; leave the key out for any travel, or take "
                "preload_kind = 'rigid'"
            )

    return worded(check, "greater than 0", {"exclusiveMinimum": 0})


def signs_of(word: str) -> str:
    """A sign for each row of an arrangement, in the order of the rows."""
    return _NAMES[word][0] if word in _NAMES else word


def places_of(word: str, distance: float) -> tuple[tuple[float, float], ...]:
    """(side, axial place [m]) of each row, neighbours at a distance [m], their middle at 0; side is +1 or -1.

    Notes
    -----
    Rows of a name begin with those that a positive load seats; rows of signs go from -x to +x.
    """
    signs, rising = _NAMES.get(word, (word, True))
    middle = 0.5 * (len(signs) - 1)
    places = [(k - middle) * distance + 0.0 for k in range(len(signs))]
    sides = [1.0 if sign == "+" else -1.0 for sign in signs]
    return tuple(zip(sides, places if rising else places[::-1], strict=True))


@attrs.frozen
class SetRow:
    """One row of a set: where it stands, which way it faces, and what of its bearing differs from the set's."""

    direction: str | None = option(
        None,
        help="'+': a positive axial motion of the inner ring loads it; default: from the arrangement",
        rule=optional(one_of("+", "-")),
    )
    position: float | None = option(
        None,
        unit="m",
        help="axial position of its inner groove centres; default: rows `row_distance` apart",
        rule=optional(finite()),
    )
    preload: float | None = option(
        None,
        unit="N",
        help="preload for which this row is ground (preload_of = 'row'); default: bearing.preload",
        rule=optional(at_least(0.0)),
    )
    preset: str | None = option(None, help="name in the catalogue; other keys override it")
    ball_diameter: float | None = option(None, unit="m", help="D", rule=optional(length()))
    pitch_diameter: float | None = option(None, unit="m", help="d_m", rule=optional(length()))
    ball_count: int | None = option(None, help="Z", rule=optional(at_least(1)))
    conformity_inner: float | None = option(
        None, help="groove radius / ball diameter, inner", rule=optional(inside(0.5, 1.0))
    )
    conformity_outer: float | None = option(
        None, help="groove radius / ball diameter, outer", rule=optional(inside(0.5, 1.0))
    )
    contact_angle_deg: float | None = option(None, unit="deg", help="free contact angle", rule=optional(between(0.0, 75.0)))
    bore: float | None = option(None, unit="m", help="bore diameter", rule=optional(length()))
    outer_diameter: float | None = option(None, unit="m", help="outer diameter", rule=optional(length()))
    width: float | None = option(None, unit="m", help="width", rule=optional(length()))
    dynamic_rating: float | None = option(
        None,
        unit="N",
        help="dynamic load rating C of one row; default: the catalogue's, else ISO 281",
        rule=optional(positive()),
    )
    static_rating: float | None = option(
        None,
        unit="N",
        help="static load rating C0 of one row; default: the catalogue's, else ISO 76",
        rule=optional(positive()),
    )
    first_ball_azimuth_deg: float | None = option(
        None, unit="deg", help="azimuth of ball 0 from +y towards +z", rule=optional(finite())
    )


#: Keys of a row that describe its bearing.
GEOMETRY = tuple(
    field.name for field in attrs.fields(SetRow) if field.name not in ("direction", "position", "preload", "preset")
)


#: Keys of printed load ratings.
RATINGS = "dynamic_rating", "static_rating"
