"""What is compiled: the contact law, and the ring on its rollers."""

import numpy as np

from raceway import LAW, jit
from raceway.core.contact.damping import add_damping
from raceway.core.ring.kernels import CONTACT_FORCE, FORCE_BY_GAP, FORCE_BY_RATE, GAP, GAP_RATE, SHIFT
from raceway.core.ring.kernels.layout import CENTRIFUGAL, DAMPING, TILT_ARM, place, ring_force, ring_tangent
from raceway.core.signatures import SYSTEM

_EXPONENT = 10.0 / 9.0
_ITERATIONS = 80
#: Rows of ``work`` between the law's five and those that stay zero here: azimuth, radial approach of the races, its speed,
#: bracket of the outer approach, outer approach, force on the ring, its tangents (two rows each).
_DIRECTION, _APPROACH, _SPEED, _BRACKET, _OUTER, _CARRIED, _STIFF, _VISCOUS = 5, 6, 7, 8, 9, 10, 11, 13


@jit(LAW)
def palmgren(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    """params (n, 1): factor k of Q = k delta^(10/9) [N/m^(10/9)]."""
    for i in range(gap.size):
        approach = max(-gap[i], 0.0)
        slope = params[i, 0] * approach ** (_EXPONENT - 1.0)
        force[i], d_gap[i], d_rate[i] = slope * approach, -_EXPONENT * slope, 0.0


@jit(SYSTEM)
def rollers(t, q, v, balls, contacts, constants, response):
    """See ``raceway.core.ring.kernels``; ball[:, 1] is the outer approach p [m], radial; ball[:, 0] is not used.

    Notes
    -----
    With the radial approach of both races d = y cos + z sin + growth - clearance / 2, a roller lies where
    Q_o(p) = Q_i(d - p) + F_c.  The difference of the sides grows with p: Newton's method within a bracket finds the one place.
    """
    ball, ball_gain, ball_history = balls
    law, law_params, law_old, law_new, dt = contacts
    scalars, table = constants
    f, K, C, work = response
    z = table.shape[0]
    gap, rate, force = work[GAP], work[GAP_RATE], work[CONTACT_FORCE]
    d_gap, d_rate = work[FORCE_BY_GAP], work[FORCE_BY_RATE]
    place(t, q, v, constants, work, (_DIRECTION, _APPROACH, _SPEED))
    for k in range(z):
        approach, push = work[_APPROACH, z + k], table[k, CENTRIFUGAL]
        # Without any load a roller lies in the middle; a pushed one as deep as its outer contact asks for.
        outer = ball[k, 1] if (approach > 0.0 or push > 0.0) and ball[k, 1] > 0.0 else 0.5 * approach
        own = ball_gain * outer + ball_history[k, 1]
        work[_OUTER, k] = outer
        work[_BRACKET, k], work[_BRACKET, z + k] = min(0.0, approach), np.inf if push > 0.0 else max(0.0, approach)
        gap[k], gap[z + k] = outer - approach, -outer
        rate[k], rate[z + k] = own - work[_SPEED, z + k], -own
        work[SHIFT, k] = work[SHIFT, z + k] = 0.0
    moving = 1
    for _ in range(_ITERATIONS):
        law(gap, rate, law_params, law_old, law_new, dt, force, d_gap, d_rate)
        add_damping(scalars[DAMPING], gap, rate, force, d_gap, d_rate)
        moving = 0
        for k in range(z):
            approach, outer, push = work[_APPROACH, z + k], work[_OUTER, k], table[k, CENTRIFUGAL]
            if approach <= 0.0 and push == 0.0:
                continue
            excess = force[k] + push - force[z + k]
            stiff = -d_gap[k] - d_gap[z + k] - ball_gain * (d_rate[k] + d_rate[z + k])
            if abs(excess) <= 1e-14 * (force[k] + force[z + k] + push):
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
            gap[k], gap[z + k] = trial - approach, -trial
            rate[k] += ball_gain * (trial - outer)
            rate[z + k] -= ball_gain * (trial - outer)
        if moving == 0:
            break
    for k in range(z):
        ball[k, 0], ball[k, 1] = 0.0, work[_OUTER, k]
        work[_CARRIED, k], work[_CARRIED, z + k] = 0.0, force[k]
        inner, outer = -d_gap[k] - ball_gain * d_rate[k], -d_gap[z + k] - ball_gain * d_rate[z + k]
        share = outer / (inner + outer) if inner + outer > 0.0 else 0.0
        for row in (_STIFF, _VISCOUS):
            work[row, k], work[row, z + k], work[row + 1, k] = 0.0, 0.0, 0.0
        work[_STIFF + 1, z + k], work[_VISCOUS + 1, z + k] = -d_gap[k] * share, -d_rate[k] * share
    ring_force(table, scalars[TILT_ARM], work, _DIRECTION, _CARRIED, f)
    if K.size > 0:
        ring_tangent(table, scalars[TILT_ARM], work, _DIRECTION, _STIFF, K)
        ring_tangent(table, scalars[TILT_ARM], work, _DIRECTION, _VISCOUS, C)
    return 1 if moving > 0 else 0
