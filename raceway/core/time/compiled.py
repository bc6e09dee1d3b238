"""Compiled time loops; their equations stand in ``raceway.core.time``, the classes with the options in ``raceway.integrators``.

Every loop has the signature ``raceway.core.signatures.LOOP``, whose records stand there::

    loop(forces, linear, outer, coefficients, steps, state, recording) -> steps done

    linear         damping holds the gyroscopic terms
    coefficients   the method's own numbers.  ``implicit``: am, af, beta, gamma, tolerance, imbalance that is rounding [N];
                   ``quasi_static``: tolerance
    state          moved on in place, only by accepted steps
    recording      rows (n, 16): t, q, v, outer force; probes (n, 3 to 6, 2 Z): gaps, contact forces, then ``ball`` (Z, 2 to 8) as
                   it is; counters (8,): see ``COUNTERS``

A loop that returns less than ``steps.total`` failed at the next step; ``state`` is then the last good one.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from numba import boolean, float64, int64, types, void

from raceway.core.jit import Kernel, jit
from raceway.core.ring.elimination import copy_matrix, eliminate, solve
from raceway.core.ring.equilibrium import BALLS_FAILED, CONVERGED, ITERATIONS, NOT_FINITE, at_rest
from raceway.core.ring.equilibrium import RESIDUAL as LEFT
from raceway.core.ring.kernels import CONTACT_FORCE as CONTACT_FORCE_ROW
from raceway.core.ring.kernels import GAP
from raceway.core.ring.kernels.layout import TILT_ARM, accept_balls, keep_slips, next_balls, work_rows
from raceway.core.signatures import (
    FORCES,
    LINEAR,
    LOOP,
    MATRIX,
    OUTER,
    RECORDING,
    RESPONSE,
    STATIC,
    VECTOR,
    Balls,
    Contacts,
    Linear,
    Response,
    StaticState,
    record,
)

#: evaluations, reason of a failure, residual at the failure, greatest penetration [m], greatest contact force [N], rows
#: recorded, greatest excitation [N].
EVALUATIONS, REASON, RESIDUAL, PENETRATION, CONTACT_FORCE, ROWS, EXCITATION = range(7)
COUNTERS = 8
NO_FAILURE, BALLS, NEWTON, UNBOUNDED = range(4)


@jit(void(OUTER, float64, VECTOR), inline=True)
def outer_force(outer, t, out):
    """out (5,): the excitation at time t, under a ramp 10 s^3 - 15 s^4 + 6 s^5 (twice continuously differentiable)."""
    outer.force(t, outer.params, out)
    if t < outer.ramp:
        s = max(t / outer.ramp, 0.0)
        for i in range(out.size):
            out[i] *= s * s * s * (10.0 - 15.0 * s + 6.0 * s * s)


@jit(void(RECORDING, int64, float64, MATRIX, VECTOR, MATRIX, MATRIX), inline=True)
def _note_step(recording, number, t, motion, outer, work, ball):
    """Note a step at time t under the outer force (5,), and the extremes in the counters."""
    stride, rows, probes, counters = recording
    n = work.shape[1]
    lowest, largest = -counters[PENETRATION], counters[CONTACT_FORCE]
    for i in range(n):
        lowest, largest = min(lowest, work[GAP, i]), max(largest, work[CONTACT_FORCE_ROW, i])
    counters[PENETRATION], counters[CONTACT_FORCE] = -lowest, largest
    if number % stride != 0:
        return
    row = int64(counters[ROWS])
    if row >= rows.shape[0]:
        return
    counters[ROWS] = row + 1.0
    rows[row, 0] = t
    for i in range(5):
        rows[row, 1 + i] = motion[0, i]
        rows[row, 6 + i] = motion[1, i]
        rows[row, 11 + i] = outer[i]
    for i in range(n):
        probes[row, 0, i] = work[GAP, i]
        probes[row, 1, i] = work[CONTACT_FORCE_ROW, i]
    for k in range(ball.shape[0]):
        for c in range(ball.shape[1]):
            place = k * ball.shape[1] + c
            probes[row, 2 + place // n, place % n] = ball[k, c]


_NEWTON_LIMIT = 40
_HALVINGS = 8
#: Orders of extrapolation of what the tangent leaves of the contacts' forces: 0 keeps it constant.
_ORDERS = 5
#: A force that is none [N]: a motion that has died out is not resolved further.
_NOTHING = 1e-30


class _Formula(NamedTuple):
    """Numbers of the method, its step [s], and the derivatives of a [1/s^2] and v [1/s] by the displacement at the end."""

    am: float
    af: float
    beta: float
    gamma: float
    dt: float
    to_a: float
    to_v: float


class _Trial(NamedTuple):
    """The state at the end of a step as it is known, each (5,): q, v, a, forces but for inertia, imbalance."""

    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    net_force: np.ndarray
    residual: np.ndarray


class _Tangent(NamedTuple):
    """Stiffness and damping of the contacts (5, 5) where forces are linearised, and behind a scratch (5, 5) the step's inverse."""

    K: np.ndarray
    C: np.ndarray
    inverse: np.ndarray


