"""Rigid rings and balls without mass: the two races of each ball in series along the line of the groove centres.

Notes
-----
With e = e_rest + J q the vector from the outer to the inner groove centre and s = |e|, the races share the approach
s - B: f_inner(s - s_o - L_i) = f_outer(s_o - L_o), where s_o is the distance of ball and outer groove centre and L the
offsets at first touch.  A ball that carries nothing sits midway between the races.
"""

import numpy as np

from raceway.core.bodies import (
    AXIAL_BY_SHIFT,
    BY_AXIAL,
    BY_AXIAL_SPEED,
    BY_OTHER,
    BY_OWN,
    BY_RADIAL,
    BY_RADIAL_SPEED,
    RADIAL_BY_SHIFT,
    SHIFT,
    SHIFT_RATE,
    WORK_ROWS,
)
from raceway.core.bodies.ring import (
    DAMPING,
    OFFSET_INNER,
    OFFSET_OUTER,
    OUTER_SHARE,
    TILT_ARM,
    place,
    ring_force,
    ring_tangent,
)
from raceway.core.contact import add_damping
from raceway.core.jit import jit
from raceway.core.signatures import SYSTEM

_ITERATIONS = 60
#: Rows of ``work`` beyond the law's, two quantities each, a half row long (index k, then z + k): direction of the line of
#: centres, bracket of the outer approach, speed along that line and approach of both races, its length and the outer
#: race's approach, force on the ring, tangents, velocity of the inner groove centre, azimuth.
NORMAL, BRACKET, SPEED, LENGTH, CARRIED, STIFF, VISCOUS, VELOCITY, DIRECTION = 5, 6, 7, 8, 9, 10, 12, 14, 15
APPROACH, OUTER = SPEED, LENGTH


@jit(SYSTEM)
def rigid_weightless(
    t, dt, q, v, ball, ball_gain, ball_known, law, law_params, law_old, law_new, scalars, table, work, f, K, C
):
    """See ``raceway.core.bodies``; ball[:, 0] is s_o [m], ball[:, 1] is not used."""
    z = table.shape[0]
    arm, li, lo, damping = scalars[TILT_ARM], scalars[OFFSET_INNER], scalars[OFFSET_OUTER], scalars[DAMPING]
    gap, rate, force, d_gap, d_rate = work[0], work[1], work[2], work[3], work[4]
    place(t, q, v, scalars, table, work, DIRECTION, NORMAL, VELOCITY)
    for k in range(z):
        a, r = work[NORMAL, k], work[NORMAL, z + k]
        work[LENGTH, k] = np.sqrt(a * a + r * r)
        inverse = 1.0 / max(work[LENGTH, k], 1e-300)
        work[NORMAL, k], work[NORMAL, z + k] = a * inverse, r * inverse
        work[SPEED, k] = work[VELOCITY, k] * work[NORMAL, k] + work[VELOCITY, z + k] * work[NORMAL, z + k]
        work[APPROACH, z + k] = work[LENGTH, k] - li - lo - work[SHIFT, k] - work[SHIFT, z + k]
        work[BRACKET, k], work[BRACKET, z + k] = 0.0, max(work[APPROACH, z + k], 0.0)
        share = table[k, OUTER_SHARE] if work[APPROACH, z + k] > 0.0 else 0.5
        work[OUTER, z + k] = share * work[APPROACH, z + k]
    # All balls go through every iteration, settled ones too, so that each loop is free of branches.
    moving = 1
    for _ in range(_ITERATIONS):
        for k in range(z):
            own = ball_gain * (lo + work[SHIFT, z + k] + work[OUTER, z + k]) + ball_known[k, 0]
            gap[k] = work[OUTER, z + k] - work[APPROACH, z + k]
            gap[z + k] = -work[OUTER, z + k]
            rate[k] = own - work[SPEED, k] + work[SHIFT_RATE, k]
            rate[z + k] = -own + work[SHIFT_RATE, z + k]
        law(gap, rate, law_params, law_old, law_new, dt, force, d_gap, d_rate)
        add_damping(damping, gap, rate, force, d_gap, d_rate)
        moving = 0
        for k in range(z):
            ki = -d_gap[k] - ball_gain * d_rate[k]
            ko = -d_gap[z + k] - ball_gain * d_rate[z + k]
            stiff = ki + ko
            imbalance = force[k] - force[z + k] if work[APPROACH, z + k] > 0.0 and stiff > 0.0 else 0.0
            work[BRACKET, k] = work[OUTER, z + k] if imbalance > 0.0 else work[BRACKET, k]
            work[BRACKET, z + k] = work[OUTER, z + k] if imbalance < 0.0 else work[BRACKET, z + k]
            step = imbalance / max(stiff, 1e-300)
            trial = work[OUTER, z + k] + step
            # A correction this small ends the iteration linearly: what it leaves is of second order.
            last = abs(step) <= 1e-8 * work[APPROACH, z + k]
            middle = 0.5 * (work[BRACKET, k] + work[BRACKET, z + k])
            between = trial > work[BRACKET, k] and trial < work[BRACKET, z + k]
            trial = trial if last or between else middle
            trial = trial if imbalance != 0.0 else work[OUTER, z + k]
            final = step if last else 0.0
            gap[k] += final
            gap[z + k] -= final
            force[k] -= ki * final
            force[z + k] += ko * final
            moving += 1 if not last and imbalance != 0.0 and trial != work[OUTER, z + k] else 0
            work[OUTER, z + k] = trial
        if moving == 0:
            break
    for k in range(z):
        closed = 1.0 if work[APPROACH, z + k] > 0.0 else 0.0
        force[k] *= closed
        force[z + k] *= closed
        ball[k, 0] = lo + work[SHIFT, z + k] + work[OUTER, z + k]
        work[CARRIED, k], work[CARRIED, z + k] = force[k] * work[NORMAL, k], force[k] * work[NORMAL, z + k]
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
