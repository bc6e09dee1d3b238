"""Rigid rings and balls without mass: the two races of each ball in series along the line of the groove centres.

With e = e_rest + J q the vector from the outer to the inner groove centre and s = |e|, the races share the approach
s - B: f_inner(s - s_o - L_i) = f_outer(s_o - L_o), where s_o is the distance of ball and outer groove centre and L the
offsets at first touch.  A ball that carries nothing sits midway between the races.
"""

import numpy as np
from numba import boolean, float64, int64, void

from raceway.core.jit import jit
from raceway.core.ring import kernels as rows
from raceway.core.ring.kernels import layout as ring
from raceway.core.ring.kernels.layout import move_centres, normal_forces, offsets_of, place, ring_force, ring_tangent
from raceway.core.ring.kernels.tensors import Tensor, put_tensor
from raceway.core.signatures import MATRIX, SYSTEM, VECTOR

_ITERATIONS = 60
#: Rows of ``work`` beyond the law's, two quantities each, a half row long (index k, then z + k): direction of the line of
#: centres, bracket of the outer approach [m], speed along that line [m/s] and approach of both races [m], its length and the
#: outer race's approach [m], force on the ring [N], tangents [N/m, N s/m] (two rows each), velocity of the inner groove
#: centre [m/s], azimuth.
NORMAL, BRACKET, SPEED, LENGTH, CARRIED, STIFF, VISCOUS, VELOCITY, DIRECTION = 5, 6, 7, 8, 9, 10, 12, 14, 15
APPROACH, OUTER = SPEED, LENGTH


@jit(void(int64, VECTOR, MATRIX, MATRIX, float64, MATRIX, MATRIX), inline=True)
def _share(k, scalars, table, ball, ball_gain, ball_history, work):
    """First guess of ball k: direction and length of its line, and the approach shared as Hertzian contacts share it."""
    z = table.shape[0]
    li, lo = offsets_of(k, scalars, table)
    a, r = work[NORMAL, k], work[NORMAL, z + k]
    length = np.sqrt(a * a + r * r)
    inverse = 1.0 / max(length, 1e-300)
    na, nr = a * inverse, r * inverse
    speed = work[VELOCITY, k] * na + work[VELOCITY, z + k] * nr
    approach = length - li - lo - work[rows.SHIFT, k] - work[rows.SHIFT, z + k]
    outer = (table[k, ring.OUTER_SHARE] if approach > 0.0 else 0.5) * approach
    ball_rate = ball_gain * (lo + work[rows.SHIFT, z + k] + outer) + ball_history[k, 0]
    rate_i, rate_o = ball_rate - speed + work[rows.SHIFT_RATE, k], work[rows.SHIFT_RATE, z + k] - ball_rate
    work[NORMAL, k], work[NORMAL, z + k] = na, nr
    work[APPROACH, z + k], work[LENGTH, k] = approach, length
    work[OUTER, z + k] = outer
    work[BRACKET, k], work[BRACKET, z + k] = 0.0, approach
    work[rows.GAP, k], work[rows.GAP, z + k] = outer - approach, -outer
    work[rows.GAP_RATE, k], work[rows.GAP_RATE, z + k] = rate_i, rate_o


@jit(boolean(int64, int64, float64, MATRIX), inline=True)
def _moves(k, z, ball_gain, work):
    """Move ball k by one step of Newton's method inside its bracket; whether it needs another one."""
    ki = -work[rows.FORCE_BY_GAP, k] - ball_gain * work[rows.FORCE_BY_RATE, k]
    ko = -work[rows.FORCE_BY_GAP, z + k] - ball_gain * work[rows.FORCE_BY_RATE, z + k]
    fi, fo = work[rows.CONTACT_FORCE, k], work[rows.CONTACT_FORCE, z + k]
    approach, outer = work[APPROACH, z + k], work[OUTER, z + k]
    stiff, imbalance = ki + ko, fi - fo
    if not approach > 0.0 or not stiff > 0.0 or imbalance == 0.0:
        return False
    step = imbalance / stiff
    if abs(step) <= 1e-8 * approach:
        # A correction this small ends the iteration linearly: what it leaves is of second order.
        inner = work[rows.GAP, k] + step
        work[OUTER, z + k] = outer + step
        work[rows.GAP, k], work[rows.GAP, z + k] = inner, -outer - step
        work[rows.CONTACT_FORCE, k], work[rows.CONTACT_FORCE, z + k] = fi - ki * step, fo + ko * step
        return False
    work[BRACKET, k if imbalance > 0.0 else z + k] = outer
    low, high = work[BRACKET, k], work[BRACKET, z + k]
    trial = outer + step if low < outer + step < high else 0.5 * (low + high)
    step = trial - outer
    work[OUTER, z + k] = trial
    work[rows.GAP, k], work[rows.GAP, z + k] = trial - approach, -trial
    work[rows.GAP_RATE, k] += ball_gain * step
    work[rows.GAP_RATE, z + k] -= ball_gain * step
    return trial != outer


