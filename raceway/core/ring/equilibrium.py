"""Static equilibrium of the ring under a constant load, by a trust region on the total potential.

With rigid rings, no friction and laws whose force grows with the approach, the potential is convex: the length of
e - p and of p are convex in (q, p), the contact energies grow and are convex in those lengths, and a minimum over the
balls p keeps convexity.  The compliance of elastic bodies keeps it as long as the contacts are softer than what it takes
off them, which the kernels see to.  So a trust-region Newton iteration finds the one minimum from anywhere.  Tilts are scaled by
the arm R so that all unknowns are lengths.

``solve_equilibrium`` and ``find_root``, for forces without a potential, are of the signature ``raceway.core.signatures.EQUILIBRIUM``::

    solve_equilibrium(forces, linear, tolerance, t, state, response, report) -> status

    linear      its stiffness is added to the contacts' (the shaft's against tilts)
    tolerance   residual over the sum of the inner races' forces and the loads
    t           time [s]: balls that orbit stand still where they are then
    report      (2,) out: iterations, relative residual
    status      CONVERGED, NOT_CONVERGED, BALLS_FAILED, NOT_FINITE or RUN_AWAY (nothing holds the ring)

More, Sorensen: Computing a trust region step, SIAM J. Sci. Stat. Comput. 4 (1983).
"""

import numpy as np
from numba import float64, void

from raceway.core.contact.damping import stored_energy
from raceway.core.jit import jit
from raceway.core.ring.elimination import cholesky_solve, copy_matrix, solve
from raceway.core.ring.kernels import CONTACT_FORCE, GAP, STORED
from raceway.core.ring.kernels.layout import CAGE, CENTRIFUGAL, REST_AXIAL, REST_RADIAL, TILT_ARM, keep_slips, stop
from raceway.core.signatures import (
    CONSTANTS,
    CONTACTS,
    EQUILIBRIUM,
    LINEAR,
    MATRIX,
    RESPONSE,
    STATIC,
    VECTOR,
    Balls,
    Constants,
    Contacts,
    Response,
    StaticState,
)


@jit(CONSTANTS(CONSTANTS, float64), allocates=True)
def at_rest(constants, t):
    """The constants of balls that stand where they are at a time."""
    if constants.scalars[CAGE] == 0.0:
        return constants
    scalars, table = constants.scalars.copy(), constants.table.copy()
    stop(t, scalars, table)
    return Constants(scalars, table)


CONVERGED, NOT_CONVERGED, BALLS_FAILED, NOT_FINITE, RUN_AWAY = range(5)
#: Entries of ``report``.
ITERATIONS, RESIDUAL = range(2)
#: Rate of the slow motions that a damping is taken from, over the stiffness by the damping [1/s]: an error of second order in it.
SLOW = 1e-4
_LIMIT = 300
#: Rows of ``work`` that the energy's integral takes, from the first to the one after the last.
_SCRATCH, _SCRATCH_END = 8, 14


@jit(float64(CONTACTS, CONSTANTS, LINEAR, VECTOR, MATRIX, MATRIX, VECTOR))
def _potential_energy(contacts, constants, linear, q, ball, work, energy):
    """Energy [J] of the contacts at the gaps in ``work``, of the bodies and of the linear stiffness, less the work of all forces."""
    table = constants.table
    stored_energy(contacts.law, contacts.params, contacts.old, contacts.new, work[GAP], work[_SCRATCH:_SCRATCH_END], energy)
    total = 0.0
    for i in range(energy.size):
        total += energy[i] + work[STORED, i]
    for k in range(table.shape[0]):
        if table[k, CENTRIFUGAL] != 0.0:
            total -= table[k, CENTRIFUGAL] * ball[k, 1]
    for i in range(5):
        total -= linear.load[i] * q[i]
        for j in range(5):
            total += 0.5 * q[i] * linear.stiffness[i, j] * q[j]
    return total


