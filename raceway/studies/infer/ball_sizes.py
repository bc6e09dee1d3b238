"""Usual diameters of bearing balls: inch sizes first, which most makers take, in steps that grow with the ball; then whole and half mm.

References
----------
ISO 3290-1:2014, annex of preferred ball sizes (its inch sizes: by 1/64 in small, 1/32 in middle, 1/16 in large balls).
"""

from __future__ import annotations

import numpy as np

_INCH = 25.4e-3
#: First and last size, and the step: in inches, and in m.
_BY_INCH = ((1 / 16, 31 / 64, 1 / 64), (1 / 2, 47 / 32, 1 / 32), (3 / 2, 4.0, 1 / 16))
_BY_MILLIMETRE = ((1e-3, 12.5e-3, 0.5e-3), (13e-3, 100e-3, 1e-3))
#: Relative distance up to which two sizes are one.
_SAME = 1e-6


def ball_sizes(smallest: float, largest: float, metric: bool = False) -> np.ndarray:
    """Sizes (n,) [m] from ``smallest`` to ``largest`` [m], by inches or by mm."""
    unit, steps = (1.0, _BY_MILLIMETRE) if metric else (_INCH, _BY_INCH)
    every = np.concatenate([np.arange(first, last + 0.5 * step, step) for first, last, step in steps]) * unit
    return every[(every >= smallest) & (every <= largest)]


def size_words(diameter: float) -> str:
    """A size as people write it: 15/32 in, 6.5 mm."""
    parts = diameter / _INCH * 64.0
    if abs(parts - round(parts)) < _SAME * parts:
        top, bottom = round(parts), 64
        while top % 2 == 0 and bottom > 1:
            top, bottom = top // 2, bottom // 2
        return f"{top}/{bottom} in" if bottom > 1 else f"{top} in"
    return f"{1e3 * diameter:g} mm"
