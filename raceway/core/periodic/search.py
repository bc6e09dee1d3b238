"""The periodic motions of a system: directly, and along branches on which the force grows or the speed changes."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from math import ceil

import attrs
import numpy as np

from raceway.core.bodies.ring import CAGE
from raceway.core.periodic.branch import Branch, Point
from raceway.core.periodic.collocation import Path, Problem, Solved, solve
from raceway.core.periodic.first_guess import guess, response, standing
from raceway.core.periodic.floquet import Floquet, floquet
from raceway.core.periodic.neighbour import Neighbour, neighbour_of
from raceway.core.periodic.rates import stiff
from raceway.core.periodic.refinement import Refined, refine
from raceway.core.periodic.sampling import half_a_turn_later, states
from raceway.core.periodic.sweep import forces
from raceway.core.periodic.symmetry import one_pitch, one_turn
from raceway.core.system import System
from raceway.errors import ConvergenceError

#: Intervals a turn at least, and for each order of the highest natural frequency.
_INTERVALS, _PER_ORDER = 24, 1.5
#: Highest order that meshes are made for: the part of a solution that vibrates faster grows over each interval, a thousand
#: radians of it beyond all numbers, so that slow motions look singular.
HIGHEST = 2000.0
_DIRECT_LIMIT = 12
#: Points of a branch, intervals of its meshes, and relative error that they are kept fit for.
_POINTS, _MOST, _ROUGH = 120, 512, 1e-4
#: Speeds, over the wanted one, from which the motion is followed where none grows out of rest.
_DETOURS = (1.15, 1.3, 1.6, 0.85, 0.7)
#: First and least step of a growing force.
_FIRST_SHARE, _LEAST_SHARE = 0.25, 0.02
#: Share of the force up to which the branch from rest is followed for its folds: a Duffing oscillator whose motion differs
#: by a tenth from its linear response (``neighbour.MOST_NONLINEAR``) folds at 1.35 times the force, the internal resonances
#: of the article's scene with tilt free at 1.6 and 1.8 times.
_BEYOND = 2.0
#: A branch that stays below this share of the force for so many points has become a free vibration: it is left there.
_SMALL_SHARE, _SMALL_POINTS = 0.2, 10
#: Distance of two motions over their size below which they are one.
_SAME = 1e-3
#: Angles at which motions are compared: no harmonic of a turn hides between them.
_COMPARED = 2.0 * np.pi * np.arange(17) / 17


@attrs.frozen(eq=False)
class Found:
    """A periodic motion.

    Attributes
    ----------
    refined : the motion with its error
    highest : order of the highest natural frequency at the equilibrium
    how : "directly", "from rest" (the force grows), "from a higher speed", "from a lower speed" or "by Fourier collocation"
    fate : its multipliers
    fold : share of the force at which the branch from rest turns back for good; None where it leads to the whole force
    others : further motions under the same force that were met in the search
    """

    refined: Refined
    highest: float
    how: str
    fate: Floquet
    fold: float | None = None
    others: tuple[Found, ...] = ()

    @property
    def all(self) -> tuple[Found, ...]:
        """This one first."""
        return (self, *self.others)


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


def find(problem: Problem, q: np.ndarray, tangent: np.ndarray, tolerance: float, near: Neighbour | None = None) -> Found:
    """The periodic motion of a ring about the equilibrium q (5,), to a relative tolerance, and others beside it.

    Parameters
    ----------
    near : motion of a similar problem to start from

    Notes
    -----
    Newton's iteration from the linear response, with full steps only: one that has to be shortened may end on a resonant
    branch far away.  Where it fails, is unstable, or ends far from the linear response, there may be several motions: the
    branch that leads from the resting ring is followed round its folds, and every place where it meets the whole force is a
    motion.  The first one along the branch that is not unstable is taken; where all are, the one that is left slowest.  Where
    the branch never reaches the whole force and all found so far is unstable, motions at other speeds are followed to this one.

    Raises
    ------
    ConvergenceError
        No periodic motion found, with what was tried.
    """
    highest = highest_order(problem, tangent)
    nodes = mesh_of(problem, highest)
    followed = None if near is None else near.first_guess(problem, q, tangent, nodes)
    direct = None
    for first in ([] if followed is None else [followed]) + [None]:
        try:
            direct = found_by(_direct(problem, q, tangent, tolerance, highest, first), highest, "directly")
        except ConvergenceError:
            continue
        # Far from the linear response there may be other motions: then the search without a neighbour decides.
        if not may_have_others(direct, q, tangent):
            return direct
    if not can_follow(problem, q, tangent):
        # Each point would take seconds.
        return direct or found_by(_grown_only(problem, q, tangent, tolerance, highest), highest, "from rest")
    return _chosen(problem, q, tangent, tolerance, nodes, direct)


def may_have_others(found: Found, q: np.ndarray, tangent: np.ndarray) -> bool:
    """Whether a motion is unstable or so far from its linear response about q (5,) that other ones may exist beside it."""
    return found.fate.verdict == "unstable" or not neighbour_of(found.refined.solved, q, tangent).near_linear


def can_follow(problem: Problem, q: np.ndarray, tangent: np.ndarray) -> bool:
    """Whether branches are followed: meshes for the natural frequencies are small, and dashpots in the contacts weak."""
    nodes = mesh_of(problem, highest_order(problem, tangent))
    return len(nodes) <= _MOST and not stiff(problem, standing(problem, q, nodes))


def found_by(refined: Refined, highest: float, how: str, fold: float | None = None) -> Found:
    """A motion with its multipliers."""
    return Found(refined, highest, how, floquet(refined.solved, highest), fold)


def _grown_only(problem: Problem, q: np.ndarray, tangent: np.ndarray, tolerance: float, highest: float) -> Refined:
    try:
        return _grown(problem, q, tangent, tolerance)
    except ConvergenceError as why:
        raise ConvergenceError(
            "no motion of the period of the force was found from rest, and it is not looked for along branches: natural "
            f"frequencies go up to {highest:.3g} times the force's, or dashpots are strong. A transient integrator with "
            "start = 'ramp' shows what the ring does.",
            {"q": q.copy()},
        ) from why


def _chosen(
    problem: Problem, q: np.ndarray, tangent: np.ndarray, tolerance: float, nodes: np.ndarray, direct: Found | None
) -> Found:
    """The motion that is taken, of all that the branch from rest and Newton's iteration lead to."""
    highest = highest_order(problem, tangent)
    points, lost = _followed(problem, q, tangent, nodes)
    found: list[Found] = []
    for refined in _at_whole_force(problem, points, tolerance):
        if not any(_alike(refined, one.refined) for one in found):
            found.append(found_by(refined, highest, "from rest"))
    fold = None if any(p.parameter >= 1.0 for p in points) else max((p.parameter for p in points), default=0.0)
    if direct is not None:
        # Where both ways lead to one motion, the shorter one is told.
        same = [k for k, one in enumerate(found) if _alike(direct.refined, one.refined)]
        if same:
            found[same[0]] = direct
        else:
            found.append(attrs.evolve(direct, fold=fold))
    if not found:
        try:
            found = [found_by(_grown(problem, q, tangent, tolerance), highest, "from rest")]
        except ConvergenceError:
            if lost is not None:
                raise lost from None
    if fold is not None and problem.system.scalars[CAGE] == 0.0 and all(one.fate.verdict == "unstable" for one in found):
        reached = _by_detours(problem, q, tangent, tolerance, highest, fold)
        found += [one for one in reached if not any(_alike(one.refined, known.refined) for known in found)]
    if not found:
        turns_back = any(p.folded for p in points)
        why = (
            "where its branch turns back (an internal resonance)" if turns_back else "beyond which it could not be followed"
        )
        raise ConvergenceError(
            f"no motion of the period of the force was found: the one that grows out of rest ends at {100 * (fold or 0.0):.3g} % "
            f"of the force, {why}, and none leads here from other speeds. A transient integrator with start = 'ramp' shows "
            "what the ring does instead.",
            {"q": q.copy(), "points": points},
        )
    first, *others = taken(found)
    return attrs.evolve(first, others=tuple(others))


