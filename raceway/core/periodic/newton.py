"""Newton's iteration for the unknowns of a path, compiled: sweeps over its intervals, corrections that are cut where balls fail."""

from typing import NamedTuple

import numpy as np
from numba import boolean, float64, int64, types, void

from raceway.core.jit import jit
from raceway.core.periodic import intervals
from raceway.core.ring.elimination import copy_cube, eliminate
from raceway.core.signatures import CUBE, MATRIX, VECTOR, record

#: A displacement's rounding over the displacement itself, below which no correction can come.
ROUNDING = 1e-14
#: Entries of ``report``: sweeps of all intervals, largest imbalance [N], last correction [m], size of the motion [m], and 1
#: where a step had to be shortened.
SWEEPS, WORST_IMBALANCE, CORRECTION, SIZE, SHORTENED = range(5)
REPORT = 8
SOLVED, STALLED, BALLS_FAILED, SINGULAR = range(4)
#: Sweeps at the limit of rounding after which no better one comes.
_FINE = 5


class Closure(NamedTuple):
    """How a span ends: rotation of a state (2 n, 2 n), order of the balls (Z,), columns of the balls that have rates (r,)."""

    rotation: np.ndarray
    order: np.ndarray
    rated: np.ndarray


class Limits(NamedTuple):
    """Last correction over the motion's size, imbalance that is rounding [N], sweeps, and halvings of a step that may follow each other."""

    tolerance: float
    rounding: float
    sweeps: int
    patience: int


CLOSURE = record(Closure, MATRIX, intervals.INDICES, intervals.INDICES)
LIMITS = record(Limits, float64, float64, int64, int64)


@jit(void(intervals.SAMPLES, intervals.CHANGE, float64))
def _move(samples, change, factor):
    for k in range(samples.q.shape[0]):
        for c in range(5):
            samples.q[k, c] += factor * change.q[k, c]
            samples.v[k, c] += factor * change.v[k, c]
    for k in range(samples.a.shape[0]):
        for c in range(5):
            samples.a[k, c] += factor * change.a[k, c]


@jit(boolean(intervals.EQUATIONS, MATRIX, MATRIX, intervals.SAMPLES, MATRIX, VECTOR))
def _first_state(equations, rotation, span_transfer, samples, close, first):
    """first (2 n,): correction of the state at the start with which the span closes; False where it has none."""
    free = equations.free
    n, m, q, v = free.size, samples.q.shape[0] - 1, samples.q, samples.v
    # A path that was put together from others may not end where it begins: that is corrected with the rest.
    for i in range(2 * n):
        close[i, 2 * n] = span_transfer[i, 2 * n] + (q[m, free[i]] if i < n else v[m, free[i - n]])
        for j in range(2 * n):
            close[i, j] = rotation[i, j] - span_transfer[i, j]
            close[i, 2 * n] -= rotation[i, j] * (q[0, free[j]] if j < n else v[0, free[j - n]])
    if not eliminate(close):
        return False
    for i in range(2 * n):
        first[i] = close[i, 2 * n]
    return True


@jit(types.UniTuple(float64, 3)(VECTOR, intervals.SAMPLES, intervals.CHANGE))
def _sizes(weight, samples, change):
    """Largest correction of a displacement, derivative by the angle, and displacement [m]; tilts as lengths."""
    correction, size, displacement = 0.0, 0.0, 0.0
    for k in range(samples.q.shape[0]):
        for c in range(5):
            correction = max(correction, abs(change.q[k, c]) / weight[c])
            size = max(size, abs(samples.v[k, c]) / weight[c])
            displacement = max(displacement, abs(samples.q[k, c]) / weight[c])
    return correction, size, displacement


