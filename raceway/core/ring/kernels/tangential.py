"""Balls with tangential contact forces in their meridian plane: gyroscopic moments, Coulomb friction, or both.

Notes
-----
With n = (sin a, cos a) the direction of a contact at its angle a and t = (cos a, -sin a), the inner race gives a ball
g_i = f_i n_i + (tau_i - T_i) t_i and the outer one takes g_o = f_o n_o + (tau_o - T_o) t_o; g_i - g_o + F_c = 0.  T comes from
the gyroscopic moment, tau from friction; both put the couple -r h, h = tau - T, on the section of the inner ring (of friction
-r k_t u, which belongs to the stored energy).  Gyroscopic moments and sliding have no potential: tangents are not symmetric.
"""

import numpy as np
from numba import float64, int64, void

from raceway.core.jit import jit
from raceway.core.lanes import LANES, MASK, WIDTH, any_of, larger, live_of, put, root, spread, take, where
from raceway.core.ring import kernels as rows
from raceway.core.ring.kernels import layout as ring
from raceway.core.ring.kernels import rolling as at
from raceway.core.ring.kernels import tensors
from raceway.core.ring.kernels.layout import (
    BALL_CENTRE,
    BALL_VELOCITY,
    add_couples,
    approach,
    move_centres,
    normal_forces,
    offsets_of,
    place,
    ring_force,
    ring_tangent,
)
from raceway.core.ring.kernels.rolling import BallContact, linear_balance, rub, with_gyroscopic
from raceway.core.ring.kernels.tensors import pair_of, put_pair, put_tensors
from raceway.core.signatures import MATRIX, SYSTEM, VECTOR

#: Steps after which a ball begins anew; after twice as many its imbalance has to shrink at every step.
PATIENCE = 60
_ITERATIONS = 300
#: Rows that the iteration has done with, used again for what goes to the ring: force [N], its derivatives by e and its velocity
#: [N/m, N s/m] (two rows each); what ``layout.add_couples`` reads, of forces and of dampings (three rows each).
_CARRIED, _STIFF, _VISCOUS, _COUPLES, _VISCOUS_COUPLES = 8, 5, 21, 33, 36


@jit(void(int64, VECTOR, VECTOR, MATRIX, MATRIX, MATRIX, MATRIX), inline=True)
def _first_guess(k, q, scalars, table, ball, ball_history, work):
    """Begin with ball k; where nothing presses it on either race it lies midway, without forces."""
    z = table.shape[0]
    li, lo = offsets_of(k, scalars, table)
    ea, er, shift = work[BALL_CENTRE, k], work[BALL_CENTRE, z + k], work[rows.SHIFT, z + k]
    turn = q[3] * work[at.DIRECTION, z + k] - q[4] * work[at.DIRECTION, k]
    turn_arc = (scalars[ring.OFFSET_INNER] + 0.5 * scalars[ring.DIAMETER]) * table[k, ring.SIDE] * turn
    length = np.sqrt(ea * ea + er * er)
    room = li + lo + work[rows.SHIFT, k] + shift
    work[at.CENTRIFUGAL, k], work[at.TURNED, z + k] = table[k, ring.CENTRIFUGAL], turn_arc
    work[rows.OFFSET, k], work[rows.OFFSET, z + k] = li, lo
    work[at.STATE, z + k], work[rows.PLACE, k], work[rows.PLACE, z + k] = at.MOVES, ball[k, 0], ball[k, 1]
    for c in range(2):
        work[rows.HISTORY, k + c * z], work[at.COMMITTED, k + c * z] = ball_history[k, c], ball_history[k, ring.SLIPS + c]
        work[at.SLIP, k + c * z] = ball[k, ring.SLIPS + c]
    _forget(k, z, work)
    if table[k, ring.CENTRIFUGAL] == 0.0 and length <= room:
        scale, angle = (lo + shift + 0.5 * (length - room)) / length, np.arctan2(ea, er)
        work[rows.PLACE, k], work[rows.PLACE, z + k] = scale * ea, scale * er
        at_i, at_o = scalars[ring.OFFSET_INNER] * angle, scalars[ring.OFFSET_OUTER] * angle
        work[at.SLIP, k], work[at.SLIP, z + k] = at_i - turn_arc, at_o
        work[at.STATE, z + k] = at.LOOSE
    elif ball[k, 0] == 0.0 and ball[k, 1] == 0.0 or ball[k, 0] ** 2 + ball[k, 1] ** 2 <= lo * lo:
        if length > li + lo:
            scale = (lo + table[k, ring.OUTER_SHARE] * (length - li - lo)) / length
            work[rows.PLACE, k], work[rows.PLACE, z + k] = scale * ea, scale * er
        else:
            _seat_outside(k, table, work)


