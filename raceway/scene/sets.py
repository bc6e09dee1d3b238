"""Sets of rows of balls: their names in makers' catalogues, signs, and rows one by one.

A row faces one of two ways: "+" is seated by a positive axial motion of the inner ring, "-" by a negative one.  Rows that face
alike are in tandem and share a load; rows that face each other's way brace each other under a preload.
"""

from raceway.framework.options import Rule, nearest, worded

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
