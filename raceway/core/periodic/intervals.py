"""Interval by interval: the state at a Gauss point, the balance of forces there, and the elimination of its unknowns.

The angle theta = w t is the independent variable, so that displacements and their derivatives by the angle are of one
size: w^2 M q'' + w C q' + K q + f(t, q, w q') = push.  Unknown are q and q' at the start of each interval and the
accelerations A at its Gauss points.  Linearised, an interval's own unknowns are eliminated,
dA = S_y (dq, dq') + S_r + S_p dp, which leaves the transfer (dq, dq')_next = T_y (dq, dq') + T_r + T_p dp; p is a parameter.

n unknown coordinates, m intervals, s points an interval, k the number of an interval.
"""

from typing import NamedTuple

import numpy as np
from numba import boolean, float64, int64, void

from raceway.core.jit import jit
from raceway.core.ring.elimination import copy_matrix, eliminate
from raceway.core.ring.kernels.layout import work_rows
from raceway.core.signatures import (
    CUBE,
    FORCE_POINTER,
    FORCES,
    LINEAR,
    MATRIX,
    RESPONSE,
    VECTOR,
    Balls,
    Contacts,
    Forces,
    Linear,
    Response,
    record,
)

INDICES = int64[::1]


class Equations(NamedTuple):
    """Compiled forces, linear parts, the law's memory (2 Z, m), numbers of unknown coordinates (n,), weight (5,), w [rad/s], dw/dp.

    The weight makes moments forces.
    """

    forces: Forces
    linear: Linear
    memory: np.ndarray
    free: np.ndarray
    weight: np.ndarray
    speed: float
    by_parameter: float


class Mesh(NamedTuple):
    """Angles of the nodes (m + 1,), and ``Rule.packed`` (2 s + 3, s)."""

    nodes: np.ndarray
    rule: np.ndarray


class Samples(NamedTuple):
    """q, v (m + 1, 5) at nodes, a (m s, 5) at Gauss points; there also columns of the balls and their rates (m s, Z, c),
    the outer forces ``push`` (m s, 5), and the derivative of the balance of forces by the parameter at one speed, ``slope`` (m s, 5).
    """

    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    ball: np.ndarray
    rate: np.ndarray
    push: np.ndarray
    slope: np.ndarray


class Eliminated(NamedTuple):
    """stages (m s n, 2 n + 2): S_y, S_r, S_p; transfer (m 2 n, 2 n + 2): T_y, T_r, T_p; span_transfer (2 n, 2 n + 2): of all intervals."""

    stages: np.ndarray
    transfer: np.ndarray
    span_transfer: np.ndarray


class Change(NamedTuple):
    """Corrections of q, v (m + 1, 5) and a (m s, 5)."""

    q: np.ndarray
    v: np.ndarray
    a: np.ndarray


EQUATIONS = record(Equations, FORCES, LINEAR, MATRIX, INDICES, VECTOR, float64, float64)
MESH = record(Mesh, VECTOR, MATRIX)
SAMPLES = record(Samples, MATRIX, MATRIX, MATRIX, CUBE, CUBE, MATRIX, MATRIX)
ELIMINATED = record(Eliminated, MATRIX, MATRIX, MATRIX)
CHANGE = record(Change, MATRIX, MATRIX, MATRIX)

#: Entries of ``report``: largest weighted imbalance at a Gauss point [N], largest weighted jump between intervals [m], greatest
#: internal force [N].
IMBALANCE, JUMP, FORCE = range(3)


class _Local(NamedTuple):
    """Of one interval: state q, v (5,) at a point, its linear system (s n, s n + 2 n + 2), its transfer (2 n, 2 n + 2), and scratch."""

    q: np.ndarray
    v: np.ndarray
    block: np.ndarray
    transfer: np.ndarray
    product: np.ndarray
    memory: np.ndarray
    response: Response


