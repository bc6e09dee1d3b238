"""Meshes that are halved where the error is made, and the error that is left.

Notes
-----
*At the nodes*: the balance of forces is integrated over each interval once more with more points along the motion found;
what q and q' would gain is the interval's defect, and the linearised problem carries all defects round to the error of the
motion (it is solved already, so this costs one sweep without tangents).  *Between the nodes*: the highest Legendre
coefficient of the acceleration on each interval, with the decay seen in the lower ones, integrated twice.  Where a ball
leaves its race the force has a jump in its second derivative, neither part falls faster than h^2.5 there, and those
intervals are divided again and again.
"""

from __future__ import annotations

from collections.abc import Callable

import attrs
import numpy as np

from raceway.core.periodic.collocation import Solved, solve
from raceway.core.periodic.defects import Excitation, carry, try_between
from raceway.core.periodic.problem import Path, Problem
from raceway.core.periodic.rates import between
from raceway.core.periodic.rule import integrals
from raceway.errors import ConvergenceError

#: Intervals beyond which no mesh goes, rounds of dividing, and parts of an interval in one round.
MOST_INTERVALS = 8192
_ROUNDS = 16
_PARTS = 8
#: Largest double integral of a Legendre polynomial of degree 4 over an interval of length 1.
_BETWEEN = 1.0 / 64.0
#: Newton's iteration ends at this part of the tolerance.
_NEWTON = 1e-2


@attrs.frozen(eq=False)
class Estimate:
    """Error of a motion on one mesh.

    Attributes
    ----------
    error : largest error of a displacement over the motion's size;  defect, between : (m,) where it is made [m]
    field : (m + 1, 5) estimated error of q at the nodes
    """

    error: float
    defect: np.ndarray
    between: np.ndarray
    field: np.ndarray


def estimate(solved: Solved, closed: Callable[[np.ndarray], np.ndarray] | None = None) -> Estimate:
    """The error of a motion by its defects, carried round, and by the tail of its polynomials.

    Parameters
    ----------
    closed : change of the state at the start (2 n,) with which the span closes after a gap (2 n,) at its end; None: the parameter
        of a branch stays as it is, which has no answer at a fold
    """
    problem, path = solved.problem, solved.path
    system, free, weight = problem.system, problem.free, problem.weight
    m, s, n = path.intervals, len(problem.rule.points), len(free)
    inverse = np.linalg.inv(system.mass[np.ix_(free, free)])
    defect = np.empty((m, 2 * n))
    excitation = Excitation(system.force, system.force_params, problem.share, problem.clock)
    tried = attrs.evolve(path, rate=between(problem, path)).samples(np.empty((0, 5)))
    done = try_between(
        problem.equations, excitation, inverse, problem.mesh(path.nodes), problem.rule.try_packed, tried, defect
    )
    if done < m or not np.isfinite(defect).all():
        raise ConvergenceError("the balls find no place between the races", {"q": path.q[0].copy()})
    dq, dv = np.zeros_like(path.q), np.zeros_like(path.v)
    transfer, whole = solved.eliminated.transfer, solved.eliminated.whole
    carry(free, transfer, np.zeros(2 * n), defect, dq, dv)
    end = np.concatenate([dq[-1, free], dv[-1, free]])
    first = np.linalg.solve(problem.closing - whole[:, : 2 * n], end) if closed is None else closed(end)
    carry(free, transfer, first, defect, dq, dv)
    h = np.diff(path.nodes)
    legendre = np.abs(np.einsum("js,msc->mjc", problem.rule.legendre, path.a.reshape(m, s, 5))) / weight
    last, lower = legendre[:, -1], legendre[:, -3:].max(axis=1)
    beyond = last * np.sqrt(last / np.maximum(lower, 1e-300))
    tails = _BETWEEN * h**2 * beyond.max(axis=1)
    made = np.maximum(np.abs(defect[:, :n]), np.abs(defect[:, n:])) / weight[free]
    floor = max(solved.size, 1e-300)
    error = (float(np.abs(dq / weight).max()) + float(tails.max())) / floor
    return Estimate(error, made.max(axis=1), tails, dq)


