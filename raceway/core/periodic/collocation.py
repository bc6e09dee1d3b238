"""The periodic boundary-value problem on one mesh, and Newton's iteration for all its unknowns at once."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import attrs
import numpy as np

from raceway.core.periodic.intervals import (
    BALLS_FAILED,
    CORRECTION,
    REPORT,
    ROUNDING,
    SHORTENED,
    SINGULAR,
    SIZE,
    SOLVED,
    STALLED,
    SWEEPS,
    WORST_IMBALANCE,
    Closure,
    Eliminated,
    Equations,
    Limits,
    Mesh,
    Samples,
    forces,
    newton,
    renew_rates,
)
from raceway.core.ring.kernels.layout import CAGE, COSINE, LEVER, REST_RADIAL, SIDE, SINE
from raceway.core.ring.orbit import States, responses
from raceway.core.ring.system import System
from raceway.errors import ConvergenceError

#: Gauss points of an interval.
STAGES = 4
#: Places at which the motion's polynomial is tried against the balance of forces, besides the Gauss points.
_TRIED = (0.0, 0.19, 0.5, 0.81, 1.0)


@attrs.frozen(eq=False)
class _Rule:
    """Numbers of the rule with s stages.

    points : (s,) in (0, 1)
    velocity, position : (s, s) first and second integrals of the Lagrange polynomials up to each point
    packed : (2 s + 3, s) velocity, position, the same up to the end of the interval and points one below the other, for kernels
    tried : (e,) further points;  tried_values, tried_velocity, tried_position : (e, s) values there, and integrals up to them
    gain : (2, s + e) what the position and the velocity at the end take more of the values at all points than of those at the Gauss points
    legendre : (s, s) Legendre coefficients of values at the points

    On an interval of length h the acceleration is the polynomial through its values A_j at the Gauss points c_j; v(u) = v0 +
    h sum_j a_j(u) A_j, q(u) = q0 + u h v0 + h^2 sum_j aa_j(u) A_j with a_j, aa_j the first and second integral of the
    Lagrange polynomial l_j, u from 0 to 1. For s points the error at the ends of intervals is of order 2 s where the motion
    is smooth, between them of order s + 2.

    Source: de Boor, Swartz, SIAM J. Numer. Anal. 10 (1973), 582-606: collocation at Gaussian points.
    """

    points: np.ndarray
    velocity: np.ndarray
    position: np.ndarray
    packed: np.ndarray
    tried: np.ndarray
    tried_values: np.ndarray
    tried_velocity: np.ndarray
    tried_position: np.ndarray
    gain: np.ndarray
    legendre: np.ndarray


def integrals(points: np.ndarray, at: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Lagrange polynomials of points (s,) in [0, 1] at places (n,): values, first and second integrals from 0, (n, s) each."""
    s = len(points)
    powers = np.linalg.inv(np.vander(points, s, increasing=True))  # s <= 9 points: 1e-10 of rounding at worst
    k = np.arange(s)
    monomials = at[:, None] ** k
    once = monomials * at[:, None] / (k + 1)
    return monomials @ powers, once @ powers, (once * at[:, None] / (k + 2)) @ powers


@cache
def _rule(stages: int = STAGES) -> _Rule:
    """The rule with a number of Gauss points an interval."""
    x, _ = np.polynomial.legendre.leggauss(stages)
    points = 0.5 * (x + 1.0)
    _, velocity, position = integrals(points, points)
    _, v_end, q_end = integrals(points, np.ones(1))
    trial_points = np.array(_TRIED)
    _, v_all, q_all = integrals(np.concatenate([points, trial_points]), np.ones(1))
    gain = np.vstack([q_all, v_all])
    gain[:, :stages] -= np.vstack([q_end, v_end])
    legendre = np.linalg.inv(np.polynomial.legendre.legvander(x, stages - 1))
    both = np.ascontiguousarray(np.vstack([velocity, position, v_end, q_end, points]))
    return _Rule(points, velocity, position, both, trial_points, *integrals(points, trial_points), gain, legendre)


#: Largest difference that counts as rounding, over the largest force: ball solves end near 1e-12.
_SAME = 1e-9


