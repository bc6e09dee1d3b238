"""Exponent of a power law with its interval: the test of "quadratic".

Notes
-----
For each exponent the law is linear in its other numbers.  The interval holds every exponent whose sum of squared rests stays
below S (1 + t^2 / (n - m)) + 3.84 e^2: S is the least sum, e the root mean square of the runs' own errors, n numbers, m
parameters, t Student's and 3.84 chi squared at 95 %.

References
----------
Seber, Wild, Nonlinear Regression (1989), section 5.4 (intervals from the sum of squares).
"""

from __future__ import annotations

import attrs
import numpy as np
from scipy.special import stdtrit

_EXPONENTS = np.linspace(0.05, 30.0, 2996)
_CHANCE, _CHI_SQUARED = 0.975, 3.84
#: Nearer to 2 than to 1 or 3 is roughly quadratic; a straight line has 1.
NEAREST, STRAIGHT = (1.5, 2.5), 1.0


@attrs.frozen
class Exponent:
    """Of a power law; ``low`` and ``high`` end its 95 % interval."""

    value: float
    low: float
    high: float

    @property
    def roughly_quadratic(self) -> bool:
        """Nearer to 2 than to any other whole number, and no straight line."""
        return NEAREST[0] <= self.value <= NEAREST[1] and not self.low <= STRAIGHT <= self.high

    def __str__(self) -> str:
        return f"{self.value:.2f} ({self.low:.2f} to {self.high:.2f})"


def exponent(x: np.ndarray, y: np.ndarray, errors: np.ndarray, constant: bool) -> Exponent | None:
    """p of y = c x^p, or of y = a + c x^p with a ``constant``; None where the numbers are too few for an interval.

    Parameters
    ----------
    x : (n,) positive;  y : (n,), nan where a number is missing;  errors : (n,) absolute
    """
    known = np.isfinite(y)
    x, y, errors = x[known], y[known], errors[known]
    free = len(y) - 2 - constant
    if free < 1:
        return None
    sums = _rests(x[None, :] ** _EXPONENTS[:, None], y, constant)
    best = int(np.argmin(sums))
    limit = sums[best] * (1.0 + stdtrit(free, _CHANCE) ** 2 / free) + _CHI_SQUARED * float((errors**2).mean())
    inside = _EXPONENTS[sums <= limit]
    # The grid's own step is the least interval that can be told.
    step = _EXPONENTS[1] - _EXPONENTS[0]
    low, high = (
        min(inside.min(initial=np.inf), _EXPONENTS[best] - step),
        max(inside.max(initial=0.0), _EXPONENTS[best] + step),
    )
    return Exponent(float(_EXPONENTS[best]), float(low), float(high))


def _rests(powers: np.ndarray, y: np.ndarray, constant: bool) -> np.ndarray:
    """Sums of squares (k,) that y (n,) leaves beside the best multiple of each power (k, n), about the means with a constant."""
    if constant:
        powers, y = powers - powers.mean(axis=1, keepdims=True), y - y.mean()
    factor = powers @ y / (powers**2).sum(axis=1)
    return np.asarray(((y - factor[:, None] * powers) ** 2).sum(axis=1))