FORMULA = record(_Formula, *[float64] * 7)
TRIAL = record(_Trial, *[VECTOR] * 5)
TANGENT = record(_Tangent, *[MATRIX] * 3)


@jit(void(FORMULA, VECTOR, MATRIX, TRIAL), inline=True)
def _differences(formula, free, motion, trial):
    """v and a at the end of the step from q there and the motion (4, 5) at its begin."""
    dt, beta, gamma = formula.dt, formula.beta, formula.gamma
    for i in range(5):
        prediction = motion[0, i] + dt * motion[1, i] + dt * dt * (0.5 - beta) * motion[2, i]
        trial.a[i] = (trial.q[i] - prediction) * formula.to_a * free[i]
        trial.v[i] = motion[1, i] + dt * ((1.0 - gamma) * motion[2, i] + gamma * trial.a[i])


@jit(types.UniTuple(float64, 3)(FORMULA, LINEAR, MATRIX, TRIAL, RESPONSE, VECTOR, float64), inline=True)
def _imbalance(formula, linear, motion, trial, response, push, arm):
    """Largest imbalance [N], inertia force and force of all; fills ``net_force`` and ``residual``.  Tilts count by the arm [m]."""
    mass, damping, stiffness, free, load = linear
    q, v, a, net_forces, residual = trial
    norm, moving, scale = 0.0, 0.0, 0.0
    for i in range(response.work.shape[1]):
        scale += abs(response.work[CONTACT_FORCE_ROW, i])
    for i in range(5):
        weight = 1.0 if i < 3 else 1.0 / arm
        net_force, inertia, spring_force = response.f[i] - load[i] - push[i], 0.0, 0.0
        for j in range(5):
            net_force += damping[i, j] * v[j] + stiffness[i, j] * q[j]
            inertia += mass[i, j] * ((1.0 - formula.am) * a[j] + formula.am * motion[2, j])
            spring_force += mass[i, j] * abs(q[j])
        net_forces[i] = net_force
        residual[i] = (inertia + (1.0 - formula.af) * net_force + formula.af * motion[3, i]) * free[i]
        norm = max(norm, abs(residual[i]) * weight)
        # Below the rounding of the inertia forces nothing can be asked.
        moving = max(moving, abs(inertia) * weight, 1e-6 * spring_force * formula.to_a * weight)
        scale = max(scale, abs(push[i] + load[i]) * weight)
    return norm, moving, max(scale, moving)


@jit(boolean(FORMULA, LINEAR, RESPONSE, TANGENT, MATRIX, int64), inline=True)
def _linearise(formula, linear, response, tangent, differences, known):
    """Take the tangent of the last evaluation, also in what ``_extend`` has of ``known`` steps; False where it is singular."""
    mass, damping, stiffness, free, _ = linear
    K, C, inverse = tangent
    for k in range(min(known, differences.shape[0])):
        for i in range(5):
            for j in range(5):
                differences[k, 10 + i] -= (response.K[i, j] - K[i, j]) * differences[k, j]
                differences[k, 10 + i] -= (response.C[i, j] - C[i, j]) * differences[k, 5 + j]
    copy_matrix(response.K, K)
    copy_matrix(response.C, C)
    for i in range(5):
        for j in range(5):
            inverse[i, j], inverse[i, 5 + j] = (
                (1.0 - formula.am) * formula.to_a * mass[i, j]
                + (1.0 - formula.af) * (K[i, j] + stiffness[i, j] + formula.to_v * (C[i, j] + damping[i, j]))
            ) * free[i] * free[j], 0.0  # fmt: skip
        inverse[i, 5 + i] = 1.0
        if free[i] == 0.0:
            inverse[i, i] = 1.0
    return eliminate(inverse)


