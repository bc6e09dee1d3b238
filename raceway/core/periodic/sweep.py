"""Compiled parts of the collocation: everything that is done once an interval.

Notes
-----
The angle theta = w t is the independent variable, so that displacements and their derivatives by the angle are of one
size: w^2 M q'' + w C q' + K q + f(t, q, w q') = push.  Unknown are q and q' at the start of each interval and the
accelerations A at its Gauss points.  Linearised, an interval's own unknowns are eliminated,
dA = S_y (dq, dq') + S_r + S_p dp, which leaves the transfer (dq, dq')_next = T_y (dq, dq') + T_r + T_p dp; p is a parameter.

Arrays: n unknown coordinates ``free`` (n,), m intervals, s points an interval, i the number of an interval
    nodes (m + 1,) angles;  rule (2 s + 3, s) of ``raceway.core.periodic.rule``
    q, v (m + 1, 5), a (m s, 5), ball, rate (m s, Z, c), push, slope (m s, 5): forces, and the derivative of
        force balance by the parameter
    stages (m s n, 2 n + 2): S_y, S_r, S_p;  transfer (m 2 n, 2 n + 2): T_y, T_r, T_p;  whole (2 n, 2 n + 2): of all intervals
"""

import numpy as np
from numba import boolean, float64, int64, void

from raceway.core.jit import jit
from raceway.core.ring.dense import copy_matrix
from raceway.core.ring.kernels.columns import work_rows
from raceway.core.signatures import CUBE, FORCE_POINTER, LAW_POINTER, MATRIX, SYSTEM_POINTER, VECTOR

INDICES = int64[::1]
MODEL = (SYSTEM_POINTER, LAW_POINTER, MATRIX, VECTOR, MATRIX, MATRIX)


@jit(void(FORCE_POINTER, VECTOR, VECTOR, MATRIX), allocates=True)
def forces(force, params, times, out):
    """out (n, 5): the excitation at times (n,)."""
    for i in range(times.size):
        force(times[i], params, out[i])


@jit(boolean(MATRIX, int64, int64))
def eliminate(matrix, n, columns):
    """Solve in place: matrix (n, n + columns) holds the system and its right sides, which become the solutions."""
    for column in range(n):
        pivot, largest = column, abs(matrix[column, column])
        for row in range(column + 1, n):
            if abs(matrix[row, column]) > largest:
                pivot, largest = row, abs(matrix[row, column])
        if not largest > 0.0:
            return False
        if pivot != column:
            for k in range(column, n + columns):
                matrix[column, k], matrix[pivot, k] = matrix[pivot, k], matrix[column, k]
        inverse = 1.0 / matrix[column, column]
        for row in range(column + 1, n):
            factor = matrix[row, column] * inverse
            if factor != 0.0:
                for k in range(column + 1, n + columns):
                    matrix[row, k] -= factor * matrix[column, k]
    for row in range(n - 1, -1, -1):
        inverse = 1.0 / matrix[row, row]
        for k in range(n, n + columns):
            matrix[row, k] *= inverse
        for above in range(row):
            factor = matrix[above, row]
            if factor != 0.0:
                for k in range(n, n + columns):
                    matrix[above, k] -= factor * matrix[row, k]
    return True


