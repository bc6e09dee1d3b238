"""Newton's iteration for a periodic motion on one mesh, compiled as a whole."""

import numpy as np
from numba import float64, int64

from raceway.core.jit import jit
from raceway.core.periodic.sweep import INDICES, MODEL, condense, differentiate, eliminate, spread
from raceway.core.ring.dense import copy_cube
from raceway.core.signatures import CUBE, MATRIX, VECTOR

#: A displacement's rounding over the displacement itself, below which no correction can come.
ROUNDING = 1e-14
#: Entries of ``report``: sweeps of all intervals, largest imbalance [N], last correction [m], size of the motion [m], and 1
#: where a step had to be shortened.
SWEEPS, IMBALANCE, CORRECTION, SIZE, SHORTENED = range(5)
REPORT = 8
SOLVED, STALLED, BALLS_FAILED, SINGULAR = range(4)


@jit(
    int64(
        *MODEL, MATRIX, MATRIX, MATRIX, VECTOR, INDICES, float64, MATRIX, INDICES, INDICES, VECTOR, VECTOR, MATRIX, MATRIX,
        MATRIX, MATRIX, CUBE, CUBE, MATRIX, MATRIX, float64, int64, int64, MATRIX, MATRIX, MATRIX, VECTOR,
    ),
    allocates=True,
)  # fmt: skip
def newton(
    system, law, law_params, scalars, table, law_state, mass, damping, stiffness, weight, free, speed, closing, order, rated,
    nodes, points, rule, q, v, a, ball, rate, push, slope, tolerance, limit, patience, stages, transfer, whole, report,
):  # fmt: skip
    """Move q, v, a, ball and rate onto the periodic motion; see ``raceway.core.periodic.sweep`` for the arrays.

    Parameters
    ----------
    closing : (2 n, 2 n) rotation of a state by the span;  order : (Z,) see ``raceway.core.periodic.symmetry``
    rated : columns of ``ball`` that have rates
    tolerance : of the last correction over the size of the motion
    patience : halvings of a step that may follow each other
    """
    m, s, n, z = nodes.size - 1, points.size, free.size, ball.shape[1]
    noted = np.zeros(3)
    dq, dv, da = np.zeros_like(q), np.zeros_like(v), np.zeros_like(a)
    safe = ball.copy()
    close = np.empty((2 * n, 2 * n + 1))
    first = np.empty(2 * n)
    columns = rated.size
    longer, more, most = np.empty(m + 3), np.empty((m * s + 4, z, columns)), np.empty((m * s + 4, z, columns))
    longer[0], longer[m + 2] = nodes[0] - (nodes[m] - nodes[m - 1]), nodes[m] + nodes[1] - nodes[0]
    for k in range(m + 1):
        longer[k + 1] = nodes[k]
    factor, worst, halvings, fine = 1.0, np.inf, 0, 0
    for sweep in range(1, limit + 1):
        report[SWEEPS] = sweep
        done = condense(
            system, law, law_params, scalars, table, law_state, mass, damping, stiffness, weight, free, speed, nodes,
            rule, q, v, a, ball, rate, push, slope, stages, transfer, whole, noted,
        )  # fmt: skip
        # The accelerations of a first guess are rough: its imbalance tells nothing.
        if done < m or (sweep > 2 and noted[0] > 2.0 * worst and noted[0] > 1e-9 * noted[2]):
            report[SHORTENED] = 1.0
            halvings += 1
            if sweep == 1 or halvings > patience:
                return BALLS_FAILED if done < m else STALLED
            factor *= 0.5
            for k in range(m + 1):
                for c in range(5):
                    q[k, c] -= factor * dq[k, c]
                    v[k, c] -= factor * dv[k, c]
            for k in range(m * s):
                for c in range(5):
                    a[k, c] -= factor * da[k, c]
            copy_cube(safe, ball)
            continue
        worst, halvings = noted[0], 0
        report[IMBALANCE] = worst
        # A path that was put together from others may not end where it begins: that is corrected with the rest.
        for i in range(2 * n):
            close[i, 2 * n] = whole[i, 2 * n] + (q[m, free[i]] if i < n else v[m, free[i - n]])
            for j in range(2 * n):
                close[i, j] = closing[i, j] - whole[i, j]
                close[i, 2 * n] -= closing[i, j] * (q[0, free[j]] if j < n else v[0, free[j - n]])
        if not eliminate(close, 2 * n, 1):
            return SINGULAR
        for i in range(2 * n):
            first[i] = close[i, 2 * n]
        spread(free, stages, transfer, first, 0.0, dq, dv, da)
        if sweep > 1:
            factor = min(1.0, 2.0 * factor)
        correction, size, place = 0.0, 0.0, 0.0
        for k in range(m + 1):
            for c in range(5):
                correction = max(correction, abs(dq[k, c]) / weight[c])
                q[k, c] += factor * dq[k, c]
                v[k, c] += factor * dv[k, c]
                size = max(size, abs(v[k, c]) / weight[c])
                place = max(place, abs(q[k, c]) / weight[c])
        for k in range(m * s):
            for c in range(5):
                a[k, c] += factor * da[k, c]
        report[CORRECTION], report[SIZE] = correction, size
        if not np.isfinite(correction):
            return SINGULAR
        copy_cube(ball, safe)
        for k in range(m * s):
            for b in range(z):
                for c in range(columns):
                    more[k + 2, b, c] = ball[k, b, rated[c]]
        for k in range(2):
            for b in range(z):
                for c in range(columns):
                    # Ball b stands one span later where ball order[b] stood.
                    more[m * s + 2 + k, b, c] = ball[k, order[b], rated[c]]
                    more[k, order[b], c] = ball[m * s - 2 + k, b, rated[c]]
        differentiate(longer, points, speed, more, most)
        for k in range(m * s):
            for b in range(z):
                for c in range(columns):
                    rate[k, b, rated[c]] = most[k + 2, b, c]
        if factor < 1.0 or sweep == 1:
            continue
        fine = fine + 1 if correction <= 1e-8 * size else 0
        if correction <= tolerance * size + ROUNDING * place or fine > 5:
            return SOLVED
    return STALLED
