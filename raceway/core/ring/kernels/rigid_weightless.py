"""Rigid rings and balls without mass: the two races of each ball in series along the line of the groove centres.

Notes
-----
With e = e_rest + J q the vector from the outer to the inner groove centre and s = |e|, the races share the approach
s - B: f_inner(s - s_o - L_i) = f_outer(s_o - L_o), where s_o is the distance of ball and outer groove centre and L the
offsets at first touch.  A ball that carries nothing sits midway between the races.
"""

import numpy as np

from raceway.core.contact.damping import add_damping
from raceway.core.jit import jit
from raceway.core.ring.kernels import (
    AXIAL_BY_SHIFT,
    BY_AXIAL,
    BY_AXIAL_SPEED,
    BY_OTHER,
    BY_OWN,
    BY_RADIAL,
    BY_RADIAL_SPEED,
    FORCE,
    FORCE_BY_CENTRE,
    FORCE_BY_SPEED,
    RADIAL_BY_SHIFT,
    SHIFT,
    SHIFT_RATE,
    WORK_ROWS,
)
from raceway.core.ring.kernels.layout import (
    DAMPING,
    OFFSET_INNER,
    OFFSET_OUTER,
    OUTER_SHARE,
    TILT_ARM,
    move_centres,
    place,
    ring_force,
    ring_tangent,
)
from raceway.core.signatures import SYSTEM

_ITERATIONS = 60
#: Rows of ``work`` beyond the law's, two quantities each, a half row long (index k, then z + k): direction of the line of
#: centres, bracket of the outer approach, speed along that line and approach of both races, its length and the outer
#: race's approach, force on the ring, tangents, velocity of the inner groove centre, azimuth.
NORMAL, BRACKET, SPEED, LENGTH, CARRIED, STIFF, VISCOUS, VELOCITY, DIRECTION = 5, 6, 7, 8, 9, 10, 12, 14, 15
APPROACH, OUTER = SPEED, LENGTH


