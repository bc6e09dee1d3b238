"""Equilibria of many operating points in one compiled loop: the numbers of each point are a row of the columns."""

import numpy as np
from numba import float64, void

from raceway.core.jit import jit
from raceway.core.lanes import WIDTH
from raceway.core.ring.elimination import cholesky_solve, copy_matrix
from raceway.core.ring.equilibrium import CONVERGED, SLOW, find_root, solve_equilibrium
from raceway.core.ring.kernels import CONTACT_FORCE
from raceway.core.ring.kernels.layout import (
    DAMPING,
    GYROSCOPIC,
    TILT_ARM,
    TIME_CONSTANT,
    are_condensed,
    keep_slips,
    place,
    work_rows,
)
from raceway.core.ring.lockstep import POINT_ROWS, lockstep
from raceway.core.ring.lockstep import WORK_ROWS as LANES_ROWS
from raceway.core.signatures import (
    CONSTANTS,
    CONTACTS,
    CUBE,
    KERNELS,
    LEAST,
    LINEAR,
    LOOSE,
    MATRIX,
    POINTS,
    RESPONSE,
    STATES,
    TOLERANCE,
    VECTOR,
    Balls,
    Constants,
    Contacts,
    Forces,
    Linear,
    Response,
    StaticState,
)


@jit(float64(MATRIX, LINEAR, float64, MATRIX, VECTOR))
def _definiteness(K, linear, arm, factor, scale):
    """Least pivot of the scaled tangent of the unknowns over its largest diagonal entry; not positive where something is loose."""
    largest, least = 0.0, np.inf
    for i in range(5):
        scale[i] = (1.0 if i < 3 else 1.0 / arm) * linear.free[i]
    for i in range(5):
        for j in range(5):
            factor[i, j] = 0.5 * (K[i, j] + K[j, i] + 2.0 * linear.stiffness[i, j]) * scale[i] * scale[j]
        largest = max(largest, factor[i, i])
    for i in range(5):
        if scale[i] == 0.0:
            factor[i, i] = largest
    if not cholesky_solve(factor, scale, 5):
        return 0.0
    for i in range(5):
        least = min(least, factor[i, i] * factor[i, i])
    return least / largest


@jit(void(KERNELS, CONTACTS, CONSTANTS, VECTOR, MATRIX, RESPONSE, MATRIX), allocates=True)
def _slow_damping(kernels, contacts, constants, q, places, response, history):
    """C of the response, of a ring that moves while the balls stay, to that of slow motions in which they move, too: see
    ``raceway.core.ring.system.System.damping_at``; ``history`` (Z, b) holds the slips."""
    stiffest, most_damping, C = 0.0, 0.0, response.C
    for i in range(3):
        stiffest, most_damping = max(stiffest, response.K[i, i]), max(most_damping, C[i, i])
    if most_damping == 0.0:
        return
    ball = places.copy()
    rate, columns, still = SLOW * stiffest / most_damping, ball.shape[1], np.zeros(5)
    probe = Response(np.empty(5), np.empty((5, 5)), np.empty((5, 5)), response.work)
    C[:] = 0.0
    for sign in (1.0, -1.0):
        for k in range(ball.shape[0]):
            for c in range(columns):
                if columns == kernels.columns or c < 2 or c > 3:  # slips have no rates
                    history[k, c] = -sign * rate * places[k, c]
        copy_matrix(places, ball)
        kernels.system(0.0, q, still, Balls(ball, sign * rate, history), contacts, constants, probe)
        for i in range(5):
            for j in range(5):
                C[i, j] += sign * (probe.K[i, j] + sign * rate * probe.C[i, j]) / (2.0 * rate)