LOCAL = record(_Local, VECTOR, VECTOR, MATRIX, MATRIX, MATRIX, MATRIX, RESPONSE)


@jit(LOCAL(EQUATIONS, MESH), allocates=True)
def local_arrays(equations, mesh):
    constants, n = equations.forces.constants, equations.free.size
    size, columns = mesh.rule.shape[1] * n, 2 * n + 2
    work = np.zeros((work_rows(constants.scalars, constants.table), 2 * constants.table.shape[0]))
    response = Response(np.empty(5), np.empty((5, 5)), np.empty((5, 5)), work)
    block, transfer, product = np.empty((size, size + columns)), np.empty((2 * n, columns)), np.empty((2 * n, columns))
    return _Local(np.empty(5), np.empty(5), block, transfer, product, equations.memory.copy(), response)


@jit(float64(MESH, SAMPLES, int64, int64, float64, VECTOR, VECTOR))
def _state_at(mesh, samples, k, i, speed, q, v):
    """q [m] and v [m/s] (5,) at point i of the mesh's rule in interval k; the time [s]."""
    nodes, rule = mesh
    s, h = rule.shape[1], nodes[k + 1] - nodes[k]
    u = rule[2 * s + 2, i]
    for c in range(5):
        q[c] = samples.q[k, c] + u * h * samples.v[k, c]
        v[c] = samples.v[k, c]
        for j in range(s):
            q[c] += h * h * rule[s + i, j] * samples.a[k * s + j, c]
            v[c] += h * rule[i, j] * samples.a[k * s + j, c]
    for c in range(5):
        v[c] *= speed
    return (nodes[k] + u * h) / speed


@jit(float64(EQUATIONS, SAMPLES, int64, int64, VECTOR, VECTOR, VECTOR))
def _left_over(equations, samples, at, c, q, v, f):
    """Imbalance [N] along coordinate c at Gauss point ``at``: f (5,) are the contacts' forces."""
    linear, speed = equations.linear, equations.speed
    total = f[c] - samples.push[at, c]
    for d in range(5):
        total += (
            speed * speed * linear.mass[c, d] * samples.a[at, d]
            + linear.damping[c, d] * v[d]
            + linear.stiffness[c, d] * q[d]
        )
    return total


@jit(boolean(EQUATIONS, MESH, SAMPLES, int64, LOCAL, VECTOR))
def _linearise(equations, mesh, samples, at, local, report):
    """Rows of the interval's linear system that belong to Gauss point ``at``; False where a force is no number."""
    linear, free, speed, rule = equations.linear, equations.free, equations.speed, mesh.rule
    n, s, block, response = free.size, rule.shape[1], local.block, local.response
    k, i = at // s, at % s
    size, h, u = s * n, mesh.nodes[k + 1] - mesh.nodes[k], rule[2 * s + 2, i]
    for r in range(n):
        row, c = i * n + r, free[r]
        total, slope = _left_over(equations, samples, at, c, local.q, local.v, response.f), samples.slope[at, c]
        if not np.isfinite(total):
            return False
        report[IMBALANCE] = max(report[IMBALANCE], abs(total) * equations.weight[c])
        report[FORCE] = max(report[FORCE], abs(response.f[c]) * equations.weight[c])
        for j in range(n):
            d = free[j]
            by_q, by_v = response.K[c, d] + linear.stiffness[c, d], speed * (response.C[c, d] + linear.damping[c, d])
            inertia = speed * speed * linear.mass[c, d]
            slope += equations.by_parameter / speed * (2.0 * inertia * samples.a[at, d] + by_v * local.v[d] / speed)
            for p in range(s):
                entry = h * rule[i, p] * by_v + h * h * rule[s + i, p] * by_q
                if p == i:
                    entry += inertia
                block[row, p * n + j] = entry
            block[row, size + j] = -by_q
            block[row, size + n + j] = -(by_v + u * h * by_q)
        block[row, size + 2 * n] = -total
        block[row, size + 2 * n + 1] = -slope
    return True


