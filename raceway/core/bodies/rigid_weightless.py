"""Rigid rings and balls without mass: the two races of each ball in series along the line of the groove centres.

Notes
-----
With e = e_rest + J q the vector from the outer to the inner groove centre and s = |e|, the races share the approach
s - B: f_inner(s - s_o - L_i) = f_outer(s_o - L_o), where s_o is the distance of ball and outer groove centre and L the
offsets at first touch.  A ball that carries nothing sits midway between the races.
"""

import numpy as np

from raceway.core.bodies.ring import (
    DAMPING,
    LEVER,
    OFFSET_INNER,
    OFFSET_OUTER,
    OUTER_SHARE,
    SIDE,
    TILT_ARM,
    add_ball,
    place,
)
from raceway.core.contact import add_damping
from raceway.core.jit import jit
from raceway.core.signatures import SYSTEM

_ITERATIONS = 60


@jit(SYSTEM)
def rigid_weightless(
    t, dt, q, v, ball, ball_gain, ball_known, law, law_params, law_old, law_new, scalars, table, work, f, K, C
):
    """See ``raceway.core.bodies``; ball[:, 0] is s_o [m], ball[:, 1] is not used."""
    z = table.shape[0]
    arm, li, lo, damping = scalars[TILT_ARM], scalars[OFFSET_INNER], scalars[OFFSET_OUTER], scalars[DAMPING]
    gap, rate, force, d_gap, d_rate = work[0], work[1], work[2], work[3], work[4]
    ea, er, low, high, speed = work[5], work[6], work[7], work[8], work[9]
    cosine, sine = work[10][:z], work[10][z:]
    for i in range(5):
        f[i] = 0.0
        for j in range(5):
            K[i, j] = 0.0
            C[i, j] = 0.0
    place(t, q, v, scalars, table, ea[:z], er[:z], work[11][:z], work[11][z:], cosine, sine)
    for k in range(z):
        length = np.sqrt(ea[k] * ea[k] + er[k] * er[k])
        approach = length - li - lo
        ea[z + k] = length
        er[z + k] = approach
        speed[k] = (work[11, k] * ea[k] + work[11, z + k] * er[k]) / length if length > 0.0 else 0.0
        low[k], high[k] = 0.0, max(approach, 0.0)
        share = table[k, OUTER_SHARE] if approach > 0.0 else 0.5
        ball[k, 0] = lo + share * approach
    for iteration in range(_ITERATIONS):
        for k in range(z):
            own = ball_gain * ball[k, 0] + ball_known[k, 0]
            outer = ball[k, 0] - lo
            gap[k] = outer - er[z + k]
            gap[z + k] = -outer
            rate[k] = own - speed[k]
            rate[z + k] = -own
        law(gap, rate, law_params, law_old, law_new, dt, force, d_gap, d_rate)
        add_damping(damping, gap, rate, force, d_gap, d_rate)
        moving = False
        for k in range(z):
            approach = er[z + k]
            if approach <= 0.0:
                continue
            ki = -d_gap[k] - ball_gain * d_rate[k]
            ko = -d_gap[z + k] - ball_gain * d_rate[z + k]
            imbalance = force[k] - force[z + k]
            if not (ki + ko > 0.0) or imbalance == 0.0:
                continue
            outer = ball[k, 0] - lo
            if imbalance > 0.0:
                low[k] = outer
            else:
                high[k] = outer
            step = imbalance / (ki + ko)
            if abs(step) <= 1e-8 * approach:
                # One linear correction ends the iteration: what it leaves is of second order.
                ball[k, 0] += step
                force[k] -= ki * step
                force[z + k] += ko * step
                gap[k] += step
                gap[z + k] -= step
                continue
            trial = outer + step
            if trial <= low[k] or trial >= high[k]:
                trial = 0.5 * (low[k] + high[k])
                if trial == low[k] or trial == high[k]:
                    continue
            ball[k, 0] = lo + trial
            moving = True
        if not moving:
            break
        if iteration == _ITERATIONS - 1:
            return 1
    for k in range(z):
        if er[z + k] <= 0.0:
            force[k] = 0.0
            force[z + k] = 0.0
            continue
        total = -d_gap[k] - d_gap[z + k] - ball_gain * (d_rate[k] + d_rate[z + k])
        if not total > 0.0:
            continue
        length = ea[z + k]
        na, nr = ea[k] / length, er[k] / length
        carried = force[k]
        share = (-d_gap[z + k] - ball_gain * d_rate[z + k]) / total
        normal = -d_gap[k] * share - carried / length
        dashpot = -d_rate[k] * share
        add_ball(
            cosine[k], sine[k], arm, table[k, SIDE], table[k, LEVER], carried * na, carried * nr,
            normal * na * na + carried / length, normal * na * nr, normal * na * nr,
            normal * nr * nr + carried / length,
            dashpot * na * na, dashpot * na * nr, dashpot * na * nr, dashpot * nr * nr, f, K, C,
        )  # fmt: skip
    return 0
