"""Equilibrium where forces have no potential (gyroscopic moments, friction): a damped Newton iteration.

Notes
-----
It starts near the solution: from the equilibrium without those forces, or from the step before.
"""

import numpy as np

from raceway.core.jit import jit
from raceway.core.ring.dense import solve
from raceway.core.ring.kernels.columns import slips_end
from raceway.core.ring.kernels.layout import CAGE, TILT_ARM, stop
from raceway.core.signatures import SETTLE

CONVERGED, NOT_CONVERGED, BALLS_FAILED, NOT_FINITE = range(4)
_LIMIT = 100


@jit(SETTLE, allocates=True)
def find_root(
    system, law, law_params, scalars, table, stiffness, free, load, tolerance, t, q, ball, law_state, work, f, K, report
):
    """Same arguments and result as ``raceway.core.ring.equilibrium.settle``; slips are taken from ``ball`` as committed."""
    if scalars[CAGE] != 0.0:
        scalars, table = scalars.copy(), table.copy()
        stop(t, scalars, table)
    arm = scalars[TILT_ARM]
    # No rates; the columns of slips hold the committed ones.
    rest, known = np.zeros(5), np.zeros_like(ball)
    known[:, 2 : slips_end(scalars, ball)] = ball[:, 2 : slips_end(scalars, ball)]
    law_new = law_state.copy()
    C, J, r, step = np.empty((5, 5)), np.empty((5, 5)), np.empty(5), np.zeros(5)
    weight = np.ones(5)
    weight[3] = 1.0 / arm
    weight[4] = 1.0 / arm
    before, cuts = np.inf, 0
    for iteration in range(_LIMIT):
        status = system(
            t, 0.0, q, rest, ball, 0.0, known, law, law_params, law_state, law_new, scalars, table, work, f, K, C
        )
        norm, scale = 0.0, 0.0
        if status == 0:
            for i in range(work.shape[1]):
                scale += abs(work[2, i])
            for i in range(5):
                total = f[i] - load[i]
                scale += abs(load[i]) * weight[i]
                for j in range(5):
                    total += stiffness[i, j] * q[j]
                r[i] = total * free[i]
                norm = max(norm, abs(r[i]) * weight[i]) if np.isfinite(r[i]) else np.inf
        else:
            norm = np.inf
        report[0] = iteration
        report[1] = norm / max(scale, 1e-300)
        if norm <= tolerance * scale:
            return CONVERGED
        if not norm <= 1.5 * before:
            cuts += 1
            if cuts > 30:
                return BALLS_FAILED if status != 0 else NOT_CONVERGED
            for i in range(5):
                step[i] *= 0.5
                q[i] -= step[i]
            continue
        before = norm
        for i in range(5):
            step[i] = -r[i]
            for j in range(5):
                J[i, j] = (K[i, j] + stiffness[i, j]) * free[i] * free[j]
            if free[i] == 0.0:
                J[i, i] = 1.0
        if not solve(J, step):
            return NOT_CONVERGED
        for i in range(5):
            q[i] += step[i]
    return NOT_CONVERGED
