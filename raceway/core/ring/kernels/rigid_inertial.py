"""Rigid rings and balls with centrifugal force: each ball centre finds its place in its meridian plane.

Notes
-----
The ball centre p (axial, radial, from the outer groove centre) minimises the convex potential
U_i(|e - p| - L_i) + U_o(|p| - L_o) - F_c p_radial; a damped Newton iteration finds it for all balls at once.  The
ring's tangent is A - A H^-1 A with A the inner contact's and H = A + B both contacts' 2x2 stiffness.  The ball's own
acceleration in its meridian plane is left out: its slowest mode, along the groove, lies at some kHz.
"""

import numpy as np
from numba import boolean, float64, int64, void

from raceway.core.jit import jit
from raceway.core.ring import kernels as rows
from raceway.core.ring.kernels import layout as ring
from raceway.core.ring.kernels import tensors
from raceway.core.ring.kernels.layout import move_centres, normal_forces, offsets_of, place, ring_force, ring_tangent
from raceway.core.signatures import MATRIX, SYSTEM, VECTOR

_ITERATIONS = 200
#: Rows of ``work`` beyond the law's, two quantities each, a half row long (index k, then z + k): inner groove centre [m] and its
#: velocity [m/s], last step [m] and slope along it [N m] with a flag for settled balls, directions of the two contacts' lines
#: and their lengths [m].
CENTRE, VELOCITY, STEP, SEARCH, INNER, OUTER, LENGTH = 5, 6, 7, 8, 9, 10, 11
DONE = SEARCH
#: Of settled balls, since the law is called again for others: force [N] and its derivatives of both contacts, direction of the
#: inner one.
KEPT_FORCE, KEPT_BY_GAP, KEPT_BY_RATE, KEPT_NORMAL = 12, 13, 14, 15
#: cos and sin of the azimuth.
DIRECTION = 16
#: Rows that the iteration has done with, used again for what goes to the ring: force [N], tangents [N/m, N s/m] (two rows each).
CARRIED, STIFF, VISCOUS = 9, 5, 7


@jit(void(int64, VECTOR, MATRIX, MATRIX, MATRIX), inline=True)
def _first_guess(k, scalars, table, ball, work):
    """Begin with ball k where it is, or on its seat."""
    z = table.shape[0]
    li, lo = offsets_of(k, scalars, table)
    work[SEARCH, k] = 0.0
    work[DONE, z + k] = 0.0
    if ball[k, 0] * ball[k, 0] + ball[k, 1] * ball[k, 1] > lo * lo:
        return
    # A guess off the outer race: on its seat there, or, where nothing is known, on the line of the groove centres.
    length = np.sqrt(work[CENTRE, k] * work[CENTRE, k] + work[CENTRE, z + k] * work[CENTRE, z + k])
    if ball[k, 0] == 0.0 and ball[k, 1] == 0.0 and length > li + lo:
        scale = (lo + table[k, ring.OUTER_SHARE] * (length - li - lo)) / length
        ball[k, 0], ball[k, 1] = scale * work[CENTRE, k], scale * work[CENTRE, z + k]
    else:
        ball[k, 0], ball[k, 1] = 0.0, lo + (table[k, ring.CENTRIFUGAL] / table[k, ring.OUTER_FACTOR]) ** (2.0 / 3.0)


