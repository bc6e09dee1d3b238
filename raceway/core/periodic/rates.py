"""The rates of the balls along a periodic motion.

Notes
-----
A ball has no mass along its groove: its place b follows from the ring's motion and, where contacts have dashpots, from its
own rate r.  So r = D b(r), D the derivative over one span and round its end.  Dashpots are weak as a rule (1e-11 s of lag
behind the motion with the default), and putting the last rates in converges at once: the compiled iteration does so after
every sweep.  Where lag times the largest entry of D is no longer small that diverges, in the finest modes of the mesh first,
and Newton's iteration takes over: (I - D T) dr = D b - r with T = db/dr of each ball, by differences.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from raceway.core.periodic.sweep import contacts, differentiate
from raceway.core.ring.orbit import States
from raceway.errors import ConvergenceError

if TYPE_CHECKING:
    from raceway.core.periodic.problem import Path, Problem
    from raceway.core.periodic.rule import Rule

#: Lag times the largest entry of D above which the rates are solved for: a fifth leaves seven sweeps for 1e-5.
_STIFF = 0.02
#: Step of the differences [m/s] over the velocity of the motion.
_STEP = 0.1


def derivative(problem: Problem, path: Path) -> np.ndarray:
    """Rates (m s, Z, r) of the columns that have rates, from the balls' places along the motion."""
    rated = problem.system.rated_columns
    order = problem.symmetry.order
    # Those of the next and of the last span are this one's, renumbered.
    before, after = path.ball[-2:][:, np.argsort(order)], path.ball[:2][:, order]
    ball = np.ascontiguousarray(np.concatenate([before, path.ball, after])[:, :, rated])
    rate = np.empty_like(ball)
    differentiate(_longer(path.nodes), problem.rule.points, problem.speed, ball, rate)
    return rate[2:-2]


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
    """
    rated = problem.system.rated_columns
    wanted = derivative(problem, path)
    if solved:
        old = path.rate[:, :, rated]
        wanted = old + _solve(problem, path, wanted - old)
    path.rate[:, :, rated] = wanted


def between(problem: Problem, path: Path) -> np.ndarray:
    """Rates (m e, Z, c) at the points between the Gauss points that estimates try."""
    s = len(problem.rule.points)
    values = problem.rule.tried_values
    rate = path.rate.reshape(path.intervals, s, *path.rate.shape[1:])
    return np.ascontiguousarray(np.einsum("es,mszc->mezc", values, rate).reshape(-1, *path.rate.shape[1:]))


def _longer(nodes: np.ndarray) -> np.ndarray:
    """Nodes with an interval more at each end."""
    h = np.diff(nodes)
    return np.concatenate([[nodes[0] - h[-1]], nodes, [nodes[-1] + h[0]]])


@cache
def _steepest(rule: Rule) -> float:
    """Largest entry of the derivative on an interval of length 1 among equals."""
    return float(np.abs(_weights(rule, np.array([0.0, 1.0]))).max())


def _weights(rule: Rule, nodes: np.ndarray) -> np.ndarray:
    """D (m s, s + 4) by the angle: row i has the weights of samples k s - 2 to k s + s + 1, k the interval of sample i."""
    m, s = len(nodes) - 1, len(rule.points)
    width = s + 4
    rows = np.arange(m * s + 4)
    # Any s + 4 samples in a row have different remainders: one signal for each remainder tells every weight.
    signal = np.ascontiguousarray((rows[:, None] % width == np.arange(width)).astype(float)[:, :, None])
    out = np.empty_like(signal)
    differentiate(_longer(nodes), rule.points, 1.0, signal, out)
    of = (np.arange(m * s) // s * s)[:, None] + np.arange(width)
    return np.take_along_axis(out[2:-2, :, 0], of % width, axis=1)


def _lags(problem: Problem, path: Path) -> np.ndarray:
    """T (m s, Z, r, r) [s]: places by rates."""
    columns: list[list[int]] = [[c] for c in problem.system.rated_columns]
    here, *moved = _places(problem, path, np.arange(len(path.a)), [[], *columns])
    return np.stack([(one - here) / _step(problem, path) for one in moved], axis=-1)


def _step(problem: Problem, path: Path) -> float:
    return _STEP * max(float(np.abs(path.v / problem.weight).max()), 1e-9) * problem.speed


def _places(problem: Problem, path: Path, chosen: np.ndarray, moved: list[list[int]]) -> list[np.ndarray]:
    """Columns (n, Z, r) of the balls at some of the Gauss points, for each set of columns with the rates of that set moved."""
    system, rule = problem.system, problem.rule
    s, rated = len(rule.points), system.rated_columns
    k, i = chosen // s, chosen % s
    h, a = np.diff(path.nodes)[k, None], path.a.reshape(path.intervals, s, 5)[k]
    q = path.q[k] + rule.points[i, None] * h * path.v[k] + h**2 * np.einsum("ns,nsc->nc", rule.position[i], a)
    v = (path.v[k] + h * np.einsum("ns,nsc->nc", rule.velocity[i], a)) * problem.speed
    times = (path.nodes[k] + rule.points[i] * h[:, 0]) / problem.speed
    gap, force = np.empty((2, len(chosen), 2 * system.ball_count))
    found = []
    for columns in moved:
        ball, rate = path.ball[chosen].copy(), path.rate[chosen].copy()
        rate[:, :, columns] += _step(problem, path)
        done = contacts(system.compiled_forces, system.law_state, States(times, q, v, ball, rate), gap, force)
        if done < len(chosen):
            raise ConvergenceError("the balls find no place between the races", {"q": q[done].copy()})
        found.append(ball[:, :, rated])
    return found


def _solve(problem: Problem, path: Path, rest: np.ndarray) -> np.ndarray:
    """(I - D T)^-1 of a residual (m s, Z, r), all balls of a span together: one goes on where another one ends."""
    from scipy.sparse import bsr_array, eye_array
    from scipy.sparse.linalg import splu

    n, z, r = rest.shape
    s, order = len(problem.rule.points), problem.symmetry.order
    lags, weights = _lags(problem, path), problem.speed * _weights(problem.rule, path.nodes)
    back = np.argsort(order)
    ball, sample = np.meshgrid(np.arange(z), np.arange(n), indexing="ij")
    at = sample[:, :, None] // s * s + np.arange(s + 4) - 2
    whose = np.where(at < 0, back[ball][:, :, None], np.where(at >= n, order[ball][:, :, None], ball[:, :, None]))
    at %= n
    blocks = -weights[None, :, :, None, None] * lags[at, whose]
    row = np.arange(z * n + 1) * (s + 4)
    matrix = bsr_array((blocks.reshape(-1, r, r), (whose * n + at).ravel(), row), shape=(z * n * r, z * n * r))
    found = splu((matrix + eye_array(z * n * r)).tocsc()).solve(rest.swapaxes(0, 1).ravel())
    return found.reshape(z, n, r).swapaxes(0, 1)
