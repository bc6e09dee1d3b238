"""Rigid rings and balls with centrifugal force: each ball centre finds its place in its meridian plane.

Notes
-----
The ball centre p (axial, radial, from the outer groove centre) minimises the convex potential
U_i(|e - p| - L_i) + U_o(|p| - L_o) - F_c p_radial; a damped Newton iteration finds it for all balls at once, four in the lanes
of one step.  The ring's tangent is A - A H^-1 A with A the inner contact's and H = A + B both contacts' 2x2 stiffness.  The ball's
own acceleration in its meridian plane is left out: its slowest mode, along the groove, lies at some kHz.
"""

import numpy as np
from numba import float64, int64, void

from raceway.core.jit import jit
from raceway.core.lanes import LANES, MASK, WIDTH, any_of, larger, live_of, root, smaller, spread, take, where
from raceway.core.ring import kernels as rows
from raceway.core.ring.kernels import layout as ring
from raceway.core.ring.kernels import tensors
from raceway.core.ring.kernels.layout import (
    approach,
    move_centres,
    normal_forces,
    offsets_of,
    place,
    ring_force,
    ring_tangent,
)
from raceway.core.ring.kernels.tensors import pair_of, put_pair, put_tensors
from raceway.core.signatures import MATRIX, SYSTEM, VECTOR

_ITERATIONS = 200
#: Rows of ``work`` beyond the law's, two quantities each, a half row long (index k, then z + k), and those of ``layout.approach``: last
#: step [m], slope along it [N m] with a flag for settled balls.
STEP, SEARCH, DONE = 7, 8, 8
#: Of settled balls, since the law is called again for others: force [N] and its derivatives of both contacts, direction of the
#: inner one.
KEPT_FORCE, KEPT_BY_GAP, KEPT_BY_RATE, KEPT_NORMAL = 12, 13, 14, 15
#: cos and sin of the azimuth; centrifugal force [N].
DIRECTION, CENTRIFUGAL = 16, 17
#: Rows that the iteration has done with, used again for what goes to the ring: force [N], tangents [N/m, N s/m] (two rows each).
CARRIED, STIFF, VISCOUS = 9, 5, 7


@jit(void(int64, VECTOR, MATRIX, MATRIX, MATRIX, MATRIX), inline=True)
def _first_guess(k, scalars, table, ball, ball_history, work):
    """Begin with ball k where it is, or on its seat; its numbers into rows."""
    z = table.shape[0]
    li, lo = offsets_of(k, scalars, table)
    pa, pr, centrifugal = ball[k, 0], ball[k, 1], table[k, ring.CENTRIFUGAL]
    if not pa * pa + pr * pr > lo * lo:
        # A guess off the outer race: on its seat there, or, where nothing is known, on the line of the groove centres.
        ea, er = work[ring.BALL_CENTRE, k], work[ring.BALL_CENTRE, z + k]
        length = np.sqrt(ea * ea + er * er)
        if pa == 0.0 and pr == 0.0 and length > li + lo:
            scale = (lo + table[k, ring.OUTER_SHARE] * (length - li - lo)) / length
            pa, pr = scale * ea, scale * er
        else:
            pa, pr = 0.0, lo + (centrifugal / table[k, ring.OUTER_FACTOR]) ** (2.0 / 3.0)
    work[rows.PLACE, k], work[rows.PLACE, z + k], work[CENTRIFUGAL, k] = pa, pr, centrifugal
    work[rows.HISTORY, k], work[rows.HISTORY, z + k] = ball_history[k, 0], ball_history[k, 1]
    work[rows.OFFSET, k], work[rows.OFFSET, z + k] = li, lo
    work[SEARCH, k], work[DONE, z + k] = 0.0, 0.0


@jit(tensors.LANES_TENSOR(LANES, LANES, LANES, LANES), inline=True)
def _of_contact(na, nr, k, w):
    """Stiffness of a contact: k along its direction n, its force over its length w across."""
    along = k - w
    across = along * na * nr
    return tensors.Tensor(along * na * na + w, across, across, along * nr * nr + w)