@jit(void(int64, VECTOR, MATRIX, MATRIX, float64, MATRIX, MATRIX), inline=True)
def _approach(k, scalars, table, ball, ball_gain, ball_history, work):
    """Directions, lengths, gaps and gap rates of both contacts of ball k."""
    z, (li, lo), pa, pr = ball.shape[0], offsets_of(k, scalars, table), ball[k, 0], ball[k, 1]
    xa, xr = work[CENTRE, k] - pa, work[CENTRE, z + k] - pr
    so, si = np.sqrt(pa * pa + pr * pr), np.sqrt(xa * xa + xr * xr)
    by_so = 1.0 / so
    oa, orr = pa * by_so, pr * by_so
    ia, ir = oa, orr
    if si > 0.0:
        by_si = 1.0 / si
        ia, ir = xa * by_si, xr * by_si
    own_a, own_r = ball_gain * pa + ball_history[k, 0], ball_gain * pr + ball_history[k, 1]
    rate_i = work[rows.SHIFT_RATE, k] - (ia * (work[VELOCITY, k] - own_a) + ir * (work[VELOCITY, z + k] - own_r))
    rate_o = work[rows.SHIFT_RATE, z + k] - (oa * own_a + orr * own_r)
    gap_i, gap_o = li - si + work[rows.SHIFT, k], lo - so + work[rows.SHIFT, z + k]
    work[LENGTH, k], work[LENGTH, z + k] = si, so
    work[OUTER, k], work[OUTER, z + k] = oa, orr
    work[INNER, k], work[INNER, z + k] = ia, ir
    work[rows.GAP, k], work[rows.GAP, z + k] = gap_i, gap_o
    work[rows.GAP_RATE, k], work[rows.GAP_RATE, z + k] = rate_i, rate_o


@jit(tensors.TENSOR(tensors.TENSOR, float64, float64, float64, float64), inline=True)
def _plus(t, na, nr, k, w):
    """T plus the stiffness of a contact: k along its direction n, its force over its length w across."""
    return tensors.Tensor(
        t.aa + (k - w) * na * na + w, t.ar + (k - w) * na * nr, t.ra + (k - w) * na * nr, t.rr + (k - w) * nr * nr + w
    )


@jit(boolean(int64, float64, MATRIX, MATRIX, float64, MATRIX), inline=True)
def _settles(k, lo, table, ball, ball_gain, work):
    """Move ball k by one step of Newton's method on its potential; whether that was the last one."""
    z = table.shape[0]
    fi, fo = work[rows.CONTACT_FORCE, k], work[rows.CONTACT_FORCE, z + k]
    gap_i, gap_o = work[rows.GAP, k], work[rows.GAP, z + k]
    ia, ir, oa, orr = work[INNER, k], work[INNER, z + k], work[OUTER, k], work[OUTER, z + k]
    ga = fo * oa - fi * ia
    gr = fo * orr - fi * ir - table[k, ring.CENTRIFUGAL]
    if work[SEARCH, k] < 0.0:
        # Beyond the minimum along the last step by more than it began with: go half-way back.
        along = ga * work[STEP, k] + gr * work[STEP, z + k]
        if along > -0.9 * work[SEARCH, k]:
            work[STEP, k] *= 0.5
            work[STEP, z + k] *= 0.5
            work[SEARCH, k] *= 0.5
            ball[k, 0] -= work[STEP, k]
            ball[k, 1] -= work[STEP, z + k]
            return False
    ki = -work[rows.FORCE_BY_GAP, k] - ball_gain * work[rows.FORCE_BY_RATE, k]
    ko = -work[rows.FORCE_BY_GAP, z + k] - ball_gain * work[rows.FORCE_BY_RATE, z + k]
    by_si = 1.0 / work[LENGTH, k] if work[LENGTH, k] > 0.0 else 0.0
    wi, wo = fi * by_si, fo / work[LENGTH, z + k]
    haa, har, _, hrr = _plus(_plus(tensors.Tensor(0.0, 0.0, 0.0, 0.0), ia, ir, ki, wi), oa, orr, ko, wo)
    det = haa * hrr - har * har
    if not det > 1e-14 * (haa + hrr) * (haa + hrr):
        shift = 1e-7 * (haa + hrr) + 1.0
        haa += shift
        hrr += shift
        det = haa * hrr - har * har
    inverse = 1.0 / det
    sa, sr = (har * gr - hrr * ga) * inverse, (har * ga - haa * gr) * inverse
    size = np.sqrt(sa * sa + sr * sr)
    reach = 0.2 * lo
    if size > reach:
        sa *= reach / size
        sr *= reach / size
    # The shallower of the closed contacts sets the scale: under a light ring load the centrifugal force presses
    # the ball far deeper into the outer race than the inner race is.  Below rounding nothing can be asked.
    shallow = -gap_o if gap_i >= 0.0 else (-gap_i if gap_o >= 0.0 else min(-gap_i, -gap_o))
    if size <= max(1e-8 * shallow, 1e-14 * lo):
        # One linear correction ends the iteration: what it leaves is of second order.
        inner, outer = ia * sa + ir * sr, oa * sa + orr * sr
        work[rows.GAP, k], work[rows.GAP, z + k] = gap_i + inner, gap_o - outer
        ball[k, 0] += sa
        ball[k, 1] += sr
        # Kept for the tangent below, since the law is called again for the balls that still move.
        work[KEPT_FORCE, k], work[KEPT_FORCE, z + k] = max(fi - ki * inner, 0.0), max(fo + ko * outer, 0.0)
        work[KEPT_BY_GAP, k], work[KEPT_BY_GAP, z + k] = work[rows.FORCE_BY_GAP, k], work[rows.FORCE_BY_GAP, z + k]
        work[KEPT_BY_RATE, k], work[KEPT_BY_RATE, z + k] = work[rows.FORCE_BY_RATE, k], work[rows.FORCE_BY_RATE, z + k]
        work[KEPT_NORMAL, k], work[KEPT_NORMAL, z + k] = ia - (sa - ia * inner) * by_si, ir - (sr - ir * inner) * by_si
        work[DONE, z + k] = 1.0
        return True
    work[STEP, k], work[STEP, z + k] = sa, sr
    work[SEARCH, k] = ga * sa + gr * sr
    ball[k, 0] += sa
    ball[k, 1] += sr
    return False


