"""The periodic motion of a system: directly, or along a branch on which the force grows or the speed changes."""

from __future__ import annotations

from math import ceil

import attrs
import numpy as np

from raceway.core.bodies.ring import CAGE
from raceway.core.periodic.branch import Branch, Point
from raceway.core.periodic.collocation import Path, Problem, Solved, solve
from raceway.core.periodic.first_guess import guess, response, standing
from raceway.core.periodic.neighbour import Neighbour, neighbour_of
from raceway.core.periodic.rates import stiff
from raceway.core.periodic.refinement import Refined, refine
from raceway.core.periodic.symmetry import one_pitch, one_turn
from raceway.core.system import System
from raceway.errors import ConvergenceError

#: Intervals a turn at least, and for each order of the highest natural frequency.
_INTERVALS, _PER_ORDER = 24, 1.5
_DIRECT_LIMIT = 12
#: Points of a branch, intervals of its meshes, and relative error that they are kept fit for.
_POINTS, _MOST, _ROUGH = 120, 512, 1e-4
#: Speeds, over the wanted one, from which the motion is followed where none grows out of rest.
_DETOURS = (1.15, 1.3, 1.6, 0.85, 0.7)
#: First and least step of a growing force.
_FIRST_SHARE, _LEAST_SHARE = 0.25, 0.02


@attrs.frozen(eq=False)
class Found:
    """A periodic motion.

    Attributes
    ----------
    refined : the motion with its error
    highest : order of the highest natural frequency at the equilibrium
    how : "directly", "from rest" (the force grows), "from a higher speed" or "from a lower speed"
    fold : share of the force at which the branch from rest turns back; None where it does not
    """

    refined: Refined
    highest: float
    how: str
    fold: float | None = None


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
    turn = max(_INTERVALS, _PER_ORDER * min(highest, 2000.0))
    count = max(2, ceil(factor * turn * problem.symmetry.span / (2.0 * np.pi) - 1e-9))
    return np.linspace(0.0, problem.symmetry.span, count + 1)


def find(problem: Problem, q: np.ndarray, tangent: np.ndarray, tolerance: float, near: Neighbour | None = None) -> Found:
    """The periodic motion that grows out of the equilibrium q (5,), to a relative tolerance.

    Parameters
    ----------
    near : motion of a similar problem to start from

    Notes
    -----
    Newton's iteration from the linear response, with full steps only: one that has to be shortened may end on a resonant
    branch far away.  Then with the force growing in steps, then along the branch that leads from the resting ring to the
    whole force, round its folds.  Where that branch turns back for good, motions under the whole force at other speeds are
    followed to this speed.

    Raises
    ------
    ConvergenceError
        No periodic motion found, with what was tried.
    """
    highest = highest_order(problem, tangent)
    nodes = mesh_of(problem, highest)
    followed = None if near is None else near.first_guess(problem, q, tangent, nodes)
    for first in ([] if followed is None else [followed]) + [None]:
        try:
            refined = _direct(problem, q, tangent, tolerance, highest, first)
        except ConvergenceError:
            continue
        # Far from the linear response there may be other motions: then the search without a neighbour decides.
        if first is None or neighbour_of(refined.solved, q, tangent).near_linear:
            return Found(refined, highest, "directly")
    try:
        return Found(_grown(problem, q, tangent, tolerance), highest, "from rest")
    except ConvergenceError:
        pass
    if len(nodes) > _MOST or stiff(problem, standing(problem, q, nodes)):
        # Each point would take seconds.
        raise ConvergenceError(
            "no motion of the period of the force was found from rest, and it is not looked for along branches: natural "
            f"frequencies go up to {highest:.3g} times the force's, or dashpots are strong. A transient integrator with "
            "start = 'ramp' shows what the ring does.",
            {"q": q.copy()},
        )
    points = from_rest(problem, q, tangent, nodes)
    if points[-1].parameter >= 1.0:
        return Found(_from_branch(problem, points, 1.0, tolerance), highest, "from rest")
    fold = max(p.parameter for p in points)
    if problem.system.scalars[CAGE] == 0.0:
        for ratio in _DETOURS:
            try:
                refined = _detour(problem, q, tangent, tolerance, ratio)
            except ConvergenceError:
                continue
            return Found(refined, highest, "from a higher speed" if ratio > 1.0 else "from a lower speed", fold)
    turns_back = any(p.folded for p in points)
    why = "where its branch turns back (an internal resonance)" if turns_back else "beyond which it could not be followed"
    raise ConvergenceError(
        f"no motion of the period of the force was found: the one that grows out of rest ends at {100 * fold:.3g} % of the "
        f"force, {why}, and none leads here from other speeds. A transient integrator with start = 'ramp' shows what the "
        "ring does instead.",
        {"q": q.copy(), "points": points},
    )