@jit(MASK(int64, MASK, float64, MATRIX), inline=True)
def _moving(k, live, ball_gain, work):
    """Move the balls from k on that have not settled by one step of Newton's method on their potentials; those that go on."""
    z = work.shape[1] // 2
    (fi, fo), (gap_i, gap_o) = pair_of(work, rows.CONTACT_FORCE, k, live), pair_of(work, rows.GAP, k, live)
    (ia, ir), (oa, orr) = pair_of(work, ring.INNER, k, live), pair_of(work, ring.OUTER, k, live)
    (pa, pr), (da, dr) = pair_of(work, rows.PLACE, k, live), pair_of(work, STEP, k, live)
    search, done = pair_of(work, SEARCH, k, live)
    active = live & (done == 0.0)
    ga = fo * oa - fi * ia
    gr = fo * orr - fi * ir - take(work, CENTRIFUGAL, k, live)
    # Beyond the minimum along the last step by more than it began with: go half-way back.
    back = active & (search < 0.0) & (ga * da + gr * dr > -0.9 * search)
    by_gap_i, by_gap_o = pair_of(work, rows.FORCE_BY_GAP, k, live)
    by_rate_i, by_rate_o = pair_of(work, rows.FORCE_BY_RATE, k, live)
    ki, ko = -by_gap_i - ball_gain * by_rate_i, -by_gap_o - ball_gain * by_rate_o
    (si, so), lo = pair_of(work, ring.LENGTH, k, live), take(work, rows.OFFSET, z + k, live)
    by_si = where(si > 0.0, 1.0 / si, 0.0)
    a, b = _of_contact(ia, ir, ki, fi * by_si), _of_contact(oa, orr, ko, fo / so)
    haa, har, hrr = a.aa + b.aa, a.ar + b.ar, a.rr + b.rr
    trace = haa + hrr
    shift = where(haa * hrr - har * har > 1e-14 * trace * trace, 0.0, 1e-7 * trace + 1.0)
    haa, hrr = haa + shift, hrr + shift
    inverse = 1.0 / (haa * hrr - har * har)
    sa, sr = (har * gr - hrr * ga) * inverse, (har * ga - haa * gr) * inverse
    size, reach = root(sa * sa + sr * sr), 0.2 * lo
    scale = where(size > reach, reach / size, 1.0)
    sa, sr = scale * sa, scale * sr
    # The shallower of the closed contacts sets the scale: under a light ring load the centrifugal force presses
    # the ball far deeper into the outer race than the inner race is.  Below rounding nothing can be asked.
    shallow = where(gap_i >= 0.0, -gap_o, where(gap_o >= 0.0, -gap_i, smaller(-gap_i, -gap_o)))
    ends = active & ~back & (size <= larger(1e-8 * shallow, 1e-14 * lo))
    if any_of(ends):
        # One linear correction ends the iteration: what it leaves is of second order.  Kept for the tangent, since the law is called
        # again for the balls that still move.
        inner, outer = ia * sa + ir * sr, oa * sa + orr * sr
        put_pair(work, rows.GAP, k, ends, gap_i + inner, gap_o - outer)
        put_pair(work, KEPT_FORCE, k, ends, larger(fi - ki * inner, 0.0), larger(fo + ko * outer, 0.0))
        put_pair(work, KEPT_BY_GAP, k, ends, by_gap_i, by_gap_o)
        put_pair(work, KEPT_BY_RATE, k, ends, by_rate_i, by_rate_o)
        put_pair(work, KEPT_NORMAL, k, ends, ia - (sa - ia * inner) * by_si, ir - (sr - ir * inner) * by_si)
    da, dr = where(back, 0.5 * da, sa), where(back, 0.5 * dr, sr)
    put_pair(work, rows.PLACE, k, active, where(back, pa - da, pa + da), where(back, pr - dr, pr + dr))
    put_pair(work, STEP, k, active, da, dr)
    put_pair(work, SEARCH, k, active, where(back, 0.5 * search, ga * sa + gr * sr), where(ends, 1.0, 0.0))
    return active & ~ends


