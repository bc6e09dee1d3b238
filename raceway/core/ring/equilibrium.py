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
from numba import float64, int64

from raceway.core.contact.damping import stored_energy
from raceway.core.jit import jit
from raceway.core.ring.dense import cholesky_solve
from raceway.core.ring.kernels import STORED
from raceway.core.ring.kernels.layout import CAGE, CENTRIFUGAL, TILT_ARM, stop
from raceway.core.signatures import LAW_POINTER, MATRIX, SETTLE, VECTOR

CONVERGED, NOT_CONVERGED, BALLS_FAILED, NOT_FINITE, RUN_AWAY = range(5)
#: Entries of ``report``.
ITERATIONS, RESIDUAL = range(2)
_LIMIT = 300


@jit(float64(LAW_POINTER, MATRIX, MATRIX, MATRIX, MATRIX, MATRIX, MATRIX, VECTOR))
def contact_energy(law, law_params, law_old, law_new, table, ball, work, energy):
    """Energy [J] stored in all contacts at the gaps in work[0] and in the bodies, less the work of the centrifugal forces."""
    scratch = work[8:14]
    stored_energy(law, law_params, law_old, law_new, work[0], scratch, energy)
    total = 0.0
    for i in range(energy.size):
        total += energy[i] + work[STORED, i]
    for k in range(table.shape[0]):
        if table[k, CENTRIFUGAL] != 0.0:
            total -= table[k, CENTRIFUGAL] * ball[k, 1]
    return total


@jit(float64(MATRIX, int64))
def force_scale(work, inner):
    """Sum of the inner races' forces and a ten-thousandth of the outer ones' [N]."""
    total = 0.0
    for i in range(work.shape[1]):
        total += abs(work[2, i]) * (1.0 if i < inner else 1e-4)
    return total


