"""The motion as a series of equilibria: no inertia, no rates.

Notes
-----
Each step starts from the last two equilibria, extrapolated, and ends with the trust region of
``raceway.core.ring.equilibrium``; where forces have no potential, ``quasi_static_tangential`` ends it with
``raceway.core.ring.root``.  ``coefficients``: tolerance.
"""

import numpy as np
from numba import boolean, float64, int64, void

from raceway.core.jit import jit
from raceway.core.ring.equilibrium import settle
from raceway.core.ring.kernels.columns import slips_end, work_rows
from raceway.core.ring.kernels.layout import stop
from raceway.core.schemes.compiled import note_step, outer_force
from raceway.core.signatures import FORCE_POINTER, LAW_POINTER, LOOP, MATRIX, SYSTEM_POINTER, VECTOR


@jit(void(FORCE_POINTER, float64, VECTOR, float64, VECTOR, MATRIX, MATRIX, VECTOR, VECTOR, VECTOR, MATRIX))
def extrapolate(force, t, force_params, ramp, load, motion, ball, outer, q, total, trial):
    """First guess of the next equilibrium (q, trial), and its load: ``outer`` of the excitation and in ``total``."""
    outer_force(force, t, force_params, ramp, outer)
    for i in range(5):
        q[i] = motion[0, i] + motion[1, i]
        total[i] = load[i] + outer[i]
    for k in range(ball.shape[0]):
        for c in range(ball.shape[1]):
            trial[k, c] = ball[k, c]


@jit(
    boolean(
        int64, VECTOR, SYSTEM_POINTER, LAW_POINTER, MATRIX, VECTOR, MATRIX, float64, VECTOR, MATRIX, MATRIX, VECTOR, MATRIX,
        MATRIX, MATRIX, MATRIX, MATRIX, MATRIX, VECTOR,
    ),
    allocates=True,
)  # fmt: skip
def accept(
    status, report, system, law, law_params, scalars, table, t, q, trial, work, f, K, motion, still, ball, ball_before,
    law_state, counters,
):  # fmt: skip
    """Commit an equilibrium and the law's memory of it; False, with the reason in ``counters``, where there is none."""
    counters[0] += report[0] + 1.0
    if status != 0:
        counters[1] = 1.0 if status == 2 else (3.0 if status >= 3 else 2.0)
        counters[2] = report[1]
        return False
    if law_state.shape[1] > 0:
        # One more evaluation hands out the law's memory of this equilibrium: no rates, no step of time.
        now, places, law_new = scalars.copy(), table.copy(), law_state.copy()
        stop(t, now, places)
        rest, C, known = np.zeros(5), np.empty((5, 5)), np.zeros_like(ball)
        known[:, 2 : slips_end(scalars, ball)] = ball[:, 2 : slips_end(scalars, ball)]
        if system(t, 0.0, q, rest, trial, 0.0, known, law, law_params, law_state, law_new, now, places, work, f, K, C) != 0:
            counters[1] = 1.0
            return False
        law_state[:, :] = law_new
    for i in range(5):
        motion[1, i] = q[i] - motion[0, i]
        motion[0, i] = q[i]
        still[0, i] = q[i]
    for k in range(ball.shape[0]):
        for c in range(ball.shape[1]):
            ball_before[k, c], ball[k, c] = ball[k, c], trial[k, c]
    return True


@jit(LOOP, allocates=True)
def quasi_static(
    system, law, force, law_params, scalars, table, force_params, mass, damping, stiffness, free, load, coefficients,
    dt, ramp, first, count, motion, ball, ball_before, law_state, stride, rows, probes, counters,
):  # fmt: skip
    """See ``raceway.core.schemes.compiled``; motion[1] is not a velocity here but the change over the last step."""
    work = np.zeros((work_rows(scalars, table), 2 * ball.shape[0]))
    f, K, report, still, trial = np.empty(5), np.empty((5, 5)), np.zeros(2), motion.copy(), np.empty_like(ball)
    q, total, outer, time = np.empty(5), np.empty(5), np.empty(5), np.empty(1)
    for step in range(count):
        number = first + step + 1
        time[0] = number * dt
        extrapolate(force, time[0], force_params, ramp, load, motion, ball, outer, q, total, trial)
        status = settle(
            system, law, law_params, scalars, table, stiffness, free, total, coefficients[0], time[0], q, trial,
            law_state, work, f, K, report,
        )  # fmt: skip
        if not accept(
            status, report, system, law, law_params, scalars, table, time[0], q, trial, work, f, K, motion, still, ball,
            ball_before, law_state, counters,
        ):  # fmt: skip
            return step
        note_step(number, rows, probes, stride, time, still, outer, work, ball, counters)
    return count
