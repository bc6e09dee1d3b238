"""The compiled loop; equations in ``raceway.core.schemes.one_step``.  ``coefficients``: am, af, beta, gamma, tolerance."""

import numpy as np

from raceway.core.jit import jit
from raceway.core.ring.dense import solve
from raceway.core.ring.kernels.columns import accept_balls, next_balls, work_rows
from raceway.core.ring.kernels.layout import TILT_ARM
from raceway.core.schemes.compiled import note_step, outer_force
from raceway.core.signatures import LOOP

_NEWTON_LIMIT = 40
#: A force that is none [N]: a motion that has died out is not resolved further.
_NOTHING = 1e-30


@jit(LOOP, allocates=True)
def implicit(
    system, law, force, law_params, scalars, table, force_params, mass, damping, stiffness, free, load, coefficients,
    dt, ramp, first, count, motion, ball, ball_before, law_state, stride, rows, probes, counters,
):  # fmt: skip
    """See ``raceway.core.schemes.compiled``."""
    am, af, beta, gamma, tolerance = (
        coefficients[0], coefficients[1], coefficients[2], coefficients[3], coefficients[4],
    )  # fmt: skip
    z = ball.shape[0]
    arm = scalars[TILT_ARM]
    work = np.zeros((work_rows(scalars, table), 2 * z))
    f, K, C, J = np.empty(5), np.empty((5, 5)), np.empty((5, 5)), np.empty((5, 5))
    q, v, a, r, dq, outer, time = (
        np.empty(5), np.empty(5), np.empty(5), np.empty(5), np.zeros(5), np.empty(5), np.empty(1),
    )  # fmt: skip
    residual = np.empty(5)
    known, trial = np.empty_like(ball), np.empty_like(ball)
    law_new = law_state.copy()
    to_a = 1.0 / (beta * dt * dt)
    to_v = gamma / (beta * dt)
    gain = 1.5 / dt
    next_balls(scalars, dt, ball, ball_before, known, trial)
    for step in range(count):
        number = first + step + 1
        t = number * dt
        time[0] = t
        outer_force(force, t, force_params, ramp, outer)
        for i in range(5):
            # Start from constant acceleration.
            q[i] = motion[0, i] + dt * motion[1, i] + 0.5 * dt * dt * motion[2, i]
        norm_before = np.inf
        found = False
        halvings = 0
        norm = np.inf
        for _ in range(_NEWTON_LIMIT):
            for i in range(5):
                predicted = motion[0, i] + dt * motion[1, i] + dt * dt * (0.5 - beta) * motion[2, i]
                a[i] = (q[i] - predicted) * to_a * free[i]
                v[i] = motion[1, i] + dt * ((1.0 - gamma) * motion[2, i] + gamma * a[i])
            counters[0] += 1.0
            status = system(
                t, dt, q, v, trial, gain, known, law, law_params, law_state, law_new, scalars, table, work, f, K, C
            )
            if status != 0:
                counters[1] = 1.0
                return step
            norm, scale = 0.0, 0.0
            for i in range(2 * z):
                scale += abs(work[2, i])
            for i in range(5):
                weight = 1.0 if i < 3 else 1.0 / arm
                rest, inertia, held = f[i] - load[i] - outer[i], 0.0, 0.0
                for j in range(5):
                    rest += damping[i, j] * v[j] + stiffness[i, j] * q[j]
                    inertia += mass[i, j] * ((1.0 - am) * a[j] + am * motion[2, j])
                    held += mass[i, j] * abs(q[j])
                r[i] = rest
                residual[i] = (inertia + (1.0 - af) * rest + af * motion[3, i]) * free[i]
                norm = max(norm, abs(residual[i]) * weight)
                # Below the rounding of the inertia forces nothing can be asked.
                scale = max(scale, abs(outer[i] + load[i]) * weight, abs(inertia) * weight, 1e-6 * held * to_a * weight)
            if not np.isfinite(norm):
                counters[1] = 3.0
                return step
            if norm <= tolerance * scale + _NOTHING:
                found = True
                break
            if norm > 2.0 * norm_before and halvings < 8:
                halvings += 1
                for i in range(5):
                    dq[i] *= 0.5
                    q[i] -= dq[i]
                continue
            halvings = 0
            norm_before = norm
            for i in range(5):
                dq[i] = -residual[i]
                for j in range(5):
                    J[i, j] = (
                        (1.0 - am) * to_a * mass[i, j]
                        + (1.0 - af) * (K[i, j] + stiffness[i, j] + to_v * (C[i, j] + damping[i, j]))
                    ) * free[i] * free[j]  # fmt: skip
            for i in range(5):
                if free[i] == 0.0:
                    J[i, i] = 1.0
            if not solve(J, dq):
                counters[1] = 2.0
                counters[2] = norm
                return step
            for i in range(5):
                q[i] += dq[i]
        if not found:
            counters[1] = 2.0
            counters[2] = norm
            return step
        for i in range(5):
            if not abs(q[i]) < 1.0:
                counters[1] = 3.0
                return step
        for i in range(5):
            motion[0, i], motion[1, i], motion[2, i], motion[3, i] = q[i], v[i], a[i], r[i]
        accept_balls(scalars, dt, ball, ball_before, known, trial)
        if law_state.size > 0:
            for i in range(law_state.shape[0]):
                for j in range(law_state.shape[1]):
                    law_state[i, j] = law_new[i, j]
        note_step(number, rows, probes, stride, time, motion, outer, work, ball, counters)
    return count