def taken(found: list[Found]) -> list[Found]:
    """The same motions, that one first which is taken: the first that is not unstable, else the one that is left slowest."""
    slowest = min(found, key=lambda one: one.fate.largest)
    first = next((one for one in found if one.fate.verdict != "unstable"), slowest)
    return [first, *(one for one in found if one is not first)]


def _followed(
    problem: Problem, q: np.ndarray, tangent: np.ndarray, nodes: np.ndarray
) -> tuple[list[Point], ConvergenceError | None]:
    """The branch from rest, beyond the whole force for its folds and round to the force's opposite; why it has no point."""
    try:
        return from_rest(problem, q, tangent, nodes, _BEYOND, -1.0, _SMALL_POINTS), None
    except ConvergenceError as why:
        return [], why


def _at_whole_force(problem: Problem, points: list[Point], tolerance: float) -> Iterator[Refined]:
    """Where a branch over the share of the force meets the whole force, or its opposite: that is the force half a turn later."""
    opposite = _reverses(problem) and problem.system.scalars[CAGE] == 0.0
    for one, two in pairwise(points):
        for wanted in (1.0, -1.0):
            if (one.parameter - wanted) * (two.parameter - wanted) > 0.0 or (wanted < 0.0 and not opposite):
                continue
            try:
                if wanted > 0.0:
                    yield _from_branch(problem, [one, two], wanted, tolerance)
                else:
                    path = _towards([one, two], wanted)
                    later = half_a_turn_later(attrs.evolve(two.solved, path=path), problem)
                    yield refine(solve(problem, later, 1e-2 * tolerance), tolerance)
            except ConvergenceError:
                continue


