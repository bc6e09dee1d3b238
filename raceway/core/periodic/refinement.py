"""Meshes that are halved where the error is made, and the error that is left.

*At the nodes*: the balance of forces is integrated over each interval once more with more points along the motion found;
what q and q' would gain is the interval's defect, and the linearised problem carries all defects round to the error of the
motion (it is solved already, so this costs one sweep without tangents).  *Between the nodes*: the highest Legendre
coefficient of the acceleration on each interval, with the decay seen in the lower ones, integrated twice.  Where a ball
leaves its race the force has a jump in its second derivative, neither part falls faster than h^2.5 there, and those
intervals are divided again and again.
"""

from collections.abc import Callable
from math import ceil

import attrs
import numpy as np

from raceway.core.periodic.collocation import Path, Problem, Solved, solve
from raceway.core.periodic.intervals import Change, forces, spread
from raceway.core.periodic.turn import integrals, rotations
from raceway.core.record import Motion, Record, Schedule
from raceway.core.ring.orbit import States, responses
from raceway.errors import ConvergenceError
from raceway.storage.tables import Tables

#: Intervals beyond which no mesh goes, rounds of dividing, and parts of an interval in one round.
MOST_INTERVALS = 8192
_ROUNDS = 16
_PARTS = 8
#: Largest double integral of a Legendre polynomial of degree 4 over an interval of length 1.
_BETWEEN = 1.0 / 64.0
#: Power of an interval's length that errors fall with at least where motions are smooth, and part of the error aimed at.
_SMOOTH, _SAFE = 5.0, 0.1
#: Newton's iteration ends at this part of the tolerance.
_NEWTON = 1e-2


def _defects(problem: Problem, path: Path) -> np.ndarray:
    """(m, 2 n): what q and q' at the end of each interval gain by the accelerations at further points, which balance the forces there."""
    system, rule, free, speed = problem.system, problem.rule, problem.free, problem.speed
    m, s, e = path.intervals, len(rule.points), len(rule.tried)
    angles, q, v = (x.reshape(m * e, -1) for x in path.states((rule.tried, rule.tried_velocity, rule.tried_position)))
    angle, v = angles[:, 0], v * speed
    ball, rate = (x.reshape(m, s, *x.shape[1:]) for x in (path.ball, path.rate))
    near = ball[:, np.minimum(s - 1, (rule.tried * s).astype(int))].reshape(m * e, *path.ball.shape[1:])
    between = np.einsum("es,mszc->mezc", rule.tried_values, rate).reshape(near.shape)
    f = responses(system, States(angle / speed, q, v, near, between)).f
    left = system.load + problem.share * problem.force(angle) - f - v @ system.damping.T - q @ system.stiffness.T
    further = np.linalg.solve(system.mass[np.ix_(free, free)], left[:, free].T).T / speed**2
    both = np.concatenate([path.a.reshape(m, s, 5)[:, :, free], further.reshape(m, e, -1)], axis=1)
    h = np.diff(path.nodes)[:, None]
    by_position, by_velocity = np.einsum("gs,msn->gmn", rule.gain, both)
    defect = np.hstack([h**2 * by_position, h * by_velocity])
    if not np.isfinite(defect).all():
        raise ConvergenceError("the balls have no equilibrium between the races", {"q": path.q[0].copy()})
    return defect


@attrs.frozen(eq=False)
class Estimate:
    """Error of a motion on one mesh.

    error : largest error of a displacement over the motion's size;  defect, between : (m,) where it is made [m]
    field : (m + 1, 5) estimated error of q at the nodes
    """

    error: float
    defect: np.ndarray
    between: np.ndarray
    field: np.ndarray


