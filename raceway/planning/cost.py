"""Predicted time of a run of compiled rings, and of a point in columns, from measured times of their parts.

Constants are seconds of processor time of the reference machine of ``slowness``, with all that a run does
for its error beside its answer: tests/evidence/test_cost.py holds whole runs against them.
"""

import time
from collections.abc import Mapping
from functools import cache

import attrs

from raceway.planning.parts import Balls, PlannedMotion
from raceway.planning.resolve import Problem, recorded_per_turn

#: How much less a step of an explicit method takes, whose steps iterate less.
_EXPLICIT = 0.5
#: An equilibrium of a series, over a step in time.
_EQUILIBRIUM = 6.0
#: Steps of a run with a third one from another start, over those of two.
_FROM_ANOTHER_START = 4.0 / 3.0
#: A step in which the speed changes: one call from Python each.
_CHANGING_S = 130.0e-6
#: A steady orbit; the search for further ones, and from which amplitude over the axial load on: a force along a fixed
#: direction on free tilts meets internal resonances.  The search takes 0.3 to 9 s: what it will meet is not known before.
_ORBIT_S, _SEARCH_S, _SEARCH_FROM = 0.02, 3.0, 0.4
#: Start-up with warm caches, to the first result.
START_S = 1.2


@attrs.frozen
class Times:
    """Measured times of one kind of compiled rings with 12 balls [s].

    Attributes
    ----------
    step : of an implicit method, by the kind of the balls;  sample : of the record: lines, energies and extremes
    search : of a steady orbit, over that of rigid rings
    """

    step: Mapping[str, float]
    sample: float
    search: float


def runs(problem: Problem, motion: PlannedMotion) -> float:
    """Motions that are integrated for the answer and its error, over those without memory of the start."""
    return _FROM_ANOTHER_START if motion.recorded and problem.depends_on_start else 1.0


def compiled_motion(problem: Problem, balls: Balls, motion: PlannedMotion, times: Times, more: float = 0.0) -> float:
    """Processor time of the motion of a compiled ring [s]; ``more`` : of a step with 12 balls."""
    if not motion.recorded:
        return 0.0
    method, share = problem.integrator.method, problem.bearing.balls_in_all / 12.0
    each = runs(problem, motion) * share * (times.step[balls.kind] + more)
    each *= (1.0 if method.implicit else _EXPLICIT) * (1.0 if method.inertial else _EQUILIBRIUM)
    if problem.sweeps:
        each += _CHANGING_S
    samples = motion.turns * recorded_per_turn(motion.steps_per_turn, motion.turns, method.inertial)
    steps = 0 if method.steady else motion.turns * motion.steps_per_turn
    # A steady orbit is the answer, or a transient starts on it.
    orbit = 0.0
    if method.inertial:
        with_search = problem.tilts and problem.excitation.sense == 0
        with_search = with_search and problem.excitation.amplitude_n > _SEARCH_FROM * abs(problem.load.axial)
        orbit = _SEARCH_S if with_search else _ORBIT_S
    return times.search * orbit + samples * share * times.sample + steps * each


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
    seconds = []
    for _ in range(repeats):  # the logistic map in numbers of Python: scalar work like that of the compiled loops
        start, x, total = time.process_time(), 0.5, 0.0
        for _ in range(_ITERATIONS):
            x = 3.7 * x * (1.0 - x)
            total += x
        seconds.append(time.process_time() - start)
    return min(seconds) / _REFERENCE_S
