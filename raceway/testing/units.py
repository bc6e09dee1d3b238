"""Reads the units that options declare, so that a plug-in can be checked in other units of length, force and time."""

from __future__ import annotations

import re

from raceway.testing.suite import ConformityError

#: Exponents of length, force and time.
_UNITS: dict[str, tuple[float, float, float]] = {
    "m": (1, 0, 0), "N": (0, 1, 0), "s": (0, 0, 1), "kg": (-1, 1, 2), "Pa": (-2, 1, 0), "J": (1, 1, 0), "Hz": (0, 0, -1),
    "W": (1, 1, -1), "K": (0, 0, 0), "rad": (0, 0, 0), "deg": (0, 0, 0), "r": (0, 0, 0), "min": (0, 0, 1), "1": (0, 0, 0), "%": (0, 0, 0),
}  # fmt: skip
_FACTOR = re.compile(r"^([A-Za-z%]+|1)(?:\^?(-?\d+(?:\.\d+)?))?$")


def exponents(unit: str) -> tuple[float, float, float]:
    """Exponents of length, force and time in a unit such as "N/m3", "kg m", "N/m^1.5", "" or "r/min".

    Raises
    ------
    ConformityError
        A unit that is not made of SI units.
    """
    total = [0.0, 0.0, 0.0]
    above, *below = unit.split("/")
    for sign, part in ((1.0, above), *((-1.0, p) for p in below)):
        for word in part.split():
            match = _FACTOR.match(word)
            if match is None or match.group(1) not in _UNITS:
                raise ConformityError(
                    f"the unit '{unit}' of an option cannot be read; write SI units such as 'N s/m' or 'N/m3'"
                )
            power = sign * float(match.group(2) or 1.0)
            total = [t + power * u for t, u in zip(total, _UNITS[match.group(1)], strict=True)]
    return total[0], total[1], total[2]


def scale_of(unit: str, length: float, force: float, time: float) -> float:
    """The factor by which a value in this unit changes when lengths, forces and times are multiplied."""
    a, b, c = exponents(unit)
    return length**a * force**b * time**c