@jit(MASK(int64, MASK, float64, MATRIX), inline=True)
def _condense(k, live, ball_gain, work):
    """Tangents of the balls from k on to the ring, and what elastic bodies ask for; returns the balls that have none."""
    (fi, fo), (si, so) = pair_of(work, rows.CONTACT_FORCE, k, live), pair_of(work, ring.LENGTH, k, live)
    (na, nr), (oa, orr) = pair_of(work, KEPT_NORMAL, k, live), pair_of(work, ring.OUTER, k, live)
    (by_gap_i, by_gap_o), (by_rate_i, by_rate_o) = pair_of(work, KEPT_BY_GAP, k, live), pair_of(work, KEPT_BY_RATE, k, live)
    pressed = live & ~((fi == 0.0) & (by_gap_i == 0.0))
    elastic, viscous = where(pressed, -by_gap_i, 0.0), where(pressed, -by_rate_i, 0.0)
    ki, ko = elastic + ball_gain * viscous, where(pressed, -by_gap_o - ball_gain * by_rate_o, 0.0)
    # E by the ring's motion (elastic part), P by the ball's motion, H = P + the outer contact's.
    wi, wo = where(pressed, fi / si, 0.0), where(pressed, fo / so, 0.0)
    e, p, m = _of_contact(na, nr, elastic, wi), _of_contact(na, nr, ki, wi), _of_contact(na, nr, viscous, spread(0.0))
    b = _of_contact(oa, orr, ko, wo)
    h = tensors.Tensor(p.aa + b.aa, p.ar + b.ar, p.ra + b.ra, p.rr + b.rr)
    det = h.aa * h.rr - h.ar * h.ar
    inverse = 1.0 / where(det > 0.0, det, 1.0)
    t = tensors.times_adjugate(p, h)
    t = tensors.Tensor(t.aa * inverse, t.ar * inverse, t.ra * inverse, t.rr * inverse)
    stiffness, damping = tensors.less(e, t, e), tensors.less(m, t, m)
    put_tensors(work, STIFF, k, live, stiffness)
    put_tensors(work, VISCOUS, k, live, damping)
    if work.shape[0] == rows.WORK_ROWS:
        return pressed & ~(det > 0.0)
    put_tensors(work, rows.FORCE_BY_CENTRE, k, live, stiffness)
    put_tensors(work, rows.FORCE_BY_SPEED, k, live, damping)
    # dp = -H^-1 (ki ni dw_i - ko no dw_o) + H^-1 E de;  rows g of dQ = g (...): ki ni^T H^-1 and -ko no^T H^-1.
    gi, go = tensors.row_times_adjugate(tensors.Pair(na, nr), h), tensors.row_times_adjugate(tensors.Pair(oa, orr), h)
    gi = tensors.Pair(ki * gi.axial * inverse, ki * gi.radial * inverse)
    go = tensors.Pair(-ko * go.axial * inverse, -ko * go.radial * inverse)
    none = tensors.Pair(spread(0.0), spread(0.0))
    inner, outer = tensors.less_row(tensors.Pair(elastic * na, elastic * nr), gi, e), tensors.less_row(none, go, e)
    put_pair(work, rows.BY_AXIAL, k, live, inner.axial, outer.axial)
    put_pair(work, rows.BY_RADIAL, k, live, inner.radial, outer.radial)
    inner, outer = tensors.less_row(tensors.Pair(viscous * na, viscous * nr), gi, m), tensors.less_row(none, go, m)
    put_pair(work, rows.BY_AXIAL_SPEED, k, live, inner.axial, outer.axial)
    put_pair(work, rows.BY_RADIAL_SPEED, k, live, inner.radial, outer.radial)
    ri, ro = tensors.Pair(-ki * na, -ki * nr), tensors.Pair(ko * oa, ko * orr)
    own_i, own_o = -ki - gi.axial * ri.axial - gi.radial * ri.radial, -ko - go.axial * ro.axial - go.radial * ro.radial
    put_pair(work, rows.BY_OWN, k, live, own_i, own_o)
    by_o, by_i = -gi.axial * ro.axial - gi.radial * ro.radial, -go.axial * ri.axial - go.radial * ri.radial
    put_pair(work, rows.BY_OTHER, k, live, by_o, by_i)
    inner, outer = tensors.less_column(ri, t, ri), tensors.less_column(none, t, ro)
    put_pair(work, rows.AXIAL_BY_SHIFT, k, live, inner.axial, outer.axial)
    put_pair(work, rows.RADIAL_BY_SHIFT, k, live, inner.radial, outer.radial)
    return pressed & ~(det > 0.0)


@jit(SYSTEM)
def rigid_inertial(t, q, v, balls, contacts, constants, response):
    """See ``raceway.core.ring.kernels``; ball (Z, 2) holds p [m]; a row of zeros asks for a first guess."""
    ball, ball_gain, ball_history = balls
    scalars, table = constants
    f, K, C, work = response
    z, elastic_bodies = table.shape[0], work.shape[0] > rows.WORK_ROWS
    place(t, q, v, constants, work, (DIRECTION, ring.BALL_CENTRE, ring.BALL_VELOCITY))
    if elastic_bodies:
        move_centres(work, ring.BALL_CENTRE, ring.BALL_VELOCITY)
    for k in range(z):
        _first_guess(k, scalars, table, ball, ball_history, work)
    moving = True
    for _ in range(_ITERATIONS):
        for k in range(0, z, WIDTH):
            approach(k, live_of(k, z), ball_gain, work)
        normal_forces(contacts, scalars, work)
        moving = False
        for k in range(0, z, WIDTH):
            moving |= any_of(_moving(k, live_of(k, z), ball_gain, work))
        if not moving:
            break
    if moving:
        return 1
    damped = False
    for k in range(0, z, WIDTH):
        live = live_of(k, z)
        damped |= any_of(~(take(work, KEPT_BY_RATE, k, live) == 0.0))
        (fi, fo), (na, nr) = pair_of(work, KEPT_FORCE, k, live), pair_of(work, KEPT_NORMAL, k, live)
        put_pair(work, rows.CONTACT_FORCE, k, live, fi, fo)
        put_pair(work, CARRIED, k, live, fi * na, fi * nr)
        if elastic_bodies:
            for row in range(rows.WORK_ROWS, rows.WORK_ROWS + rows.KERNEL_ROWS):
                put_pair(work, row, k, live, spread(0.0), spread(0.0))
            put_pair(work, rows.FORCE, k, live, fi * na, fi * nr)
    for k in range(z):
        ball[k, 0], ball[k, 1] = work[rows.PLACE, k], work[rows.PLACE, z + k]
    ring_force(table, scalars[ring.TILT_ARM], work, DIRECTION, CARRIED, f)
    if K.size == 0 and not elastic_bodies:
        return 0
    singular = False
    for k in range(0, z, WIDTH):
        singular |= any_of(_condense(k, live_of(k, z), ball_gain, work))
    if singular:
        return 1
    if K.size > 0:
        ring_tangent(table, scalars[ring.TILT_ARM], work, DIRECTION, STIFF, K)
        if damped:
            ring_tangent(table, scalars[ring.TILT_ARM], work, DIRECTION, VISCOUS, C)
        else:
            C[:] = 0.0
    return 0