@attrs.frozen(eq=False)
class Symmetry:
    """The motion repeats itself after ``span`` [rad of the force's angle], rotated.

    Attributes
    ----------
    rotation : (5, 5) P;  angle : by which P rotates about x [rad]
    order : (Z,) the ball that stood where each ball stands one span later
    pitch : whether the span is one ball pitch
    """

    span: float
    rotation: np.ndarray
    angle: float
    order: np.ndarray
    pitch: bool


def rotations(angles: np.ndarray) -> np.ndarray:
    """(n, 5, 5) x, y, z, tilt_y, tilt_z turned by angles (n,) about x."""
    c, s = np.cos(angles), np.sin(angles)
    out = np.zeros((len(c), 5, 5))
    out[:, 0, 0] = 1.0
    out[:, 1, 1] = out[:, 2, 2] = out[:, 3, 3] = out[:, 4, 4] = c
    out[:, 2, 1] = out[:, 4, 3] = s
    out[:, 1, 2] = out[:, 3, 4] = -s
    return out


def one_turn(system: System) -> Symmetry:
    """No symmetry: the motion repeats itself after a turn."""
    return Symmetry(2.0 * np.pi, np.eye(5), 0.0, np.arange(system.ball_count), False)


def one_pitch(system: System, speed: float, q: np.ndarray) -> Symmetry | None:
    """The symmetry of one ball pitch, or None where forces or bodies do not have it.

    Parameters
    ----------
    speed : of the force [rad/s];  q : (5,) equilibrium; bodies are tried some way off it

    Notes
    -----
    A force that turns with w over equal, equally spaced balls meets the same bearing again after it has passed one pitch:
    q(theta + Theta) = P q(theta), P the rotation by the angle that the force has turned meanwhile, ball k then standing
    where ball ``order[k]`` stood. With balls at rest Theta = 2 pi / Z; balls that travel with w_c are passed more slowly,
    Theta = (2 pi / Z) / |1 - w_c / w|, and a turn of the force is then no period at all. Whether forces and bodies are
    equivariant is tried on the system itself, so that nothing has to be known about laws and bodies.
    """
    table = system.table
    rows: dict[tuple[float, float], list[int]] = {}
    for k, row in enumerate(table[:, [SIDE, LEVER]].tolist()):
        rows.setdefault((row[0], row[1]), []).append(k)
    counts = {len(row) for row in rows.values()}
    count = counts.pop()
    # A load across the axis is no part of it whatever the balls are.
    if counts or count < 2 or np.any(system.load[1:] * system.free[1:]):
        return None
    direction = np.arctan2(table[:, SINE], table[:, COSINE])
    cage = system.scalars[CAGE] / speed
    for sense in (1.0, -1.0):
        if sense == cage:
            continue
        span = 2.0 * np.pi / count / abs(sense - cage)
        symmetry = Symmetry(span, rotations(np.array([sense * span]))[0], sense * span, np.arange(len(table)), True)
        # Whether the force one span later is the force now, turned.
        times = np.array([0.0, 0.37, 1.9]) / speed
        push = np.empty((6, 5))
        forces(system.force, system.force_params, np.concatenate([times, times + symmetry.span / speed]), push)
        push *= system.free
        if not bool(np.abs(push[3:] - push[:3] @ symmetry.rotation.T).max() <= _SAME * np.abs(push).max()):
            continue
        order = _order(direction, list(rows.values()), -np.sign(sense - cage) * 2.0 * np.pi / count)
        if order is None:
            return None
        symmetry = attrs.evolve(symmetry, order=order)
        return symmetry if _bodies_turn(system, symmetry, speed, q) else None
    return None


def _order(direction: np.ndarray, rows: list[list[int]], by: float) -> np.ndarray | None:
    """For every ball the one of its row that stands at an angle ``by`` from it; None where there is none."""
    order = np.empty(len(direction), dtype=int)
    for row in rows:
        off = direction[row][:, None] + by - direction[row][None, :]
        off = np.abs((off + np.pi) % (2.0 * np.pi) - np.pi)
        if off.min(axis=1).max() > 1e-9:
            return None
        order[row] = np.array(row)[off.argmin(axis=1)]
    return order