@jit(SYSTEM)
def rigid_weightless(t, q, v, balls, contacts, constants, response):
    """See ``raceway.core.ring.kernels``; ball[:, 0] is s_o [m], ball[:, 1] is not used."""
    ball, ball_gain, ball_known = balls
    law, law_params, law_old, law_new, dt = contacts
    scalars, table = constants
    f, K, C, work = response
    z = table.shape[0]
    arm, li, lo, damping = scalars[TILT_ARM], scalars[OFFSET_INNER], scalars[OFFSET_OUTER], scalars[DAMPING]
    gap, rate, force, d_gap, d_rate = work[0], work[1], work[2], work[3], work[4]
    place(t, q, v, scalars, table, work, DIRECTION, NORMAL, VELOCITY)
    if work.shape[0] > WORK_ROWS:
        move_centres(work, NORMAL, VELOCITY)
    for k in range(z):
        a, r = work[NORMAL, k], work[NORMAL, z + k]
        length = np.sqrt(a * a + r * r)
        inverse = 1.0 / max(length, 1e-300)
        na, nr = a * inverse, r * inverse
        speed = work[VELOCITY, k] * na + work[VELOCITY, z + k] * nr
        approach = length - li - lo - work[SHIFT, k] - work[SHIFT, z + k]
        outer = (table[k, OUTER_SHARE] if approach > 0.0 else 0.5) * approach
        own = ball_gain * (lo + work[SHIFT, z + k] + outer) + ball_known[k, 0]
        rate_i, rate_o = own - speed + work[SHIFT_RATE, k], work[SHIFT_RATE, z + k] - own
        work[NORMAL, k], work[NORMAL, z + k] = na, nr
        work[APPROACH, z + k], work[LENGTH, k] = approach, length
        work[OUTER, z + k] = outer
        work[BRACKET, k], work[BRACKET, z + k] = 0.0, approach
        gap[k], gap[z + k], rate[k], rate[z + k] = outer - approach, -outer, rate_i, rate_o
    moving = 1
    for _ in range(_ITERATIONS):
        law(gap, rate, law_params, law_old, law_new, dt, force, d_gap, d_rate)
        add_damping(damping, gap, rate, force, d_gap, d_rate)
        moving = 0
        for k in range(z):
            ki = -d_gap[k] - ball_gain * d_rate[k]
            ko = -d_gap[z + k] - ball_gain * d_rate[z + k]
            fi, fo, approach, outer = force[k], force[z + k], work[APPROACH, z + k], work[OUTER, z + k]
            stiff, imbalance = ki + ko, fi - fo
            if not approach > 0.0 or not stiff > 0.0 or imbalance == 0.0:
                continue
            step = imbalance / stiff
            if abs(step) <= 1e-8 * approach:
                # A correction this small ends the iteration linearly: what it leaves is of second order.
                inner = gap[k] + step
                work[OUTER, z + k] = outer + step
                gap[k], gap[z + k] = inner, -outer - step
                force[k], force[z + k] = fi - ki * step, fo + ko * step
                continue
            work[BRACKET, k if imbalance > 0.0 else z + k] = outer
            low, high = work[BRACKET, k], work[BRACKET, z + k]
            trial = outer + step if low < outer + step < high else 0.5 * (low + high)
            moving += 1 if trial != outer else 0
            step = trial - outer
            work[OUTER, z + k] = trial
            gap[k], gap[z + k] = trial - approach, -trial
            rate[k] += ball_gain * step
            rate[z + k] -= ball_gain * step
        if moving == 0:
            break
    for k in range(z):
        closed = 1.0 if work[APPROACH, z + k] > 0.0 else 0.0
        fi, fo, na, nr = force[k] * closed, force[z + k] * closed, work[NORMAL, k], work[NORMAL, z + k]
        ball[k, 0] = lo + work[SHIFT, z + k] + work[OUTER, z + k]
        force[k], force[z + k] = fi, fo
        work[CARRIED, k], work[CARRIED, z + k] = fi * na, fi * nr
    ring_force(table, arm, work, DIRECTION, CARRIED, f)
    if work.shape[0] > WORK_ROWS:
        # Both contacts carry the same force, and feel both shifts alike.
        for k in range(z):
            ki, ko = -d_gap[k] - ball_gain * d_rate[k], -d_gap[z + k] - ball_gain * d_rate[z + k]
            closed = 1.0 if work[APPROACH, z + k] > 0.0 and ki + ko > 0.0 else 0.0
            share = closed * ko / max(ki + ko, 1e-300)
            na, nr = work[NORMAL, k], work[NORMAL, z + k]
            for c in (k, z + k):
                work[BY_AXIAL, c], work[BY_RADIAL, c] = -d_gap[k] * share * na, -d_gap[k] * share * nr
                work[BY_AXIAL_SPEED, c], work[BY_RADIAL_SPEED, c] = -d_rate[k] * share * na, -d_rate[k] * share * nr
                work[BY_OWN, c] = work[BY_OTHER, c] = -ki * share
                work[AXIAL_BY_SHIFT, c], work[RADIAL_BY_SHIFT, c] = -ki * share * na, -ki * share * nr
                work[FORCE, c] = work[CARRIED, c]
            across = closed * force[k] / max(work[LENGTH, k], 1e-300)
            along, dashpot = -d_gap[k] * share - across, -d_rate[k] * share
            work[FORCE_BY_CENTRE, k], work[FORCE_BY_CENTRE, z + k] = along * na * na + across, along * na * nr
            work[FORCE_BY_CENTRE + 1, k], work[FORCE_BY_CENTRE + 1, z + k] = along * na * nr, along * nr * nr + across
            work[FORCE_BY_SPEED, k], work[FORCE_BY_SPEED, z + k] = dashpot * na * na, dashpot * na * nr
            work[FORCE_BY_SPEED + 1, k], work[FORCE_BY_SPEED + 1, z + k] = dashpot * na * nr, dashpot * nr * nr
    if K.size > 0:
        for k in range(z):
            stiff = -d_gap[k] - d_gap[z + k] - ball_gain * (d_rate[k] + d_rate[z + k])
            na, nr = work[NORMAL, k], work[NORMAL, z + k]
            closed = 1.0 if work[APPROACH, z + k] > 0.0 and stiff > 0.0 else 0.0
            share = closed * (-d_gap[z + k] - ball_gain * d_rate[z + k]) / max(stiff, 1e-300)
            across = closed * force[k] / max(work[LENGTH, k], 1e-300)
            along, dashpot = -d_gap[k] * share - across, -d_rate[k] * share
            work[STIFF, k], work[STIFF, z + k] = along * na * na + across, along * na * nr
            work[STIFF + 1, k], work[STIFF + 1, z + k] = along * na * nr, along * nr * nr + across
            work[VISCOUS, k], work[VISCOUS, z + k] = dashpot * na * na, dashpot * na * nr
            work[VISCOUS + 1, k], work[VISCOUS + 1, z + k] = dashpot * na * nr, dashpot * nr * nr
        ring_tangent(table, arm, work, DIRECTION, STIFF, K)
        ring_tangent(table, arm, work, DIRECTION, VISCOUS, C)
    return 1 if moving > 0 else 0