@jit(void(EQUATIONS, MESH, SAMPLES, int64, LOCAL, VECTOR))
def _transfer_of(equations, mesh, samples, k, local, report):
    """Transfer of interval k, and the jump that a path still makes at its end, from the solved linear system."""
    free, rule, transfer, block = equations.free, mesh.rule, local.transfer, local.block
    n, s, h = free.size, rule.shape[1], mesh.nodes[k + 1] - mesh.nodes[k]
    q, v, a = samples.q, samples.v, samples.a
    size, columns = s * n, 2 * n + 2
    for r in range(n):
        c = free[r]
        jump_q, jump_v = q[k, c] + h * v[k, c] - q[k + 1, c], v[k, c] - v[k + 1, c]
        for j in range(columns):
            transfer[r, j], transfer[n + r, j] = 0.0, 0.0
        transfer[r, r], transfer[r, n + r], transfer[n + r, n + r] = 1.0, h, 1.0
        for p in range(s):
            by_q, by_v = h * h * rule[2 * s + 1, p], h * rule[2 * s, p]
            jump_q += by_q * a[k * s + p, c]
            jump_v += by_v * a[k * s + p, c]
            for j in range(columns):
                transfer[r, j] += by_q * block[p * n + r, size + j]
                transfer[n + r, j] += by_v * block[p * n + r, size + j]
        transfer[r, 2 * n] += jump_q
        transfer[n + r, 2 * n] += jump_v
        report[JUMP] = max(report[JUMP], max(abs(jump_q), abs(jump_v)) / equations.weight[c])


@jit(int64(EQUATIONS, MESH, SAMPLES, ELIMINATED, VECTOR), allocates=True)
def condense(equations, mesh, samples, elimination, report):
    """Linearise and eliminate interval by interval; the number of intervals done, less than m at a failure."""
    return condense_interval(equations, mesh, samples, elimination, report, local_arrays(equations, mesh))


@jit(int64(EQUATIONS, MESH, SAMPLES, ELIMINATED, VECTOR, LOCAL))
def condense_interval(equations, mesh, samples, elimination, report, local):
    forces, span_transfer, response = equations.forces, elimination.span_transfer, local.response
    m, s, n = mesh.nodes.size - 1, mesh.rule.shape[1], equations.free.size
    columns = 2 * n + 2
    contacts = Contacts(forces.law, forces.law_params, equations.memory, local.memory, 0.0)
    report[IMBALANCE], report[JUMP], report[FORCE] = 0.0, 0.0, 0.0
    for i in range(2 * n):
        for j in range(columns):
            span_transfer[i, j] = 1.0 if i == j else 0.0
    for k in range(m):
        for i in range(s):
            at = k * s + i
            t = _state_at(mesh, samples, k, i, equations.speed, local.q, local.v)
            balls = Balls(samples.ball[at], 0.0, samples.rate[at])
            if forces.system(t, local.q, local.v, balls, contacts, forces.constants, response) != 0:
                return k
            if not _linearise(equations, mesh, samples, at, local, report):
                return k
        if not eliminate(local.block):
            return k
        _transfer_of(equations, mesh, samples, k, local, report)
        # What interval k leaves, and the transfer of those before times its own
        stages, transfer, span_transfer = elimination
        product = local.product
        size = local.block.shape[0]
        states, columns = span_transfer.shape[0], span_transfer.shape[1]
        for i in range(size):
            for j in range(columns):
                stages[k * size + i, j] = local.block[i, size + j]
        for i in range(states):
            for j in range(columns):
                transfer[k * states + i, j] = local.transfer[i, j]
                product[i, j] = local.transfer[i, j] if j >= states else 0.0
            for p in range(states):
                for j in range(columns):
                    product[i, j] += local.transfer[i, p] * span_transfer[p, j]
        copy_matrix(product, span_transfer)
    return m


