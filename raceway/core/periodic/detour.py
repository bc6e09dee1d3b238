"""Periodic motions that are followed to from another speed of the force, a heavier axial load, or no damping."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import partial
from itertools import islice, pairwise

import attrs
import numpy as np

from raceway.core.periodic.branch import Branch, towards
from raceway.core.periodic.collocation import solve
from raceway.core.periodic.direct import MOST, ROUGH, directly, full_steps, grown
from raceway.core.periodic.from_rest import POINTS, at_whole_force, trail
from raceway.core.periodic.problem import Problem
from raceway.core.periodic.refinement import Refined, refine
from raceway.core.ring.kernels.layout import DAMPING, TIME_CONSTANT
from raceway.errors import ConvergenceError

#: Speeds, and axial loads, over the wanted one, that the motion is followed from.
_RATIOS, _LOADS = (1.15, 1.3, 1.6, 0.85, 0.7), (1.5, 2.5)
#: Speeds that are so near that a branch leads here through its folds, if at all.
_NEAR = (1.02, 1.05, 0.97)


def from_elsewhere(
    problem: Problem, q: np.ndarray, tangent: np.ndarray, tolerance: float, lost: bool
) -> tuple[Refined, str] | None:
    """The first motion that leads here from another speed or load, and from where; None where none does.

    Parameters
    ----------
    q : (5,) static equilibrium;  tangent : (5, 5) of its contacts
    lost : no motion is known here, so that nearby branches are worth following through their folds
    """
    for ratio in (*(_NEAR if lost else ()), *_RATIOS):
        problem.watch()
        at = partial(_at_speed, problem)
        with suppress(ConvergenceError):
            found = _followed(at, q, tangent, tolerance, ratio, lost and ratio in _NEAR)
            return found, "from a higher speed" if ratio > 1.0 else "from a lower speed"
    if problem.system.load[0] == 0.0 or problem.system.free[0] == 0.0:
        return None
    for ratio in _LOADS:
        problem.watch()
        at = partial(_at_load, problem)
        with suppress(ConvergenceError):
            system = at(ratio).system
            there, ball, _ = system.settle(q)
            stiff = system.evaluate(there, ball=ball).stiffness
            return _followed(at, there, stiff, tolerance, ratio, False), "from a heavier axial load"
    return None


def from_undamped(
    problem: Problem, q: np.ndarray, tangent: np.ndarray, nodes: np.ndarray, tolerance: float
) -> Iterator[Refined]:
    """Motions that the branch from rest leads to without damping, each continued to the damped ring; none of an undamped one.

    Notes
    -----
    Without damping branches of motions cross, where the ring's motion may lead or lag alike; the least damping parts them
    there, and what lay beyond the crossing is no longer on the branch that begins at rest, though it still exists.
    """
    system = problem.system.without(DAMPING, TIME_CONSTANT)
    skew = 0.5 * (system.damping - system.damping.T)  # gyroscopic moments stay: they take no energy
    if np.array_equal(system.scalars, problem.system.scalars) and np.array_equal(skew, system.damping):
        return
    still = attrs.evolve(problem, system=attrs.evolve(system, damping=skew))
    problem.watch()
    with suppress(ConvergenceError):
        for motion in at_whole_force(still, trail(still, q, tangent, nodes).crossings, ROUGH):
            problem.watch()
            with suppress(ConvergenceError):
                yield refine(full_steps(problem, motion.solved.path, 1e-2 * tolerance), tolerance)


def _at_speed(problem: Problem, ratio: float) -> Problem:
    """At another speed of the force, the bodies' own speed and the force itself unchanged."""
    return attrs.evolve(problem, speed=ratio * problem.speed, clock=problem.speed)


def _at_load(problem: Problem, ratio: float) -> Problem:
    load = problem.system.load.copy()
    load[0] *= ratio
    return attrs.evolve(problem, system=attrs.evolve(problem.system, load=load))


def _followed(
    at: Callable[[float], Problem], q: np.ndarray, tangent: np.ndarray, tolerance: float, ratio: float, through: bool
) -> Refined:
    """From the motion about an equilibrium at a ratio to that at 1; ``through`` folds, too.

    Raises
    ------
    ConvergenceError
        None leads there.
    """
    far, sense = at(ratio), float(np.sign(1.0 - ratio))
    try:
        begin = directly(far, q, tangent, ROUGH)
    except ConvergenceError:
        begin = grown(far, q, tangent, ROUGH)
    branch = Branch(at, abs(ratio - 1.0), begin.solved.size, ROUGH, MOST)
    points = branch.follow(branch.start(begin.solved, ratio, sense), 0.1, 1.0)
    for one, two in pairwise(islice(points, POINTS)):
        if (two.parameter - 1.0) * sense >= 0.0:
            return refine(solve(at(1.0), towards(one, two, 1.0), 1e-2 * tolerance), tolerance)
        if (two.folded and not through) or (two.parameter - ratio) * sense < 0.0:
            break
    raise ConvergenceError("the branch turns back")
