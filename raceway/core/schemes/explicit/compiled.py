"""The compiled loop; equations in ``raceway.core.schemes.explicit``."""

import numpy as np
from numba import boolean, float64, void

from raceway.core.jit import jit
from raceway.core.ring.dense import copy_matrix, solve
from raceway.core.ring.kernels.columns import accept_balls, next_balls, work_rows
from raceway.core.schemes.compiled import BALLS, EVALUATIONS, NEWTON, REASON, UNBOUNDED, note_step, outer_force
from raceway.core.signatures import LINEAR, LOOP, MATRIX, VECTOR, Balls, Contacts, Response


@jit(boolean(LINEAR, float64, MATRIX), allocates=True)
def effective_inverse(linear, dt, inverse):
    """inverse (5, 5) of M + C dt / 2 among the unknowns; False where that is singular."""
    free = linear.free
    for column in range(5):
        J, rhs = np.zeros((5, 5)), np.zeros(5)
        for i in range(5):
            for j in range(5):
                J[i, j] = (linear.mass[i, j] + 0.5 * dt * linear.damping[i, j]) * free[i] * free[j]
            if free[i] == 0.0:
                J[i, i] = 1.0
        rhs[column] = free[column]
        if not solve(J, rhs):
            return False
        for i in range(5):
            inverse[i, column] = rhs[i]
    return True


@jit(void(LINEAR, boolean, VECTOR, VECTOR, VECTOR, VECTOR), inline=True)
def unbalanced(linear, ground, q, half, push, f):
    """f (5,), at first the contacts' force, becomes the force that accelerates; ``ground``: whether damping or stiffness act."""
    for i in range(5):
        f[i] = linear.load[i] + push[i] - f[i]
    if not ground:
        return
    for i in range(5):
        rest = f[i]
        for j in range(5):
            rest -= linear.damping[i, j] * half[j] + linear.stiffness[i, j] * q[j]
        f[i] = rest


@jit(boolean(MATRIX, VECTOR, VECTOR, VECTOR), inline=True)
def accelerate(inverse, f, q, a):
    """a (5,) of the force f (5,); whether it and the displacement q (5,) are bounded."""
    bounded = True
    for i in range(5):
        total = 0.0
        for j in range(5):
            total += inverse[i, j] * f[j]
        a[i] = total
        if not abs(q[i]) < 1.0 or not np.isfinite(total):
            bounded = False
    return bounded


@jit(LOOP, allocates=True)
def central_difference(forces, linear, outer, coefficients, steps, state, recording):
    """See ``raceway.core.schemes.compiled``."""
    dt, constants, motion, counters = steps.dt, forces.constants, state.motion, recording.counters
    work = np.zeros((work_rows(constants.scalars, constants.table), 2 * constants.table.shape[0]))
    # No tangents are asked for.
    response = Response(np.empty(5), np.empty((0, 0)), np.empty((0, 0)), work)
    q, half, guess, a, push = np.empty(5), np.empty(5), np.empty(5), np.empty(5), np.empty(5)
    balls = Balls(np.empty_like(state.ball), 1.5 / dt, np.empty_like(state.ball))
    contacts = Contacts(forces.law, forces.law_params, state.memory, state.memory.copy(), dt)
    next_balls(constants.scalars, dt, state.ball, state.ball_before, balls.known, balls.place)
    inverse = np.zeros((5, 5))
    if not effective_inverse(linear, dt, inverse):
        counters[REASON] = NEWTON
        return 0
    # A bearing alone has no linear damping and stiffness at all.
    ground, taken = linear.damping.any() or linear.stiffness.any(), 0
    while taken < steps.total:
        number = steps.first + taken + 1
        t = number * dt
        outer_force(outer, t, push)
        for i in range(5):
            q0, v0, a0 = motion[0, i], motion[1, i], motion[2, i]
            half[i], guess[i], q[i] = v0 + 0.5 * dt * a0, v0 + dt * a0, q0 + dt * (v0 + 0.5 * dt * a0)
        counters[EVALUATIONS] += 1.0
        if forces.system(t, q, guess, balls, contacts, constants, response) != 0:
            counters[REASON] = BALLS
            break
        unbalanced(linear, ground, q, half, push, response.f)
        if not accelerate(inverse, response.f, q, a):
            counters[REASON] = UNBOUNDED
            break
        for i in range(5):
            motion[0, i], motion[1, i], motion[2, i] = q[i], half[i] + 0.5 * dt * a[i], a[i]
        accept_balls(constants.scalars, dt, state.ball, state.ball_before, balls.known, balls.place)
        copy_matrix(contacts.new, state.memory)
        note_step(recording, number, t, motion, push, work, state.ball)
        taken += 1
    if taken > 0:
        for i in range(5):
            motion[3, i] = 0.0
            for j in range(5):
                motion[3, i] -= linear.mass[i, j] * motion[2, j]
    return taken
