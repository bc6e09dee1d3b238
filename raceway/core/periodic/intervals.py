"""Interval by interval: the state at a Gauss point, the balance of forces there, and the elimination of its unknowns."""

from typing import NamedTuple

import numpy as np
from numba import boolean, float64, int64, void

from raceway.core.jit import jit
from raceway.core.periodic.arrays import ELIMINATED, EQUATIONS, MESH, SAMPLES
from raceway.core.ring.dense import copy_matrix
from raceway.core.ring.kernels.columns import work_rows
from raceway.core.signatures import MATRIX, RESPONSE, VECTOR, Balls, Contacts, Response, record

#: Entries of ``report``: largest weighted imbalance at a Gauss point [N], largest weighted jump between intervals [m], greatest
#: internal force [N].
IMBALANCE, JUMP, FORCE = range(3)


class Local(NamedTuple):
    """Of one interval: state q, v (5,) at a point, its linear system (s n, s n + 2 n + 2), and its transfer (2 n, 2 n + 2)."""

    q: np.ndarray
    v: np.ndarray
    block: np.ndarray
    transfer: np.ndarray


LOCAL = record(Local, VECTOR, VECTOR, MATRIX, MATRIX)


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


@jit(float64(MESH, SAMPLES, int64, int64, float64, VECTOR, VECTOR))
def state_at(mesh, samples, k, i, speed, q, v):
    """q [m] and v [m/s] (5,) at point i of the mesh's rule in interval k; the time [s]."""
    nodes, rule = mesh
    points, s = (rule.shape[0] - 3) // 2, samples.a.shape[0] // (nodes.size - 1)
    h, u = nodes[k + 1] - nodes[k], rule[2 * points + 2, i]
    for c in range(5):
        q[c] = samples.q[k, c] + u * h * samples.v[k, c]
        v[c] = samples.v[k, c]
        for j in range(s):
            q[c] += h * h * rule[points + i, j] * samples.a[k * s + j, c]
            v[c] += h * rule[i, j] * samples.a[k * s + j, c]
    for c in range(5):
        v[c] *= speed
    return (nodes[k] + u * h) / speed


@jit(float64(EQUATIONS, SAMPLES, int64, int64, VECTOR, VECTOR, VECTOR))
def left_over(equations, samples, at, c, q, v, f):
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


@jit(boolean(EQUATIONS, MESH, SAMPLES, int64, RESPONSE, LOCAL, VECTOR))
def linearise(equations, mesh, samples, at, response, local, report):
    """Rows of the interval's linear system that belong to Gauss point ``at``; False where a force is no number."""
    linear, free, speed, rule = equations.linear, equations.free, equations.speed, mesh.rule
    n, s, block = free.size, rule.shape[1], local.block
    k, i = at // s, at % s
    size, h, u = s * n, mesh.nodes[k + 1] - mesh.nodes[k], rule[2 * s + 2, i]
    for r in range(n):
        row, c = i * n + r, free[r]
        total = left_over(equations, samples, at, c, local.q, local.v, response.f)
        if not np.isfinite(total):
            return False
        report[IMBALANCE] = max(report[IMBALANCE], abs(total) * equations.weight[c])
        report[FORCE] = max(report[FORCE], abs(response.f[c]) * equations.weight[c])
        for j in range(n):
            d = free[j]
            by_q, by_v = response.K[c, d] + linear.stiffness[c, d], speed * (response.C[c, d] + linear.damping[c, d])
            inertia = speed * speed * linear.mass[c, d]
            for p in range(s):
                entry = h * rule[i, p] * by_v + h * h * rule[s + i, p] * by_q
                if p == i:
                    entry += inertia
                block[row, p * n + j] = entry
            block[row, size + j] = -by_q
            block[row, size + n + j] = -(by_v + u * h * by_q)
        block[row, size + 2 * n] = -total
        block[row, size + 2 * n + 1] = -samples.slope[at, c]
    return True


@jit(void(EQUATIONS, MESH, SAMPLES, int64, LOCAL, VECTOR))
def transfer_of(equations, mesh, samples, k, local, report):
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


@jit(void(LOCAL, int64, ELIMINATED, MATRIX))
def carry_on(local, k, eliminated, product):
    """Keep what interval k leaves, and multiply the transfer of those before by its own; ``product`` is scratch."""
    stages, transfer, whole = eliminated
    size = local.block.shape[0]
    states, columns = whole.shape[0], whole.shape[1]
    for i in range(size):
        for j in range(columns):
            stages[k * size + i, j] = local.block[i, size + j]
    for i in range(states):
        for j in range(columns):
            transfer[k * states + i, j] = local.transfer[i, j]
            total = local.transfer[i, j] if j >= states else 0.0
            for p in range(states):
                total += local.transfer[i, p] * whole[p, j]
            product[i, j] = total
    copy_matrix(product, whole)


@jit(int64(EQUATIONS, MESH, SAMPLES, ELIMINATED, VECTOR), allocates=True)
def condense(equations, mesh, samples, eliminated, report):
    """Linearise and eliminate interval by interval; the number of intervals done, less than m at a failure."""
    forces, whole = equations.forces, eliminated.whole
    constants = forces.constants
    m, s, n = mesh.nodes.size - 1, mesh.rule.shape[1], equations.free.size
    size, columns = s * n, 2 * n + 2
    work = np.zeros((work_rows(constants.scalars, constants.table), 2 * constants.table.shape[0]))
    response = Response(np.empty(5), np.empty((5, 5)), np.empty((5, 5)), work)
    contacts = Contacts(forces.law, forces.law_params, equations.memory, equations.memory.copy(), 0.0)
    local = Local(np.empty(5), np.empty(5), np.empty((size, size + columns)), np.empty((2 * n, columns)))
    product = np.empty((2 * n, columns))
    report[IMBALANCE], report[JUMP], report[FORCE] = 0.0, 0.0, 0.0
    for i in range(2 * n):
        for j in range(columns):
            whole[i, j] = 1.0 if i == j else 0.0
    for k in range(m):
        for i in range(s):
            at = k * s + i
            t = state_at(mesh, samples, k, i, equations.speed, local.q, local.v)
            balls = Balls(samples.ball[at], 0.0, samples.rate[at])
            if forces.system(t, local.q, local.v, balls, contacts, constants, response) != 0:
                return k
            if not linearise(equations, mesh, samples, at, response, local, report):
                return k
        if not eliminate(local.block, size, columns):
            return k
        transfer_of(equations, mesh, samples, k, local, report)
        carry_on(local, k, eliminated, product)
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
    q, v, place = np.empty(5), np.empty(5), np.empty((constants.table.shape[0], samples.ball.shape[2]))
    for k in range(m):
        for i in range(s):
            at = k * s + i
            t = state_at(mesh, samples, k, i, equations.speed, q, v)
            copy_matrix(samples.ball[at], place)
            if forces.system(t, q, v, Balls(place, 0.0, samples.rate[at]), contacts, constants, response) != 0:
                return k
            for c in range(5):
                out[at, c] = left_over(equations, samples, at, c, q, v, response.f)
    return m
