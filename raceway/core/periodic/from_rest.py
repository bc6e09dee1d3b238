"""The branch of periodic motions that grows out of the resting ring with the force, and where it meets the whole force."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import islice, pairwise

import attrs
import numpy as np

from raceway.core.periodic.arrays import Eliminated
from raceway.core.periodic.branch import Branch, Point, towards
from raceway.core.periodic.collocation import Solved, solve
from raceway.core.periodic.direct import MOST, ROUGH
from raceway.core.periodic.first_guess import response, standing
from raceway.core.periodic.problem import Path, Problem
from raceway.core.periodic.refinement import Refined, refine
from raceway.core.periodic.sampling import half_a_turn_later
from raceway.core.periodic.sweep import forces
from raceway.core.ring.kernels.layout import CAGE
from raceway.errors import ConvergenceError

#: Points of a branch.
POINTS = 120
#: Share of the force up to which the branch from rest is followed for its folds: a Duffing oscillator whose motion differs
#: by a tenth from its linear response (``neighbour.MOST_NONLINEAR``) folds at 1.35 times the force, the internal resonances
#: of the article's scene with tilt free at 1.6 and 1.8 times.
_BEYOND = 2.0
#: A branch that stays below this share of the force for so many points has become a free vibration: it is left there.
_SMALL_SHARE, _SMALL_POINTS = 0.2, 10


@attrs.frozen(eq=False)
class Trail:
    """Points of a branch over the share of the force.

    Attributes
    ----------
    largest : share of the force;  reaches : the whole force
    folds : whether it turns back anywhere
    crossings : neighbouring points on either side of the whole force or its opposite, in the order of the branch
    """

    largest: float = 0.0
    folds: bool = False
    crossings: tuple[tuple[Point, Point], ...] = ()

    @property
    def reaches(self) -> bool:
        return self.largest >= 1.0

    @classmethod
    def of(cls, points: Iterable[Point]) -> Trail:
        """Of points that come one by one."""
        largest, folds, crossings = 0.0, False, []
        for one, two in pairwise(points):
            largest, folds = max(largest, one.parameter, two.parameter), folds or two.folded
            if any((one.parameter - whole) * (two.parameter - whole) <= 0.0 for whole in (1.0, -1.0)):
                crossings.append((one, two))
        return cls(largest, folds, tuple(crossings))


def trail(problem: Problem, q: np.ndarray, tangent: np.ndarray, nodes: np.ndarray) -> Trail:
    """The branch from rest, beyond the whole force for its folds and round to the force's opposite.

    Raises
    ------
    ConvergenceError
        It has no first point.
    """
    return Trail.of(from_rest(problem, q, tangent, nodes, _BEYOND, -1.0, _SMALL_POINTS))


def from_rest(
    problem: Problem,
    q: np.ndarray,
    tangent: np.ndarray,
    nodes: np.ndarray,
    most: float = 1.0,
    least: float = -0.01,
    small_points: int = POINTS,
) -> Iterator[Point]:
    """Points from the resting ring on until the force's share leaves ``least`` to ``most``, or to where the branch is lost.

    Parameters
    ----------
    small_points : points in a row of next to no force that end it, too: there it has become a free vibration

    Raises
    ------
    ConvergenceError
        There is no first point.
    """
    _, lines = response(problem, tangent)
    length = max(float(np.abs(lines / problem.weight).max(initial=0.0)), 1e-12)

    def slope(at: Problem, path: Path) -> np.ndarray:
        return -problem.share * at.force(path.nodes)

    branch = Branch(lambda share: attrs.evolve(problem, share=share * problem.share), 1.0, length, ROUGH, MOST, slope)
    still = attrs.evolve(problem, share=0.0)
    n, none = len(problem.free), np.empty((0, 0))
    linear = Eliminated(none, none, np.zeros((2 * n, 2 * n + 2)))
    rest = Solved(still, standing(still, q, nodes), linear, 0.0, True, 0, 0.0)
    first, small = branch.start(rest, 0.0), 0
    try:
        for point in islice(branch.follow(first, 0.1, 2.0), POINTS):
            yield point
            small = small + 1 if point.solved.size > length and abs(point.parameter) < _SMALL_SHARE else 0
            if point.parameter >= most or point.parameter < least or small >= small_points:
                return
    except ConvergenceError:  # lost: what it led to stands
        return


def at_whole_force(problem: Problem, crossings: Iterable[tuple[Point, Point]], tolerance: float) -> Iterator[Refined]:
    """Where a branch over the share of the force meets the whole force, or its opposite: that is the force half a turn later."""
    opposite = _reverses(problem) and problem.system.scalars[CAGE] == 0.0
    for one, two in crossings:
        for wanted in (1.0, -1.0):
            if (one.parameter - wanted) * (two.parameter - wanted) > 0.0 or (wanted < 0.0 and not opposite):
                continue
            path = towards(one, two, wanted)
            try:
                if wanted < 0.0:
                    path = half_a_turn_later(attrs.evolve(two.solved, path=path), problem)
                yield refine(solve(problem, path, 1e-2 * tolerance), tolerance)
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