@jit(void(TANGENT, MATRIX, int64, TRIAL, VECTOR), inline=True)
def _foretell(tangent, differences, order, trial, f):
    """f (5,): forces of the contacts at q and v, by the tangent and what it leaves, extrapolated from steps before."""
    for i in range(5):
        force = 0.0
        for k in range(order + 1):
            force += differences[k, 10 + i]
        for j in range(5):
            force += tangent.K[i, j] * trial.q[j] + tangent.C[i, j] * trial.v[j]
        f[i] = force


@jit(void(FORMULA, LINEAR, RESPONSE, VECTOR, VECTOR), inline=True)
def _follow(formula, linear, response, dq, net_force):
    """Forces of the contacts, and of all but inertia, after a last small change of q by dq."""
    for i in range(5):
        for j in range(5):
            own = response.K[i, j] + formula.to_v * response.C[i, j]
            response.f[i] += own * dq[j]
            net_force[i] += (own + linear.stiffness[i, j] + formula.to_v * linear.damping[i, j]) * dq[j]


@jit(int64(TANGENT, MATRIX, int64, TRIAL, VECTOR, float64), inline=True)
def _extend(tangent, differences, known, trial, f, arm):
    """Add a step to ``known`` ones in the backward differences (m, 15) of q, v, and f less the tangent's part.

    Returns the order of extrapolation that would have foretold the latter best.
    """
    rows, best, least = min(known, differences.shape[0] - 1), 0, np.inf
    for i in range(5):
        rest = f[i]
        for j in range(5):
            rest -= tangent.K[i, j] * trial.q[j] + tangent.C[i, j] * trial.v[j]
        q, v = trial.q[i], trial.v[i]
        for k in range(rows + 1):
            q, differences[k, i] = q - differences[k, i], q
            v, differences[k, 5 + i] = v - differences[k, 5 + i], v
            rest, differences[k, 10 + i] = rest - differences[k, 10 + i], rest
    for order in range(rows):
        size = 0.0
        for i in range(5):
            # The difference that an order leaves out is its error.
            size = max(size, abs(differences[order + 1, 10 + i]) * (1.0 if i < 3 else 1.0 / arm))
        if size < least:
            best, least = order, size
    return best


@jit(boolean(TRIAL, MATRIX), inline=True)
def _commit(trial, motion):
    """Move the motion (4, 5) to the end of the step; False, and nothing moved, where that is out of all bounds."""
    for i in range(5):
        if not abs(trial.q[i]) < 1.0:
            return False
    for i in range(5):
        motion[0, i], motion[1, i], motion[2, i], motion[3, i] = trial.q[i], trial.v[i], trial.a[i], trial.net_force[i]
    return True


@jit(LOOP, allocates=True)
def implicit(forces, linear, outer, coefficients, steps, state, recording):
    """See ``raceway.core.time.compiled``."""
    dt, constants, motion, counters = steps.dt, forces.constants, state.motion, recording.counters
    arm, beta, gamma = constants.scalars[TILT_ARM], coefficients[2], coefficients[3]
    formula = _Formula(coefficients[0], coefficients[1], beta, gamma, dt, 1.0 / (beta * dt * dt), gamma / (beta * dt))
    tolerance, rounding = coefficients[4], coefficients[5]
    trial = _Trial(np.empty(5), np.empty(5), np.empty(5), np.empty(5), np.empty(5))
    tangent = _Tangent(np.zeros((5, 5)), np.zeros((5, 5)), np.zeros((5, 10)))
    q, dq, push, norm, order = trial.q, np.zeros(5), np.empty(5), np.inf, 0
    balls = Balls(np.empty_like(state.ball), 1.5 / dt, np.empty_like(state.ball))
    bend, differences = np.zeros_like(state.ball), np.zeros((_ORDERS + 1, 15))
    contacts = Contacts(forces.law, forces.law_params, state.memory, state.memory.copy(), dt)
    work = np.zeros((work_rows(constants.scalars, constants.table), 2 * constants.table.shape[0]))
    response = Response(np.empty(5), np.empty((5, 5)), np.empty((5, 5)), work)
    next_balls(constants.scalars, dt, state.ball, state.ball_before, balls.history, balls.position)
    for step in range(steps.total):
        number = steps.first + step + 1
        t = number * dt
        outer_force(outer, t, push)
        for i in range(5):
            # Start from constant acceleration.
            counters[EXCITATION] = max(counters[EXCITATION], abs(push[i]) * (1.0 if i < 3 else 1.0 / arm))
            q[i] = motion[0, i] + dt * motion[1, i] + 0.5 * dt * dt * motion[2, i]
        before, halvings, in_balance = np.inf, 0, False
        for iteration in range(_NEWTON_LIMIT):
            _differences(formula, linear.free, motion, trial)
            foretold = iteration == 0 and step > 0
            if foretold:
                _foretell(tangent, differences, order, trial, response.f)
            else:
                counters[EVALUATIONS] += 1.0
                if forces.system(t, q, trial.v, balls, contacts, constants, response) != 0:
                    counters[REASON] = BALLS
                    return step
            norm, moving, scale = _imbalance(formula, linear, motion, trial, response, push, arm)
            if not np.isfinite(norm):
                counters[REASON] = UNBOUNDED
                return step
            if not foretold:
                enough = tolerance * max(counters[EXCITATION], moving) + rounding + _NOTHING
                # Forces of a law that iterates may be rougher than rounding: what no longer shrinks is measured by the largest of all.
                in_balance = norm <= enough or 0.5 * before < norm <= tolerance * scale
                if not in_balance and norm > 2.0 * before and halvings < _HALVINGS:
                    halvings += 1
                    for i in range(5):
                        dq[i] *= 0.5
                        q[i] -= dq[i]
                    continue
                halvings, before = 0, norm
                if not in_balance and not _linearise(formula, linear, response, tangent, differences, step):
                    break
            for i in range(5):
                dq[i] = 0.0
                for j in range(5):
                    dq[i] -= tangent.inverse[i, 5 + j] * trial.residual[j]
                q[i] += dq[i]
            if in_balance:
                # The last change is too small to ask for the forces again.
                _differences(formula, linear.free, motion, trial)
                _follow(formula, linear, response, dq, trial.net_force)
                break
        if not in_balance:
            counters[REASON], counters[RESIDUAL] = NEWTON, norm
            return step
        if not _commit(trial, motion):
            counters[REASON] = UNBOUNDED
            return step
        order = _extend(tangent, differences, step, trial, response.f, arm)
        accept_balls(constants.scalars, dt, state.ball, state.ball_before, balls.history, balls.position, bend)
        copy_matrix(contacts.new, state.memory)
        _note_step(recording, number, t, motion, push, work, state.ball)
    return steps.total