def estimate(solution: Solved, closure: Callable[[np.ndarray], np.ndarray] | None = None) -> Estimate:
    """The error of a motion by its defects, carried round, and by the tail of its polynomials.

    closure : change of the state at the start (2 n,) with which the span closes after a gap (2 n,) at its end; None: the parameter
        of a branch stays as it is, which has no answer at a fold
    """
    problem, path = solution.problem, solution.path
    free, weight = problem.free, problem.weight
    m, s, n = path.intervals, len(problem.rule.points), len(free)
    defect = _defects(problem, path)
    eliminated, dq = solution.eliminated, np.zeros_like(path.q)
    transfer, change = eliminated.transfer.copy(), Change(dq, np.zeros_like(path.v), np.empty((0, 5)))
    transfer[:, 2 * n] = defect.ravel()
    carried = eliminated._replace(stages=np.empty((0, 2 * n + 2)), transfer=transfer)
    spread(free, carried, np.zeros(2 * n), 0.0, change)
    end = np.concatenate([dq[-1, free], change.v[-1, free]])
    closed = problem.closing - eliminated.span_transfer[:, : 2 * n]
    spread(free, carried, np.linalg.solve(closed, end) if closure is None else closure(end), 0.0, change)
    h = np.diff(path.nodes)
    legendre = np.abs(np.einsum("js,msc->mjc", problem.rule.legendre, path.a.reshape(m, s, 5))) / weight
    last, lower = legendre[:, -1], legendre[:, -3:].max(axis=1)
    beyond = last * np.sqrt(last / np.maximum(lower, 1e-300))
    tails = _BETWEEN * h**2 * beyond.max(axis=1)
    defects = np.maximum(np.abs(defect[:, :n]), np.abs(defect[:, n:])) / weight[free]
    floor = max(solution.size, 1e-300)
    error = (float(np.abs(dq / weight).max()) + float(tails.max())) / floor
    return Estimate(error, defects.max(axis=1), tails, dq)


def divided(nodes: np.ndarray, parts: np.ndarray) -> np.ndarray:
    """New nodes with interval k in parts[k] equal parts."""
    parent = np.repeat(np.arange(len(parts)), parts)
    inside = np.arange(len(parent)) - np.repeat(np.cumsum(parts) - parts, parts)
    return np.append(nodes[parent] + np.diff(nodes)[parent] * inside / parts[parent], nodes[-1])


def fitting(nodes: np.ndarray, error: Estimate, target: float, widest: float) -> np.ndarray:
    """Nodes of a mesh with an error below ``target`` [m] that has intervals where the error is made, none above ``widest`` [rad].

    Errors of smooth motions fall faster than ``_SMOOTH`` powers of an interval's length, so that it is no shorter than needed.
    """
    h, made = np.diff(nodes), np.maximum(error.defect * len(error.defect), error.between)
    density = np.maximum((made / (_SAFE * target)) ** (1.0 / _SMOOTH) / h, 1.0 / widest)
    # A contact opens elsewhere in the next motion.
    for _ in range(2):
        density = np.maximum(density, 0.5 * np.maximum(np.roll(density, 1), np.roll(density, -1)))
    share = np.append(0.0, np.cumsum(density * h))
    return np.interp(np.linspace(0.0, share[-1], ceil(share[-1] - 1e-9) + 1), share, nodes)


def sampled_at(problem: Problem, path: Path, nodes: np.ndarray) -> Path:
    """The same motion on another mesh."""
    q, v, *_ = motion_at(problem, path, nodes)
    *_, a, ball, rate = motion_at(problem, path, problem.angles(nodes))
    return Path(nodes, *(np.ascontiguousarray(part) for part in (q, v, a, ball, rate)))


@attrs.frozen(eq=False)
class Refined:
    """A periodic motion on a mesh that is fit for it.

    error : estimated, of a displacement over the motion's size;  rounds : of dividing
    sweeps, evaluations : of all meshes together
    """

    solved: Solved
    error: float
    rounds: int
    sweeps: int
    evaluations: int