@jit(float64(MATRIX))
def _force_scale(work):
    """Sum of the inner races' forces and a ten-thousandth of the outer ones' [N]."""
    total = 0.0
    for i in range(work.shape[1]):
        total += abs(work[CONTACT_FORCE, i]) * (1.0 if i < work.shape[1] // 2 else 1e-4)
    return total


@jit(float64(LINEAR, VECTOR, VECTOR, VECTOR, VECTOR))
def _imbalance(linear, f, q, weight, r):
    """r (5,): forces that are left [N, N m] with those of the contacts f (5,); the largest, by weight (5,), or infinity."""
    norm = 0.0
    for i in range(5):
        total = f[i] - linear.load[i]
        for j in range(5):
            total += linear.stiffness[i, j] * q[j]
        r[i] = total * linear.free[i]
        norm = max(norm, abs(r[i]) * weight[i]) if np.isfinite(r[i]) else np.inf
    return norm


@jit(float64(LINEAR, VECTOR, VECTOR, VECTOR, VECTOR))
def _gradient(linear, f, q, scale, out):
    """out (5,): slope of the potential by the scaled unknowns [N], from the contacts' force f (5,); its largest entry."""
    norm = _imbalance(linear, f, q, scale, out)
    for i in range(5):
        out[i] *= scale[i]
    return norm


@jit(float64(LINEAR, MATRIX, VECTOR, float64, MATRIX))
def _hessian(linear, K, scale, least, H):
    """H (5, 5): second derivatives by the scaled unknowns [N/m] from the contacts' K; its largest diagonal entry, or ``least``."""
    trace, free = 0.0, linear.free
    for i in range(5):
        for j in range(5):
            H[i, j] = (K[i, j] + linear.stiffness[i, j]) * scale[i] * scale[j] * free[i] * free[j]
        trace = max(trace, H[i, i])
    if trace == 0.0:
        trace = least
    for i in range(5):
        if free[i] == 0.0:
            H[i, i] = trace
    return trace


@jit(float64(MATRIX, VECTOR, float64, float64, float64, MATRIX, VECTOR))
def _trust_region_step(H, g, norm, trace, radius, factor, step):
    """step (5,): Newton's where it stays inside the radius, else of (H + shift) d = -g with |d| = radius; its length."""
    size, shift, low, high = np.inf, 0.0, 0.0, 0.0
    for _ in range(60):
        for i in range(5):
            step[i] = -g[i]
            for j in range(5):
                factor[i, j] = H[i, j]
            factor[i, i] += shift + 1e-15 * trace
        size = np.inf
        if cholesky_solve(factor, step, 5):
            size = 0.0
            for i in range(5):
                size += step[i] * step[i]
            size = np.sqrt(size)
        if size <= radius:
            if shift == 0.0 or size >= 0.8 * radius:
                break
            high = shift
        else:
            low = max(shift, 1e-12 * trace)
        if high == 0.0:
            shift = max(10.0 * shift, 1e-10 * trace, 0.1 * norm / radius)
        else:
            shift = np.sqrt(low * high)
            if high <= low * 1.05:
                shift = high
    return size


@jit(float64(float64, float64, MATRIX, VECTOR, VECTOR, VECTOR))
def _decrease_ratio(before, after, H, g, g_new, step):
    """Fall of the potential from ``before`` to ``after`` [J] over that of the quadratic model over a step."""
    model_decrease, slopes = 0.0, 0.0
    for i in range(5):
        total = g[i]
        for j in range(5):
            total += 0.5 * H[i, j] * step[j]
        model_decrease -= step[i] * total
        slopes += (g[i] + g_new[i]) * step[i]
    if not model_decrease > 0.0:
        return 0.0
    if model_decrease <= 1e-13 * (abs(before) + abs(after)):
        # Energies no longer tell the two states apart: the mean of the slopes at both ends of the step does.
        return -0.5 * slopes / model_decrease
    return (before - after) / model_decrease


@jit(void(STATIC, RESPONSE, STATIC, RESPONSE))
def _accept(trial, new, state, now):
    for i in range(5):
        state.q[i], now.f[i] = trial.q[i], new.f[i]
    copy_matrix(new.K, now.K)
    copy_matrix(trial.ball, state.ball)


@jit(EQUILIBRIUM, allocates=True)
def solve_equilibrium(forces, linear, tolerance, t, state, response, report):
    """Move a state at rest to the equilibrium of ``linear.load`` (5,), the least potential; the response is the contacts' there."""
    constants, q, ball, work = at_rest(forces.constants, t), state.q, state.ball, response.work
    arm, scale = constants.scalars[TILT_ARM], np.ones(5)
    scale[3], scale[4] = 1.0 / arm, 1.0 / arm
    still, zeros, trial = np.zeros(5), np.zeros_like(ball), StaticState(np.empty(5), ball.copy(), state.memory)
    contacts = Contacts(forces.law, forces.law_params, state.memory, state.memory.copy(), 0.0)
    now = Response(response.f, response.K, np.empty((5, 5)), work)
    new = Response(np.empty(5), np.empty((5, 5)), now.C, work)
    g, g_new, step, energies = np.zeros(5), np.zeros(5), np.empty(5), np.empty(work.shape[1])
    H, factor = np.empty((5, 5)), np.empty((5, 5))
    radius = 0.05 * (abs(constants.scalars[REST_AXIAL]) + abs(constants.scalars[REST_RADIAL]))
    if radius == 0.0:  # bearings without grooves or clearance
        radius = 1e-3 * arm
    if forces.system(t, q, still, Balls(ball, 0.0, zeros), contacts, constants, now) != 0:
        return BALLS_FAILED
    # What the ring feels counts: under centrifugal force the outer races may carry a million times more, of which only
    # the rounding (a ten-thousandth of the tolerance, 1e-15) remains.
    force_scale, weight, potential, relative = _force_scale(work), 0.0, np.nan, np.inf
    for i in range(5):
        weight += abs(linear.load[i]) * scale[i]
    for iteration in range(_LIMIT):
        norm = _gradient(linear, now.f, q, scale, g)
        relative = norm / max(force_scale + weight, 1e-300)
        report[ITERATIONS], report[RESIDUAL] = iteration, relative
        if not np.isfinite(norm):
            return NOT_FINITE
        # A thousand of its arms away: nothing holds the ring
        away = False
        for i in range(5):
            away = away or abs(q[i]) > 1e3 * arm * scale[i]
        if away:
            return RUN_AWAY
        if relative <= tolerance:
            return CONVERGED
        size = _trust_region_step(H, g, norm, _hessian(linear, now.K, scale, norm / radius, H), radius, factor, step)
        if not np.isfinite(size):
            return NOT_CONVERGED
        for i in range(5):
            trial.q[i] = q[i] + step[i] * scale[i]
        copy_matrix(ball, trial.ball)
        if forces.system(t, trial.q, still, Balls(trial.ball, 0.0, zeros), contacts, constants, new) != 0:
            radius *= 0.25
            if radius < 1e-18:
                return BALLS_FAILED
            continue
        carried_new = _force_scale(work)
        if _gradient(linear, new.f, trial.q, scale, g_new) < 0.25 * norm:
            potential, radius = np.nan, max(radius, 3.0 * size)
        else:
            if np.isnan(potential):  # it is seldom asked for: the state before is evaluated again
                if forces.system(t, q, still, Balls(ball, 0.0, zeros), contacts, constants, now) != 0:
                    return BALLS_FAILED
                potential = _potential_energy(contacts, constants, linear, q, ball, work, energies)
                if forces.system(t, trial.q, still, Balls(trial.ball, 0.0, zeros), contacts, constants, new) != 0:
                    return BALLS_FAILED
            energy = _potential_energy(contacts, constants, linear, trial.q, trial.ball, work, energies)
            ratio = _decrease_ratio(potential, energy, H, g, g_new, step)
            if ratio < 0.25:
                radius = 0.25 * min(radius, size)
            elif ratio > 0.75 and size >= 0.7 * radius:
                radius *= 3.0
            if radius < 1e-22:  # no step helps any more: rounding, where the imbalance is small already
                break
            if not ratio > 1e-4:
                continue
            potential = energy
        force_scale = carried_new
        _accept(trial, new, state, now)
    return CONVERGED if relative <= 1e3 * tolerance else NOT_CONVERGED


_ROOT_LIMIT = 100
_HALVINGS = 30


@jit(EQUILIBRIUM, allocates=True)
def find_root(forces, linear, tolerance, t, state, response, report):
    """The same where forces have no potential, by Newton's method; slips are taken from ``state`` as committed."""
    constants, q, ball, work = at_rest(forces.constants, t), state.q, state.ball, response.work
    # No rates; the columns of slips hold the committed ones.
    still, history = np.zeros(5), np.empty_like(ball)
    keep_slips(constants.scalars, ball, history)
    contacts = Contacts(forces.law, forces.law_params, state.memory, state.memory.copy(), 0.0)
    now = Response(response.f, response.K, np.empty((5, 5)), work)
    J, r, step, weight, ones = np.empty((5, 6)), np.empty(5), np.zeros(5), np.ones(5), np.ones(5)
    weight[3] = 1.0 / constants.scalars[TILT_ARM]
    weight[4] = 1.0 / constants.scalars[TILT_ARM]
    before, cuts = np.inf, 0
    for iteration in range(_ROOT_LIMIT):
        status = forces.system(t, q, still, Balls(ball, 0.0, history), contacts, constants, now)
        norm, scale = np.inf, 0.0
        if status == 0:
            for i in range(work.shape[1]):
                scale += abs(work[CONTACT_FORCE, i])
            for i in range(5):
                scale += abs(linear.load[i]) * weight[i]
            norm = _imbalance(linear, now.f, q, weight, r)
        report[ITERATIONS], report[RESIDUAL] = iteration, norm / max(scale, 1e-300)
        if norm <= tolerance * scale:
            return CONVERGED
        if not (np.isfinite(norm) and norm <= 1.5 * before):
            cuts += 1
            if cuts > _HALVINGS or before == np.inf:
                return BALLS_FAILED if status != 0 else NOT_CONVERGED
            for i in range(5):
                step[i] *= 0.5
                q[i] -= step[i]
            continue
        before = norm
        _hessian(linear, now.K, ones, 1.0, J)
        for i in range(5):
            J[i, 5] = -r[i]
        if not solve(J):
            return NOT_CONVERGED
        for i in range(5):
            step[i] = J[i, 5]
            q[i] += step[i]
    return NOT_CONVERGED
