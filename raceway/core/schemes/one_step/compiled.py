"""The compiled loop; equations in ``raceway.core.schemes.one_step``.  ``coefficients``: am, af, beta, gamma, tolerance,
imbalance that is rounding [N]."""

from typing import NamedTuple

import numpy as np
from numba import boolean, float64, types, void

from raceway.core.jit import jit
from raceway.core.ring.dense import copy_matrix, solve
from raceway.core.ring.kernels import CONTACT_FORCE
from raceway.core.ring.kernels.columns import accept_balls, next_balls, work_rows
from raceway.core.ring.kernels.layout import TILT_ARM
from raceway.core.schemes.compiled import (
    BALLS,
    EVALUATIONS,
    EXCITATION,
    NEWTON,
    REASON,
    RESIDUAL,
    UNBOUNDED,
    note_step,
    outer_force,
)
from raceway.core.signatures import LINEAR, LOOP, MATRIX, RESPONSE, VECTOR, Balls, Contacts, Response, record

_NEWTON_LIMIT = 40
_HALVINGS = 8
#: A force that is none [N]: a motion that has died out is not resolved further.
_NOTHING = 1e-30


class Formula(NamedTuple):
    """Numbers of the method, its step [s], and the derivatives of a [1/s^2] and v [1/s] by the displacement at the end."""

    am: float
    af: float
    beta: float
    gamma: float
    dt: float
    to_a: float
    to_v: float


class Trial(NamedTuple):
    """The state at the end of a step as it is known, each (5,): q, v, a, forces but for inertia, imbalance."""

    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    rest: np.ndarray
    residual: np.ndarray


FORMULA = record(Formula, *[float64] * 7)
TRIAL = record(Trial, *[VECTOR] * 5)


@jit(void(FORMULA, VECTOR, MATRIX, TRIAL), inline=True)
def differences(formula, free, motion, trial):
    """v and a at the end of the step from q there and the motion (4, 5) at its begin."""
    dt, beta, gamma = formula.dt, formula.beta, formula.gamma
    for i in range(5):
        predicted = motion[0, i] + dt * motion[1, i] + dt * dt * (0.5 - beta) * motion[2, i]
        trial.a[i] = (trial.q[i] - predicted) * formula.to_a * free[i]
        trial.v[i] = motion[1, i] + dt * ((1.0 - gamma) * motion[2, i] + gamma * trial.a[i])


@jit(types.UniTuple(float64, 3)(FORMULA, LINEAR, MATRIX, TRIAL, RESPONSE, VECTOR, float64), inline=True)
def imbalance(formula, linear, motion, trial, response, push, arm):
    """Largest imbalance [N], inertia force and force of all; fills ``rest`` and ``residual``.  Tilts count by the arm [m]."""
    mass, damping, stiffness, free, load = linear
    q, v, a, rests, residual = trial
    norm, moving, scale = 0.0, 0.0, 0.0
    for i in range(response.work.shape[1]):
        scale += abs(response.work[CONTACT_FORCE, i])
    for i in range(5):
        weight = 1.0 if i < 3 else 1.0 / arm
        rest, inertia, held = response.f[i] - load[i] - push[i], 0.0, 0.0
        for j in range(5):
            rest += damping[i, j] * v[j] + stiffness[i, j] * q[j]
            inertia += mass[i, j] * ((1.0 - formula.am) * a[j] + formula.am * motion[2, j])
            held += mass[i, j] * abs(q[j])
        rests[i] = rest
        residual[i] = (inertia + (1.0 - formula.af) * rest + formula.af * motion[3, i]) * free[i]
        norm = max(norm, abs(residual[i]) * weight)
        # Below the rounding of the inertia forces nothing can be asked.
        moving = max(moving, abs(inertia) * weight, 1e-6 * held * formula.to_a * weight)
        scale = max(scale, abs(push[i] + load[i]) * weight)
    return norm, moving, max(scale, moving)