def refine(solution: Solved, tolerance: float) -> Refined:
    """Divide intervals and solve again until the estimated error is below the tolerance, or the mesh cannot grow.

    An error within rounding's share, or a mesh that reaches ``MOST_INTERVALS``, ends it too; the error says so.
    """
    problem = solution.problem
    s = len(problem.rule.points)
    sweeps, evaluations = solution.sweeps, solution.sweeps * solution.path.intervals * s
    for rounds in range(_ROUNDS):
        error = estimate(solution)
        evaluations += solution.path.intervals * len(problem.rule.tried)
        if error.error <= max(tolerance, solution.rounding) or rounds == _ROUNDS - 1:
            break
        target = tolerance * solution.size
        largest = float(np.abs(error.field / problem.weight).max())
        # Defects add up; each of the important ones may make its share.
        important = max(int((error.defect > 0.1 * error.defect.max()).sum()), 1)
        target_defect = 0.5 * target / max(largest, 1e-300) * error.defect.sum() / important
        too_much = np.maximum(error.defect / max(target_defect, 1e-300), error.between / (0.5 * target))
        # Where a contact opens, halving takes a defect down by 2^2.5 to 2^3.5.
        parts = np.minimum(2 ** np.ceil(np.log2(np.maximum(too_much, 1.0)) / 3.0).astype(int), _PARTS)
        if parts.max() == 1:
            parts[np.argmax(too_much)] = 2
        nodes = divided(solution.path.nodes, parts)
        if len(nodes) > MOST_INTERVALS:
            break
        problem.watch()
        solution = solve(problem, sampled_at(problem, solution.path, nodes), _NEWTON * tolerance)
        sweeps += solution.sweeps
        evaluations += solution.sweeps * solution.path.intervals * s
    return Refined(solution, error.error, rounds, sweeps, evaluations)


def motion_at(problem: Problem, path: Path, angles: np.ndarray) -> tuple[np.ndarray, ...]:
    """q, dq/dtheta, d2q/dtheta2 (n, 5), balls and rates (n, Z, c) at angles (n,) within the span; balls are interpolated."""
    k, step, u, q, (values, once, _), a = _displacement_at(problem, path, angles)
    s = len(problem.rule.points)
    v = path.v[k] + step * np.einsum("ns,nsc->nc", once, a)
    shape = (path.intervals, s, *path.ball.shape[1:])
    ball, rate = (np.einsum("ns,nszc->nzc", values, x.reshape(shape)[k]) for x in (path.ball, path.rate))
    return q, v, np.einsum("ns,nsc->nc", values, a), ball, rate


def _displacement_at(
    problem: Problem, path: Path, angles: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, tuple[np.ndarray, np.ndarray, np.ndarray], np.ndarray]:
    """Of angles (n,) the intervals, their lengths (n, 1), the places in them, q (n, 5), the rule's integrals, accelerations."""
    s, h = len(problem.rule.points), np.diff(path.nodes)
    k = np.clip(np.searchsorted(path.nodes, angles, side="right") - 1, 0, path.intervals - 1)
    step = h[k][:, None]
    u = (angles - path.nodes[k]) / h[k]
    rule = integrals(problem.rule.points, u)
    a = path.a.reshape(path.intervals, s, 5)[k]
    q = path.q[k] + u[:, None] * step * path.v[k] + step**2 * np.einsum("ns,nsc->nc", rule[2], a)
    return k, step, u, q, rule, a


def displacements(solution: Solved, angles: np.ndarray) -> np.ndarray:
    """q (n, 5) at any angles (n,): the first of ``states``."""
    problem, symmetry = solution.problem, solution.problem.symmetry
    spans = _spans(symmetry.span, angles)
    q = _displacement_at(problem, solution.path, angles - spans * symmetry.span)[3]
    return np.einsum("nij,nj->ni", rotations(symmetry.angle * np.arange(spans.max() + 1))[spans], q) if spans.any() else q


def _spans(span: float, angles: np.ndarray) -> np.ndarray:
    """How many whole spans lie before each angle; a sample at the very end of one belongs to it: nothing has to be turned then."""
    return np.maximum(np.ceil(angles / span - 1e-12).astype(int) - 1, 0)


