"""Equilibrium where forces have no potential (gyroscopic moments, friction): a damped Newton iteration.

Notes
-----
It starts near the solution: from the equilibrium without those forces, or from the step before.
"""

import numpy as np
from numba import boolean, float64

from raceway.core.jit import jit
from raceway.core.ring.dense import solve
from raceway.core.ring.equilibrium import BALLS_FAILED, CONVERGED, ITERATIONS, NOT_CONVERGED, RESIDUAL
from raceway.core.ring.kernels import CONTACT_FORCE
from raceway.core.ring.kernels.columns import keep_slips
from raceway.core.ring.kernels.layout import CAGE, TILT_ARM, stop
from raceway.core.signatures import LINEAR, MATRIX, SETTLE, VECTOR, Balls, Constants, Contacts, Response

_LIMIT = 100
_HALVINGS = 30


@jit(SETTLE, allocates=True)
def find_root(forces, linear, tolerance, t, rest, response, report):
    """Same arguments and result as ``raceway.core.ring.equilibrium.settle``; slips are taken from ``rest`` as committed."""
    constants, q, ball, work = forces.constants, rest.q, rest.ball, response.work
    if constants.scalars[CAGE] != 0.0:
        constants = Constants(constants.scalars.copy(), constants.table.copy())
        stop(t, constants.scalars, constants.table)
    # No rates; the columns of slips hold the committed ones.
    still, known = np.zeros(5), np.empty_like(ball)
    keep_slips(constants.scalars, ball, known)
    contacts = Contacts(forces.law, forces.law_params, rest.memory, rest.memory.copy(), 0.0)
    now = Response(response.f, response.K, np.empty((5, 5)), work)
    J, r, step, weight = np.empty((5, 5)), np.empty(5), np.zeros(5), np.ones(5)
    weight[3] = 1.0 / constants.scalars[TILT_ARM]
    weight[4] = 1.0 / constants.scalars[TILT_ARM]
    before, cuts = np.inf, 0
    for iteration in range(_LIMIT):
        status = forces.system(t, q, still, Balls(ball, 0.0, known), contacts, constants, now)
        norm, scale = np.inf, 0.0
        if status == 0:
            for i in range(work.shape[1]):
                scale += abs(work[CONTACT_FORCE, i])
            for i in range(5):
                scale += abs(linear.load[i]) * weight[i]
            norm = imbalance(linear, now.f, q, weight, r)
        report[ITERATIONS], report[RESIDUAL] = iteration, norm / max(scale, 1e-300)
        if norm <= tolerance * scale:
            return CONVERGED
        if not norm <= 1.5 * before:
            cuts += 1
            if cuts > _HALVINGS:
                return BALLS_FAILED if status != 0 else NOT_CONVERGED
            for i in range(5):
                step[i] *= 0.5
                q[i] -= step[i]
            continue
        before = norm
        if not newton_step(linear, now.K, r, J, step):
            return NOT_CONVERGED
        for i in range(5):
            q[i] += step[i]
    return NOT_CONVERGED


@jit(float64(LINEAR, VECTOR, VECTOR, VECTOR, VECTOR))
def imbalance(linear, f, q, weight, r):
    """r (5,): forces that are left [N, N m]; the largest, by weight (5,), or infinity."""
    norm = 0.0
    for i in range(5):
        total = f[i] - linear.load[i]
        for j in range(5):
            total += linear.stiffness[i, j] * q[j]
        r[i] = total * linear.free[i]
        norm = max(norm, abs(r[i]) * weight[i]) if np.isfinite(r[i]) else np.inf
    return norm


@jit(boolean(LINEAR, MATRIX, VECTOR, MATRIX, VECTOR))
def newton_step(linear, K, r, J, step):
    """step (5,) that the tangent K (5, 5) of the contacts asks for; J (5, 5) is scratch.  False where it is singular."""
    free = linear.free
    for i in range(5):
        step[i] = -r[i]
        for j in range(5):
            J[i, j] = (K[i, j] + linear.stiffness[i, j]) * free[i] * free[j]
        if free[i] == 0.0:
            J[i, i] = 1.0
    return solve(J, step)