@jit(SETTLE, allocates=True)
def settle(
    system, law, law_params, scalars, table, stiffness, free, load, tolerance, t, q, ball, law_state, work, f, K, report
):
    """Move q (5,) and ball (Z, 2) to the equilibrium of ``load`` (5,); f and K are the contacts' there.

    Parameters
    ----------
    stiffness : (5, 5) linear stiffness added to the contacts' (the shaft's against tilts)
    free : (5,) 1 for unknowns, 0 for coordinates that are held
    tolerance : residual over the sum of the inner races' forces and the loads
    t : time [s]: balls that orbit stand still where they are then
    report : (2,) out: iterations, relative residual

    Returns
    -------
    int
        ``CONVERGED``, ``NOT_CONVERGED``, ``BALLS_FAILED``, ``NOT_FINITE`` or ``RUN_AWAY`` (nothing holds the ring).
    """
    if scalars[CAGE] != 0.0:
        scalars, table = scalars.copy(), table.copy()
        stop(t, scalars, table)
    arm = scalars[TILT_ARM]
    scale = np.ones(5)
    scale[3] = 1.0 / arm
    scale[4] = 1.0 / arm
    rest = np.zeros(5)
    zeros = np.zeros_like(ball)
    law_new = law_state.copy()
    C, K_new, f_new = np.empty((5, 5)), np.empty((5, 5)), np.empty(5)
    g, g_new, step, trial = np.zeros(5), np.zeros(5), np.zeros(5), np.empty(5)
    H, factor, rhs = np.empty((5, 5)), np.empty((5, 5)), np.empty(5)
    ball_new = ball.copy()
    energy_rows = np.empty(work.shape[1])
    radius = 0.05 * (abs(scalars[0]) + abs(scalars[1]))
    if radius == 0.0:  # bearings without grooves or clearance
        radius = 1e-3 * arm
    status = system(t, 0.0, q, rest, ball, 0.0, zeros, law, law_params, law_state, law_new, scalars, table, work, f, K, C)
    if status != 0:
        return BALLS_FAILED
    # What the ring feels counts: under centrifugal force the outer races may carry a million times more, of which only
    # the rounding (a ten-thousandth of the tolerance, 1e-15) remains.
    inner = work.shape[1] // 2
    forces = force_scale(work, inner)
    potential = np.nan
    weight, relative = 0.0, np.inf
    for i in range(5):
        weight += abs(load[i]) * scale[i]
    for iteration in range(_LIMIT):
        norm = 0.0
        for i in range(5):
            total = f[i] - load[i]
            for j in range(5):
                total += stiffness[i, j] * q[j]
            g[i] = total * scale[i] * free[i]
            norm = max(norm, abs(g[i]))
        relative = norm / max(forces + weight, 1e-300)
        report[0] = iteration
        report[1] = relative
        if not np.isfinite(norm):
            return NOT_FINITE
        for i in range(5):
            if abs(q[i]) > 1e3 * arm * scale[i]:
                return RUN_AWAY
        if relative <= tolerance:
            return CONVERGED
        trace = 0.0
        for i in range(5):
            for j in range(5):
                H[i, j] = (K[i, j] + stiffness[i, j]) * scale[i] * scale[j] * free[i] * free[j]
            trace = max(trace, H[i, i])
        if trace == 0.0:
            trace = norm / radius
        for i in range(5):
            if free[i] == 0.0:
                H[i, i] = trace
        # The step: Newton where it stays inside the radius, else (H + shift) d = -g with |d| = radius.
        shift, low, high = 0.0, 0.0, 0.0
        for _ in range(60):
            for i in range(5):
                rhs[i] = -g[i]
                for j in range(5):
                    factor[i, j] = H[i, j]
                factor[i, i] += shift + 1e-15 * trace
            size = np.inf
            if cholesky_solve(factor, rhs, 5):
                size = 0.0
                for i in range(5):
                    size += rhs[i] * rhs[i]
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
        if not np.isfinite(size):
            return NOT_CONVERGED
        predicted = 0.0
        for i in range(5):
            step[i] = rhs[i] * scale[i]
            trial[i] = q[i] + step[i]
        for i in range(5):
            total = g[i]
            for j in range(5):
                total += 0.5 * H[i, j] * rhs[j]
            predicted -= rhs[i] * total
        for k in range(ball.shape[0]):
            for c in range(ball.shape[1]):
                ball_new[k, c] = ball[k, c]
        if np.isnan(potential):
            potential = contact_energy(law, law_params, law_state, law_new, table, ball, work, energy_rows)
            for i in range(5):
                potential -= load[i] * q[i]
                for j in range(5):
                    potential += 0.5 * q[i] * stiffness[i, j] * q[j]
        status = system(
            t, 0.0, trial, rest, ball_new, 0.0, zeros, law, law_params, law_state, law_new, scalars, table, work,
            f_new, K_new, C,
        )  # fmt: skip
        if status != 0:
            radius *= 0.25
            if radius < 1e-18:
                return BALLS_FAILED
            continue
        norm_new, forces_new = 0.0, force_scale(work, inner)
        for i in range(5):
            total = f_new[i] - load[i]
            for j in range(5):
                total += stiffness[i, j] * trial[j]
            g_new[i] = total * scale[i] * free[i]
            norm_new = max(norm_new, abs(g_new[i]))
        accepted = norm_new < 0.25 * norm
        if accepted:
            potential = np.nan
            radius = max(radius, 3.0 * size)
        else:
            energy = contact_energy(law, law_params, law_state, law_new, table, ball_new, work, energy_rows)
            for i in range(5):
                energy -= load[i] * trial[i]
                for j in range(5):
                    energy += 0.5 * trial[i] * stiffness[i, j] * trial[j]
            ratio = (potential - energy) / predicted if predicted > 0.0 else 0.0
            rounding = 1e-13 * (abs(potential) + abs(energy))
            if predicted <= rounding:
                # Energies no longer tell the two states apart: the mean of the slopes at both ends of the step does.
                slopes = 0.0
                for i in range(5):
                    slopes += (g[i] + g_new[i]) * rhs[i]
                ratio = -0.5 * slopes / predicted if predicted > 0.0 else 0.0
            accepted = ratio > 1e-4
            if ratio < 0.25:
                radius = 0.25 * min(radius, size)
            elif ratio > 0.75 and size >= 0.7 * radius:
                radius *= 3.0
            if accepted:
                potential = energy
            if radius < 1e-22:
                # No step helps any more: rounding, where the imbalance is small already.
                return CONVERGED if relative <= 1e3 * tolerance else NOT_CONVERGED
        if accepted:
            forces = forces_new
            for i in range(5):
                q[i] = trial[i]
                f[i] = f_new[i]
                for j in range(5):
                    K[i, j] = K_new[i, j]
            for k in range(ball.shape[0]):
                for c in range(ball.shape[1]):
                    ball[k, c] = ball_new[k, c]
    return CONVERGED if relative <= 1e3 * tolerance else NOT_CONVERGED
