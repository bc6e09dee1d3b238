"""Static equilibrium of the ring under a constant load, by a trust region on the total potential.

Notes
-----
With rigid rings, no friction and laws whose force grows with the approach, the potential is convex: the length of
e - p and of p are convex in (q, p), the contact energies grow and are convex in those lengths, and a minimum over the
balls p keeps convexity.  The compliance of elastic bodies keeps it as long as the contacts are softer than what it takes
off them, which the kernels see to.  So a trust-region Newton iteration finds the one minimum from anywhere.  Tilts are scaled by
the arm R so that all unknowns are lengths.

References
----------
More, Sorensen: Computing a trust region step, SIAM J. Sci. Stat. Comput. 4 (1983).
"""

import numpy as np
from numba import boolean, float64, int64, void

from raceway.core.contact.damping import stored_energy
from raceway.core.jit import jit
from raceway.core.ring.kernels import CONTACT_FORCE, GAP, STORED
from raceway.core.ring.kernels.layout import CAGE, CENTRIFUGAL, REST_AXIAL, REST_RADIAL, TILT_ARM, keep_slips, stop
from raceway.core.signatures import (
    CONSTANTS,
    CONTACTS,
    CUBE,
    LINEAR,
    MATRIX,
    SETTLE,
    VECTOR,
    Balls,
    Constants,
    Contacts,
    Response,
)


@jit(boolean(MATRIX, VECTOR))
def solve(matrix, rhs):
    """Solve in place by Gaussian elimination with partial pivoting; ``rhs`` becomes the solution.

    Returns False when a pivot vanishes or is not a number; both arrays are then undefined.
    """
    n = rhs.size
    for column in range(n):
        pivot, largest = column, abs(matrix[column, column])
        for row in range(column + 1, n):
            if abs(matrix[row, column]) > largest:
                pivot, largest = row, abs(matrix[row, column])
        if not largest > 0.0:
            return False
        if pivot != column:
            for k in range(column, n):
                matrix[column, k], matrix[pivot, k] = matrix[pivot, k], matrix[column, k]
            rhs[column], rhs[pivot] = rhs[pivot], rhs[column]
        inverse = 1.0 / matrix[column, column]
        for row in range(column + 1, n):
            factor = matrix[row, column] * inverse
            if factor != 0.0:
                for k in range(column + 1, n):
                    matrix[row, k] -= factor * matrix[column, k]
                rhs[row] -= factor * rhs[column]
    for row in range(n - 1, -1, -1):
        total = rhs[row]
        for k in range(row + 1, n):
            total -= matrix[row, k] * rhs[k]
        rhs[row] = total / matrix[row, row]
    return True


@jit(boolean(MATRIX, VECTOR, int64))
def cholesky_solve(matrix, rhs, n):
    """Solve a symmetric positive definite system in place; False (undefined arrays) when it is not one."""
    for j in range(n):
        total = matrix[j, j]
        for k in range(j):
            total -= matrix[j, k] * matrix[j, k]
        if not total > 0.0:
            return False
        root = total**0.5
        matrix[j, j] = root
        for i in range(j + 1, n):
            total = matrix[i, j]
            for k in range(j):
                total -= matrix[i, k] * matrix[j, k]
            matrix[i, j] = total / root
    for i in range(n):
        total = rhs[i]
        for k in range(i):
            total -= matrix[i, k] * rhs[k]
        rhs[i] = total / matrix[i, i]
    for i in range(n - 1, -1, -1):
        total = rhs[i]
        for k in range(i + 1, n):
            total -= matrix[k, i] * rhs[k]
        rhs[i] = total / matrix[i, i]
    return True


@jit(void(MATRIX, MATRIX))
def copy_matrix(source, target):
    """target[:, :] = source.

    Notes
    -----
    Where an array is assigned to a slice of another, numba compiles the words of its error message, too: seconds.
    """
    for i in range(source.shape[0]):
        for j in range(source.shape[1]):
            target[i, j] = source[i, j]


@jit(void(CUBE, CUBE))
def copy_cube(source, target):
    """target[:, :, :] = source."""
    for i in range(source.shape[0]):
        for j in range(source.shape[1]):
            for k in range(source.shape[2]):
                target[i, j, k] = source[i, j, k]


CONVERGED, NOT_CONVERGED, BALLS_FAILED, NOT_FINITE, RUN_AWAY = range(5)
#: Entries of ``report``.
ITERATIONS, RESIDUAL = range(2)
_LIMIT = 300
#: Rows of ``work`` that the energy's integral takes, from the first to the one after the last.
_SCRATCH, _SCRATCH_END = 8, 14


@jit(float64(CONTACTS, CONSTANTS, MATRIX, MATRIX, VECTOR))
def contact_energy(contacts, constants, ball, work, energy):
    """Energy [J] stored in all contacts at the gaps in ``work`` and in the bodies, less the work of the centrifugal forces."""
    table = constants.table
    stored_energy(contacts.law, contacts.params, contacts.old, contacts.new, work[GAP], work[_SCRATCH:_SCRATCH_END], energy)
    total = 0.0
    for i in range(energy.size):
        total += energy[i] + work[STORED, i]
    for k in range(table.shape[0]):
        if table[k, CENTRIFUGAL] != 0.0:
            total -= table[k, CENTRIFUGAL] * ball[k, 1]
    return total