@jit(void(int64, int64, float64, MATRIX), inline=True)
def _tangents(k, z, ball_gain, work):
    """Tangents of ball k to the ring, and for elastic bodies the derivatives of its contact forces: both feel both shifts alike."""
    by_gap, by_rate = work[rows.FORCE_BY_GAP, k], work[rows.FORCE_BY_RATE, k]
    ki = -by_gap - ball_gain * by_rate
    ko = -work[rows.FORCE_BY_GAP, z + k] - ball_gain * work[rows.FORCE_BY_RATE, z + k]
    na, nr = work[NORMAL, k], work[NORMAL, z + k]
    contact = 1.0 if work[APPROACH, z + k] > 0.0 and ki + ko > 0.0 else 0.0
    share = contact * ko / max(ki + ko, 1e-300)
    across = contact * work[rows.CONTACT_FORCE, k] / max(work[LENGTH, k], 1e-300)
    along, dashpot = -by_gap * share - across, -by_rate * share
    stiffness = Tensor(along * na * na + across, along * na * nr, along * na * nr, along * nr * nr + across)
    damping = Tensor(dashpot * na * na, dashpot * na * nr, dashpot * na * nr, dashpot * nr * nr)
    put_tensor(stiffness, work, STIFF, k)
    put_tensor(damping, work, VISCOUS, k)
    if work.shape[0] == rows.WORK_ROWS:
        return
    put_tensor(stiffness, work, rows.FORCE_BY_CENTRE, k)
    put_tensor(damping, work, rows.FORCE_BY_SPEED, k)
    for c in (k, z + k):
        work[rows.BY_AXIAL, c], work[rows.BY_RADIAL, c] = -by_gap * share * na, -by_gap * share * nr
        work[rows.BY_AXIAL_SPEED, c], work[rows.BY_RADIAL_SPEED, c] = -by_rate * share * na, -by_rate * share * nr
        work[rows.BY_OWN, c] = work[rows.BY_OTHER, c] = -ki * share
        work[rows.AXIAL_BY_SHIFT, c], work[rows.RADIAL_BY_SHIFT, c] = -ki * share * na, -ki * share * nr
        work[rows.FORCE, c] = work[CARRIED, c]


@jit(SYSTEM)
def rigid_weightless(t, q, v, balls, contacts, constants, response):
    """See ``raceway.core.ring.kernels``; ball[:, 0] is s_o [m], ball[:, 1] is not used."""
    ball, ball_gain, ball_history = balls
    scalars, table = constants
    f, K, C, work = response
    z, arm, elastic_bodies = table.shape[0], scalars[ring.TILT_ARM], work.shape[0] > rows.WORK_ROWS
    force = work[rows.CONTACT_FORCE]
    place(t, q, v, constants, work, (DIRECTION, NORMAL, VELOCITY))
    if elastic_bodies:
        move_centres(work, NORMAL, VELOCITY)
    for k in range(z):
        _share(k, scalars, table, ball, ball_gain, ball_history, work)
    moving = 1
    for _ in range(_ITERATIONS):
        normal_forces(contacts, scalars, work)
        moving = 0
        for k in range(z):
            moving += _moves(k, z, ball_gain, work)
        if moving == 0:
            break
    for k in range(z):
        contact = 1.0 if work[APPROACH, z + k] > 0.0 else 0.0
        fi, fo, na, nr = force[k] * contact, force[z + k] * contact, work[NORMAL, k], work[NORMAL, z + k]
        _, lo = offsets_of(k, scalars, table)
        ball[k, 0] = lo + work[rows.SHIFT, z + k] + work[OUTER, z + k]
        force[k], force[z + k] = fi, fo
        work[CARRIED, k], work[CARRIED, z + k] = fi * na, fi * nr
    ring_force(table, arm, work, DIRECTION, CARRIED, f)
    if elastic_bodies or K.size > 0:
        for k in range(z):
            _tangents(k, z, ball_gain, work)
    if K.size > 0:
        ring_tangent(table, arm, work, DIRECTION, STIFF, K)
        ring_tangent(table, arm, work, DIRECTION, VISCOUS, C)
    return 1 if moving > 0 else 0