@jit(boolean(LINEAR, float64, MATRIX))
def _effective_inverse(linear, dt, J):
    """J (5, 10): (M + C dt / 2) among the unknowns and, behind it, its inverse; False where it is singular."""
    free = linear.free
    for i in range(5):
        for j in range(5):
            J[i, j] = (linear.mass[i, j] + 0.5 * dt * linear.damping[i, j]) * free[i] * free[j]
            J[i, 5 + j] = 0.0
        J[i, 5 + i] = free[i]
        if free[i] == 0.0:
            J[i, i] = 1.0
    return solve(J)


@jit(void(LINEAR, boolean, VECTOR, VECTOR, VECTOR, VECTOR), inline=True)
def _net_force(linear, ground, q, half, push, f):
    """f (5,), at first the contacts' force, becomes the force that accelerates; ``ground``: whether damping or stiffness act."""
    for i in range(5):
        f[i] = linear.load[i] + push[i] - f[i]
    if not ground:
        return
    for i in range(5):
        force = f[i]
        for j in range(5):
            force -= linear.damping[i, j] * half[j] + linear.stiffness[i, j] * q[j]
        f[i] = force


@jit(LOOP, allocates=True)
def central_difference(forces, linear, outer, coefficients, steps, state, recording):
    """See ``raceway.core.time.compiled``."""
    dt, constants, motion, counters = steps.dt, forces.constants, state.motion, recording.counters
    work = np.zeros((work_rows(constants.scalars, constants.table), 2 * constants.table.shape[0]))
    # No tangents are asked for.
    response = Response(np.empty(5), np.empty((0, 0)), np.empty((0, 0)), work)
    q, half, guess, a, push = np.empty(5), np.empty(5), np.empty(5), np.empty(5), np.empty(5)
    balls = Balls(np.empty_like(state.ball), 1.5 / dt, np.empty_like(state.ball))
    contacts = Contacts(forces.law, forces.law_params, state.memory, state.memory.copy(), dt)
    next_balls(constants.scalars, dt, state.ball, state.ball_before, balls.history, balls.position)
    effective, straight = np.empty((5, 10)), np.empty((0, 0))
    if not _effective_inverse(linear, dt, effective):
        counters[REASON] = NEWTON
        return 0
    # A bearing alone has no linear damping and stiffness at all.
    ground, steps_taken = linear.damping.any() or linear.stiffness.any(), 0
    while steps_taken < steps.total:
        number = steps.first + steps_taken + 1
        t = number * dt
        outer_force(outer, t, push)
        for i in range(5):
            q0, v0, a0 = motion[0, i], motion[1, i], motion[2, i]
            half[i], guess[i], q[i] = v0 + 0.5 * dt * a0, v0 + dt * a0, q0 + dt * (v0 + 0.5 * dt * a0)
        counters[EVALUATIONS] += 1.0
        if forces.system(t, q, guess, balls, contacts, constants, response) != 0:
            counters[REASON] = BALLS
            break
        _net_force(linear, ground, q, half, push, response.f)
        # Whether acceleration and displacement are bounded
        finite = True
        for i in range(5):
            total = 0.0
            for j in range(5):
                total += effective[i, 5 + j] * response.f[j]
            a[i] = total
            if not abs(q[i]) < 1.0 or not np.isfinite(total):
                finite = False
        if not finite:
            counters[REASON] = UNBOUNDED
            break
        for i in range(5):
            motion[0, i], motion[1, i], motion[2, i] = q[i], half[i] + 0.5 * dt * a[i], a[i]
        accept_balls(constants.scalars, dt, state.ball, state.ball_before, balls.history, balls.position, straight)
        copy_matrix(contacts.new, state.memory)
        _note_step(recording, number, t, motion, push, work, state.ball)
        steps_taken += 1
    if steps_taken > 0:
        for i in range(5):
            motion[3, i] = 0.0
            for j in range(5):
                motion[3, i] -= linear.mass[i, j] * motion[2, j]
    return steps_taken