@jit(void(int64, int64, MATRIX))
def _forget(k, z, work):
    """Begin with the steps of ball k anew."""
    work[at.SLOPE, k], work[at.MERIT, z + k], work[at.STEP, k], work[at.STEP, z + k] = 0.0, np.inf, 0.0, 0.0


@jit(void(int64, MATRIX, MATRIX))
def _seat_outside(k, table, work):
    """Put ball k where its centrifugal force alone holds it, on the outer race, and forget its steps."""
    z = table.shape[0]
    depth = (table[k, ring.CENTRIFUGAL] / table[k, ring.OUTER_FACTOR]) ** (2.0 / 3.0)
    work[rows.PLACE, k], work[rows.PLACE, z + k] = 0.0, work[rows.OFFSET, z + k] + depth
    _forget(k, z, work)


@jit(tensors.LANES_PAIR(at.CONTACTS, at.TANGENTIALS, LANES, LANES, LANES), inline=True)
def _ball_step(contacts, h, ra, rr, longest):
    """-J^-1 R [m], regular where J is not, and no longer than ``longest``.

    J = dR/dp = -G_i - G_o + cross terms through the moment's dependence on both angles.
    """
    j = linear_balance(contacts, contacts[0].stiffness, spread(0.0), h).j
    trace, det = j.aa + j.rr, j.aa * j.rr - j.ar * j.ra
    shift = where(larger(det, -det) > 1e-14 * trace * trace, 0.0, -1e-7 * larger(trace, -trace) - 1.0)
    jaa, jrr = j.aa + shift, j.rr + shift
    inverse = -1.0 / (jaa * jrr - j.ar * j.ra)
    axial, radial = (jrr * ra - j.ar * rr) * inverse, (jaa * rr - j.ra * ra) * inverse
    size = root(axial * axial + radial * radial)
    scale = where(size > longest, longest / size, 1.0)
    return tensors.Pair(axial * scale, radial * scale)


@jit(at.CONTACTS(int64, MASK, tensors.LANES_PAIR, tensors.LANES_PAIR, tensors.LANES_PAIR, float64, MATRIX), inline=True)
def _contacts_of(k, live, force, by_gap, by_rate, ball_gain, work):
    """Both contacts of the balls from k on, of forces and their derivatives of the inner and the outer one."""
    (ia, ir), (oa, orr) = pair_of(work, ring.INNER, k, live), pair_of(work, ring.OUTER, k, live)
    si, so = pair_of(work, ring.LENGTH, k, live)
    inner, outer = -by_gap.axial - ball_gain * by_rate.axial, -by_gap.radial - ball_gain * by_rate.radial
    return BallContact(ia, ir, si, force.axial, inner), BallContact(oa, orr, so, force.radial, outer)