@jit(void(intervals.MESH, CLOSURE, float64, CUBE, CUBE), allocates=True)
def renew_rates(mesh, closure, speed, ball, rate):
    """rate (m s, Z, c) [m/s] of the columns of ball (m s, Z, c) that have one: two samples of the next span follow at each end."""
    nodes, rate_columns, order = mesh.nodes, closure.rated, closure.order
    m, s, z = nodes.size - 1, mesh.rule.shape[1], ball.shape[1]
    longer, more = np.empty(m + 3), np.empty((m * s + 4, z, rate_columns.size))
    most = np.empty_like(more)
    longer[0], longer[m + 2] = nodes[0] - (nodes[m] - nodes[m - 1]), nodes[m] + nodes[1] - nodes[0]
    for k in range(m + 1):
        longer[k + 1] = nodes[k]
    for c in range(rate_columns.size):
        for b in range(z):
            for k in range(m * s):
                more[k + 2, b, c] = ball[k, b, rate_columns[c]]
            for k in range(2):
                # Ball b stands one span later where ball order[b] stood.
                more[m * s + 2 + k, b, c] = ball[k, order[b], rate_columns[c]]
                more[k, order[b], c] = ball[m * s - 2 + k, b, rate_columns[c]]
    intervals.differentiate(longer, mesh.rule[2 * s + 2], speed, more, most)
    for k in range(m * s):
        for b in range(z):
            for c in range(rate_columns.size):
                rate[k, b, rate_columns[c]] = most[k + 2, b, c]


@jit(
    int64(intervals.EQUATIONS, CLOSURE, intervals.MESH, intervals.SAMPLES, LIMITS, intervals.ELIMINATED, VECTOR),
    allocates=True,
)
def newton(equations, closure, mesh, samples, limits, elimination, report):
    """Move the samples, but push and slope, onto the periodic motion."""
    m, n = mesh.nodes.size - 1, equations.free.size
    scratch, safe = np.zeros(3), samples.ball.copy()
    change = intervals.Change(np.zeros_like(samples.q), np.zeros_like(samples.v), np.zeros_like(samples.a))
    close, first, local = np.empty((2 * n, 2 * n + 1)), np.empty(2 * n), intervals.local_arrays(equations, mesh)
    factor, worst, halvings, fine = 1.0, np.inf, 0, 0
    for sweep in range(1, limits.sweeps + 1):
        report[SWEEPS] = sweep
        success = intervals.condense_interval(equations, mesh, samples, elimination, scratch, local)
        # The accelerations of a first guess are rough: its imbalance tells nothing.
        if success < m or (
            sweep > 2
            and scratch[intervals.IMBALANCE] > 2.0 * worst
            and scratch[intervals.IMBALANCE] > 1e-9 * scratch[intervals.FORCE]
        ):
            report[SHORTENED] = 1.0
            halvings += 1
            if sweep == 1 or halvings > limits.patience:
                return BALLS_FAILED if success < m else STALLED
            factor *= 0.5
            _move(samples, change, -factor)
            copy_cube(safe, samples.ball)
            continue
        worst, halvings = scratch[intervals.IMBALANCE], 0
        report[WORST_IMBALANCE] = worst
        if not _first_state(equations, closure.rotation, elimination.span_transfer, samples, close, first):
            return SINGULAR
        intervals.spread(equations.free, elimination, first, 0.0, change)
        if sweep > 1:
            factor = min(1.0, 2.0 * factor)
        _move(samples, change, factor)
        correction, size, displacement = _sizes(equations.weight, samples, change)
        report[CORRECTION], report[SIZE] = correction, size
        if not np.isfinite(correction):
            return SINGULAR
        copy_cube(samples.ball, safe)
        renew_rates(mesh, closure, equations.speed, samples.ball, samples.rate)
        if factor < 1.0 or sweep == 1:
            continue
        fine = fine + 1 if correction <= 1e-8 * size else 0
        if correction <= limits.tolerance * size + ROUNDING * displacement or worst <= limits.rounding or fine > _FINE:
            return SOLVED
    return STALLED
