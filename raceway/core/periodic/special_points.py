"""Special points of a branch: folds, branch points, period doublings and pairs of multipliers that leave the unit circle."""

from collections.abc import Callable

import attrs
import numpy as np

from raceway.core.periodic.branch import Branch, Point
from raceway.core.periodic.floquet import NEUTRAL

FOLD, BRANCH, DOUBLING, PAIR = "fold", "branch point", "period doubling", "Neimark-Sacker"


#: Length of a step to which a point is located, over the step in which it was found.
_CLOSE = 1e-8


Test = Callable[[Point], float]


@attrs.frozen(eq=False)
class _Special:
    """A special point.

    kind : FOLD, BRANCH, DOUBLING or PAIR;  length : of the step to it from the point before
    angle : of the critical pair in a span [rad]; the second frequency over the span's; None for others
    """

    kind: str
    point: Point
    length: float
    angle: float | None = None


def special_points(branch: Branch, start: Point, end: Point, size: float) -> list[_Special]:
    """Those between a point and the next one, a step of length ``size`` [units] further on, in their order of kinds.

    Each has a function along the branch that changes its sign there, with T the transfer over a span that is turned back:

    fold               the parameter's part of the tangent
    branch point       det of the bordered problem [1 - T, -T_p; tangent]: another branch crosses (a symmetry breaks)
    period doubling    det(T + 1)
    Neimark-Sacker     |mu| - 1 of the pair that crosses the unit circle; the multipliers outside change by two at once

    Found between two neighbours and located by Brent's method on the length of the step from the first one. Without damping
    multipliers lie on the circle: a pair leaves it where two of them meet (a Krein collision), which is reported as the last
    kind.

    Seydel, Practical Bifurcation and Stability Analysis, 3rd ed. (2010), sections 5.3, 7.4; Kuznetsov, Elements of Applied
    Bifurcation Theory (1998), section 10.2.
    """
    specials = []
    tests: dict[str, Callable[[Point], float]] = {
        FOLD: lambda point: float(point.tangent[-1]),
        BRANCH: branch.crossing,
        DOUBLING: lambda point: float(np.linalg.det(point.transfer + np.eye(len(point.transfer)))),
    }
    for kind, test in tests.items():
        if test(start) * test(end) < 0.0:
            specials.append(_Special(kind, *located(branch, start, end, size, test)))
    before, after = _outside(start), _outside(end)
    by_pairs = after[1] - before[1]
    if abs(by_pairs) >= 2 and abs(sum(after) - sum(before) - by_pairs) <= len(specials):
        count = min(before[1], after[1])
        point, length = located(branch, start, end, size, lambda at: _pair(at, count))
        critical = point.floquet.of_span
        pairs = critical[np.abs(critical.imag) > 1e-6]
        specials.append(_Special(PAIR, point, length, float(abs(np.angle(pairs[np.argmin(np.abs(np.abs(pairs) - 1.0))])))))
    return specials


def located(branch: Branch, start: Point, end: Point, size: float, test: Test) -> tuple[Point, float]:
    """Where a function of the points is zero between two neighbours at which its signs differ, and the length of the step to it."""
    from scipy.optimize import brentq

    points = {0.0: start, size: end}

    def value(length: float) -> float:
        if length not in points:
            points[length] = branch.step(start, length)
        return test(points[length])

    length = brentq(value, 0.0, size, xtol=_CLOSE * size, rtol=1e-12)
    return points[length], length


def _outside(point: Point) -> tuple[int, int]:
    """How many multipliers of a turn lie outside the unit circle: real ones, and ones of pairs."""
    floquet = point.floquet
    outside = floquet.of_span[np.abs(floquet.of_span) > 1.0 + NEUTRAL]
    complex_ones = int((np.abs(outside.imag) > 1e-6 * np.abs(outside)).sum())
    return len(outside) - complex_ones, complex_ones


def _pair(point: Point, count: int) -> float:
    """How far the largest pair but ``count`` multipliers is outside."""
    multipliers = point.floquet.of_span
    sizes = np.sort(np.abs(multipliers[np.abs(multipliers.imag) > 1e-6 * np.abs(multipliers)]))[::-1]
    return float(sizes[count] - 1.0 - NEUTRAL) if len(sizes) > count else -1.0