@jit(MASK(int64, MASK, int64, float64, VECTOR, MATRIX), inline=True)
def _moving(k, live, attempt, ball_gain, scalars, work):
    """Move the balls from k on that have not settled by one step; those that go on.

    With n = (sin a, cos a) the direction of a contact at its angle a and t = (cos a, -sin a), the imbalance of a ball at p
    is R = f_i n_i + h_i t_i - f_o n_o - h_o t_o + F_c. It has no potential: a step that goes beyond the balance is halved,
    balls that run in circles begin anew, and those that fail again have to come closer at every step.
    """
    z = work.shape[1] // 2
    slope, state = pair_of(work, at.SLOPE, k, live)
    active = live & (state == at.MOVES)
    force, (gap_i, gap_o) = pair_of(work, rows.CONTACT_FORCE, k, live), pair_of(work, rows.GAP, k, live)
    by_gap, by_rate = pair_of(work, rows.FORCE_BY_GAP, k, live), pair_of(work, rows.FORCE_BY_RATE, k, live)
    contacts = _contacts_of(k, live, force, by_gap, by_rate, ball_gain, work)
    (inner, outer), (fi, fo) = contacts, force
    o, slips = spread(0.0), pair_of(work, at.SLIP, k, live)
    h = at.Tangential(o, o, o, o, o, o, o, o, o, o, o, o, o, o, o, o, o, o)
    if scalars[ring.FRICTION] != 0.0:
        h, slips = rub(k, live, contacts, scalars, work)
    if scalars[ring.GYROSCOPIC] != 0.0:
        h = with_gyroscopic(k, live, contacts, h, scalars, work)
    ra = fi * inner.axial + h.inner * inner.radial - fo * outer.axial - h.outer * outer.radial
    rr = fi * inner.radial - h.inner * inner.axial - fo * outer.radial + h.outer * outer.axial
    rr = rr + take(work, at.CENTRIFUGAL, k, live)
    size, (da, dr) = root(ra * ra + rr * rr), pair_of(work, at.STEP, k, live)
    # Beyond the balance along the last step by more than it began with: go half-way back.
    too_far = (slope > 0.0) & (-(ra * da + rr * dr) > 0.9 * slope)
    if attempt > 2 * PATIENCE:
        # Twice in circles: descend at every step instead.
        long = root(da * da + dr * dr) > 1e-13
        too_far = (long & (size > 0.9999 * take(work, at.MERIT, z + k, live))) | (~long & too_far)
    back, (pa, pr) = active & too_far, pair_of(work, rows.PLACE, k, live)
    sa, sr = _ball_step(contacts, h, ra, rr, 0.2 * take(work, rows.OFFSET, z + k, live))
    ends = active & ~back & (root(sa * sa + sr * sr) <= 1e-10 * larger(larger(-gap_i, -gap_o), 1e-12))
    da, dr = where(back, 0.5 * da, sa), where(back, 0.5 * dr, sr)
    put_pair(work, rows.PLACE, k, active, where(back, pa - da, pa + da), where(back, pr - dr, pr + dr))
    put_pair(work, at.STEP, k, active, da, dr)
    put_pair(work, at.SLOPE, k, active, where(back, 0.5 * slope, ra * da + rr * dr), where(ends, at.SETTLED, at.MOVES))
    put(work, at.MERIT, z + k, active & ~back, size)
    if any_of(ends):
        # Forces and tangents are kept from before this step, which ``_condense`` adds to the forces.
        put_pair(work, at.KEPT_FORCE, k, ends, fi, fo)
        put_pair(work, at.KEPT_BY_GAP, k, ends, by_gap.axial, by_gap.radial)
        put_pair(work, at.KEPT_BY_RATE, k, ends, by_rate.axial, by_rate.radial)
        put_pair(work, at.SLIP, k, ends, slips.axial, slips.radial)
        at.put_tangential(work, k, ends, h)
    return active & ~ends


