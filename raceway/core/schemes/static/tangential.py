"""The motion as a series of equilibria of forces without a potential: friction, gyroscopic moments of the balls."""

import numpy as np

from raceway.core.jit import jit
from raceway.core.ring.kernels.columns import work_rows
from raceway.core.ring.root import find_root
from raceway.core.schemes.compiled import note_step
from raceway.core.schemes.static.compiled import accept, extrapolate
from raceway.core.signatures import LOOP


@jit(LOOP, allocates=True)
def quasi_static_tangential(
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
        status = find_root(
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