@jit(boolean(int64, float64, MATRIX), inline=True)
def _condense(k, ball_gain, work):
    """Tangents of ball k to the ring, and what elastic bodies ask for; False where there is none."""
    z = work.shape[1] // 2
    fi, fo = work[rows.CONTACT_FORCE, k], work[rows.CONTACT_FORCE, z + k]
    na, nr, oa, orr = work[KEPT_NORMAL, k], work[KEPT_NORMAL, z + k], work[OUTER, k], work[OUTER, z + k]
    elastic, viscous = -work[KEPT_BY_GAP, k], -work[KEPT_BY_RATE, k]
    ki = elastic + ball_gain * viscous
    ko = -work[KEPT_BY_GAP, z + k] - ball_gain * work[KEPT_BY_RATE, z + k]
    # E by the ring's motion (elastic part), P by the ball's motion, H = P + the outer contact's.
    wi, wo, none = fi / work[LENGTH, k], fo / work[LENGTH, z + k], tensors.Tensor(0.0, 0.0, 0.0, 0.0)
    e, p, m = _plus(none, na, nr, elastic, wi), _plus(none, na, nr, ki, wi), _plus(none, na, nr, viscous, 0.0)
    h = _plus(p, oa, orr, ko, wo)
    det = h.aa * h.rr - h.ar * h.ar
    if not det > 0.0:
        return False
    inverse = 1.0 / det
    t = tensors.times_adjugate(p, h)
    t = tensors.Tensor(t.aa * inverse, t.ar * inverse, t.ra * inverse, t.rr * inverse)
    stiffness, damping = tensors.less(e, t, e), tensors.less(m, t, m)
    tensors.put_tensor(stiffness, work, STIFF, k)
    tensors.put_tensor(damping, work, VISCOUS, k)
    if work.shape[0] == rows.WORK_ROWS:
        return True
    tensors.put_tensor(stiffness, work, rows.FORCE_BY_CENTRE, k)
    tensors.put_tensor(damping, work, rows.FORCE_BY_SPEED, k)
    # dp = -H^-1 (ki ni dw_i - ko no dw_o) + H^-1 E de;  rows g of dQ = g (...): ki ni^T H^-1 and -ko no^T H^-1.
    gi, go = tensors.row_times_adjugate(tensors.Pair(na, nr), h), tensors.row_times_adjugate(tensors.Pair(oa, orr), h)
    gi = tensors.Pair(ki * gi.axial * inverse, ki * gi.radial * inverse)
    go = tensors.Pair(-ko * go.axial * inverse, -ko * go.radial * inverse)
    work[rows.BY_AXIAL, k], work[rows.BY_RADIAL, k] = tensors.less_row(tensors.Pair(elastic * na, elastic * nr), gi, e)
    work[rows.BY_AXIAL, z + k], work[rows.BY_RADIAL, z + k] = tensors.less_row(tensors.NOTHING, go, e)
    work[rows.BY_AXIAL_SPEED, k], work[rows.BY_RADIAL_SPEED, k] = tensors.less_row(
        tensors.Pair(viscous * na, viscous * nr), gi, m
    )
    work[rows.BY_AXIAL_SPEED, z + k], work[rows.BY_RADIAL_SPEED, z + k] = tensors.less_row(tensors.NOTHING, go, m)
    ri, ro = tensors.Pair(-ki * na, -ki * nr), tensors.Pair(ko * oa, ko * orr)
    work[rows.BY_OWN, k] = -ki - gi.axial * ri.axial - gi.radial * ri.radial
    work[rows.BY_OTHER, k] = -gi.axial * ro.axial - gi.radial * ro.radial
    work[rows.BY_OTHER, z + k] = -go.axial * ri.axial - go.radial * ri.radial
    work[rows.BY_OWN, z + k] = -ko - go.axial * ro.axial - go.radial * ro.radial
    work[rows.AXIAL_BY_SHIFT, k], work[rows.RADIAL_BY_SHIFT, k] = tensors.less_column(ri, t, ri)
    work[rows.AXIAL_BY_SHIFT, z + k], work[rows.RADIAL_BY_SHIFT, z + k] = tensors.less_column(tensors.NOTHING, t, ro)
    return True


