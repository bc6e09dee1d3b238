"""A periodic motion reached from another speed of the force, where none that grows out of rest leads to it."""

from __future__ import annotations

from itertools import islice, pairwise

import attrs
import numpy as np

from raceway.core.periodic.branch import Branch, towards
from raceway.core.periodic.collocation import solve
from raceway.core.periodic.direct import MOST, ROUGH, directly, grown
from raceway.core.periodic.from_rest import POINTS
from raceway.core.periodic.problem import Problem
from raceway.core.periodic.refinement import Refined, refine
from raceway.errors import ConvergenceError

#: Speeds, over the wanted one, that the motion is followed from.
_RATIOS = (1.15, 1.3, 1.6, 0.85, 0.7)


def from_other_speeds(problem: Problem, q: np.ndarray, tangent: np.ndarray, tolerance: float) -> tuple[Refined, str] | None:
    """The first motion that leads here from another speed, and from where; None where none does."""
    for ratio in _RATIOS:
        problem.watch()
        where = "from a higher speed" if ratio > 1.0 else "from a lower speed"
        try:
            return _from(problem, q, tangent, tolerance, ratio), where
        except ConvergenceError:
            continue
    return None


def _from(problem: Problem, q: np.ndarray, tangent: np.ndarray, tolerance: float, ratio: float) -> Refined:
    """From the motion at another speed of the force, the bodies' own speed unchanged."""
    wanted, sense = problem.speed, float(np.sign(1.0 - ratio))

    def at(speed: float) -> Problem:
        return attrs.evolve(problem, speed=speed, clock=wanted)

    far = at(ratio * wanted)
    try:
        begin = directly(far, q, tangent, ROUGH)
    except ConvergenceError:
        begin = grown(far, q, tangent, ROUGH)
    branch = Branch(at, abs(ratio - 1.0) * wanted, begin.solved.size, ROUGH, MOST)
    points = branch.follow(branch.start(begin.solved, far.speed, sense), 0.1, 1.0)
    for one, two in pairwise(islice(points, POINTS)):
        if (two.parameter - wanted) * sense >= 0.0:
            return refine(solve(problem, towards(one, two, wanted), 1e-2 * tolerance), tolerance)
        if two.folded:
            break
    raise ConvergenceError("the branch turns back")
