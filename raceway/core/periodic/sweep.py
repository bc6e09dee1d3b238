"""Compiled parts of the collocation that go over all intervals at once; the arrays: ``raceway.core.periodic.arrays``."""

import numpy as np
from numba import float64, int64, void

from raceway.core.jit import jit
from raceway.core.periodic.arrays import CHANGE, ELIMINATED, INDICES
from raceway.core.ring.kernels import CONTACT_FORCE, GAP
from raceway.core.ring.kernels.columns import work_rows
from raceway.core.ring.orbit import STATES
from raceway.core.signatures import CUBE, FORCE_POINTER, FORCES, MATRIX, VECTOR, Balls, Contacts, Response


@jit(void(FORCE_POINTER, VECTOR, VECTOR, MATRIX), allocates=True)
def forces(force, params, times, out):
    """out (n, 5): the excitation at times (n,)."""
    for i in range(times.size):
        force(times[i], params, out[i])


@jit(void(INDICES, ELIMINATED, VECTOR, float64, CHANGE))
def spread(free, eliminated, first, parameter, change):
    """The change of a path that the change first (2 n,) of its first state and that of the parameter make."""
    stages, transfer, _ = eliminated
    dq, dv, da = change
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


@jit(int64(FORCES, MATRIX, STATES, MATRIX, MATRIX), allocates=True)
def contacts(forces, memory, states, gap, force):
    """gap, force (n, 2 Z) at n states; their balls are a guess and become the places.  The number of states done."""
    constants = forces.constants
    work = np.zeros((work_rows(constants.scalars, constants.table), 2 * constants.table.shape[0]))
    response = Response(np.empty(5), np.empty((0, 0)), np.empty((0, 0)), work)
    law = Contacts(forces.law, forces.law_params, memory, memory.copy(), 0.0)
    for i in range(states.times.size):
        balls = Balls(states.ball[i], 0.0, states.rate[i])
        if forces.system(states.times[i], states.q[i], states.v[i], balls, law, constants, response) != 0:
            return i
        for c in range(gap.shape[1]):
            gap[i, c] = work[GAP, c]
            force[i, c] = work[CONTACT_FORCE, c]
    return states.times.size