def _direct(
    problem: Problem, q: np.ndarray, tangent: np.ndarray, tolerance: float, highest: float, first: Path | None = None
) -> Refined:
    if first is None:
        first = guess(problem, q, tangent, mesh_of(problem, highest))
    return refine(solve(problem, first, 1e-2 * tolerance, 0, _DIRECT_LIMIT), tolerance)


def _grown(problem: Problem, q: np.ndarray, tangent: np.ndarray, tolerance: float) -> Refined:
    """With the force growing step by step, each begun where the last two lead; twice the mesh of a direct solve."""
    nodes = mesh_of(problem, highest_order(problem, tangent), 2)

    def part(share: float) -> Problem:
        return attrs.evolve(problem, share=share * problem.share)

    share, step = 0.0, _FIRST_SHARE
    last, before, gap = standing(problem, q, nodes), None, 1.0
    while share < 1.0:
        step = min(step, 1.0 - share)
        here = part(share + step)
        first = guess(here, q, tangent, nodes) if before is None else _between(before, last, 1.0 + step / gap)
        try:
            solved = solve(here, first, _ROUGH, 0, _DIRECT_LIMIT)
        except ConvergenceError:
            step *= 0.5
            # A large mesh makes small steps dear; none leads round a fold anyway.
            if step < (_LEAST_SHARE if len(nodes) <= _MOST else 0.5 * _FIRST_SHARE):
                raise
            continue
        share, gap = share + step, step
        before, last = last, solved.path
        step *= 1.5 if solved.sweeps <= 5 else 1.0
    return refine(solve(problem, last, 1e-2 * tolerance), tolerance)


def _from_branch(problem: Problem, points: list[Point], wanted: float, tolerance: float) -> Refined:
    """The motion at one parameter, from the last two points of a branch on either side of it."""
    one, two = points[-2:]
    path = two.solved.path
    if one.solved.path.intervals == path.intervals and np.array_equal(one.solved.path.nodes, path.nodes):
        part = (wanted - one.parameter) / (two.parameter - one.parameter)
        path = _between(one.solved.path, path, part)
    return refine(solve(problem, path, 1e-2 * tolerance), tolerance)


def _between(one: Path, two: Path, part: float) -> Path:
    names = ("q", "v", "a", "ball", "rate")
    return attrs.evolve(two, **{x: (1.0 - part) * getattr(one, x) + part * getattr(two, x) for x in names})


def _detour(problem: Problem, q: np.ndarray, tangent: np.ndarray, tolerance: float, ratio: float) -> Refined:
    """From the motion at another speed of the force, the bodies' own speed unchanged."""
    wanted = problem.speed

    def at(speed: float) -> Problem:
        return Problem(problem.system, speed, problem.symmetry, problem.share, wanted)

    far = at(ratio * wanted)
    try:
        begin = _direct(far, q, tangent, _ROUGH, highest_order(far, tangent))
    except ConvergenceError:
        begin = _grown(far, q, tangent, _ROUGH)
    branch = Branch(at, abs(ratio - 1.0) * wanted, begin.solved.size, _ROUGH, _MOST)
    sense = np.sign(1.0 - ratio)
    first = branch.start(begin.solved, far.speed, sense)
    points = branch.follow(first, 0.1, lambda p: (p.parameter - wanted) * sense >= 0.0 or p.folded, _POINTS, 1.0)
    if (points[-1].parameter - wanted) * sense < 0.0:
        raise ConvergenceError("the branch turns back", {"points": points})
    return _from_branch(problem, points, wanted, tolerance)


def from_rest(problem: Problem, q: np.ndarray, tangent: np.ndarray, nodes: np.ndarray) -> list[Point]:
    """The branch from the resting ring to the whole force, or to where it is lost or back at no force."""
    _, lines = response(problem, tangent)
    length = max(float(np.abs(lines / problem.weight).max(initial=0.0)), 1e-12)
    branch = Branch(lambda share: attrs.evolve(problem, share=share), 1.0, length, _ROUGH, _MOST)
    still = attrs.evolve(problem, share=0.0)
    n, none = len(problem.free), np.empty((0, 0))
    rest = Solved(still, standing(still, q, nodes), none, none, np.zeros((2 * n, 2 * n + 2)), 0.0, True, 0, 0.0)

    def ended(p: Point) -> bool:
        return p.parameter >= 1.0 or p.parameter < -0.01

    try:
        return branch.follow(branch.start(rest, 0.0), 0.1, ended, _POINTS, 2.0)
    except ConvergenceError as why:
        if "points" not in why.state:
            raise
        return list(why.state["points"])
