"""The periodic boundary-value problem on one mesh, and Newton's iteration for all its unknowns at once."""

from collections.abc import Callable
from functools import cache

import attrs
import numpy as np

from raceway.core.periodic import newton
from raceway.core.periodic.intervals import Eliminated, Equations, Mesh, Samples, forces
from raceway.core.periodic.turn import GaussRule, Symmetry, gauss_rule
from raceway.core.ring.orbit import States, responses
from raceway.core.ring.system import System
from raceway.errors import ConvergenceError


@attrs.frozen(eq=False)
class Problem:
    """M q'' + C q' + K q + f = load + share * force(t) with q(theta + span) = P q(theta).

    speed : of the force, w [rad/s]: a turn of theta is a turn of the force
    share : of the excitation that acts;  clock : speed that belongs to the excitation's own time, ``speed`` unless a branch
        is followed over speed while the bodies keep theirs: then ``by_parameter`` is the derivative of ``speed``
    free : (n,) numbers of the unknown coordinates
    weight : (5,) makes moments forces; lengths of tilts are tilts over it
    closing : (2 n, 2 n) rotation of an unknown state (q, v) by the span
    watch : called between the tries of a search, which what it raises ends
    """

    system: System
    speed: float
    symmetry: Symmetry
    share: float = 1.0
    clock: float = attrs.field(default=attrs.Factory(lambda self: self.speed, takes_self=True))
    rule: GaussRule = attrs.field(factory=gauss_rule)
    by_parameter: float = 0.0
    watch: Callable[[], None] = lambda: None

    free: np.ndarray = attrs.field(init=False)
    weight: np.ndarray = attrs.field(init=False)
    closing: np.ndarray = attrs.field(init=False)

    @free.default
    def _free(self) -> np.ndarray:
        return np.flatnonzero(self.system.free > 0.0)

    @weight.default
    def _weight(self) -> np.ndarray:
        arm = self.system.arm
        return np.array([1.0, 1.0, 1.0, 1.0 / arm, 1.0 / arm])

    @closing.default
    def _closing(self) -> np.ndarray:
        part = self.symmetry.rotation[self.free[:, None], self.free]
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
        memory, by_parameter = system.law_state, self.by_parameter
        return Equations(system.compiled_forces, system.linear, memory, self.free, self.weight, self.speed, by_parameter)

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

    solved : one step of Newton's iteration instead of plain substitution

    A ball has no mass along its groove: its place b follows from the ring's motion and, where contacts have dashpots, from
    its own rate r. So r = D b(r), D the derivative over one span and round its end. Dashpots are weak as a rule (1e-11 s of
    lag behind the motion with the default), and putting the last rates in converges at once: the compiled iteration does so
    after every sweep. Where lag times the largest entry of D is no longer small that diverges, in the finest modes of the
    mesh first, and Newton's iteration takes over: (I - D T) dr = D b - r with T = db/dr of each ball, by differences.
    """
    columns = np.array(problem.system.rated_columns)
    closure = newton.Closure(problem.closing, problem.symmetry.order, columns)
    rate = path.rate.copy() if solved else path.rate
    newton.renew_rates(problem.mesh(path.nodes), closure, problem.speed, path.ball, rate)
    if solved:
        path.rate[:, :, columns] += _solve_places(problem, path, (rate - path.rate)[:, :, columns])


@cache
def _steepest(rule: GaussRule) -> float:
    """Largest entry of the derivative on an interval of length 1 among equals."""
    return float(np.abs(_weights(rule, np.array([0.0, 1.0]))).max())


def _weights(rule: GaussRule, nodes: np.ndarray) -> np.ndarray:
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


def _solve_places(problem: Problem, path: Path, residual: np.ndarray) -> np.ndarray:
    """(I - D T)^-1 of a residual (m s, Z, r), all balls of a span together: one goes on where another one ends."""
    from scipy.sparse import bsr_array, eye_array
    from scipy.sparse.linalg import splu

    n, z, r = residual.shape
    system, rule, order = problem.system, problem.rule, problem.symmetry.order
    step = _STEP * max(float(np.abs(path.v / problem.weight).max()), 1e-9) * problem.speed
    s, places = len(rule.points), []
    angles, q, v = path.states((rule.points, rule.velocity, rule.position))
    time, q, v = angles.ravel() / problem.speed, q.reshape(-1, 5), v.reshape(-1, 5) * problem.speed
    # Columns (m s, Z, r) of the balls at the Gauss points, as they are and with each rate moved.
    for columns in ([], *([c] for c in system.rated_columns)):
        ball, rate = path.ball.copy(), path.rate.copy()
        rate[:, :, columns] += step
        responses(system, States(time, q, v, ball, rate))
        places.append(ball[:, :, system.rated_columns])
    # T (m s, Z, r, r) [s]: places by rates.
    lags = np.stack([(balls - places[0]) / step for balls in places[1:]], axis=-1)
    weights = problem.speed * _weights(problem.rule, path.nodes)
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
        displacement = newton.ROUNDING * float(np.abs(self.path.q / self.problem.weight).max())
        return max(displacement, self.correction) / max(self.size, 1e-300)


def gap(problem: Problem, path: Path) -> np.ndarray:
    """Gap between the end of a path (2 n,) and the rotated state of its beginning: y_m - P y_0 of the unknown states."""
    return np.asarray(path.state(-1, problem.free) - problem.closing @ path.state(0, problem.free))


def solve(problem: Problem, path: Path, tolerance: float, patience: int = 12, limit: int = 40) -> Solved:
    """Newton's iteration from a first guess.

    tolerance : largest last correction over the motion's size
    patience : halvings of a step that may follow each other

    Where dashpots make the balls lag, the motion with given rates and the rates of that motion are found in turn.

    ConvergenceError: With the state at the start of the span that the iteration ended at, finite or the first guess.
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
    why = f"no periodic motion found near the first guess: the rates of the balls change it by {change:.2g} m still: too strong dashpots in the contacts"
    raise ConvergenceError(why, {"q": path.q[0].copy()})


