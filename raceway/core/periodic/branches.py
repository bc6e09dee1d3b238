"""Motions on branches: on which the force grows from rest, or the speed or the load changes; where none is alone or found directly."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from functools import partial
from itertools import islice, pairwise

import attrs
import numpy as np

from raceway.core.periodic import search
from raceway.core.periodic.branch import Branch, Point
from raceway.core.periodic.collocation import Path, Problem, Solved, solve
from raceway.core.periodic.intervals import Eliminated, forces
from raceway.core.periodic.refinement import Refined, displacements, refine, states
from raceway.core.periodic.search import PeriodicMotion
from raceway.core.ring.kernels.layout import CAGE, DAMPING, TIME_CONSTANT
from raceway.errors import ConvergenceError

#: First and least step of a growing force; on larger meshes the least is half the first.
_FIRST_SHARE, _LEAST_SHARE = 0.25, 0.02


def _towards(before: Point, after: Point, parameter: float) -> Path:
    """The path at one parameter between two points, or of the second one where their meshes differ."""
    path = after.solved.path
    if before.solved.path.intervals == path.intervals and np.array_equal(before.solved.path.nodes, path.nodes):
        part = (parameter - before.parameter) / (after.parameter - before.parameter)
        path = _between(before.solved.path, path, part)
    return path


def _between(first: Path, second: Path, part: float) -> Path:
    """The second path's part and the first one's rest; ``part`` > 1 goes on beyond the second."""
    names = ("q", "v", "a", "ball", "rate")
    return attrs.evolve(second, **{x: (1.0 - part) * getattr(first, x) + part * getattr(second, x) for x in names})


def _by_force_steps(problem: Problem, q: np.ndarray, tangent: np.ndarray, tolerance: float) -> Refined:
    """With the force growing step by step, each begun where the last two lead; twice the mesh of a direct solve."""
    nodes = search.mesh_of(problem, search.highest_order(problem, tangent), 2)

    def part(share: float) -> Problem:
        return attrs.evolve(problem, share=share * problem.share)

    share, step = 0.0, _FIRST_SHARE
    last, before, gap = search.standing(problem, q, nodes), None, 1.0
    while share < 1.0:
        problem.watch()
        step = min(step, 1.0 - share)
        here = part(share + step)
        first = search.guess(here, q, tangent, nodes) if before is None else _between(before, last, 1.0 + step / gap)
        try:
            solution = search.full_steps(here, first, search.ROUGH)
        except ConvergenceError:
            step *= 0.5
            # A large mesh makes small steps dear; none leads round a fold anyway.
            if step < (_LEAST_SHARE if len(nodes) <= search.MOST else 0.5 * _FIRST_SHARE):
                raise
            continue
        share, gap = share + step, step
        before, last = last, solution.path
        step *= 1.5 if solution.sweeps <= 5 else 1.0
    return refine(solve(problem, last, 1e-2 * tolerance), tolerance)


#: Points of a branch; those of one from rest, and its longest step; the error that meshes are made for, and their most intervals.
POINTS = 120
_FROM_REST, _LONGEST, _ERROR, _MOST = 60, 4.0, 1e-3, 96
#: Share of the force up to which the branch from rest is followed for its folds: a Duffing oscillator whose motion differs
#: by a tenth from its linear response (``neighbour.MOST_NONLINEAR``) folds at 1.35 times the force, the internal resonances
#: of the article's scene with tilt free at 1.6 and 1.8 times.
_BEYOND = 2.0
#: A branch that stays below this share of the force for so many points has become a free vibration: it is left there.
_SMALL_SHARE, _SMALL_POINTS = 0.2, 10


@attrs.define(eq=False)
class _ForceBranch:
    """What is known of a branch over the share of the force once its points are asked for.

    largest : share of the force;  folds : whether it turns back anywhere
    failure : why it has no first point
    """

    points: Iterator[Point]
    largest: float = 0.0
    folds: bool = False
    failure: ConvergenceError | None = None

    def crossings(self) -> Iterator[tuple[Point, Point]]:
        """Neighbouring points on either side of the full force or its opposite, in the order of the branch."""
        try:
            for before, after in pairwise(self.points):
                self.largest = max(self.largest, before.parameter, after.parameter)
                self.folds = self.folds or after.folded
                if any((before.parameter - share) * (after.parameter - share) <= 0.0 for share in (1.0, -1.0)):
                    yield before, after
        except ConvergenceError as why:
            self.failure = why


def _force_branch(problem: Problem, q: np.ndarray, tangent: np.ndarray, nodes: np.ndarray) -> _ForceBranch:
    """The branch from rest, beyond the full force for its folds and round to the force's opposite."""
    return _ForceBranch(force_continuation(problem, q, tangent, nodes, _BEYOND, -1.0, _SMALL_POINTS))


