"""Speed of this machine: a fixed piece of work, timed once a process."""

from __future__ import annotations

import time
from functools import cache

#: Iterations of the piece of work, and its processor time on the machine that ``wall_time``'s constants belong to [s].
_ITERATIONS, _REFERENCE_S = 4000, 2.0e-4
#: Repeats: the least of many short ones finds the moments in which other programs leave the core alone.
REPEATS = 20


@cache
def slowness() -> float:
    """Processor time of this machine over that of the machine on which the plan's constants were measured; takes 5 ms."""
    return timed()


def timed(repeats: int = REPEATS) -> float:
    """``slowness`` as it is now."""
    return min(_seconds() for _ in range(repeats)) / _REFERENCE_S


def _seconds() -> float:
    """Of the logistic map in floating-point numbers of Python: scalar work like that of the compiled loops."""
    begun, x, total = time.process_time(), 0.5, 0.0
    for _ in range(_ITERATIONS):
        x = 3.7 * x * (1.0 - x)
        total += x
    return time.process_time() - begun