def record(solution: Solved, schedule: Schedule, counts: Tables) -> Record:
    """Samples at every ``stride``-th step of a schedule, which begins at angle zero.

    counts : what the record says about its making; penetration and contact force are added
    """
    problem = solution.problem
    system, span = problem.system, problem.symmetry.span
    every = problem.speed * schedule.dt * schedule.stride
    total = schedule.steps // schedule.stride
    angles = every * np.arange(1, total + 1)
    # Where samples of one span fall on those of the next they need not be computed again.
    a_turn = schedule.steps_per_turn // schedule.stride
    inside = round(span / every)
    if a_turn * schedule.stride != schedule.steps_per_turn or abs(inside * every - span) > 1e-9 * span:
        inside = total
    inside = min(inside, total)
    angles = angles[:inside]
    q, v, a, ball, rate = states(solution, angles)
    now = responses(system, States(angles / problem.speed, q, v * problem.speed, ball, rate))
    gap, force = now.gap, now.force
    repeat = _Repeat(problem, inside, total)
    push = np.empty((total, 5))
    time = schedule.dt * schedule.stride * np.arange(1, total + 1)
    forces(system.force, system.force_params, time, push)
    displacement, velocity, places = repeat.states(q), repeat.states(v) * problem.speed, repeat.balls(ball)
    before = places[-2] if schedule.stride == 1 and total > 1 else places[-1] - schedule.dt * repeat.balls(rate)[-1]
    acceleration = repeat.states(a)[-1] * problem.speed**2 * (system.free > 0.0)
    return Record(
        time=time,
        displacement=displacement,
        velocity=velocity,
        force=push,
        gap=repeat.contacts(gap),
        contact_force=repeat.contacts(force),
        ball=places,
        final=Motion(displacement[-1].copy(), velocity[-1].copy(), acceleration, places[-1].copy(), before.copy()),
        schedule=schedule,
        counts={
            **counts,
            "max_penetration_m": float(max(-gap.min(), 0.0)),
            "peak_contact_force_n": float(force.max(initial=0.0)),
        },
    )


def states(solution: Solved, angles: np.ndarray) -> tuple[np.ndarray, ...]:
    """q, dq/dtheta, d2q/dtheta2 (n, 5), balls and rates (n, Z, c) at any angles (n,): those beyond the span are turned there."""
    problem, symmetry = solution.problem, solution.problem.symmetry
    spans = _spans(symmetry.span, angles)
    q, v, a, ball, rate = motion_at(problem, solution.path, angles - spans * symmetry.span)
    if spans.any():
        repeat = _Repeat(problem, 1, int(spans.max()) + 1)
        turn = repeat.turns[spans]
        q, v, a = (np.einsum("nij,nj->ni", turn, x) for x in (q, v, a))
        order = repeat.orders[spans][:, :, None]
        ball, rate = (np.take_along_axis(x, np.broadcast_to(order, x.shape), axis=1) for x in (ball, rate))
    return q, v, a, np.ascontiguousarray(ball), np.ascontiguousarray(rate)


class _Repeat:
    """Samples of one span, ``inside`` of them, continued to ``total``: turned, with the balls renumbered."""

    def __init__(self, problem: Problem, inside: int, total: int) -> None:
        self.inside, self.total = inside, total
        spans = -(-total // inside)
        z = problem.system.ball_count
        self.turns = rotations(problem.symmetry.angle * np.arange(spans))
        self.orders = np.empty((spans, z), dtype=int)
        self.orders[0] = np.arange(z)
        for k in range(1, spans):
            self.orders[k] = problem.symmetry.order[self.orders[k - 1]]

    def states(self, values: np.ndarray) -> np.ndarray:
        """(total, 5) from (inside, 5)."""
        return (values @ self.turns.transpose(0, 2, 1)).reshape(-1, 5)[: self.total]

    def contacts(self, values: np.ndarray) -> np.ndarray:
        """(total, 2 Z) from (inside, 2 Z)."""
        both = np.concatenate([self.orders, self.orders + self.orders.shape[1]], axis=1)
        return values[:, both].swapaxes(0, 1).reshape(-1, values.shape[1])[: self.total]

    def balls(self, values: np.ndarray) -> np.ndarray:
        """(total, Z, c) from (inside, Z, c)."""
        return values[:, self.orders].swapaxes(0, 1).reshape(-1, *values.shape[1:])[: self.total]
