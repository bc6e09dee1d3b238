"""How far along Newton's step: to where the potential's slope is a part of that at its start."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import numpy as np

T = TypeVar("T")

#: Trials of one search, and the slope of the potential over that at its start at which it ends.
TRIALS, FLAT = 12, 0.9


def searched(slope: float, at: Callable[[float], tuple[T, float, bool]]) -> T:
    """The state at the part of a step that the search ends with.

    Parameters
    ----------
    slope : of the potential at the step's start, downwards: step . unbalanced forces
    at : function of the part of the step -> the state there, its slope, and whether its forces balance well enough

    Notes
    -----
    -phi'(s) = step . rest falls from one side of the minimum to the other by as much as points that close are stiffer than the
    bodies.  The minimum is kept between the longest part s that falls short of it and the shortest one beyond: a part that is
    only cut, and never lengthened, stops short of where points close, in this iteration and in all that follow.
    """
    part, short, beyond, at_short, at_beyond = 1.0, 0.0, np.inf, slope, 0.0
    for _ in range(TRIALS):
        state, now, enough = at(part)
        if abs(now) <= FLAT * abs(slope) or enough or now > 0.0 and np.isinf(beyond):
            break
        if now > 0.0:
            short, at_short = part, now
        else:
            beyond, at_beyond = part, now
        # The secant, but well inside: one end may stay for long where the slope bends.
        part = short + (beyond - short) * min(max(at_short / (at_short - at_beyond), 0.1), 0.9)
    return state