def _reverses(problem: Problem) -> bool:
    """Whether the force half a turn later is its opposite."""
    angles = np.array([0.1, 0.9, 2.3])
    now, later = np.empty((3, 5)), np.empty((3, 5))
    system = problem.system
    forces(system.force, system.force_params, angles / problem.clock, now)
    forces(system.force, system.force_params, (angles + np.pi) / problem.clock, later)
    return bool(np.abs(now + later).max() <= 1e-9 * np.abs(now).max())


def _alike(one: Refined, two: Refined) -> bool:
    """Whether two motions of one problem are the same."""
    pair = [states(found.solved, _COMPARED)[0] / found.solved.problem.weight for found in (one, two)]
    return bool(np.abs(pair[0] - pair[1]).max() <= _SAME * max(one.solved.size, two.solved.size))


def _by_detours(
    problem: Problem, q: np.ndarray, tangent: np.ndarray, tolerance: float, highest: float, fold: float | None
) -> list[Found]:
    """The first motion that leads here from another speed."""
    for ratio in _DETOURS:
        try:
            refined = _detour(problem, q, tangent, tolerance, ratio)
        except ConvergenceError:
            continue
        return [found_by(refined, highest, "from a higher speed" if ratio > 1.0 else "from a lower speed", fold)]
    return []


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
    return refine(solve(problem, _towards(points, wanted), 1e-2 * tolerance), tolerance)


def _towards(points: list[Point], wanted: float) -> Path:
    """The path at one parameter between the last two points, or of the last one where their meshes differ."""
    one, two = points[-2:]
    path = two.solved.path
    if one.solved.path.intervals == path.intervals and np.array_equal(one.solved.path.nodes, path.nodes):
        part = (wanted - one.parameter) / (two.parameter - one.parameter)
        path = _between(one.solved.path, path, part)
    return path


def _between(one: Path, two: Path, part: float) -> Path:
    names = ("q", "v", "a", "ball", "rate")
    return attrs.evolve(two, **{x: (1.0 - part) * getattr(one, x) + part * getattr(two, x) for x in names})


def _detour(problem: Problem, q: np.ndarray, tangent: np.ndarray, tolerance: float, ratio: float) -> Refined:
    """From the motion at another speed of the force, the bodies' own speed unchanged."""
    wanted = problem.speed

    def at(speed: float) -> Problem:
        return attrs.evolve(problem, speed=speed, clock=wanted)

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


def from_rest(
    problem: Problem,
    q: np.ndarray,
    tangent: np.ndarray,
    nodes: np.ndarray,
    most: float = 1.0,
    least: float = -0.01,
    small_points: int = _POINTS,
) -> list[Point]:
    """The branch from the resting ring until the force's share leaves ``least`` to ``most``, or to where it is lost.

    Parameters
    ----------
    small_points : points in a row of next to no force that end it, too: there it has become a free vibration
    """
    _, lines = response(problem, tangent)
    length = max(float(np.abs(lines / problem.weight).max(initial=0.0)), 1e-12)
    branch = Branch(lambda share: attrs.evolve(problem, share=share), 1.0, length, _ROUGH, _MOST)
    still = attrs.evolve(problem, share=0.0)
    n, none = len(problem.free), np.empty((0, 0))
    rest = Solved(still, standing(still, q, nodes), none, none, np.zeros((2 * n, 2 * n + 2)), 0.0, True, 0, 0.0)
    small = 0

    def ended(p: Point) -> bool:
        nonlocal small
        small = small + 1 if p.solved.size > length and abs(p.parameter) < _SMALL_SHARE else 0
        return p.parameter >= most or p.parameter < least or small >= small_points

    try:
        return branch.follow(branch.start(rest, 0.0), 0.1, ended, _POINTS, 2.0)
    except ConvergenceError as why:
        if "points" not in why.state:
            raise
        return list(why.state["points"])
