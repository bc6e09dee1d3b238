"""Units of numbers given as text, such as "1 kN": read at the door, into the unit of the key, never inside.

A unit is a product of symbols with whole powers: ``N s/m``, ``kg m2``, ``N/mm^2``.  Turns are a dimension of their own, so that
12 000 r/min and 200 Hz are the same speed, and a speed is no inverse of time.
"""

import math
import re
from fractions import Fraction
from functools import cache

import attrs

from raceway.framework.options import nearest

#: Powers of metre, kilogram, second, radian and kelvin.
_Dimension = tuple[int, int, int, int, int]


@attrs.frozen
class Unit:
    """``factor`` times pi to the power ``pi`` of the SI unit of this dimension: products of decimals are exact, pi is separate."""

    dimension: _Dimension
    factor: Fraction = Fraction(1)
    pi: int = 0

    def times(self, factor: "Unit", power: int) -> "Unit":
        dimension = tuple(a + power * b for a, b in zip(self.dimension, factor.dimension, strict=True))
        m, kg, s, rad, kelvin = dimension
        return Unit((m, kg, s, rad, kelvin), self.factor * factor.factor**power, self.pi + power * factor.pi)


_ONE = Unit((0, 0, 0, 0, 0))
#: With prefixes.
_SCALED = {
    "m": Unit((1, 0, 0, 0, 0)),
    "g": Unit((0, 1, 0, 0, 0), Fraction(1, 1000)),
    "s": Unit((0, 0, 1, 0, 0)),
    "N": Unit((1, 1, -2, 0, 0)),
    "J": Unit((2, 1, -2, 0, 0)),
    "W": Unit((2, 1, -3, 0, 0)),
    "Pa": Unit((-1, 1, -2, 0, 0)),
    "Hz": Unit((0, 0, -1, 1, 0), Fraction(2), 1),
    "rad": Unit((0, 0, 0, 1, 0)),
}
_PREFIXES = {"n": -9, "u": -6, "µ": -6, "μ": -6, "m": -3, "c": -2, "k": 3, "M": 6, "G": 9}
_TURN = Unit((0, 0, 0, 1, 0), Fraction(2), 1)
#: As they are.
_PLAIN = {
    "in": Unit((1, 0, 0, 0, 0), Fraction("0.0254")),
    # Of the international yard and pound agreement of 1959 and standard gravity, exactly.
    "lb": Unit((0, 1, 0, 0, 0), Fraction("0.45359237")),
    "oz": Unit((0, 1, 0, 0, 0), Fraction("0.45359237") / 16),
    "lbf": Unit((1, 1, -2, 0, 0), Fraction("0.45359237") * Fraction("9.80665")),
    "psi": Unit((-1, 1, -2, 0, 0), Fraction("0.45359237") * Fraction("9.80665") / Fraction("0.0254") ** 2),
    "K": Unit((0, 0, 0, 0, 1)),
    "min": Unit((0, 0, 1, 0, 0), Fraction(60)),
    "deg": Unit((0, 0, 0, 1, 0), Fraction(1, 180), 1),
    "°": Unit((0, 0, 0, 1, 0), Fraction(1, 180), 1),
    "r": _TURN,
    "rev": _TURN,
    "rpm": Unit((0, 0, -1, 1, 0), Fraction(1, 30), 1),
}
#: Of each dimension, what a message offers.
_OFFERED = {
    "m": "m, mm, um or in",
    "N": "N, kN or lbf",
    "Pa": "Pa, MPa, GPa or psi",
    "r/min": "r/min, rpm, Hz or rad/s",
    "deg": "deg or rad",
    "Hz": "Hz or kHz",
    "s": "s or ms",
    "kg": "kg, g, lb or oz",
    "kg m": "kg m, g mm or oz in",
    "N/m": "N/m, N/um or lbf/in",
}
_FACTOR = re.compile(r"([^\W\d_]+|°)(?:(?:\^|\*\*)?([+-]?\d{1,2}))?")
_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_QUANTITY = re.compile(rf"\s*({_NUMBER})\s*(.*?)\s*", re.DOTALL)
#: For the JSON schema.
PATTERN = rf"^\s*{_NUMBER}\s*[^\s\d.].*$"
#: Digits of a number's power at most: more are no number of a bearing, and fill the memory.
_LONGEST = 400


@cache
def unit_of(text: str) -> Unit:
    """A unit from its symbols; ValueError: a symbol that is not known, or no product of symbols."""
    unit, sign = _ONE, 1
    for part in re.findall(r"\*\*|[/*·\s]|[^/*·\s]+(?:\*\*[+-]?\d+)?", text.replace(" ** ", "**")):
        if part == "/":
            sign = -1
        elif part not in "*·" and part.strip():
            match = _FACTOR.fullmatch(part)
            if match is None and part != "1":
                raise ValueError(f"'{part}' is no unit")
            if match is not None:
                unit = unit.times(_symbol(match[1]), sign * int(match[2] or 1))
            sign = 1
    return unit


def _symbol(name: str) -> Unit:
    if name in _PLAIN:
        return _PLAIN[name]
    if name in _SCALED:
        return _SCALED[name]
    if name[:1] in _PREFIXES and name[1:] in _SCALED:
        return Unit(_ONE.dimension, Fraction(10) ** _PREFIXES[name[0]]).times(_SCALED[name[1:]], 1)
    symbols = [*_PLAIN, *_SCALED, *(f"{p}{s}" for s in _SCALED for p in _PREFIXES)]
    raise ValueError(f"'{name}' is no unit{nearest(name, symbols)}")


def is_quantity(text: str) -> bool:
    """Whether a text begins with a number."""
    return _QUANTITY.fullmatch(text) is not None


def number_in(unit: str, text: str) -> float:
    """The number that a text with a unit has in another unit, rounded once: "9.525 mm" in m is 0.009525.

    unit : of the key, for instance "r/min"
    text : a number and its unit, for instance "200 Hz"

    ValueError: No number, an unknown unit, or one of another dimension; the sentence says what is accepted.
    """
    match = _QUANTITY.fullmatch(text)
    rule = f"a number in {unit}, or text with its unit: {_OFFERED.get(unit, unit)}" if unit else "a number without a unit"
    if match is None:
        raise ValueError(f"must be a number, not a string: {rule}")
    number, written_unit = match.groups()
    if not written_unit:
        raise ValueError(f"must be a number, not a string without a unit: {rule}")
    if written_unit == unit:
        return _nearest_float(Fraction(1), number)
    try:
        source, target = unit_of(written_unit), unit_of(unit)
    except ValueError as why:
        raise ValueError(f"{why}: must be {rule}") from None
    if source.dimension != target.dimension:
        raise ValueError(f"'{written_unit}' is not a unit of this key: must be {rule}")
    ratio = source.factor / target.factor
    return _nearest_float(ratio, number) * math.pi ** (source.pi - target.pi)


def _nearest_float(ratio: Fraction, number: str) -> float:
    if len(number) > _LONGEST or abs(int(number.lower().partition("e")[2] or 0)) > _LONGEST:
        raise ValueError("must be a finite number")
    try:
        return float(Fraction(number) * ratio)
    except OverflowError:
        raise ValueError("must be a finite number") from None