def _bodies_turn(system: System, symmetry: Symmetry, speed: float, q: np.ndarray) -> bool:
    """Whether mass, damping, shaft and contacts answer a turned motion with turned forces."""
    turn, free = symmetry.rotation, system.free
    linear = np.array([system.mass, system.damping, system.stiffness, np.diag(free)])
    apart = np.abs(turn @ linear - linear @ turn).max(axis=(1, 2))
    if (apart > 1e-12 * np.abs(linear).max(axis=(1, 2))).any():
        return False
    # Some way off the axis, in no special direction: a tenth of what the axial load presses the rings together.
    size = 0.1 * max(abs(q[0]), 1e-3 * abs(system.scalars[REST_RADIAL]), 1e-9)
    off = np.array([0.2, 1.0, 0.6, -0.4 / system.arm, 0.7 / system.arm]) * size * free
    state = q + off
    v = 0.3 * speed * off[[0, 2, 1, 4, 3]]
    z = system.ball_count
    ball = np.zeros((2, z, system.ball_columns))
    times = np.array([0.0, symmetry.span / speed])
    states = States(times, np.array([state, turn @ state]), np.array([v, turn @ v]), ball, np.zeros_like(ball))
    try:
        _, _, _, gap, load = responses(system, states)
    except ConvergenceError:
        return False
    # Forces, gaps and places of all balls are what the ring's force is made of.
    both = np.concatenate([symmetry.order, symmetry.order + z])
    pairs = ((ball[0], ball[1], symmetry.order), (gap[0], gap[1], both), (load[0], load[1], both))
    return all(np.abs(second - first[order]).max() <= _SAME * np.abs(first).max() for first, second, order in pairs)


@attrs.frozen(eq=False)
class Problem:
    """M q'' + C q' + K q + f = load + share * force(t) with q(theta + span) = P q(theta).

    Attributes
    ----------
    speed : of the force, w [rad/s]: a turn of theta is a turn of the force
    share : of the excitation that acts;  clock : speed that belongs to the excitation's own time, ``speed`` unless a branch
        is followed over speed while the bodies keep theirs
    free : (n,) numbers of the unknown coordinates
    weight : (5,) makes moments forces; lengths of tilts are tilts over it
    closing : (2 n, 2 n) rotation of an unknown state (q, v) by the span
    watch : called between the tries of a search, which what it raises ends
    """

    system: System
    speed: float
    symmetry: Symmetry
    share: float = 1.0
    clock: float = attrs.field()
    rule: _Rule = attrs.field(factory=_rule)
    watch: Callable[[], None] = lambda: None

    free: np.ndarray = attrs.field(init=False)
    weight: np.ndarray = attrs.field(init=False)
    closing: np.ndarray = attrs.field(init=False)

    @clock.default
    def _clock(self) -> float:
        return self.speed

    @free.default
    def _free(self) -> np.ndarray:
        return np.flatnonzero(self.system.free > 0.0)

    @weight.default
    def _weight(self) -> np.ndarray:
        arm = self.system.arm
        return np.array([1.0, 1.0, 1.0, 1.0 / arm, 1.0 / arm])

    @closing.default
    def _closing(self) -> np.ndarray:
        part = self.symmetry.rotation[np.ix_(self.free, self.free)]
        n = len(part)
        out = np.zeros((2 * n, 2 * n))
        out[:n, :n] = out[n:, n:] = part
        return out

    def angles(self, nodes: np.ndarray) -> np.ndarray:
        """(m s,) of the Gauss points."""
        return (nodes[:-1, None] + np.diff(nodes)[:, None] * self.rule.points).ravel()

    def force(self, angles: np.ndarray) -> np.ndarray:
        """The excitation at angles (n,): (n, 5)."""
        force = np.empty((len(angles), 5))
        forces(self.system.force, self.system.force_params, angles / self.clock, force)
        return force

    def push(self, nodes: np.ndarray) -> np.ndarray:
        """Load and excitation at the Gauss points (m s, 5)."""
        return self.system.load + self.share * self.force(self.angles(nodes))

    @property
    def equations(self) -> Equations:
        """What compiled parts need of it."""
        system = self.system
        return Equations(system.compiled_forces, system.linear, system.law_state, self.free, self.weight, self.speed)

    def mesh(self, nodes: np.ndarray) -> Mesh:
        """Nodes (m + 1,) with the rule inside the intervals."""
        return Mesh(nodes, self.rule.packed)

    def eliminated(self, nodes: np.ndarray) -> Eliminated:
        """Room for a linearisation on a mesh."""
        m, s, n = len(nodes) - 1, len(self.rule.points), len(self.free)
        return Eliminated(np.empty((m * s * n, 2 * n + 2)), np.empty((2 * m * n, 2 * n + 2)), np.empty((2 * n, 2 * n + 2)))


