"""The periodic motions of a system near a first guess: the linear response, or a neighbour."""

from math import ceil
from typing import ClassVar

import attrs
import numpy as np

from raceway.core.periodic.collocation import Path, Problem, Solved, solve, stiff
from raceway.core.periodic.floquet import Floquet, floquet
from raceway.core.periodic.intervals import forces
from raceway.core.periodic.refinement import Refined, motion_at, refine
from raceway.core.periodic.turn import one_pitch, one_turn
from raceway.core.ring.orbit import at_time
from raceway.core.ring.system import System

#: Samples a turn of the force: enough for eight harmonics.
_SAMPLES = 32


def response(problem: Problem, tangent: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Orders k (m,) of the force and the linear response's complex lines (m, 5): Re(x e^{j k theta}).

    tangent : (5, 5) stiffness of the contacts at the equilibrium
    """
    system, w, free = problem.system, problem.speed, problem.free
    times = 2.0 * np.pi / problem.clock / _SAMPLES * np.arange(_SAMPLES)
    force = np.empty((_SAMPLES, 5))
    forces(system.force, system.force_params, times, force)
    lines = np.fft.rfft(problem.share * force[:, free], axis=0)[: _SAMPLES // 4 + 1] / _SAMPLES
    lines[1:] *= 2.0
    orders = np.flatnonzero(np.abs(lines).max(axis=1) > 1e-9 * np.abs(lines).max(initial=0.0))
    part = np.ix_(free, free)
    mass, damping, stiffness = system.mass[part], system.damping[part], (tangent + system.stiffness)[part]
    amplitudes = np.zeros((len(orders), 5), dtype=complex)
    for row, k in enumerate(orders):
        amplitudes[row, free] = np.linalg.solve(stiffness - (k * w) ** 2 * mass + 1j * k * w * damping, lines[k])
    return orders, amplitudes


def guess(problem: Problem, q: np.ndarray, tangent: np.ndarray, nodes: np.ndarray) -> Path:
    """Linear response about an equilibrium q (5,), on a mesh."""
    orders, lines = response(problem, tangent)

    def at(angles: np.ndarray, derivative: int) -> np.ndarray:
        waves = np.exp(1j * angles[:, None] * orders) * (1j * orders) ** derivative
        return (waves @ lines).real

    return standing(problem, q, nodes, at(nodes, 0), at(nodes, 1), at(problem.angles(nodes), 2))


def standing(
    problem: Problem,
    q: np.ndarray,
    nodes: np.ndarray,
    dq: np.ndarray | float = 0.0,
    v: np.ndarray | float = 0.0,
    a: np.ndarray | float = 0.0,
) -> Path:
    """The equilibrium q (5,) for all times, with a motion about it."""
    m, s, z = len(nodes) - 1, len(problem.rule.points), problem.system.ball_count
    shape = (m * s, z, problem.system.ball_columns)
    zero = np.zeros((m + 1, 5))
    return Path(nodes, zero + q + dq, zero + v, np.zeros((m * s, 5)) + a, np.zeros(shape), np.zeros(shape))


#: Intervals a turn at least, and for each order of the highest natural frequency.
_INTERVALS, _PER_ORDER = 24, 1.5
#: Highest order that meshes are made for: the part of a solution that vibrates faster grows over each interval, a thousand
#: radians of it beyond all numbers, so that slow motions look singular.
HIGHEST = 2000.0
#: Sweeps of an iteration with full steps only.
_LIMIT = 12
#: Intervals of meshes that branches are followed on.
MOST = 512
#: Relative error of motions on the way.
ROUGH = 1e-4


def problem_of(system: System, speed: float, q: np.ndarray, symmetric: bool = True) -> Problem:
    """The boundary-value problem of one pitch where forces and bodies allow it, else of one turn.

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


#: Nonlinear part over the motion's size, up to which a neighbour is followed.  A Duffing oscillator has one motion only as
#: long as its amplitude stays within a third of the linear one (with some damping); far below that nothing can fold.
MOST_NONLINEAR = 0.1


@attrs.frozen(eq=False)
class Neighbour:
    """A solved motion, to be followed.

    problem : that it solves
    excess : motion less its linear response about the equilibrium; balls and rates as they are
    share : largest derivative of the excess over that of the motion

    The linear response of the new problem about its own equilibrium, plus the nonlinear part of its neighbour's motion, is
    where Newton's iteration begins. Where that part is large, several motions may exist under one force, and a neighbour
    could lead to another one than the search from rest: it is left alone then, and so is what it led to when that is far
    from linear; unless the neighbour's own continuation is asked for.
    """

    problem: Problem
    excess: Path
    share: float

    def first_guess(self, problem: Problem, q: np.ndarray, tangent: np.ndarray, nodes: np.ndarray) -> Path | None:
        """First guess for Newton's iteration on a mesh; None where this motion is none of the problem's unknowns.

        q : (5,) static equilibrium of ``problem``;  tangent : (5, 5) of its contacts
        """
        if not self._alike(problem):
            return None
        first = guess(problem, q, tangent, nodes)
        dq, dv, _, _, _ = motion_at(self.problem, self.excess, nodes)
        _, _, da, ball, rate = motion_at(self.problem, self.excess, problem.angles(nodes))
        return Path(nodes, first.q + dq, first.v + dv, first.a + da, np.ascontiguousarray(ball), np.ascontiguousarray(rate))

    @property
    def near_linear(self) -> bool:
        """Whether the motion is so close to its linear response that no other one is near."""
        return self.share <= MOST_NONLINEAR

    def solves(self, problem: Problem) -> bool:
        """Whether this is a motion of the problem itself."""
        mine, theirs = self.problem.system, problem.system
        names = ("scalars", "table", "law_params", "load", "force_params", "stiffness", "damping", "mass")
        kernels = mine.kernel is theirs.kernel and mine.law is theirs.law and mine.force is theirs.force
        same = kernels and self.problem.speed == problem.speed and self._alike(problem)
        return same and all(np.array_equal(getattr(mine, name), getattr(theirs, name)) for name in names)

    def _alike(self, problem: Problem) -> bool:
        mine, theirs = self.problem, problem
        same = (mine.system.ball_count, mine.system.ball_columns) == (theirs.system.ball_count, theirs.system.ball_columns)
        return same and mine.symmetry.span == theirs.symmetry.span and np.array_equal(mine.free, theirs.free)


@attrs.frozen(eq=False)
class Recorded:
    """A turn of a motion that was integrated, to be followed to the periodic one that it converges to.

    period : [s];  displacement, velocity, acceleration : (n, 5) at equidistant times from 0 on
    """

    period: float
    displacement: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray

    near_linear: ClassVar[bool] = False

    def first_guess(self, problem: Problem, q: np.ndarray, tangent: np.ndarray, nodes: np.ndarray) -> Path:
        """The same motion on a mesh; parameters as of ``Neighbour``'s."""
        times, inner, w = nodes / problem.speed, problem.angles(nodes) / problem.speed, problem.speed
        q, v = (at_time(values, self.period, times) for values in (self.displacement, self.velocity))
        path, a = standing(problem, q[0], nodes), at_time(self.acceleration, self.period, inner)
        return attrs.evolve(path, **{x: np.ascontiguousarray(y) for x, y in (("q", q), ("v", v / w), ("a", a / w**2))})


def neighbour_of(solved: Solved, q: np.ndarray, tangent: np.ndarray) -> Neighbour:
    """A solved motion, for other problems to start from; ``q``, ``tangent`` as in ``first_guess``."""
    problem, path = solved.problem, solved.path
    first = guess(problem, q, tangent, path.nodes)
    excess = attrs.evolve(path, q=path.q - first.q, v=path.v - first.v, a=path.a - first.a)
    share = float(np.abs(excess.v / problem.weight).max()) / max(solved.size, 1e-300)
    return Neighbour(problem, excess, share)


@attrs.frozen(eq=False)
class PeriodicMotion:
    """A periodic motion.

    refined : the motion with its error
    highest : order of the highest natural frequency at the equilibrium
    how : "directly", "from rest" (the force grows), "from a higher speed", "from a lower speed", "from a heavier axial load", "from no
        damping" or "by Fourier collocation"
    floquet : its multipliers
    fold : share of the force at which the branch from rest turns back for good; None where it leads to the full force
    coexisting : further motions under the same force that were met in the search
    """

    refined: Refined
    highest: float
    how: str
    floquet: Floquet
    fold: float | None = None
    coexisting: "tuple[PeriodicMotion, ...]" = ()
    _neighbour: list[Neighbour] = attrs.field(factory=list, init=False, repr=False)

    def neighbour(self, q: np.ndarray, tangent: np.ndarray) -> Neighbour:
        """What the motion lends to others, about the problem's equilibrium q (5,) with its tangent (5, 5); made once."""
        if not self._neighbour:
            self._neighbour.append(neighbour_of(self.refined.solved, q, tangent))
        return self._neighbour[0]

    @property
    def all(self) -> "tuple[PeriodicMotion, ...]":
        """This one first."""
        return (self, *self.coexisting)


def can_continue(problem: Problem, q: np.ndarray, tangent: np.ndarray) -> bool:
    """Whether branches are followed: meshes for the natural frequencies are small, and dashpots in the contacts weak."""
    nodes = mesh_of(problem, highest_order(problem, tangent))
    return len(nodes) <= MOST and not stiff(problem, standing(problem, q, nodes))


def with_multipliers(refined: Refined, highest: float, how: str, fold: float | None = None) -> PeriodicMotion:
    """A motion with its multipliers."""
    return PeriodicMotion(refined, highest, how, floquet(refined.solved, highest), fold)