@jit(float64(float64, LINEAR, VECTOR))
def with_linear_parts(energy, linear, q):
    """An energy [J] and that of the linear stiffness, less the work of the load, at q (5,)."""
    for i in range(5):
        energy -= linear.load[i] * q[i]
        for j in range(5):
            energy += 0.5 * q[i] * linear.stiffness[i, j] * q[j]
    return energy


@jit(float64(MATRIX, int64))
def force_scale(work, inner):
    """Sum of the inner races' forces and a ten-thousandth of the outer ones' [N]."""
    total = 0.0
    for i in range(work.shape[1]):
        total += abs(work[CONTACT_FORCE, i]) * (1.0 if i < inner else 1e-4)
    return total


@jit(float64(LINEAR, VECTOR, VECTOR, VECTOR, VECTOR))
def gradient(linear, f, q, scale, out):
    """out (5,): slope of the potential by the scaled unknowns [N], from the contacts' force f (5,); its largest entry."""
    norm = 0.0
    for i in range(5):
        total = f[i] - linear.load[i]
        for j in range(5):
            total += linear.stiffness[i, j] * q[j]
        out[i] = total * scale[i] * linear.free[i]
        norm = max(norm, abs(out[i]))
    return norm


@jit(float64(LINEAR, MATRIX, VECTOR, float64, MATRIX))
def hessian(linear, K, scale, least, H):
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
def trust_region_step(H, g, norm, trace, radius, factor, step):
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


@jit(float64(MATRIX, VECTOR, VECTOR))
def predicted_decrease(H, g, step):
    """How far the quadratic model falls over a step [J]."""
    predicted = 0.0
    for i in range(5):
        total = g[i]
        for j in range(5):
            total += 0.5 * H[i, j] * step[j]
        predicted -= step[i] * total
    return predicted


@jit(float64(float64, float64, float64, VECTOR, VECTOR, VECTOR))
def decrease_ratio(before, after, predicted, g, g_new, step):
    """Fall of the potential from ``before`` to ``after`` [J] over the predicted one."""
    if predicted <= 1e-13 * (abs(before) + abs(after)):
        # Energies no longer tell the two states apart: the mean of the slopes at both ends of the step does.
        slopes = 0.0
        for i in range(5):
            slopes += (g[i] + g_new[i]) * step[i]
        return -0.5 * slopes / predicted if predicted > 0.0 else 0.0
    return (before - after) / predicted if predicted > 0.0 else 0.0


@jit(void(VECTOR, VECTOR))
def copy_vector(source, target):
    """target (n,) becomes source (n,)."""
    for i in range(source.size):
        target[i] = source[i]