@jit(boolean(FORCES, float64, STATIC, MATRIX, RESPONSE), allocates=True)
def _remember(forces, t, equilibrium, before, response):
    """Commit the law's memory of an equilibrium after the balls' places ``before``; False where the balls find no place.

    One more evaluation hands it out: no rates, no step of time.
    """
    constants = at_rest(forces.constants, t)
    history = np.empty_like(equilibrium.ball)
    keep_slips(constants.scalars, before, history)
    contacts = Contacts(forces.law, forces.law_params, equilibrium.memory, equilibrium.memory.copy(), 0.0)
    if (
        forces.system(t, equilibrium.q, np.zeros(5), Balls(equilibrium.ball, 0.0, history), contacts, constants, response)
        != 0
    ):
        return False
    copy_matrix(contacts.new, equilibrium.memory)
    return True


@cache
def quasi_static(solver: Kernel) -> Kernel:
    """The loop around a kernel of signature ``EQUILIBRIUM``, which finds an equilibrium: ``raceway.core.ring.equilibrium``."""

    @jit(LOOP, allocates=True)
    def equilibria(forces, linear, outer, coefficients, steps, state, recording):
        # See ``raceway.core.time.compiled``; motion[1] is not a velocity here but the change over the last step.
        constants, counters = forces.constants, recording.counters
        work = np.zeros((work_rows(constants.scalars, constants.table), 2 * constants.table.shape[0]))
        response = Response(np.empty(5), np.empty((5, 5)), np.empty((5, 5)), work)
        report, push, total, still = np.zeros(2), np.empty(5), np.empty(5), state.motion.copy()
        under_load = Linear(linear.mass, linear.damping, linear.stiffness, linear.free, total)
        equilibrium = StaticState(np.empty(5), np.empty_like(state.ball), state.memory)
        for step in range(steps.total):
            number = steps.first + step + 1
            t = number * steps.dt
            # First guess of the next equilibrium, and its load
            outer_force(outer, t, push)
            for i in range(5):
                equilibrium.q[i] = state.motion[0, i] + state.motion[1, i]
                total[i] = linear.load[i] + push[i]
            copy_matrix(state.ball, equilibrium.ball)
            status = solver(forces, under_load, coefficients[0], t, equilibrium, response, report)
            counters[EVALUATIONS] += report[ITERATIONS] + 1.0
            if status != CONVERGED:
                counters[REASON], counters[RESIDUAL] = UNBOUNDED if status >= NOT_FINITE else NEWTON, report[LEFT]
                if status == BALLS_FAILED:
                    counters[REASON] = BALLS
                return step
            if state.memory.shape[1] > 0 and not _remember(forces, t, equilibrium, state.ball, response):
                counters[REASON] = BALLS
                return step
            for i in range(5):
                state.motion[1, i] = equilibrium.q[i] - state.motion[0, i]
                state.motion[0, i] = still[0, i] = equilibrium.q[i]
            copy_matrix(state.ball, state.ball_before)
            copy_matrix(equilibrium.ball, state.ball)
            _note_step(recording, number, t, still, push, work, state.ball)
        return steps.total

    return equilibria
