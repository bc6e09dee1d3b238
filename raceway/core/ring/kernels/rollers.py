"""Rigid rings on cylindrical rollers: line contacts cut into laminae, with the rollers' profile.

With the radial approach of both races d = y cos + z sin + growth - clearance / 2 and u = tilt_y sin - tilt_z cos, a lamina at x along
the roller, of profile P(x) = A ln[1 / (1 - (2 x / L)^2)], has the approaches d - p - x u / 2 - P at the inner race and p - x u / 2 - P
at the outer one: the roller shares the misalignment evenly, as ISO/TS 16281 has it.  The roller lies where Q_o(p) = Q_i(d - p) + F_c.
Each of n laminae carries 1 / n of what the law gives the full contact at the lamina's gap.
"""

import numpy as np
from numba import float64, int64, void

from raceway.core.contact.damping import add_damping
from raceway.core.jit import jit
from raceway.core.ring.kernels import CONTACT_FORCE, FORCE_BY_GAP, FORCE_BY_RATE, GAP, GAP_RATE, SHIFT, STORED
from raceway.core.ring.kernels.layout import CAGE, CENTRIFUGAL, COLUMNS, DAMPING, place
from raceway.core.signatures import CONTACTS, MATRIX, SYSTEM, VECTOR

#: Columns of ``table`` beyond those of balls: length of the contacts [m], factor A of the profile [m], number of laminae.
LENGTH, PROFILE, LAMINAE = range(COLUMNS, COLUMNS + 3)
ROLLER_COLUMNS = COLUMNS + 3
_ITERATIONS = 80
#: Rows of ``work`` between the law's five and those that stay zero here: azimuth, radial approach of the races, its speed,
#: bracket of the outer approach, outer approach with its rate, misalignment u with its rate; then of every contact, summed over the
#: laminae: load, its first moment along the roller, stiffness with first and second moment, dashpot with the same.
_DIRECTION, _APPROACH, _SPEED, _BRACKET, _OUTER, _TURN = range(5, 11)
_LOAD, _MOMENT, _STIFF, _STIFF_1, _STIFF_2, _VISCOUS, _VISCOUS_1, _VISCOUS_2 = range(11, 19)


@jit(void(float64, MATRIX), inline=True)
def _add_energies(share, work):
    """Add the share of each contact's energy [J] to STORED: Q delta / (1 + m) of a law that goes with delta^m.

    Energies of systems are the law's at the gaps in ``work``, those of the middle, and STORED: what the laminae have beyond it.
    """
    for i in range(work.shape[1]):
        load, approach = work[CONTACT_FORCE, i], -work[GAP, i]
        if load > 0.0 and approach > 0.0:
            work[STORED, i] += share * load * approach / (1.0 - work[FORCE_BY_GAP, i] * approach / load)


@jit(void(CONTACTS, VECTOR, MATRIX, MATRIX))
def _sum_laminae(contacts, scalars, table, work):
    """Sums over the laminae from the places of the rollers; gaps are then those of the middle."""
    law, law_params, law_old, law_new, dt = contacts
    z, n, length = table.shape[0], int(table[0, LAMINAE]), table[0, LENGTH]
    gap, rate, force = work[GAP], work[GAP_RATE], work[CONTACT_FORCE]
    d_gap, d_rate = work[FORCE_BY_GAP], work[FORCE_BY_RATE]
    work[_LOAD : _VISCOUS_2 + 1] = 0.0
    work[STORED] = 0.0
    share = 1.0 / n
    for lamina in range(n):
        x = ((lamina + 0.5) * share - 0.5) * length
        drop = -table[0, PROFILE] * np.log(1.0 - (2.0 * x / length) ** 2)
        for k in range(z):
            lean, lean_rate = 0.5 * x * work[_TURN, k], 0.5 * x * work[_TURN, z + k]
            outer, own = work[_OUTER, k], work[_OUTER, z + k]
            gap[k], gap[z + k] = outer - work[_APPROACH, z + k] + lean + drop, lean - outer + drop
            rate[k], rate[z + k] = own - work[_SPEED, z + k] + lean_rate, lean_rate - own
        law(gap, rate, law_params, law_old, law_new, dt, force, d_gap, d_rate)
        _add_energies(share, work)
        add_damping(scalars[DAMPING], gap, rate, force, d_gap, d_rate)
        for i in range(2 * z):
            load, stiff, viscous = share * force[i], -share * d_gap[i], -share * d_rate[i]
            work[_LOAD, i] += load
            work[_MOMENT, i] += x * load
            work[_STIFF, i] += stiff
            work[_STIFF_1, i] += x * stiff
            work[_STIFF_2, i] += x * x * stiff
            work[_VISCOUS, i] += viscous
            work[_VISCOUS_1, i] += x * viscous
            work[_VISCOUS_2, i] += x * x * viscous
    for k in range(z):
        gap[k], gap[z + k] = work[_OUTER, k] - work[_APPROACH, z + k], -work[_OUTER, k]
    law(gap, rate, law_params, law_old, law_new, dt, force, d_gap, d_rate)
    _add_energies(-1.0, work)
    for k in range(z):
        force[k], force[z + k] = work[_LOAD, k], work[_LOAD, z + k]


