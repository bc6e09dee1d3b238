"""What curves over speed and load do: rise or fall, by how much, with which power, whether the load's influence grows."""

import attrs
import numpy as np
from scipy.special import stdtrit

from raceway.extend import trend
from raceway_article.rules import LEVEL

#: "about" a percentage: within this share of it.
ABOUT = 0.25


def course(values: np.ndarray, errors: np.ndarray, failures: np.ndarray) -> str | None:
    """ "rises" or "falls" at every step, "level", "not monotonic"; None with a failed run, without both ends, or with
    fewer than three numbers.

    values : (n,);  errors : (n,) relative; a step within its ends' errors is no step;  failures : (n,) bool
    """
    finite = np.isfinite(values)
    if failures.any() or not (finite[0] and finite[-1] and finite.sum() >= 3):
        return None
    y = values[finite]
    if np.ptp(y) < LEVEL * abs(y[0]):
        return "level"
    steps = trend(y, errors[finite])
    return steps if steps == "not monotonic" or abs(y[-1] / y[0] - 1.0) >= LEVEL else "level"


def is_about(value: float, target: float) -> bool:
    return abs(value - target) <= ABOUT * target


def change_within(w: np.ndarray, values: np.ndarray, failures: np.ndarray, first: float, last: float) -> float | None:
    """k(last) / k(first) - 1 over the relative speed w (n,); None with a failed run or without numbers around both ends."""
    ends = None if failures.any() else _values_at(w, values, np.array([first, last]))
    return None if ends is None else float(ends[1] / ends[0] - 1.0)


def load_effect(w: np.ndarray, surface: np.ndarray, failures: np.ndarray, first: float, last: float) -> float | None:
    """Largest of max/min - 1 over the loads at the ends of a zone and the speeds in it; None as in ``change_within``.

    surface : (loads, speeds), positive;  failures : (loads, speeds) bool
    """
    zone = np.array([first, *w[(w > first) & (w < last)], last])
    rows = [None if failures.any() else _values_at(w, values, zone) for values in surface]
    complete = [row for row in rows if row is not None]
    if len(complete) < len(rows):
        return None
    return float((np.max(complete, axis=0) / np.min(complete, axis=0) - 1.0).max())


def _values_at(w: np.ndarray, values: np.ndarray, at: np.ndarray) -> np.ndarray | None:
    """Values at ascending points, between neighbours by straight lines; None where they do not reach both ends."""
    finite = np.isfinite(values)
    w, values = w[finite], values[finite]
    return None if len(w) < 2 or at[0] < w[0] or at[-1] > w[-1] else np.interp(at, w, values)


def rises_with_load(surface: np.ndarray, errors: np.ndarray, failures: np.ndarray) -> list[bool | None]:
    """At each speed: whether k rises at every step of the axial load; (loads, speeds) each."""
    courses = [course(*column) for column in zip(surface.T, errors.T, failures.T, strict=True)]
    return [None if outcome is None else outcome == "rises" for outcome in courses]


def influence(surface: np.ndarray) -> np.ndarray:
    """(loads,) |k*(1) - 1|, the size of the speed's influence."""
    return np.asarray(np.abs(surface[:, -1] / surface[:, 0] - 1.0))


def influence_grows(surface: np.ndarray, failures: np.ndarray) -> bool | None:
    """Whether the size of the speed's influence rises at every step of the axial load; (loads, speeds) each."""
    size = influence(surface)
    if failures.any() or not np.isfinite(size).all():
        return None
    return bool((np.diff(size) > 0.0).all())


_EXPONENTS = np.linspace(0.05, 30.0, 2996)
_CHANCE, _CHI_SQUARED = 0.975, 3.84
#: Nearer to 2 than to 1 or 3 is roughly quadratic; a straight line has 1.
NEAREST, _STRAIGHT = (1.5, 2.5), 1.0


@attrs.frozen
class Exponent:
    """Of a power law; ``low`` and ``high`` end its 95 % interval."""

    value: float
    low: float
    high: float

    @property
    def roughly_quadratic(self) -> bool:
        """Nearer to 2 than to any other whole number, and no straight line."""
        return NEAREST[0] <= self.value <= NEAREST[1] and not self.low <= _STRAIGHT <= self.high


def power_exponent(x: np.ndarray, y: np.ndarray, errors: np.ndarray, constant: bool) -> Exponent | None:
    """p of y = c x^p, or of y = a + c x^p with a ``constant``; None where the numbers are too few for an interval.

    x : (n,) positive;  y : (n,), nan where a number is missing;  errors : (n,) absolute
    """
    finite = np.isfinite(y)
    x, y, errors = x[finite], y[finite], errors[finite]
    free = len(y) - 2 - constant
    if free < 1:
        return None
    powers = x[None, :] ** _EXPONENTS[:, None]
    if constant:  # about the means
        powers, y = powers - powers.mean(axis=1, keepdims=True), y - y.mean()
    factor = powers @ y / (powers**2).sum(axis=1)
    sums = ((y - factor[:, None] * powers) ** 2).sum(axis=1)
    best = int(np.argmin(sums))
    limit = sums[best] * (1.0 + stdtrit(free, _CHANCE) ** 2 / free) + _CHI_SQUARED * float((errors**2).mean())
    inside = _EXPONENTS[sums <= limit]
    # No interval is narrower than the step of the grid.
    value, step = _EXPONENTS[best], _EXPONENTS[1] - _EXPONENTS[0]
    low, high = min(inside.min(initial=np.inf), value - step), max(inside.max(initial=0.0), value + step)
    return Exponent(float(value), float(low), float(high))
