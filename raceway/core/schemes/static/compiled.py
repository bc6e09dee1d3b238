"""The motion as a series of equilibria: no inertia, no rates.

Notes
-----
Each step starts from the last two equilibria, extrapolated, and ends with a solver of ``raceway.core.ring``: the trust region of
``equilibrium``, or ``root`` where forces have no potential.  ``coefficients``: tolerance.
"""

from functools import cache

import numpy as np
from numba import boolean, float64, int64, void

from raceway.core.jit import Kernel, jit
from raceway.core.ring.dense import copy_matrix
from raceway.core.ring.equilibrium import BALLS_FAILED, CONVERGED, ITERATIONS, NOT_FINITE
from raceway.core.ring.equilibrium import RESIDUAL as LEFT
from raceway.core.ring.kernels.columns import keep_slips, work_rows
from raceway.core.ring.kernels.layout import stop
from raceway.core.schemes.compiled import BALLS, EVALUATIONS, NEWTON, REASON, RESIDUAL, UNBOUNDED, note_step, outer_force
from raceway.core.signatures import (
    FORCES,
    LOOP,
    MATRIX,
    OUTER,
    RESPONSE,
    REST,
    STATE,
    VECTOR,
    Balls,
    Constants,
    Contacts,
    Linear,
    Response,
    Rest,
)


@jit(void(OUTER, float64, VECTOR, STATE, VECTOR, REST, VECTOR))
def extrapolate(outer, t, load, state, push, rest, total):
    """First guess ``rest`` of the next equilibrium, and its load ``total`` (5,): the constant one and ``push`` (5,) at time t."""
    outer_force(outer, t, push)
    for i in range(5):
        rest.q[i] = state.motion[0, i] + state.motion[1, i]
        total[i] = load[i] + push[i]
    copy_matrix(state.ball, rest.ball)


@jit(boolean(FORCES, float64, REST, MATRIX, RESPONSE), allocates=True)
def remember(forces, t, rest, before, response):
    """Commit the law's memory of an equilibrium after the balls' places ``before``; False where the balls find no place.

    One more evaluation hands it out: no rates, no step of time.
    """
    constants = Constants(forces.constants.scalars.copy(), forces.constants.table.copy())
    stop(t, constants.scalars, constants.table)
    known = np.empty_like(rest.ball)
    keep_slips(constants.scalars, before, known)
    contacts = Contacts(forces.law, forces.law_params, rest.memory, rest.memory.copy(), 0.0)
    if forces.system(t, rest.q, np.zeros(5), Balls(rest.ball, 0.0, known), contacts, constants, response) != 0:
        return False
    copy_matrix(contacts.new, rest.memory)
    return True


@jit(void(REST, STATE))
def accept(rest, state):
    """Move the state to an equilibrium; motion[1] is the change over the step."""
    motion, ball, before = state.motion, state.ball, state.ball_before
    for i in range(5):
        motion[1, i] = rest.q[i] - motion[0, i]
        motion[0, i] = rest.q[i]
    copy_matrix(ball, before)
    copy_matrix(rest.ball, ball)


@jit(float64(int64))
def reason_of(status):
    """Why a loop ends, of what a solver says."""
    if status == BALLS_FAILED:
        return BALLS
    return UNBOUNDED if status >= NOT_FINITE else NEWTON


@cache
def quasi_static(solver: Kernel) -> Kernel:
    """The loop around a kernel of signature ``SETTLE``, which finds an equilibrium."""

    @jit(LOOP, allocates=True)
    def equilibria(forces, linear, outer, coefficients, steps, state, recording):
        # See ``raceway.core.schemes.compiled``; motion[1] is not a velocity here but the change over the last step.
        constants, counters = forces.constants, recording.counters
        work = np.zeros((work_rows(constants.scalars, constants.table), 2 * constants.table.shape[0]))
        response = Response(np.empty(5), np.empty((5, 5)), np.empty((5, 5)), work)
        report, push, total, still = np.zeros(2), np.empty(5), np.empty(5), state.motion.copy()
        loaded = Linear(linear.mass, linear.damping, linear.stiffness, linear.free, total)
        rest = Rest(np.empty(5), np.empty_like(state.ball), state.memory)
        for step in range(steps.total):
            number = steps.first + step + 1
            t = number * steps.dt
            extrapolate(outer, t, linear.load, state, push, rest, total)
            status = solver(forces, loaded, coefficients[0], t, rest, response, report)
            counters[EVALUATIONS] += report[ITERATIONS] + 1.0
            if status != CONVERGED:
                counters[REASON], counters[RESIDUAL] = reason_of(status), report[LEFT]
                return step
            if state.memory.shape[1] > 0 and not remember(forces, t, rest, state.ball, response):
                counters[REASON] = BALLS
                return step
            accept(rest, state)
            for i in range(5):
                still[0, i] = rest.q[i]
            note_step(recording, number, t, still, push, work, state.ball)
        return steps.total

    return equilibria