@jit(MASK(int64, MASK, float64, MATRIX), inline=True)
def _condense(k, live, ball_gain, work):
    """What the balls from k on do to the ring, and what elastic bodies ask for; returns the balls that have no tangent."""
    state, kept = take(work, at.STATE, work.shape[1] // 2 + k, live), pair_of(work, at.KEPT_FORCE, k, live)
    by_gap, by_rate = pair_of(work, at.KEPT_BY_GAP, k, live), pair_of(work, at.KEPT_BY_RATE, k, live)
    pressed = live & (state == at.SETTLED) & ~((kept.axial == 0.0) & (by_gap.axial == 0.0))
    contacts = _contacts_of(k, live, kept, by_gap, by_rate, ball_gain, work)
    (inner, outer), h, none = contacts, at.tangential_of(work, k, live), spread(0.0)
    # Forces are those before the ball's last step: with what that changes they are off by its square.
    b, (da, dr) = linear_balance(contacts, -by_gap.axial, -by_rate.axial, h), pair_of(work, at.STEP, k, live)
    force_a = inner.force * inner.axial + h.inner * inner.radial + b.p.aa * da + b.p.ar * dr
    force_r = inner.force * inner.radial - h.inner * inner.axial + b.p.ra * da + b.p.rr * dr
    closed_i = inner.force - inner.stiffness * (inner.axial * da + inner.radial * dr)
    closed_o = outer.force + outer.stiffness * (outer.axial * da + outer.radial * dr)
    # Balls that the inner race does not press keep their outer force, loose ones have none.
    closed_o = where(pressed, larger(closed_o, 0.0), where(state == at.SETTLED, kept.radial, 0.0))
    put_pair(work, rows.CONTACT_FORCE, k, live, where(pressed, larger(closed_i, 0.0), 0.0), closed_o)
    det = b.j.aa * b.j.rr - b.j.ar * b.j.ra
    inverse = where(det == 0.0, 0.0, 1.0 / det)
    t = tensors.times_adjugate(b.p, b.j)
    t = tensors.Tensor(t.aa * inverse, t.ar * inverse, t.ra * inverse, t.rr * inverse)
    # The couple by e, and by the ball's place; turning the section moves both forces alike.
    stretch, angle = h.couple_by_length, h.couple_by_inner / where(inner.length > 0.0, inner.length, 1.0)
    by_e = tensors.Pair(stretch * inner.axial + angle * inner.radial, stretch * inner.radial - angle * inner.axial)
    angle = h.couple_by_outer / outer.length
    by_place = tensors.Pair(angle * outer.radial - by_e.axial, -angle * outer.axial - by_e.radial)
    u, couple = tensors.row_times_adjugate(by_place, b.j), h.couple + by_place.axial * da + by_place.radial * dr
    u = tensors.Pair(u.axial * inverse, u.radial * inverse)
    by_turn, by_centre = tensors.less_column(b.by_turn, t, b.by_turn), tensors.less_row(by_e, u, b.x)
    couple_by_turn = h.couple_by_turn - u.axial * b.by_turn.axial - u.radial * b.by_turn.radial
    by_velocity = tensors.less_row(tensors.Pair(none, none), u, b.m)
    stiffness, damping = tensors.less(b.e, t, b.x), tensors.less(b.m, t, b.m)
    for row in (_CARRIED, _STIFF, _STIFF + 1, _VISCOUS, _VISCOUS + 1):
        put_pair(work, row, k, live, none, none)
    for row in range(_COUPLES, _VISCOUS_COUPLES + 3):
        put_pair(work, row, k, live, none, none)
    put_pair(work, _CARRIED, k, pressed, force_a, force_r)
    put_tensors(work, _STIFF, k, pressed, stiffness)
    put_tensors(work, _VISCOUS, k, pressed, damping)
    put_pair(work, _COUPLES, k, pressed, couple, couple_by_turn)
    put_pair(work, _COUPLES + 1, k, pressed, by_turn.axial, by_turn.radial)
    put_pair(work, _COUPLES + 2, k, pressed, by_centre.axial, by_centre.radial)
    put_pair(work, _VISCOUS_COUPLES + 2, k, pressed, by_velocity.axial, by_velocity.radial)
    if work.shape[0] > rows.WORK_ROWS:
        for row in range(rows.WORK_ROWS, rows.WORK_ROWS + rows.KERNEL_ROWS):
            put_pair(work, row, k, live, none, none)
        put_pair(work, rows.FORCE, k, pressed, force_a, force_r)
        put_tensors(work, rows.FORCE_BY_CENTRE, k, pressed, stiffness)
        put_tensors(work, rows.FORCE_BY_SPEED, k, pressed, damping)
        put_pair(work, rows.FORCE_BY_TURN, k, pressed, by_turn.axial, by_turn.radial)
        put_pair(work, rows.COUPLE_BY_CENTRE, k, pressed, by_centre.axial, by_centre.radial)
        _keep_for_bodies(k, pressed, contacts, h, -by_gap.axial, -by_rate.axial, b, t, u, inverse, work)
    return pressed & (det == 0.0)


@jit(
    void(
        int64,
        MASK,
        at.CONTACTS,
        at.TANGENTIALS,
        LANES,
        LANES,
        at.BALANCE,
        tensors.LANES_TENSOR,
        tensors.LANES_PAIR,
        LANES,
        MATRIX,
    )
)
def _keep_for_bodies(k, pressed, contacts, h, elastic, viscous, b, t, u, inverse, work):
    """Contact forces by e, its velocity, shifts and turn; the balls' forces on the ring and their couples by shifts.

    Both contacts have dQ = g (dR), g = dQ/dp J^-1, on top of what they feel at a ball that stays where it is.
    """
    (na, nr, _, _, ki), (oa, orr, _, _, ko) = contacts
    gi, go = tensors.row_times_adjugate(tensors.Pair(na, nr), b.j), tensors.row_times_adjugate(tensors.Pair(oa, orr), b.j)
    gi = tensors.Pair(-ki * gi.axial * inverse, -ki * gi.radial * inverse)
    go, none = tensors.Pair(ko * go.axial * inverse, ko * go.radial * inverse), tensors.Pair(spread(0.0), spread(0.0))
    inner, outer = tensors.less_row(tensors.Pair(elastic * na, elastic * nr), gi, b.x), tensors.less_row(none, go, b.x)
    put_pair(work, rows.BY_AXIAL, k, pressed, inner.axial, outer.axial)
    put_pair(work, rows.BY_RADIAL, k, pressed, inner.radial, outer.radial)
    inner, outer = tensors.less_row(tensors.Pair(viscous * na, viscous * nr), gi, b.m), tensors.less_row(none, go, b.m)
    put_pair(work, rows.BY_AXIAL_SPEED, k, pressed, inner.axial, outer.axial)
    put_pair(work, rows.BY_RADIAL_SPEED, k, pressed, inner.radial, outer.radial)
    # The ring's force and R by the inner shift, R by the outer one.
    by_shift = tensors.Pair(h.inner_by_shift * nr - ki * na, -h.inner_by_shift * na - ki * nr)
    ri = tensors.Pair(by_shift.axial + h.grows * orr, by_shift.radial - h.grows * oa)
    ro = tensors.Pair(ko * oa - h.outer_by_shift * orr, ko * orr + h.outer_by_shift * oa)
    own_i, own_o = -ki - gi.axial * ri.axial - gi.radial * ri.radial, -ko - go.axial * ro.axial - go.radial * ro.radial
    put_pair(work, rows.BY_OWN, k, pressed, own_i, own_o)
    by_o, by_i = -gi.axial * ro.axial - gi.radial * ro.radial, -go.axial * ri.axial - go.radial * ri.radial
    put_pair(work, rows.BY_OTHER, k, pressed, by_o, by_i)
    turn_i, turn_o = (
        gi.axial * b.by_turn.axial + gi.radial * b.by_turn.radial,
        go.axial * b.by_turn.axial + go.radial * b.by_turn.radial,
    )
    put_pair(work, rows.BY_TURN, k, pressed, -turn_i, -turn_o)
    inner, outer = tensors.less_column(by_shift, t, ri), tensors.less_column(none, t, ro)
    put_pair(work, rows.AXIAL_BY_SHIFT, k, pressed, inner.axial, outer.axial)
    put_pair(work, rows.RADIAL_BY_SHIFT, k, pressed, inner.radial, outer.radial)
    couple = h.couple_by_shift - u.axial * ri.axial - u.radial * ri.radial
    put_pair(work, rows.COUPLE_BY_SHIFT, k, pressed, couple, -u.axial * ro.axial - u.radial * ro.radial)


@jit(SYSTEM)
def rigid_tangential(t, q, v, balls, contacts, constants, response):
    """See ``raceway.core.ring.kernels``; ball (Z, 4): p [m], slips [m]."""
    ball, ball_gain, ball_history = balls
    scalars, table = constants
    f, K, C, work = response
    z, arm, elastic_bodies = table.shape[0], scalars[ring.TILT_ARM], work.shape[0] > rows.WORK_ROWS
    place(t, q, v, constants, work, (at.DIRECTION, BALL_CENTRE, BALL_VELOCITY))
    if elastic_bodies:
        move_centres(work, BALL_CENTRE, BALL_VELOCITY)
    for k in range(z):
        _first_guess(k, q, scalars, table, ball, ball_history, work)
    for attempt in range(_ITERATIONS):
        if attempt == PATIENCE:
            # Forces without a potential can lead in circles: once more from the seat on the outer race.
            for k in range(z):
                if work[at.STATE, z + k] == at.MOVES:
                    _seat_outside(k, table, work)
        for k in range(0, z, WIDTH):
            # Directions of balls that have settled are those before their last step, as their forces are.
            live = live_of(k, z)
            approach(k, live & ~(take(work, at.STATE, z + k, live) == at.SETTLED), ball_gain, work)
        normal_forces(contacts, scalars, work)
        moving = False
        for k in range(0, z, WIDTH):
            moving |= any_of(_moving(k, live_of(k, z), attempt, ball_gain, scalars, work))
        if not moving:
            break
    if moving:
        return 1
    singular = False
    for k in range(0, z, WIDTH):
        singular |= any_of(_condense(k, live_of(k, z), ball_gain, work))
    if singular:
        return 1
    for k in range(z):
        for c in range(2):
            ball[k, c], ball[k, ring.SLIPS + c] = work[rows.PLACE, k + c * z], work[at.SLIP, k + c * z]
    ring_force(table, arm, work, at.DIRECTION, _CARRIED, f)
    if K.size > 0:
        ring_tangent(table, arm, work, at.DIRECTION, _STIFF, K)
        ring_tangent(table, arm, work, at.DIRECTION, _VISCOUS, C)
        add_couples(table, arm, work, at.DIRECTION, _VISCOUS_COUPLES, f, C)
    add_couples(table, arm, work, at.DIRECTION, _COUPLES, f, K)
    return 0