@jit(SYSTEM)
def rigid_inertial(t, q, v, balls, contacts, constants, response):
    """See ``raceway.core.ring.kernels``; ball (Z, 2) holds p [m]; a row of zeros asks for a first guess."""
    ball, ball_gain, ball_history = balls
    scalars, table = constants
    f, K, C, work = response
    z, elastic_bodies = table.shape[0], work.shape[0] > rows.WORK_ROWS
    force = work[rows.CONTACT_FORCE]
    place(t, q, v, constants, work, (DIRECTION, CENTRE, VELOCITY))
    if elastic_bodies:
        move_centres(work, CENTRE, VELOCITY)
    for k in range(z):
        _first_guess(k, scalars, table, ball, work)
    moving = z
    for _ in range(_ITERATIONS):
        for k in range(z):
            _approach(k, scalars, table, ball, ball_gain, ball_history, work)
        normal_forces(contacts, scalars, work)
        for k in range(z):
            if work[DONE, z + k] == 0.0:
                moving -= _settles(k, scalars[ring.OFFSET_OUTER], table, ball, ball_gain, work)
        if moving == 0:
            break
    if moving > 0:
        return 1
    for k in range(z):
        fi, fo = work[KEPT_FORCE, k], work[KEPT_FORCE, z + k]
        force[k], force[z + k] = fi, fo
        work[CARRIED, k], work[CARRIED, z + k] = fi * work[KEPT_NORMAL, k], fi * work[KEPT_NORMAL, z + k]
    ring_force(table, scalars[ring.TILT_ARM], work, DIRECTION, CARRIED, f)
    if K.size == 0 and not elastic_bodies:
        return 0
    for k in range(z):
        if elastic_bodies:
            for row in range(rows.WORK_ROWS, rows.WORK_ROWS + rows.KERNEL_ROWS):
                work[row, k], work[row, z + k] = 0.0, 0.0
            work[rows.FORCE, k], work[rows.FORCE, z + k] = work[CARRIED, k], work[CARRIED, z + k]
        if force[k] == 0.0 and work[KEPT_BY_GAP, k] == 0.0:
            for row in (STIFF, STIFF + 1, VISCOUS, VISCOUS + 1):
                work[row, k], work[row, z + k] = 0.0, 0.0
        elif not _condense(k, ball_gain, work):
            return 1
    if K.size > 0:
        ring_tangent(table, scalars[ring.TILT_ARM], work, DIRECTION, STIFF, K)
        ring_tangent(table, scalars[ring.TILT_ARM], work, DIRECTION, VISCOUS, C)
    return 0
