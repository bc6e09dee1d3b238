"""What a path lacks at the ends of its intervals when the balance of forces is integrated with more points."""

from typing import Any, NamedTuple

import numpy as np
from numba import float64, int64, void

from raceway.core.jit import jit
from raceway.core.periodic.arrays import EQUATIONS, INDICES, MESH, SAMPLES, Mesh
from raceway.core.periodic.intervals import state_at
from raceway.core.ring.dense import copy_matrix
from raceway.core.ring.kernels.columns import work_rows
from raceway.core.signatures import FORCE_POINTER, MATRIX, VECTOR, Balls, Contacts, Response, record


class Excitation(NamedTuple):
    """Excitation with its parameters (k,), the share of it that acts, and the speed of its own clock [rad/s]."""

    force: Any
    params: np.ndarray
    share: float
    clock: float


EXCITATION = record(Excitation, FORCE_POINTER, VECTOR, float64, float64)


@jit(void(EQUATIONS, MATRIX, VECTOR, VECTOR, VECTOR, VECTOR, VECTOR))
def acceleration_of(equations, inverse, q, v, push, f, out):
    """out (n,): second derivatives by the angle of the unknowns, which balance the forces; ``inverse`` (n, n) of the mass.

    f (5,), at first the contacts' forces, becomes what is left of the others.
    """
    linear, free, speed = equations.linear, equations.free, equations.speed
    n = free.size
    for r in range(n):
        c = free[r]
        total = push[c] - f[c]
        for d in range(5):
            total -= linear.damping[c, d] * v[d] + linear.stiffness[c, d] * q[d]
        f[c] = total
    for r in range(n):
        out[r] = 0.0
        for j in range(n):
            out[r] += inverse[r, j] * f[free[j]]
        out[r] /= speed * speed


@jit(int64(EQUATIONS, EXCITATION, MATRIX, MESH, MATRIX, SAMPLES, MATRIX), allocates=True)
def try_between(equations, excitation, inverse, mesh, tried, samples, defect):
    """defect (m, 2 n): what q and v at the end of each interval gain; the number of intervals done, less than m at a failure.

    Parameters
    ----------
    inverse : (n, n) of the mass
    tried : ``Rule.try_packed``;  ``samples.rate`` : (m e, Z, c) [m/s] at the e points of an interval that are tried
    """
    forces, free = equations.forces, equations.free
    constants, load = forces.constants, equations.linear.load
    m, s, n = mesh.nodes.size - 1, mesh.rule.shape[1], free.size
    e, trial = tried.shape[1] - s, Mesh(mesh.nodes, tried)
    work = np.zeros((work_rows(constants.scalars, constants.table), 2 * constants.table.shape[0]))
    response = Response(np.empty(5), np.empty((0, 0)), np.empty((0, 0)), work)
    contacts = Contacts(forces.law, forces.law_params, equations.memory, equations.memory.copy(), 0.0)
    q, v, push, acceleration = np.empty(5), np.empty(5), np.empty(5), np.empty(n)
    place = np.empty((constants.table.shape[0], samples.ball.shape[2]))
    for k in range(m):
        h = mesh.nodes[k + 1] - mesh.nodes[k]
        for i in range(2 * n):
            defect[k, i] = 0.0
        for i in range(s):
            for r in range(n):
                value = samples.a[k * s + i, free[r]]
                defect[k, r] += h * h * (tried[2 * e + 1, i] - mesh.rule[2 * s + 1, i]) * value
                defect[k, n + r] += h * (tried[2 * e, i] - mesh.rule[2 * s, i]) * value
        for i in range(e):
            u = tried[2 * e + 2, i]
            t = state_at(trial, samples, k, i, equations.speed, q, v)
            copy_matrix(samples.ball[k * s + min(s - 1, int64(u * s))], place)
            if forces.system(t, q, v, Balls(place, 0.0, samples.rate[k * e + i]), contacts, constants, response) != 0:
                return k
            excitation.force((mesh.nodes[k] + u * h) / excitation.clock, excitation.params, push)
            for c in range(5):
                push[c] = load[c] + excitation.share * push[c]
            acceleration_of(equations, inverse, q, v, push, response.f, acceleration)
            for r in range(n):
                defect[k, r] += h * h * tried[2 * e + 1, s + i] * acceleration[r]
                defect[k, n + r] += h * tried[2 * e, s + i] * acceleration[r]
    return m


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