@jit(
    int64(
        *MODEL, MATRIX, MATRIX, MATRIX, VECTOR, INDICES, float64, VECTOR, MATRIX, MATRIX, MATRIX, MATRIX, CUBE, CUBE,
        MATRIX, MATRIX, MATRIX, MATRIX, MATRIX, VECTOR,
    ),
    allocates=True,
)  # fmt: skip
def condense(
    system, law, law_params, scalars, table, law_state, mass, damping, stiffness, weight, free, speed, nodes, rule, q, v,
    a, ball, rate, push, slope, stages, transfer, whole, report,
):  # fmt: skip
    """Linearise and eliminate interval by interval; the number of intervals done, less than m at a failure.

    ``report``: largest weighted imbalance at a Gauss point [N], largest weighted jump between intervals [m], greatest
    internal force [N].
    """
    m, s, n = nodes.size - 1, rule.shape[1], free.size
    size = s * n
    columns = 2 * n + 2
    work = np.zeros((work_rows(scalars, table), 2 * table.shape[0]))
    law_new = law_state.copy()
    f, K, C = np.empty(5), np.empty((5, 5)), np.empty((5, 5))
    Q, V = np.empty(5), np.empty(5)
    block = np.empty((size, size + columns))
    local, product = np.empty((2 * n, columns)), np.empty((2 * n, columns))
    report[0], report[1], report[2] = 0.0, 0.0, 0.0
    for i in range(2 * n):
        for j in range(columns):
            whole[i, j] = 0.0
        whole[i, i] = 1.0
    for k in range(m):
        h = nodes[k + 1] - nodes[k]
        for i in range(s):
            at = k * s + i
            u = rule[2 * s + 2, i]
            for c in range(5):
                Q[c] = q[k, c] + u * h * v[k, c]
                V[c] = v[k, c]
                for j in range(s):
                    Q[c] += h * h * rule[s + i, j] * a[k * s + j, c]
                    V[c] += h * rule[i, j] * a[k * s + j, c]
            for c in range(5):
                V[c] *= speed
            t = (nodes[k] + u * h) / speed
            status = system(
                t, 0.0, Q, V, ball[at], 0.0, rate[at], law, law_params, law_state, law_new, scalars, table, work, f, K, C
            )
            if status != 0:
                return k
            for r in range(n):
                row = i * n + r
                c = free[r]
                total = f[c] - push[at, c]
                for d in range(5):
                    total += speed * speed * mass[c, d] * a[at, d] + damping[c, d] * V[d] + stiffness[c, d] * Q[d]
                if not np.isfinite(total):
                    return k
                report[0] = max(report[0], abs(total) * weight[c])
                report[2] = max(report[2], abs(f[c]) * weight[c])
                for j in range(n):
                    d = free[j]
                    by_q, by_v = K[c, d] + stiffness[c, d], speed * (C[c, d] + damping[c, d])
                    inertia = speed * speed * mass[c, d]
                    for p in range(s):
                        entry = h * rule[i, p] * by_v + h * h * rule[s + i, p] * by_q
                        if p == i:
                            entry += inertia
                        block[row, p * n + j] = entry
                    block[row, size + j] = -by_q
                    block[row, size + n + j] = -(by_v + u * h * by_q)
                block[row, size + 2 * n] = -total
                block[row, size + 2 * n + 1] = -slope[at, c]
        if not eliminate(block, size, columns):
            return k
        for i in range(size):
            for j in range(columns):
                stages[k * size + i, j] = block[i, size + j]
        for r in range(n):
            c = free[r]
            jump_q, jump_v = q[k, c] + h * v[k, c] - q[k + 1, c], v[k, c] - v[k + 1, c]
            for j in range(columns):
                local[r, j], local[n + r, j] = 0.0, 0.0
            local[r, r], local[r, n + r], local[n + r, n + r] = 1.0, h, 1.0
            for p in range(s):
                by_q, by_v = h * h * rule[2 * s + 1, p], h * rule[2 * s, p]
                jump_q += by_q * a[k * s + p, c]
                jump_v += by_v * a[k * s + p, c]
                for j in range(columns):
                    local[r, j] += by_q * block[p * n + r, size + j]
                    local[n + r, j] += by_v * block[p * n + r, size + j]
            local[r, 2 * n] += jump_q
            local[n + r, 2 * n] += jump_v
            report[1] = max(report[1], max(abs(jump_q), abs(jump_v)) / weight[c])
        for i in range(2 * n):
            for j in range(columns):
                transfer[k * 2 * n + i, j] = local[i, j]
                total = local[i, j] if j >= 2 * n else 0.0
                for p in range(2 * n):
                    total += local[i, p] * whole[p, j]
                product[i, j] = total
        for i in range(2 * n):
            for j in range(columns):
                whole[i, j] = product[i, j]
    return m


