"""The compiled loop; equations in ``raceway.core.schemes.explicit``."""

import numpy as np

from raceway.core.jit import jit
from raceway.core.ring.dense import solve
from raceway.core.ring.kernels.columns import accept_balls, next_balls, work_rows
from raceway.core.schemes.compiled import note_step, outer_force
from raceway.core.signatures import LOOP


@jit(LOOP, allocates=True)
def central_difference(
    system, law, force, law_params, scalars, table, force_params, mass, damping, stiffness, free, load, coefficients,
    dt, ramp, first, count, motion, ball, ball_before, law_state, stride, rows, probes, counters,
):  # fmt: skip
    """See ``raceway.core.schemes.compiled``."""
    z = ball.shape[0]
    work = np.zeros((work_rows(scalars, table), 2 * z))
    # No tangents are asked for.
    f, K, C = np.empty(5), np.empty((0, 0)), np.empty((0, 0))
    q, half, guess, a, outer, time = np.empty(5), np.empty(5), np.empty(5), np.empty(5), np.empty(5), np.empty(1)
    known, trial = np.empty_like(ball), np.empty_like(ball)
    law_new = law_state.copy()
    gain = 1.5 / dt
    next_balls(scalars, dt, ball, ball_before, known, trial)
    inverse = np.zeros((5, 5))
    for column in range(5):
        J, rhs = np.zeros((5, 5)), np.zeros(5)
        for i in range(5):
            for j in range(5):
                J[i, j] = (mass[i, j] + 0.5 * dt * damping[i, j]) * free[i] * free[j]
            if free[i] == 0.0:
                J[i, i] = 1.0
        rhs[column] = free[column]
        if not solve(J, rhs):
            counters[1] = 2.0
            return 0
        for i in range(5):
            inverse[i, column] = rhs[i]
    # A bearing alone has no linear damping and stiffness at all.
    linear = damping.any() or stiffness.any()
    taken = 0
    while taken < count:
        number = first + taken + 1
        t = number * dt
        time[0] = t
        outer_force(force, t, force_params, ramp, outer)
        for i in range(5):
            q0, v0, a0 = motion[0, i], motion[1, i], motion[2, i]
            half[i], guess[i], q[i] = v0 + 0.5 * dt * a0, v0 + dt * a0, q0 + dt * (v0 + 0.5 * dt * a0)
        counters[0] += 1.0
        status = system(
            t, dt, q, guess, trial, gain, known, law, law_params, law_state, law_new, scalars, table, work, f, K, C
        )
        if status != 0:
            counters[1] = 1.0
            break
        for i in range(5):
            f[i] = load[i] + outer[i] - f[i]
        if linear:
            for i in range(5):
                rest = f[i]
                for j in range(5):
                    rest -= damping[i, j] * half[j] + stiffness[i, j] * q[j]
                f[i] = rest
        bounded = True
        for i in range(5):
            total = 0.0
            for j in range(5):
                total += inverse[i, j] * f[j]
            a[i] = total
            if not abs(q[i]) < 1.0 or not np.isfinite(total):
                bounded = False
        if not bounded:
            counters[1] = 3.0
            break
        for i in range(5):
            motion[0, i], motion[1, i], motion[2, i] = q[i], half[i] + 0.5 * dt * a[i], a[i]
        accept_balls(scalars, dt, ball, ball_before, known, trial)
        if law_state.size > 0:
            for i in range(law_state.shape[0]):
                for j in range(law_state.shape[1]):
                    law_state[i, j] = law_new[i, j]
        note_step(number, rows, probes, stride, time, motion, outer, work, ball, counters)
        taken += 1
    if taken > 0:
        for i in range(5):
            motion[3, i] = 0.0
            for j in range(5):
                motion[3, i] -= mass[i, j] * motion[2, j]
    return taken