@jit(int64(EQUATIONS, MESH, SAMPLES, MATRIX), allocates=True)
def imbalances(equations, mesh, samples, out):
    """out (m s, 5): what is left of the balance of forces at the Gauss points [N, N m]; balls are left as they are."""
    forces = equations.forces
    constants = forces.constants
    m, s = mesh.nodes.size - 1, mesh.rule.shape[1]
    work = np.zeros((work_rows(constants.scalars, constants.table), 2 * constants.table.shape[0]))
    response = Response(np.empty(5), np.empty((0, 0)), np.empty((0, 0)), work)
    contacts = Contacts(forces.law, forces.law_params, equations.memory, equations.memory.copy(), 0.0)
    q, v, ball = np.empty(5), np.empty(5), np.empty((constants.table.shape[0], samples.ball.shape[2]))
    for k in range(m):
        for i in range(s):
            at = k * s + i
            t = _state_at(mesh, samples, k, i, equations.speed, q, v)
            copy_matrix(samples.ball[at], ball)
            if forces.system(t, q, v, Balls(ball, 0.0, samples.rate[at]), contacts, constants, response) != 0:
                return k
            for c in range(5):
                out[at, c] = _left_over(equations, samples, at, c, q, v, response.f)
    return m


@jit(void(FORCE_POINTER, VECTOR, VECTOR, MATRIX), allocates=True)
def forces(force, params, times, out):
    """out (n, 5): the excitation at times (n,)."""
    for i in range(times.size):
        force(times[i], params, out[i])


@jit(void(INDICES, ELIMINATED, VECTOR, float64, CHANGE))
def spread(free, elimination, first, parameter, change):
    """The change of a path that the change first (2 n,) of its first state and that of the parameter make."""
    stages, transfer, _ = elimination
    dq, dv, da = change
    n, m = free.size, dq.shape[0] - 1
    s = stages.shape[0] // (m * n)
    for r in range(n):
        dq[0, free[r]], dv[0, free[r]] = first[r], first[n + r]
    for row in range(transfer.shape[0]):
        k, i = row // (2 * n), row % (2 * n)
        total = transfer[row, 2 * n] + transfer[row, 2 * n + 1] * parameter
        for r in range(n):
            total += transfer[row, r] * dq[k, free[r]] + transfer[row, n + r] * dv[k, free[r]]
        if i < n:
            dq[k + 1, free[i]] = total
        else:
            dv[k + 1, free[i - n]] = total
    for row in range(stages.shape[0]):
        k, i = row // (s * n), row % (s * n)
        total = stages[row, 2 * n] + stages[row, 2 * n + 1] * parameter
        for r in range(n):
            total += stages[row, r] * dq[k, free[r]] + stages[row, n + r] * dv[k, free[r]]
        da[k * s + i // n, free[i % n]] = total


@jit(void(VECTOR, VECTOR, float64, CUBE, CUBE), allocates=True)
def differentiate(nodes, points, speed, ball, rate):
    """rate (m s + 4, Z, r) [m/s] of columns ball (m s + 4, Z, r) that have rates: both with two samples beyond each end.

    The derivative of the polynomial through the s points of an interval and two neighbours on either side; ``nodes`` has an
    interval more at each end, for the places of those neighbours.
    """
    s = points.size
    m = nodes.size - 3
    width = s + 4
    x, w, weights = np.empty(width), np.empty(width), np.empty(width)
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
            for j in range(width):
                weights[j] = w[j] / w[i] / (x[i] - x[j]) if j != i else 0.0
            for ball_number in range(ball.shape[1]):
                for c in range(ball.shape[2]):
                    total = 0.0
                    here = ball[k * s + i, ball_number, c]
                    for j in range(width):
                        total += weights[j] * (ball[k * s + j, ball_number, c] - here)
                    rate[k * s + i, ball_number, c] = total * speed / h
