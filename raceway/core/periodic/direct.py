"""From a first guess to a periodic motion: at once, or with the force growing step by step."""

from __future__ import annotations

from math import ceil

import attrs
import numpy as np

from raceway.core.periodic.branch import between
from raceway.core.periodic.collocation import Solved, solve
from raceway.core.periodic.first_guess import guess, standing
from raceway.core.periodic.problem import Path, Problem
from raceway.core.periodic.refinement import Refined, refine
from raceway.core.periodic.symmetry import one_pitch, one_turn
from raceway.core.ring.system import System
from raceway.errors import ConvergenceError

#: Intervals a turn at least, and for each order of the highest natural frequency.
_INTERVALS, _PER_ORDER = 24, 1.5
#: Highest order that meshes are made for: the part of a solution that vibrates faster grows over each interval, a thousand
#: radians of it beyond all numbers, so that slow motions look singular.
HIGHEST = 2000.0
#: Sweeps of an iteration with full steps only.
_LIMIT = 12
#: Intervals of meshes that branches are followed on.
MOST = 512
#: First and least step of a growing force; on larger meshes the least is half the first.
_FIRST_SHARE, _LEAST_SHARE = 0.25, 0.02
#: Relative error of motions on the way.
ROUGH = 1e-4


def problem_of(system: System, speed: float, q: np.ndarray, symmetric: bool = True) -> Problem:
    """The boundary-value problem of one pitch where forces and bodies allow it, else of one turn.

    Parameters
    ----------
    speed : of the force [rad/s];  q : (5,) static equilibrium
    """
    pitch = one_pitch(system, speed, q) if symmetric else None
    return Problem(system, speed, pitch or one_turn(system))


def highest_order(problem: Problem, tangent: np.ndarray) -> float:
    """Highest natural frequency over the force's, with the tangent (5, 5) of the contacts."""
    return float(problem.system.natural_frequencies(tangent)[-1]) / problem.speed


def mesh_of(problem: Problem, highest: float, factor: int = 1) -> np.ndarray:
    """Nodes of a first mesh, equidistant over the span, for vibrations up to an order ``highest``."""
    turn = max(_INTERVALS, _PER_ORDER * min(highest, HIGHEST))
    count = max(2, ceil(factor * turn * problem.symmetry.span / (2.0 * np.pi) - 1e-9))
    return np.linspace(0.0, problem.symmetry.span, count + 1)


def directly(problem: Problem, q: np.ndarray, tangent: np.ndarray, tolerance: float) -> Refined:
    """The motion that full steps from the linear response about an equilibrium q (5,) lead to."""
    first = guess(problem, q, tangent, mesh_of(problem, highest_order(problem, tangent)))
    return refine(full_steps(problem, first, 1e-2 * tolerance), tolerance)


def full_steps(problem: Problem, first: Path, tolerance: float) -> Solved:
    """Newton's iteration that never shortens a step: one that has to be may end on a resonant branch far away."""
    return solve(problem, first, tolerance, 0, _LIMIT)


def grown(problem: Problem, q: np.ndarray, tangent: np.ndarray, tolerance: float) -> Refined:
    """With the force growing step by step, each begun where the last two lead; twice the mesh of a direct solve."""
    nodes = mesh_of(problem, highest_order(problem, tangent), 2)

    def part(share: float) -> Problem:
        return attrs.evolve(problem, share=share * problem.share)

    share, step = 0.0, _FIRST_SHARE
    last, before, gap = standing(problem, q, nodes), None, 1.0
    while share < 1.0:
        problem.watch()
        step = min(step, 1.0 - share)
        here = part(share + step)
        first = guess(here, q, tangent, nodes) if before is None else between(before, last, 1.0 + step / gap)
        try:
            solved = full_steps(here, first, ROUGH)
        except ConvergenceError:
            step *= 0.5
            # A large mesh makes small steps dear; none leads round a fold anyway.
            if step < (_LEAST_SHARE if len(nodes) <= MOST else 0.5 * _FIRST_SHARE):
                raise
            continue
        share, gap = share + step, step
        before, last = last, solved.path
        step *= 1.5 if solved.sweeps <= 5 else 1.0
    return refine(solve(problem, last, 1e-2 * tolerance), tolerance)