@jit(SETTLE, allocates=True)
def settle(forces, linear, tolerance, t, state, response, report):
    """Move a state at rest to the equilibrium of ``linear.load`` (5,); the response is the contacts' there.

    Parameters
    ----------
    linear : its stiffness is added to the contacts' (the shaft's against tilts)
    tolerance : residual over the sum of the inner races' forces and the loads
    t : time [s]: balls that orbit stand still where they are then
    report : (2,) out: iterations, relative residual

    Returns
    -------
    int
        ``CONVERGED``, ``NOT_CONVERGED``, ``BALLS_FAILED``, ``NOT_FINITE`` or ``RUN_AWAY`` (nothing holds the ring).
    """
    constants, q, ball, work = forces.constants, state.q, state.ball, response.work
    if constants.scalars[CAGE] != 0.0:
        constants = Constants(constants.scalars.copy(), constants.table.copy())
        stop(t, constants.scalars, constants.table)
    arm = constants.scalars[TILT_ARM]
    scale = np.ones(5)
    scale[3] = 1.0 / arm
    scale[4] = 1.0 / arm
    still, zeros = np.zeros(5), np.zeros_like(ball)
    contacts = Contacts(forces.law, forces.law_params, state.memory, state.memory.copy(), 0.0)
    now = Response(response.f, response.K, np.empty((5, 5)), work)
    new = Response(np.empty(5), np.empty((5, 5)), now.C, work)
    g, g_new, step, trial = np.zeros(5), np.zeros(5), np.empty(5), np.empty(5)
    H, factor, ball_new, energies = np.empty((5, 5)), np.empty((5, 5)), ball.copy(), np.empty(work.shape[1])
    radius = 0.05 * (abs(constants.scalars[REST_AXIAL]) + abs(constants.scalars[REST_RADIAL]))
    if radius == 0.0:  # bearings without grooves or clearance
        radius = 1e-3 * arm
    if forces.system(t, q, still, Balls(ball, 0.0, zeros), contacts, constants, now) != 0:
        return BALLS_FAILED
    # What the ring feels counts: under centrifugal force the outer races may carry a million times more, of which only
    # the rounding (a ten-thousandth of the tolerance, 1e-15) remains.
    inner = work.shape[1] // 2
    carried, weight = force_scale(work, inner), 0.0
    potential, relative = np.nan, np.inf
    for i in range(5):
        weight += abs(linear.load[i]) * scale[i]
    for iteration in range(_LIMIT):
        norm = gradient(linear, now.f, q, scale, g)
        relative = norm / max(carried + weight, 1e-300)
        report[ITERATIONS], report[RESIDUAL] = iteration, relative
        if not np.isfinite(norm):
            return NOT_FINITE
        for i in range(5):
            if abs(q[i]) > 1e3 * arm * scale[i]:
                return RUN_AWAY
        if relative <= tolerance:
            return CONVERGED
        trace = hessian(linear, now.K, scale, norm / radius, H)
        size = trust_region_step(H, g, norm, trace, radius, factor, step)
        if not np.isfinite(size):
            return NOT_CONVERGED
        for i in range(5):
            trial[i] = q[i] + step[i] * scale[i]
        copy_matrix(ball, ball_new)
        if np.isnan(potential):
            potential = with_linear_parts(contact_energy(contacts, constants, ball, work, energies), linear, q)
        if forces.system(t, trial, still, Balls(ball_new, 0.0, zeros), contacts, constants, new) != 0:
            radius *= 0.25
            if radius < 1e-18:
                return BALLS_FAILED
            continue
        carried_new = force_scale(work, inner)
        if gradient(linear, new.f, trial, scale, g_new) < 0.25 * norm:
            accepted, potential, radius = True, np.nan, max(radius, 3.0 * size)
        else:
            energy = with_linear_parts(contact_energy(contacts, constants, ball_new, work, energies), linear, trial)
            ratio = decrease_ratio(potential, energy, predicted_decrease(H, g, step), g, g_new, step)
            accepted = ratio > 1e-4
            if ratio < 0.25:
                radius = 0.25 * min(radius, size)
            elif ratio > 0.75 and size >= 0.7 * radius:
                radius *= 3.0
            if accepted:
                potential = energy
            if radius < 1e-22:
                # No step helps any more: rounding, where the imbalance is small already.
                break
        if accepted:
            carried = carried_new
            copy_vector(trial, q)
            copy_vector(new.f, now.f)
            copy_matrix(new.K, now.K)
            copy_matrix(ball_new, ball)
    return CONVERGED if relative <= 1e3 * tolerance else NOT_CONVERGED


_ROOT_LIMIT = 100
_HALVINGS = 30


@jit(SETTLE, allocates=True)
def find_root(forces, linear, tolerance, t, state, response, report):
    """Same arguments and result as ``raceway.core.ring.equilibrium.settle``; slips are taken from ``state`` as committed."""
    constants, q, ball, work = forces.constants, state.q, state.ball, response.work
    if constants.scalars[CAGE] != 0.0:
        constants = Constants(constants.scalars.copy(), constants.table.copy())
        stop(t, constants.scalars, constants.table)
    # No rates; the columns of slips hold the committed ones.
    still, history = np.zeros(5), np.empty_like(ball)
    keep_slips(constants.scalars, ball, history)
    contacts = Contacts(forces.law, forces.law_params, state.memory, state.memory.copy(), 0.0)
    now = Response(response.f, response.K, np.empty((5, 5)), work)
    J, r, step, weight = np.empty((5, 5)), np.empty(5), np.zeros(5), np.ones(5)
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
            norm = imbalance(linear, now.f, q, weight, r)
        report[ITERATIONS], report[RESIDUAL] = iteration, norm / max(scale, 1e-300)
        if norm <= tolerance * scale:
            return CONVERGED
        if not norm <= 1.5 * before:
            cuts += 1
            if cuts > _HALVINGS:
                return BALLS_FAILED if status != 0 else NOT_CONVERGED
            for i in range(5):
                step[i] *= 0.5
                q[i] -= step[i]
            continue
        before = norm
        if not newton_step(linear, now.K, r, J, step):
            return NOT_CONVERGED
        for i in range(5):
            q[i] += step[i]
    return NOT_CONVERGED


@jit(float64(LINEAR, VECTOR, VECTOR, VECTOR, VECTOR))
def imbalance(linear, f, q, weight, r):
    """r (5,): forces that are left [N, N m]; the largest, by weight (5,), or infinity."""
    norm = 0.0
    for i in range(5):
        total = f[i] - linear.load[i]
        for j in range(5):
            total += linear.stiffness[i, j] * q[j]
        r[i] = total * linear.free[i]
        norm = max(norm, abs(r[i]) * weight[i]) if np.isfinite(r[i]) else np.inf
    return norm


@jit(boolean(LINEAR, MATRIX, VECTOR, MATRIX, VECTOR))
def newton_step(linear, K, r, J, step):
    """step (5,) that the tangent K (5, 5) of the contacts asks for; J (5, 5) is scratch.  False where it is singular."""
    free = linear.free
    for i in range(5):
        step[i] = -r[i]
        for j in range(5):
            J[i, j] = (K[i, j] + linear.stiffness[i, j]) * free[i] * free[j]
        if free[i] == 0.0:
            J[i, i] = 1.0
    return solve(J, step)