def force_continuation(
    problem: Problem,
    q: np.ndarray,
    tangent: np.ndarray,
    nodes: np.ndarray,
    most: float = 1.0,
    least: float = -0.01,
    small_points: int = POINTS,
) -> Iterator[Point]:
    """Points from the resting ring on until the force's share leaves ``least`` to ``most``, or to where the branch is lost.

    small_points : points in a row of next to no force that end it, too: there it has become a free vibration
    ConvergenceError: there is no first point.
    """
    _, lines = search.response(problem, tangent)
    length = max(float(np.abs(lines / problem.weight).max(initial=0.0)), 1e-12)

    def slope(at: Problem, path: Path) -> np.ndarray:
        return -problem.share * at.force(at.angles(path.nodes))

    branch = Branch(lambda share: attrs.evolve(problem, share=share * problem.share), 1.0, length, _ERROR, _MOST, slope)
    still = attrs.evolve(problem, share=0.0)
    n, none = len(problem.free), np.empty((0, 0))
    linear = Eliminated(none, none, np.zeros((2 * n, 2 * n + 2)))
    equilibrium = Solved(still, search.standing(still, q, nodes), linear, 0.0, True, 0, 0.0)
    first, small = branch.start(equilibrium, 0.0), 0
    try:
        for point in islice(branch.follow(first, 0.1, _LONGEST), _FROM_REST):
            yield point
            small = small + 1 if point.solved.size > length and abs(point.parameter) < _SMALL_SHARE else 0
            if point.parameter >= most or point.parameter < least or small >= small_points:
                return
    except ConvergenceError:  # lost: what it led to stands
        return


def _at_full_force(problem: Problem, crossings: Iterable[tuple[Point, Point]], tolerance: float) -> Iterator[Refined]:
    """Where a branch over the share of the force meets the whole force, or its opposite: that is the force half a turn later."""
    # Whether the force half a turn later is its opposite.
    angles = np.array([0.1, 0.9, 2.3])
    now, later = np.empty((3, 5)), np.empty((3, 5))
    system = problem.system
    forces(system.force, system.force_params, angles / problem.clock, now)
    forces(system.force, system.force_params, (angles + np.pi) / problem.clock, later)
    opposite = bool(np.abs(now + later).max() <= 1e-9 * np.abs(now).max()) and problem.system.scalars[CAGE] == 0.0
    for before, after in crossings:
        for share in (1.0, -1.0):
            if (before.parameter - share) * (after.parameter - share) > 0.0 or (share < 0.0 and not opposite):
                continue
            path = _towards(before, after, share)
            try:
                if share < 0.0:
                    # The motion on its own mesh as it is half a turn later, for a problem whose force is the opposite of its own.
                    solution = attrs.evolve(after.solved, path=path)
                    nodes = solution.path.nodes
                    q, v, _, _, _ = states(solution, nodes + np.pi)
                    _, _, a, ball, rate = states(solution, problem.angles(nodes) + np.pi)
                    path = Path(nodes, np.ascontiguousarray(q), np.ascontiguousarray(v), np.ascontiguousarray(a), ball, rate)
                yield refine(solve(problem, path, 1e-2 * tolerance), tolerance)
            except ConvergenceError:
                continue