@jit(void(INDICES, MATRIX, MATRIX, VECTOR, float64, MATRIX, MATRIX, MATRIX))
def spread(free, stages, transfer, first, parameter, dq, dv, da):
    """Corrections dq, dv (m + 1, 5), da (m s, 5) from the first interval's own, first (2 n,), and the parameter's."""
    n = free.size
    m = transfer.shape[0] // (2 * n)
    s = stages.shape[0] // (m * n)
    for r in range(n):
        dq[0, free[r]] = first[r]
        dv[0, free[r]] = first[n + r]
    for k in range(m):
        for i in range(s * n):
            row = k * s * n + i
            total = stages[row, 2 * n] + stages[row, 2 * n + 1] * parameter
            for r in range(n):
                total += stages[row, r] * dq[k, free[r]] + stages[row, n + r] * dv[k, free[r]]
            da[k * s + i // n, free[i % n]] = total
        for i in range(2 * n):
            row = k * 2 * n + i
            total = transfer[row, 2 * n] + transfer[row, 2 * n + 1] * parameter
            for r in range(n):
                total += transfer[row, r] * dq[k, free[r]] + transfer[row, n + r] * dv[k, free[r]]
            if i < n:
                dq[k + 1, free[i]] = total
            else:
                dv[k + 1, free[i - n]] = total


@jit(
    int64(
        *MODEL, FORCE_POINTER, VECTOR, MATRIX, MATRIX, MATRIX, MATRIX, VECTOR, INDICES, float64, float64, float64, VECTOR,
        MATRIX, MATRIX, MATRIX, MATRIX, MATRIX, CUBE, CUBE, MATRIX,
    ),
    allocates=True,
)  # fmt: skip
def try_between(
    system, law, law_params, scalars, table, law_state, force, force_params, mass, damping, stiffness, inverse, load, free,
    share, speed, clock, nodes, rule, tried, q, v, a, ball, rate_tried, defect,
):  # fmt: skip
    """defect (m, 2 n): what q and v at the end of each interval gain when the balance of forces is integrated with more points.

    Parameters
    ----------
    inverse : (n, n) of the mass;  load : (5,) constant, share : of the excitation that acts, by an own clock [rad/s]
    tried : ``Rule.try_packed``;  rate_tried : (m e, Z, c) [m/s] at the points that are tried
    """
    m, s, n = nodes.size - 1, rule.shape[1], free.size
    e = tried.shape[1] - s
    work = np.zeros((work_rows(scalars, table), 2 * table.shape[0]))
    law_new = law_state.copy()
    f, none = np.empty(5), np.empty((0, 0))
    Q, V, outer, rest, acceleration = np.empty(5), np.empty(5), np.empty(5), np.empty(n), np.empty(n)
    place = np.empty((table.shape[0], ball.shape[2]))
    for k in range(m):
        h = nodes[k + 1] - nodes[k]
        for i in range(2 * n):
            defect[k, i] = 0.0
        for i in range(s):
            for r in range(n):
                value = a[k * s + i, free[r]]
                defect[k, r] += h * h * (tried[2 * e + 1, i] - rule[2 * s + 1, i]) * value
                defect[k, n + r] += h * (tried[2 * e, i] - rule[2 * s, i]) * value
        for i in range(e):
            u = tried[2 * e + 2, i]
            at = k * s + min(s - 1, int64(u * s))
            for c in range(5):
                Q[c] = q[k, c] + u * h * v[k, c]
                V[c] = v[k, c]
                for j in range(s):
                    Q[c] += h * h * tried[e + i, j] * a[k * s + j, c]
                    V[c] += h * tried[i, j] * a[k * s + j, c]
            for c in range(5):
                V[c] *= speed
            copy_matrix(ball[at], place)
            t = (nodes[k] + u * h) / speed
            status = system(
                t, 0.0, Q, V, place, 0.0, rate_tried[k * e + i], law, law_params, law_state, law_new, scalars, table, work, f,
                none, none,
            )  # fmt: skip
            if status != 0:
                return k
            force((nodes[k] + u * h) / clock, force_params, outer)
            for r in range(n):
                c = free[r]
                total = load[c] + share * outer[c] - f[c]
                for d in range(5):
                    total -= damping[c, d] * V[d] + stiffness[c, d] * Q[d]
                rest[r] = total
            for r in range(n):
                acceleration[r] = 0.0
                for j in range(n):
                    acceleration[r] += inverse[r, j] * rest[j]
                acceleration[r] /= speed * speed
                defect[k, r] += h * h * tried[2 * e + 1, s + i] * acceleration[r]
                defect[k, n + r] += h * tried[2 * e, s + i] * acceleration[r]
    return m


@jit(void(VECTOR, VECTOR, float64, CUBE, CUBE), allocates=True)
def differentiate(nodes, points, speed, ball, rate):
    """rate (m s + 4, Z, r) [m/s] of columns ball (m s + 4, Z, r) that have rates: both with two samples beyond each end.

    Notes
    -----
    The derivative of the polynomial through the s points of an interval and two neighbours on either side; ``nodes`` has an
    interval more at each end, for the places of those neighbours.
    """
    s = points.size
    m = nodes.size - 3
    width = s + 4
    x, w = np.empty(width), np.empty(width)
    for k in range(m):
        h, before, after = nodes[k + 2] - nodes[k + 1], nodes[k + 1] - nodes[k], nodes[k + 3] - nodes[k + 2]
        x[0], x[1] = before * (points[s - 2] - 1.0), before * (points[s - 1] - 1.0)
        for i in range(s):
            x[2 + i] = h * points[i]
        x[s + 2], x[s + 3] = h + after * points[0], h + after * points[1]
        for i in range(width):
            x[i] /= h
        for j in range(width):
            w[j] = 1.0
            for i in range(width):
                if i != j:
                    w[j] /= x[j] - x[i]
        for i in range(2, s + 2):
            for ball_number in range(ball.shape[1]):
                for c in range(ball.shape[2]):
                    total = 0.0
                    here = ball[k * s + i, ball_number, c]
                    for j in range(width):
                        if j != i:
                            total += w[j] / w[i] / (x[i] - x[j]) * (ball[k * s + j, ball_number, c] - here)
                    rate[k * s + i, ball_number, c] = total * speed / h


@jit(void(INDICES, MATRIX, VECTOR, MATRIX, MATRIX, MATRIX))
def carry(free, transfer, first, defect, dq, dv):
    """dq, dv (m + 1, 5) that defects (m, 2 n) at the ends of intervals and a first state (2 n,) make."""
    n = free.size
    m = transfer.shape[0] // (2 * n)
    for r in range(n):
        dq[0, free[r]], dv[0, free[r]] = first[r], first[n + r]
    for k in range(m):
        for i in range(2 * n):
            total = defect[k, i]
            for r in range(n):
                total += transfer[2 * n * k + i, r] * dq[k, free[r]] + transfer[2 * n * k + i, n + r] * dv[k, free[r]]
            if i < n:
                dq[k + 1, free[i]] = total
            else:
                dv[k + 1, free[i - n]] = total


@jit(
    int64(*MODEL, VECTOR, MATRIX, MATRIX, CUBE, CUBE, MATRIX, MATRIX),
    allocates=True,
)
def contacts(system, law, law_params, scalars, table, law_state, times, q, v, ball, rate, gap, force):
    """gap, force (n, 2 Z) at n states with velocities v (n, 5) in seconds; ball is a guess and becomes the places."""
    work = np.zeros((work_rows(scalars, table), 2 * table.shape[0]))
    law_new = law_state.copy()
    f, none = np.empty(5), np.empty((0, 0))
    for i in range(times.size):
        status = system(
            times[i], 0.0, q[i], v[i], ball[i], 0.0, rate[i], law, law_params, law_state, law_new, scalars, table, work, f,
            none, none,
        )  # fmt: skip
        if status != 0:
            return i
        for c in range(gap.shape[1]):
            gap[i, c] = work[0, c]
            force[i, c] = work[2, c]
    return times.size


@jit(
    int64(*MODEL, MATRIX, MATRIX, MATRIX, float64, VECTOR, MATRIX, MATRIX, MATRIX, MATRIX, CUBE, CUBE, MATRIX, MATRIX),
    allocates=True,
)
def imbalances(
    system, law, law_params, scalars, table, law_state, mass, damping, stiffness, speed, nodes, rule, q, v, a, ball, rate, push,
    out,
):  # fmt: skip
    """out (m s, 5): what is left of the balance of forces at the Gauss points [N, N m]; ball is left as it is."""
    m, s = nodes.size - 1, rule.shape[1]
    work = np.zeros((work_rows(scalars, table), 2 * table.shape[0]))
    law_new = law_state.copy()
    f, none = np.empty(5), np.empty((0, 0))
    Q, V = np.empty(5), np.empty(5)
    place = np.empty((table.shape[0], ball.shape[2]))
    for k in range(m):
        h = nodes[k + 1] - nodes[k]
        for i in range(s):
            at = k * s + i
            u = rule[2 * s + 2, i]
            for c in range(5):
                Q[c] = q[k, c] + u * h * v[k, c]
                V[c] = v[k, c]
                for j in range(s):
                    Q[c] += h * h * rule[s + i, j] * a[k * s + j, c]
                    V[c] += h * rule[i, j] * a[k * s + j, c]
            for c in range(5):
                V[c] *= speed
            copy_matrix(ball[at], place)
            t = (nodes[k] + u * h) / speed
            status = system(
                t, 0.0, Q, V, place, 0.0, rate[at], law, law_params, law_state, law_new, scalars, table, work, f, none, none
            )
            if status != 0:
                return k
            for c in range(5):
                total = f[c] - push[at, c]
                for d in range(5):
                    total += speed * speed * mass[c, d] * a[at, d] + damping[c, d] * V[d] + stiffness[c, d] * Q[d]
                out[at, c] = total
    return m
