"""The motion as a series of equilibria: no inertia, no rates.

Notes
-----
Each step starts from the last two equilibria, extrapolated, and ends with the trust region of
``raceway.core.equilibrium``, or, where forces have no potential, with ``raceway.core.root``.  ``coefficients``:
tolerance, and 1 where there is no potential.
"""

import numpy as np

from raceway.core.bodies.columns import keep_slips, work_rows
from raceway.core.bodies.ring import stop
from raceway.core.equilibrium import settle
from raceway.core.integrators import note_step, outer_force
from raceway.core.jit import jit
from raceway.core.root import find_root
from raceway.core.signatures import LOOP


@jit(LOOP, allocates=True)
def quasi_static(
    system, law, force, law_params, scalars, table, force_params, mass, damping, stiffness, free, load, coefficients,
    dt, ramp, first, count, motion, ball, ball_before, law_state, stride, rows, probes, counters,
):  # fmt: skip
    """See ``raceway.core.integrators``; motion[1] is not a velocity here but the change over the last step."""
    z = ball.shape[0]
    work = np.zeros((work_rows(scalars, table), 2 * z))
    f, K = np.empty(5), np.empty((5, 5))
    q, total, outer, time, report = np.empty(5), np.empty(5), np.empty(5), np.empty(1), np.zeros(2)
    trial = np.empty_like(ball)
    still = motion.copy()
    C, rest, known, law_new = np.empty((5, 5)), np.zeros(5), np.zeros_like(ball), law_state.copy()
    for step in range(count):
        number = first + step + 1
        time[0] = number * dt
        outer_force(force, time[0], force_params, ramp, outer)
        for i in range(5):
            q[i] = motion[0, i] + motion[1, i]
            total[i] = load[i] + outer[i]
        for k in range(z):
            for c in range(ball.shape[1]):
                trial[k, c] = ball[k, c]
        if coefficients[1] == 0.0:
            status = settle(
                system, law, law_params, scalars, table, stiffness, free, total, coefficients[0], time[0], q, trial,
                law_state, work, f, K, report,
            )  # fmt: skip
        else:
            status = find_root(
                system, law, law_params, scalars, table, stiffness, free, total, coefficients[0], time[0], q, trial,
                law_state, work, f, K, report,
            )  # fmt: skip
        counters[0] += report[0] + 1.0
        if status != 0:
            counters[1] = 1.0 if status == 2 else (3.0 if status >= 3 else 2.0)
            counters[2] = report[1]
            return step
        if law_state.shape[1] > 0:
            # One more evaluation hands out the law's memory of this equilibrium: no rates, no step of time.
            now, places = scalars.copy(), table.copy()
            stop(time[0], now, places)
            keep_slips(scalars, ball, known)
            law_new[:, :] = law_state
            if (
                system(
                    time[0], 0.0, q, rest, trial, 0.0, known, law, law_params, law_state, law_new, now, places, work, f, K, C
                )
                != 0
            ):
                counters[1] = 1.0
                return step
            law_state[:, :] = law_new
        for i in range(5):
            motion[1, i] = q[i] - motion[0, i]
            motion[0, i] = q[i]
            still[0, i] = q[i]
        for k in range(z):
            for c in range(ball.shape[1]):
                ball_before[k, c], ball[k, c] = ball[k, c], trial[k, c]
        note_step(number, rows, probes, stride, time, still, outer, work, ball, counters)
    return count