#: Speeds, and axial loads, over the wanted one, that the motion is followed from.
_RATIOS, _LOADS = (1.15, 1.3, 1.6, 0.85, 0.7), (1.5, 2.5)
#: Speeds that are so near that a branch leads here through its folds, if at all.
_NEAR = (1.02, 1.05, 0.97)


def _by_homotopy(
    problem: Problem, q: np.ndarray, tangent: np.ndarray, tolerance: float, without_motion: bool
) -> tuple[Refined, str] | None:
    """The first motion that leads here from another speed or load, and from where; None where none does.

    q : (5,) static equilibrium;  tangent : (5, 5) of its contacts
    without_motion : no motion is known here, so that nearby branches are worth following through their folds
    """
    for ratio in (*(_NEAR if without_motion else ()), *_RATIOS):
        problem.watch()
        with suppress(ConvergenceError):
            candidate = _continued_to(  # the bodies' own speed and the force stay
                lambda part: attrs.evolve(problem, speed=part * problem.speed, clock=problem.speed, by_parameter=problem.speed),
                q, tangent, tolerance, ratio, without_motion and ratio in _NEAR,
            )  # fmt: skip
            return candidate, "from a higher speed" if ratio > 1.0 else "from a lower speed"
    if problem.system.load[0] == 0.0 or problem.system.free[0] == 0.0:
        return None
    for ratio in _LOADS:
        problem.watch()
        at = partial(_at_load, problem)
        with suppress(ConvergenceError):
            system = at(ratio).system
            q_loaded, ball, _ = system.solve_equilibrium(q)
            stiff = system.evaluate(q_loaded, ball=ball).stiffness
            return _continued_to(at, q_loaded, stiff, tolerance, ratio, False), "from a heavier axial load"
    return None