@jit(void(int64, int64, float64, MATRIX, MATRIX), inline=True)
def _add_tangent(k, row, gain, work, tangent):
    """Add roller k's derivatives by d and u, or by their rates, to a tangent (5, 5) of the ring.

    row : of the sums that act directly, the stiffnesses or the dashpots

    With S the sum of both races' stiffness against p, dp = (k_i dd - (k_i1 - k_o1) du / 2) / S; dQ = k_i dd - k_i1 du / 2 - S_i dp and
    dM = k_i1 dd - k_i2 du / 2 - S_i1 dp; the ring feels Q along d and -M along u.
    """
    z = work.shape[1] // 2
    inner = work[_STIFF, k] + gain * work[_VISCOUS, k]
    total = inner + work[_STIFF, z + k] + gain * work[_VISCOUS, z + k]
    if not total > 0.0:
        return
    along = work[_STIFF_1, k] + gain * work[_VISCOUS_1, k]
    by_d, by_u = work[row, k] / total, -0.5 * (work[row + 1, k] - work[row + 1, z + k]) / total
    c, s = work[_DIRECTION, k], work[_DIRECTION, z + k]
    pairs = (
        (work[row, k] - inner * by_d, -0.5 * work[row + 1, k] - inner * by_u),
        (along * by_d - work[row + 1, k], 0.5 * work[row + 2, k] + along * by_u),
    )
    by = ((c, s, 0.0, 0.0), (0.0, 0.0, s, -c))
    for i in range(2):
        for j in range(2):
            for m in range(4):
                for n in range(4):
                    tangent[1 + m, 1 + n] += by[i][m] * pairs[i][j] * by[j][n]


@jit(SYSTEM)
def rollers(t, q, v, balls, contacts, constants, response):
    """See ``raceway.core.ring.kernels``; ball[:, 1] is the outer approach p [m], radial; ball[:, 0] is not used.

    The difference of the sides grows with p: Newton's method within a bracket finds the one place.
    """
    ball, ball_gain, ball_history = balls
    scalars, table = constants
    f, K, C, work = response
    z, reach, cage = table.shape[0], 0.5 * table[0, LENGTH], scalars[CAGE]
    place(t, q, v, constants, work, (_DIRECTION, _APPROACH, _SPEED))
    for k in range(z):
        approach, push = work[_APPROACH, z + k], table[k, CENTRIFUGAL]
        c, s = work[_DIRECTION, k], work[_DIRECTION, z + k]
        work[_TURN, k] = q[3] * s - q[4] * c
        work[_TURN, z + k] = (v[3] + cage * q[4]) * s - (v[4] - cage * q[3]) * c
        edge = 0.5 * reach * abs(work[_TURN, k])
        low, high = min(0.0, approach) - edge, np.inf if push > 0.0 else max(0.0, approach) + edge
        in_contact = approach + 2.0 * edge > 0.0 or push > 0.0
        # Without any load a roller lies in the middle; a pushed one as deep as its outer contact asks for.
        outer = ball[k, 1] if in_contact and ball[k, 1] != 0.0 and low < ball[k, 1] < high else 0.5 * approach
        work[_OUTER, k], work[_OUTER, z + k] = outer, ball_gain * outer + ball_history[k, 1]
        work[_BRACKET, k], work[_BRACKET, z + k] = low, high
        work[SHIFT, k] = work[SHIFT, z + k] = 0.0
    moving = 1
    for _ in range(_ITERATIONS):
        _sum_laminae(contacts, scalars, table, work)
        moving = 0
        for k in range(z):
            outer, push = work[_OUTER, k], table[k, CENTRIFUGAL]
            inner_load, outer_load = work[_LOAD, k], work[_LOAD, z + k]
            if inner_load == 0.0 and outer_load == 0.0 and push == 0.0:
                continue
            excess = inner_load + push - outer_load
            stiff = work[_STIFF, k] + work[_STIFF, z + k] + ball_gain * (work[_VISCOUS, k] + work[_VISCOUS, z + k])
            if abs(excess) <= 1e-13 * (inner_load + outer_load + push):
                continue
            work[_BRACKET, k if excess > 0.0 else z + k] = outer
            low, high = work[_BRACKET, k], work[_BRACKET, z + k]
            trial = outer + excess / stiff if stiff > 0.0 else np.inf
            if not low < trial < high:
                # Beyond all brackets the contact is followed from first touch, where its stiffness is none.
                trial = 0.5 * (low + high) if high < np.inf else 2.0 * max(outer, 0.0) + 1e-9
            if trial == outer:
                continue
            moving += 1
            work[_OUTER, k] = trial
            work[_OUTER, z + k] += ball_gain * (trial - outer)
        if moving == 0:
            break
    f[:] = 0.0
    for k in range(z):
        ball[k, 0], ball[k, 1] = 0.0, work[_OUTER, k]
        c, s, load, moment = work[_DIRECTION, k], work[_DIRECTION, z + k], work[_LOAD, k], work[_MOMENT, k]
        f[1] += load * c
        f[2] += load * s
        f[3] -= moment * s
        f[4] += moment * c
    if K.size > 0:
        K[:] = 0.0
        C[:] = 0.0
        for k in range(z):
            _add_tangent(k, _STIFF, ball_gain, work, K)
            _add_tangent(k, _VISCOUS, ball_gain, work, C)
    return 1 if moving > 0 else 0