@jit(boolean(FORMULA, LINEAR, RESPONSE, VECTOR, MATRIX, VECTOR), inline=True)
def newton_step(formula, linear, response, residual, J, dq):
    """dq (5,) that takes the residual away; J (5, 5) is scratch.  False where the matrix is singular."""
    mass, damping, stiffness, free, _ = linear
    for i in range(5):
        dq[i] = -residual[i]
        for j in range(5):
            J[i, j] = (
                (1.0 - formula.am) * formula.to_a * mass[i, j]
                + (1.0 - formula.af)
                * (response.K[i, j] + stiffness[i, j] + formula.to_v * (response.C[i, j] + damping[i, j]))
            ) * free[i] * free[j]  # fmt: skip
    for i in range(5):
        if free[i] == 0.0:
            J[i, i] = 1.0
    return solve(J, dq)


@jit(LOOP, allocates=True)
def implicit(forces, linear, outer, coefficients, steps, state, recording):
    """See ``raceway.core.schemes.compiled``."""
    am, af, beta, gamma, tolerance, rounding = (
        coefficients[0], coefficients[1], coefficients[2], coefficients[3], coefficients[4], coefficients[5],
    )  # fmt: skip
    dt, constants, motion, counters = steps.dt, forces.constants, state.motion, recording.counters
    arm = constants.scalars[TILT_ARM]
    formula = Formula(am, af, beta, gamma, dt, 1.0 / (beta * dt * dt), gamma / (beta * dt))
    trial = Trial(np.empty(5), np.empty(5), np.empty(5), np.empty(5), np.empty(5))
    q, J, dq, push, norm = trial.q, np.empty((5, 5)), np.zeros(5), np.empty(5), np.inf
    balls = Balls(np.empty_like(state.ball), 1.5 / dt, np.empty_like(state.ball))
    contacts = Contacts(forces.law, forces.law_params, state.memory, state.memory.copy(), dt)
    work = np.zeros((work_rows(constants.scalars, constants.table), 2 * constants.table.shape[0]))
    response = Response(np.empty(5), np.empty((5, 5)), np.empty((5, 5)), work)
    next_balls(constants.scalars, dt, state.ball, state.ball_before, balls.known, balls.place)
    for step in range(steps.total):
        number = steps.first + step + 1
        t = number * dt
        outer_force(outer, t, push)
        for i in range(5):
            # Start from constant acceleration.
            counters[EXCITATION] = max(counters[EXCITATION], abs(push[i]) * (1.0 if i < 3 else 1.0 / arm))
            q[i] = motion[0, i] + dt * motion[1, i] + 0.5 * dt * dt * motion[2, i]
        before, halvings, found = np.inf, 0, False
        for _ in range(_NEWTON_LIMIT):
            differences(formula, linear.free, motion, trial)
            counters[EVALUATIONS] += 1.0
            if forces.system(t, q, trial.v, balls, contacts, constants, response) != 0:
                counters[REASON] = BALLS
                return step
            norm, moving, scale = imbalance(formula, linear, motion, trial, response, push, arm)
            if not np.isfinite(norm):
                counters[REASON] = UNBOUNDED
                return step
            enough = tolerance * max(counters[EXCITATION], moving) + rounding + _NOTHING
            # Forces of a law that iterates may be rougher than rounding: what no longer shrinks is measured by the largest of all.
            if norm <= enough or 0.5 * before < norm <= tolerance * scale:
                found = True
                break
            if norm > 2.0 * before and halvings < _HALVINGS:
                halvings += 1
                for i in range(5):
                    dq[i] *= 0.5
                    q[i] -= dq[i]
                continue
            halvings, before = 0, norm
            if not newton_step(formula, linear, response, trial.residual, J, dq):
                break
            for i in range(5):
                q[i] += dq[i]
        if not found:
            counters[REASON], counters[RESIDUAL] = NEWTON, norm
            return step
        for i in range(5):
            if not abs(q[i]) < 1.0:
                counters[REASON] = UNBOUNDED
                return step
        for i in range(5):
            motion[0, i], motion[1, i], motion[2, i], motion[3, i] = q[i], trial.v[i], trial.a[i], trial.rest[i]
        accept_balls(constants.scalars, dt, state.ball, state.ball_before, balls.known, balls.place)
        copy_matrix(contacts.new, state.memory)
        note_step(recording, number, t, motion, push, work, state.ball)
    return steps.total