def _from_undamped(
    problem: Problem, q: np.ndarray, tangent: np.ndarray, nodes: np.ndarray, tolerance: float
) -> Iterator[Refined]:
    """Motions that the branch from rest leads to without damping, each continued to the damped ring; none of an undamped one.

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
        for motion in _at_full_force(still, _force_branch(still, q, tangent, nodes).crossings(), search.ROUGH):
            problem.watch()
            with suppress(ConvergenceError):
                yield refine(search.full_steps(problem, motion.solved.path, 1e-2 * tolerance), tolerance)


def _at_load(problem: Problem, ratio: float) -> Problem:
    load = problem.system.load.copy()
    load[0] *= ratio
    return attrs.evolve(problem, system=attrs.evolve(problem.system, load=load))


def _continued_to(
    at: Callable[[float], Problem], q: np.ndarray, tangent: np.ndarray, tolerance: float, ratio: float, through: bool
) -> Refined:
    """From the motion about an equilibrium at a ratio to that at 1; ``through`` folds, too.

    ConvergenceError: none leads there.
    """
    far, sense = at(ratio), float(np.sign(1.0 - ratio))
    try:
        begin = search.directly(far, q, tangent, search.ROUGH)
    except ConvergenceError:
        begin = _by_force_steps(far, q, tangent, search.ROUGH)
    branch = Branch(at, abs(ratio - 1.0), begin.solved.size, _ERROR, _MOST)
    for before, after in pairwise(islice(branch.follow(branch.start(begin.solved, ratio, sense), 0.1, 1.0), POINTS)):
        if (after.parameter - 1.0) * sense >= 0.0:
            return refine(solve(at(1.0), _towards(before, after, 1.0), 1e-2 * tolerance), tolerance)
        if (after.folded and not through) or (after.parameter - ratio) * sense < 0.0:
            break
    raise ConvergenceError("the branch turns back")


#: Distance of two motions over their size below which they are one.
_SAME = 1e-3
#: Angles at which motions are compared: no harmonic of a turn hides between them.
_COMPARED = 2.0 * np.pi * np.arange(17) / 17
#: What to do where no periodic motion is found.
_INSTEAD = "A transient integrator with start = 'ramp' shows the motion of the ring."


def grown_from_rest(problem: Problem, q: np.ndarray, tangent: np.ndarray, tolerance: float, highest: float) -> Refined:
    try:
        return _by_force_steps(problem, q, tangent, tolerance)
    except ConvergenceError as why:
        what = "no motion with the period of the force was found from rest; branches are not searched"
        cause = f"natural frequencies go up to {highest:.3g} times the force's, or dashpots are strong"
        raise ConvergenceError(f"{what}: {cause}. {_INSTEAD}", {"q": q.copy()}) from why


def chosen(
    problem: Problem,
    q: np.ndarray,
    tangent: np.ndarray,
    tolerance: float,
    direct: PeriodicMotion | None,
    alone: bool = False,
    stable: bool = True,
) -> PeriodicMotion:
    """The motion that is taken, of all that the branch from rest and Newton's iteration lead to.

    alone : no further ones are sought beside one that is not unstable
    stable : where all of these are unstable, those without damping, at other speeds and loads are followed, too
    """
    highest = search.highest_order(problem, tangent)
    branch = _force_branch(problem, q, tangent, search.mesh_of(problem, highest))
    motions: list[PeriodicMotion] = []
    for candidate in _at_full_force(problem, branch.crossings(), tolerance):
        if not any(_alike(candidate, motion.refined) for motion in motions):
            # Where both ways lead to one motion, the shorter one is told.
            same = direct is not None and _alike(direct.refined, candidate)
            motions.append(direct if direct and same else search.with_multipliers(candidate, highest, "from rest"))
            if alone and motions[-1].floquet.verdict != "unstable":
                break
    fold = None if branch.largest >= 1.0 else branch.largest
    if direct is not None and not any(motion is direct for motion in motions):
        motions.append(attrs.evolve(direct, fold=fold))
    if not motions:
        try:
            motions = [search.with_multipliers(_by_force_steps(problem, q, tangent, tolerance), highest, "from rest")]
        except ConvergenceError:
            if branch.failure is not None:
                raise branch.failure from None

    def wanted() -> bool:
        return (stable or not motions) and all(motion.floquet.verdict == "unstable" for motion in motions)

    if wanted():
        for candidate in _from_undamped(problem, q, tangent, search.mesh_of(problem, highest), tolerance):
            if not any(_alike(candidate, other_motion.refined) for other_motion in motions):
                motions.append(search.with_multipliers(candidate, highest, "from no damping", fold))
                if alone and motions[-1].floquet.verdict != "unstable":
                    break
    if fold is not None and problem.system.scalars[CAGE] == 0.0 and wanted():
        homotopy = _by_homotopy(problem, q, tangent, tolerance, not motions)
        if homotopy is not None and not any(_alike(homotopy[0], other_motion.refined) for other_motion in motions):
            motions.append(search.with_multipliers(homotopy[0], highest, homotopy[1], fold))
    if not motions:
        back = "where its branch turns back (an internal resonance)"
        end = back if branch.folds else "beyond which it could not be followed"
        ends = f"the branch from rest ends at {100 * (fold or 0.0):.3g} % of the force, {end}"
        why = f"{ends}, and no branch leads here from other speeds or a heavier load. {_INSTEAD}"
        raise ConvergenceError(f"no motion with the period of the force was found: {why}", {"q": q.copy()})
    # Taken is the first that is not unstable, else the one that is left slowest.
    slowest = min(motions, key=lambda motion: motion.floquet.largest)
    first = next((motion for motion in motions if motion.floquet.verdict != "unstable"), slowest)
    return attrs.evolve(first, coexisting=tuple(motion for motion in motions if motion is not first))


def _alike(first: Refined, second: Refined) -> bool:
    pair = [displacements(refined.solved, _COMPARED) / refined.solved.problem.weight for refined in (first, second)]
    return bool(np.abs(pair[0] - pair[1]).max() <= _SAME * max(first.solved.size, second.solved.size))