@attrs.frozen(eq=False)
class Path:
    """A motion over one span, its derivatives by the angle.

    Attributes
    ----------
    nodes : (m + 1,) angles, from 0 to the span;  q, v : (m + 1, 5) at nodes;  a : (m s, 5) at Gauss points
    ball, rate : (m s, Z, c) columns of ``System.evaluate`` and their rates [m/s]
    """

    nodes: np.ndarray
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    ball: np.ndarray
    rate: np.ndarray

    @property
    def intervals(self) -> int:
        return len(self.nodes) - 1

    def state(self, k: int, free: np.ndarray) -> np.ndarray:
        """(2 n,) of the unknown coordinates at a node."""
        return np.concatenate([self.q[k, free], self.v[k, free]])

    def states(self, rule: tuple[np.ndarray, np.ndarray, np.ndarray]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Angles (m, e), q and v (m, e, 5) at places (e,) in each interval with their integrals (e, s): of velocities and of positions."""
        at, once, twice = rule
        h, a = np.diff(self.nodes)[:, None], self.a.reshape(self.intervals, -1, 5)
        step = h[:, :, None]
        q = self.q[:-1, None] + at[:, None] * step * self.v[:-1, None] + step**2 * (twice @ a)
        return self.nodes[:-1, None] + h * at, q, self.v[:-1, None] + step * (once @ a)

    def samples(self, push: np.ndarray, slope: np.ndarray | None = None) -> Samples:
        """For compiled parts, with outer forces ``push`` (m s, 5) and their derivative ``slope``; zeros for none."""
        by = np.zeros_like(push) if slope is None else slope
        return Samples(self.q, self.v, self.a, self.ball, self.rate, push, by)


#: Lag times the largest entry of D above which the rates are solved for: a fifth leaves seven sweeps for 1e-5.
_STIFF = 0.02
#: Step of the differences [m/s] over the velocity of the motion.
_STEP = 0.1


def stiff(problem: Problem, path: Path) -> bool:
    """Whether putting rates in does not converge: balls lag about as long as the ring's damping is over its stiffness."""
    # One state tells how much dashpots do: balls that are closed anywhere are closed at most times.
    now, weight = problem.system.evaluate(path.q[0], path.v[0] * problem.speed), problem.weight**2
    damping = float(np.abs(np.diag(now.damping) * weight).max())
    lag = damping / max(float(np.abs(np.diag(now.stiffness) * weight).max()), 1e-300)
    h = float(np.diff(path.nodes).min())
    return bool(lag * problem.speed * _steepest(problem.rule) / h > _STIFF)


def renew(problem: Problem, path: Path, solved: bool) -> None:
    """Put the rates that belong to the places of the balls into ``path.rate``.

    Parameters
    ----------
    solved : one step of Newton's iteration instead of plain substitution

    Notes
    -----
    A ball has no mass along its groove: its place b follows from the ring's motion and, where contacts have dashpots, from
    its own rate r. So r = D b(r), D the derivative over one span and round its end. Dashpots are weak as a rule (1e-11 s of
    lag behind the motion with the default), and putting the last rates in converges at once: the compiled iteration does so
    after every sweep. Where lag times the largest entry of D is no longer small that diverges, in the finest modes of the
    mesh first, and Newton's iteration takes over: (I - D T) dr = D b - r with T = db/dr of each ball, by differences.
    """
    rate_columns = problem.system.rated_columns
    columns = np.array(problem.system.rated_columns)
    closure, path_rate = Closure(problem.closing, problem.symmetry.order, columns), path.rate.copy()
    renew_rates(problem.mesh(path.nodes), closure, problem.speed, path.ball, path_rate)
    rates = path_rate[:, :, columns]
    if solved:
        old = path.rate[:, :, rate_columns]
        rates = old + _solve_places(problem, path, rates - old)
    path.rate[:, :, rate_columns] = rates


@cache
def _steepest(rule: _Rule) -> float:
    """Largest entry of the derivative on an interval of length 1 among equals."""
    return float(np.abs(_weights(rule, np.array([0.0, 1.0]))).max())


def _weights(rule: _Rule, nodes: np.ndarray) -> np.ndarray:
    """D (m s, s + 4) by the angle: row i has the weights of samples k s - 2 to k s + s + 1, k the interval of sample i."""
    s, h = len(rule.points), np.diff(nodes)[:, None]
    x = np.hstack([np.roll(h, 1) * (rule.points[-2:] - 1.0), h * rule.points, h + np.roll(h, -1) * rule.points[:2]]) / h
    # The derivative of the polynomial through them, in barycentric form.
    apart, own = x[:, :, None] - x[:, None, :], np.arange(s + 4)
    apart[:, own, own] = 1.0
    w = 1.0 / apart.prod(axis=2)
    derivative = w[:, None, :] / w[:, :, None] / apart
    derivative[:, own, own] = 0.0
    derivative[:, own, own] = -derivative.sum(axis=2)
    return (derivative[:, 2:-2] / h[:, :, None]).reshape(-1, s + 4)


def _place_step(problem: Problem, path: Path) -> float:
    return _STEP * max(float(np.abs(path.v / problem.weight).max()), 1e-9) * problem.speed


def _places(problem: Problem, path: Path, coordinates: list[list[int]]) -> list[np.ndarray]:
    """Columns (m s, Z, r) of the balls at the Gauss points, for each set of columns with the rates of that set moved."""
    system, rule = problem.system, problem.rule
    angles, q, v = path.states((rule.points, rule.velocity, rule.position))
    places = []
    for columns in coordinates:
        ball, rate = path.ball.copy(), path.rate.copy()
        rate[:, :, columns] += _place_step(problem, path)
        at = States(angles.ravel() / problem.speed, q.reshape(-1, 5), v.reshape(-1, 5) * problem.speed, ball, rate)
        responses(system, at)
        places.append(ball[:, :, system.rated_columns])
    return places


def _solve_places(problem: Problem, path: Path, residual: np.ndarray) -> np.ndarray:
    """(I - D T)^-1 of a residual (m s, Z, r), all balls of a span together: one goes on where another one ends."""
    from scipy.sparse import bsr_array, eye_array
    from scipy.sparse.linalg import splu

    n, z, r = residual.shape
    s, order = len(problem.rule.points), problem.symmetry.order
    # T (m s, Z, r, r) [s]: places by rates.
    columns: list[list[int]] = [[c] for c in problem.system.rated_columns]
    here, *others = _places(problem, path, [[], *columns])
    lags, weights = (
        np.stack([(balls - here) / _place_step(problem, path) for balls in others], axis=-1),
        problem.speed * _weights(problem.rule, path.nodes),
    )
    back = np.argsort(order)
    ball, sample = np.meshgrid(np.arange(z), np.arange(n), indexing="ij")
    at = sample[:, :, None] // s * s + np.arange(s + 4) - 2
    whose = np.where(at < 0, back[ball][:, :, None], np.where(at >= n, order[ball][:, :, None], ball[:, :, None]))
    at %= n
    blocks = -weights[None, :, :, None, None] * lags[at, whose]
    row = np.arange(z * n + 1) * (s + 4)
    matrix = bsr_array((blocks.reshape(-1, r, r), (whose * n + at).ravel(), row), shape=(z * n * r, z * n * r))
    solution = splu((matrix + eye_array(z * n * r)).tocsc()).solve(residual.swapaxes(0, 1).ravel())
    return solution.reshape(z, n, r).swapaxes(0, 1)


#: Turns of motion and rates, and the change over the motion's size that rounding may leave.
_RATES, _LEFT = 20, 1e-9


@attrs.frozen(eq=False)
class Solved:
    """A periodic motion on one mesh.

    Attributes
    ----------
    eliminated : the last linearisation
    size : largest derivative by the angle [m], the amplitude of a 1x motion; tilts as lengths at the arm
    direct : whether full steps of Newton's iteration sufficed
    sweeps : of all intervals that it took;  correction : the last one [m]
    """

    problem: Problem
    path: Path
    eliminated: Eliminated
    size: float
    direct: bool
    sweeps: int
    correction: float

    @property
    def rounding(self) -> float:
        """What rounding leaves of error, over the motion's size: of displacements, or of forces where the last correction is that.

        Much of a motion of picometres.
        """
        displacement = ROUNDING * float(np.abs(self.path.q / self.problem.weight).max())
        return max(displacement, self.correction) / max(self.size, 1e-300)


def gap(problem: Problem, path: Path) -> np.ndarray:
    """Gap between the end of a path (2 n,) and the rotated state of its beginning: y_m - P y_0 of the unknown states."""
    return np.asarray(path.state(-1, problem.free) - problem.closing @ path.state(0, problem.free))


def solve(problem: Problem, path: Path, tolerance: float, patience: int = 12, limit: int = 40) -> Solved:
    """Newton's iteration from a first guess.

    Parameters
    ----------
    tolerance : largest last correction over the motion's size
    patience : halvings of a step that may follow each other

    Notes
    -----
    Where dashpots make the balls lag, the motion with given rates and the rates of that motion are found in turn.

    Raises
    ------
    ConvergenceError
        With the state at the start of the span that the iteration ended at, finite or the first guess.
    """
    if not stiff(problem, path):
        return newton_iteration(problem, path, tolerance, patience, limit, np.array(problem.system.rated_columns))
    sweeps, change = 0, np.inf
    for turn in range(_RATES):
        solution = newton_iteration(problem, path, tolerance, patience, limit, np.empty(0, dtype=np.int64))
        sweeps += solution.sweeps
        last, change = change, float(np.abs((solution.path.q - path.q) / problem.weight).max())
        path = solution.path
        enough = 10.0 * max(tolerance, solution.rounding) * solution.size
        if turn > 0 and (change <= enough or (change >= last and change <= _LEFT * solution.size)):
            return attrs.evolve(solution, sweeps=sweeps)
        problem.watch()
        renew(problem, path, True)
    raise ConvergenceError(
        f"no periodic motion found near the first guess: the rates of the balls change it by {change:.2g} m still: too "
        "strong dashpots in the contacts",
        {"q": path.q[0].copy()},
    )


def linearised(problem: Problem, path: Path) -> Eliminated:
    """About a path, whose arrays a step of Newton's method moves then."""
    elimination, closure = (
        problem.eliminated(path.nodes),
        Closure(problem.closing, problem.symmetry.order, np.empty(0, dtype=np.int64)),
    )
    samples, once = path.samples(problem.push(path.nodes)), Limits(0.0, 0.0, 1, 0)
    status = newton(problem.equations, closure, problem.mesh(path.nodes), samples, once, elimination, np.zeros(REPORT))
    if status == BALLS_FAILED:
        raise ConvergenceError("the balls have no equilibrium between the races", {"q": path.q[0].copy()})
    return elimination


def newton_iteration(
    problem: Problem, path: Path, tolerance: float, patience: int, limit: int, rate_columns: np.ndarray
) -> Solved:
    """The compiled iteration; ``rate_columns``: columns of the balls whose rates are put in after every sweep."""
    elimination, report = problem.eliminated(path.nodes), np.zeros(REPORT)
    q, v, a, ball, rate = path.q.copy(), path.v.copy(), path.a.copy(), path.ball.copy(), path.rate.copy()
    solution = attrs.evolve(path, q=q, v=v, a=a, ball=ball, rate=rate)
    closure = Closure(problem.closing, problem.symmetry.order, rate_columns)
    limits = Limits(tolerance, problem.system.force_rounding(path.q[0]), limit, patience)
    samples = solution.samples(problem.push(path.nodes))
    status = newton(problem.equations, closure, problem.mesh(path.nodes), samples, limits, elimination, report)
    if status != SOLVED:
        why = {STALLED: "the iteration stalls", SINGULAR: "the motion is singular"}.get(
            status, "the balls have no equilibrium between the races"
        )
        raise ConvergenceError(
            f"no periodic motion found near the first guess: {why} after {int(report[SWEEPS])} iterations, imbalance "
            f"{report[WORST_IMBALANCE]:.2g} N",
            {"q": q[0] if np.isfinite(q[0]).all() else path.q[0].copy()},
        )
    return Solved(
        problem,
        solution,
        elimination,
        float(report[SIZE]),
        report[SHORTENED] == 0.0,
        int(report[SWEEPS]),
        float(report[CORRECTION]),
    )