def linearised(problem: Problem, path: Path) -> Eliminated:
    """About a path, whose arrays a step of Newton's method moves then."""
    elimination = problem.eliminated(path.nodes)
    closure = newton.Closure(problem.closing, problem.symmetry.order, np.empty(0, dtype=np.int64))
    samples, once = path.samples(problem.push(path.nodes)), newton.Limits(0.0, 0.0, 1, 0)
    status = newton.newton(
        problem.equations, closure, problem.mesh(path.nodes), samples, once, elimination, np.zeros(newton.REPORT)
    )
    if status == newton.BALLS_FAILED:
        raise ConvergenceError("the balls have no equilibrium between the races", {"q": path.q[0].copy()})
    return elimination


def newton_iteration(
    problem: Problem, path: Path, tolerance: float, patience: int, limit: int, rate_columns: np.ndarray
) -> Solved:
    """The compiled iteration; ``rate_columns``: columns of the balls whose rates are put in after every sweep."""
    elimination, report = problem.eliminated(path.nodes), np.zeros(newton.REPORT)
    q, v, a, ball, rate = path.q.copy(), path.v.copy(), path.a.copy(), path.ball.copy(), path.rate.copy()
    solution = Path(path.nodes, q, v, a, ball, rate)
    closure = newton.Closure(problem.closing, problem.symmetry.order, rate_columns)
    limits = newton.Limits(tolerance, problem.system.force_rounding(path.q[0]), limit, patience)
    samples = solution.samples(problem.push(path.nodes))
    status = newton.newton(problem.equations, closure, problem.mesh(path.nodes), samples, limits, elimination, report)
    if status != newton.SOLVED:
        why = {newton.STALLED: "the iteration stalls", newton.SINGULAR: "the motion is singular"}.get(
            status, "the balls have no equilibrium between the races"
        )
        reason = f"no periodic motion found near the first guess: {why} after {int(report[newton.SWEEPS])} iterations, imbalance {report[newton.WORST_IMBALANCE]:.2g} N"
        raise ConvergenceError(reason, {"q": q[0] if np.isfinite(q[0]).all() else path.q[0].copy()})
    size, correction = float(report[newton.SIZE]), float(report[newton.CORRECTION])
    whole, sweeps = report[newton.SHORTENED] == 0.0, int(report[newton.SWEEPS])
    return Solved(problem, solution, elimination, size, whole, sweeps, correction)