def divided(nodes: np.ndarray, parts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """New nodes with interval k in parts[k] equal parts, and for each new interval the old one that it lies in."""
    parent = np.repeat(np.arange(len(parts)), parts)
    inside = np.arange(len(parent)) - np.repeat(np.cumsum(parts) - parts, parts)
    start = nodes[parent] + np.diff(nodes)[parent] * inside / parts[parent]
    return np.append(start, nodes[-1]), parent


def resampled(problem: Problem, path: Path, nodes: np.ndarray, parent: np.ndarray) -> Path:
    """The same motion on a divided mesh."""
    s, h = len(problem.rule.points), np.diff(path.nodes)
    a = path.a.reshape(path.intervals, s, 5)
    where = (nodes[:-1] - path.nodes[parent]) / h[parent]
    _, once, twice = integrals(problem.rule.points, where)
    step, own = h[parent, None], a[parent]
    v = path.v[parent] + step * np.einsum("ms,msc->mc", once, own)
    q = path.q[parent] + (where[:, None] * step) * path.v[parent] + step**2 * np.einsum("ms,msc->mc", twice, own)
    points = (where[:, None] + (np.diff(nodes) / h[parent])[:, None] * problem.rule.points).ravel()
    values, _, _ = integrals(problem.rule.points, points)
    of = np.repeat(parent, s)
    inner = np.einsum("ns,nsc->nc", values, a[of])
    nearest = of * s + np.abs(points[:, None] - problem.rule.points).argmin(axis=1)
    return Path(
        nodes,
        np.vstack([q, path.q[-1:]]),
        np.vstack([v, path.v[-1:]]),
        inner,
        path.ball[nearest].copy(),
        path.rate[nearest].copy(),
    )


@attrs.frozen(eq=False)
class Refined:
    """A periodic motion on a mesh that is fit for it.

    Attributes
    ----------
    error : estimated, of a displacement over the motion's size;  rounds : of dividing
    sweeps, evaluations : of all meshes together
    """

    solved: Solved
    error: float
    rounds: int
    sweeps: int
    evaluations: int


def refine(solved: Solved, tolerance: float) -> Refined:
    """Divide intervals and solve again until the estimated error is below the tolerance, or the mesh cannot grow.

    Notes
    -----
    An error within rounding's share, or a mesh that reaches ``MOST_INTERVALS``, ends it too; the error says so.
    """
    problem = solved.problem
    s = len(problem.rule.points)
    extra = problem.rule.try_packed.shape[1] - s
    sweeps, evaluations = solved.sweeps, solved.sweeps * solved.path.intervals * s
    for rounds in range(_ROUNDS):
        found = estimate(solved)
        m = solved.path.intervals
        evaluations += m * extra
        if found.error <= max(tolerance, solved.rounding) or rounds == _ROUNDS - 1:
            break
        wanted = tolerance * solved.size
        carried = float(np.abs(found.field / problem.weight).max())
        # Defects add up; each of the important ones may make its share.
        important = max(int((found.defect > 0.1 * found.defect.max()).sum()), 1)
        allowed = 0.5 * wanted / max(carried, 1e-300) * found.defect.sum() / important
        too_much = np.maximum(found.defect / max(allowed, 1e-300), found.between / (0.5 * wanted))
        # Where a contact opens, halving takes a defect down by 2^2.5 to 2^3.5.
        parts = np.minimum(2 ** np.ceil(np.log2(np.maximum(too_much, 1.0)) / 3.0).astype(int), _PARTS)
        if parts.max() == 1:
            parts[np.argmax(too_much)] = 2
        nodes, parent = divided(solved.path.nodes, parts)
        if len(nodes) > MOST_INTERVALS:
            break
        problem.watch()
        solved = solve(problem, resampled(problem, solved.path, nodes, parent), _NEWTON * tolerance)
        sweeps += solved.sweeps
        evaluations += solved.sweeps * solved.path.intervals * s
    return Refined(solved, found.error, rounds, sweeps, evaluations)