@jit(void(KERNELS, LINEAR, POINTS, STATES), allocates=True, releases=True)
def equilibria(kernels, linear, points, states):
    """The equilibrium of every point; ``linear`` has what all of them share.  States of points whose status is not 0 are undefined."""
    n, z, damped = points.table.shape[0], points.table.shape[1], len(states.damping) > 0
    memory, columns = np.zeros((2 * z, 0)), states.ball.shape[2]
    still, report, f, factor, scale = np.zeros(5), np.zeros(2), np.empty(5), np.empty((5, 5)), np.empty(5)
    stiffness = linear.stiffness.copy()
    work = np.zeros((work_rows(points.scalars[0], points.table[0]), 2 * z))
    free_ball, history = np.zeros((z, kernels.columns)), np.zeros((z, columns))
    width = WIDTH if kernels.lanes else 0
    lanes, of_points = np.zeros((LANES_ROWS, 2 * z * width)), np.zeros((POINT_ROWS, width))
    bodies = np.empty((width * are_condensed(points.scalars[0]), points.scalars.shape[1]))
    params_of_lanes, none = np.empty((2 * z * width, points.params.shape[2])), np.zeros((2 * z * width, 0))
    rates, C = True, np.empty((5, 5))
    for p in range(n):
        if width > 0 and p % width == 0:
            rates = lockstep(kernels.law, linear, p, points, states, params_of_lanes, none, bodies, lanes, of_points)
        in_lanes = width > 0 and states.status[p] == CONVERGED
        dampers = points.scalars[p, DAMPING] != 0.0 or points.scalars[p, TIME_CONSTANT] != 0.0
        if in_lanes and not (damped and (rates or dampers)):
            if damped:
                states.damping[p] = 0.0
            continue
        if damped:
            C = states.damping[p]
        constants = Constants(points.scalars[p], points.table[p])
        params, K, q = points.params[p], states.stiffness[p], states.q[p]
        stiffness[3, 3] = points.shaft[p]
        stiffness[4, 4] = points.shaft[p]
        own = Linear(linear.mass, linear.damping, stiffness, linear.free, points.load[p])
        response, ball, status = Response(f, K, C, work), states.ball[p], states.status[p]
        if not in_lanes:
            for i in range(5):
                q[i] = points.guess[p, i]
            free_ball[:] = 0.0
            forces = Forces(kernels.base, kernels.law, params, constants)
            status = solve_equilibrium(forces, own, TOLERANCE, 0.0, StaticState(q, free_ball, memory), response, report)
            ball[:] = 0.0
            if status == CONVERGED and constants.scalars[GYROSCOPIC] != 0.0:
                moving = Forces(kernels.system, kernels.law, params, constants)
                status = find_root(moving, own, TOLERANCE, 0.0, StaticState(q, ball, memory), response, report)
            elif columns == kernels.columns:
                copy_matrix(free_ball, ball)
        if status == CONVERGED:
            keep_slips(constants.scalars, ball, history)
            contacts = Contacts(kernels.law, params, memory, memory, 0.0)
            unsolvable = kernels.system(0.0, q, still, Balls(ball, 0.0, history), contacts, constants, response) != 0
            if unsolvable or not _definiteness(K, own, constants.scalars[TILT_ARM], factor, scale) > LEAST:
                status = LOOSE
            for i in range(2 * z):
                states.force[p, i] = work[CONTACT_FORCE, i]
            if damped:
                _slow_damping(kernels, contacts, constants, q, ball, response, history)
        states.status[p] = status


@jit(void(MATRIX, CUBE, MATRIX, CUBE), allocates=True, releases=True)
def groove_centres(scalars, table, q, out):
    """Of every point the vectors from outer to inner groove centres: ``out`` (n, 2, Z), axial and radial [m]."""
    z, still = table.shape[1], np.zeros(5)
    work = np.empty((3, 2 * z))
    for p in range(q.shape[0]):
        place(0.0, q[p], still, Constants(scalars[p], table[p]), work, (0, 1, 2))
        for k in range(z):
            out[p, 0, k], out[p, 1, k] = work[1, k], work[1, z + k]
