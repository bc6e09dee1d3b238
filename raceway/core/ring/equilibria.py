"""Equilibria of many operating points in one compiled loop: the numbers of each point are a row of the columns."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import float64, int64, void

from raceway.core.jit import jit
from raceway.core.ring.elimination import cholesky_solve, copy_matrix
from raceway.core.ring.equilibrium import CONVERGED, SLOW, find_root, solve_equilibrium
from raceway.core.ring.kernels import CONTACT_FORCE
from raceway.core.ring.kernels.layout import GYROSCOPIC, TILT_ARM, keep_slips, place, work_rows
from raceway.core.signatures import (
    CONSTANTS,
    CONTACTS,
    CUBE,
    LAW_POINTER,
    LINEAR,
    MATRIX,
    RESPONSE,
    SYSTEM_POINTER,
    VECTOR,
    Balls,
    Constants,
    Contacts,
    Forces,
    Linear,
    Response,
    StaticState,
    record,
)

#: Relative residual of the equilibria.
TOLERANCE = 1e-12
#: Status beside those of ``raceway.core.ring.equilibrium``: some motion is held by less than this part of the stiffest one.
LOOSE, _LEAST = 5, 1e-9


class Points(NamedTuple):
    """Numbers of n points: ``scalars`` (n, s), ``table`` (n, Z, c), law's ``params`` (n, 2 Z, k), ``load`` (n, 5), ``shaft`` (n,)
    [N m/rad] against tilts, and ``guess`` (n, 5) to begin with."""

    scalars: np.ndarray
    table: np.ndarray
    params: np.ndarray
    load: np.ndarray
    shaft: np.ndarray
    guess: np.ndarray


class States(NamedTuple):
    """What is computed of n points: displacement (n, 5), positions of balls (n, Z, b), tangent of the contacts and their
    damping (n, 5, 5), contact forces (n, 2 Z), status (n,)."""

    q: np.ndarray
    ball: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    force: np.ndarray
    status: np.ndarray


class Kernels(NamedTuple):
    """``system`` (a ``SYSTEM``), ``base`` (the one whose forces have a potential, ``columns`` of ``ball``) and ``law`` (a ``LAW``)."""

    system: Any
    base: Any
    columns: int
    law: Any


POINTS = record(Points, MATRIX, CUBE, CUBE, MATRIX, VECTOR, MATRIX)
STATES = record(States, MATRIX, CUBE, CUBE, CUBE, MATRIX, int64[::1])
KERNELS = record(Kernels, SYSTEM_POINTER, SYSTEM_POINTER, int64, LAW_POINTER)


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
    n, z = points.table.shape[0], points.table.shape[1]
    memory, columns = np.zeros((2 * z, 0)), states.ball.shape[2]
    still, report, f, factor, scale = np.zeros(5), np.zeros(2), np.empty(5), np.empty((5, 5)), np.empty(5)
    stiffness = linear.stiffness.copy()
    work = np.zeros((work_rows(points.scalars[0], points.table[0]), 2 * z))
    free_ball, history = np.zeros((z, kernels.columns)), np.zeros((z, columns))
    for p in range(n):
        constants, params, K, q = (
            Constants(points.scalars[p], points.table[p]),
            points.params[p],
            states.stiffness[p],
            states.q[p],
        )
        stiffness[3, 3] = points.shaft[p]
        stiffness[4, 4] = points.shaft[p]
        own = Linear(linear.mass, linear.damping, stiffness, linear.free, points.load[p])
        for i in range(5):
            q[i] = points.guess[p, i]
        free_ball[:] = 0.0
        response = Response(f, K, states.damping[p], work)
        forces = Forces(kernels.base, kernels.law, params, constants)
        status = solve_equilibrium(forces, own, TOLERANCE, 0.0, StaticState(q, free_ball, memory), response, report)
        ball = states.ball[p]
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
            if unsolvable or not _definiteness(K, own, constants.scalars[TILT_ARM], factor, scale) > _LEAST:
                status = LOOSE
            for i in range(2 * z):
                states.force[p, i] = work[CONTACT_FORCE, i]
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
