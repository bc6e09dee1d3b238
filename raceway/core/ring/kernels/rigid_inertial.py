"""Rigid rings and balls, with or without centrifugal force: each ball centre finds its place in its meridian plane.

With n = (sin a, cos a) the direction of a contact at its angle a and t = (cos a, -sin a), the inner race gives a ball
g_i = f_i n_i + h_i t_i and the outer one takes g_o = f_o n_o + h_o t_o; g_i - g_o + F_c = 0.  h = tau - T: T comes from the gyroscopic
moment, tau from friction; both put the couple -r h on the section of the inner ring (of friction -r k_t u, which belongs to the stored
energy).  Without h, of balls without columns of slips, that is the least of a convex potential; moments and sliding have none, and tangents
are not symmetric.  A damped Newton iteration finds the place p for all balls at once, four in the lanes of one step.  The ball's own
acceleration in its meridian plane is left out: its slowest mode, along the groove, lies at some kHz.  Without any of these forces the
place lies on the line of the groove centres, where the races are in series; a ball that carries nothing lies midway.
"""

import numpy as np
from numba import boolean, float64, int64, void

from raceway.core.jit import jit
from raceway.core.lanes import LANES, MASK, WIDTH, any_of, larger, live_of, put, root, spread, take, where
from raceway.core.ring import kernels as rows
from raceway.core.ring.kernels import layout as ring
from raceway.core.ring.kernels import rolling as at
from raceway.core.ring.kernels import tensors
from raceway.core.ring.kernels.rolling import BallContact, linear_balance, plain_balance, rub, with_gyroscopic
from raceway.core.ring.kernels.tensors import LANES_PAIR, LANES_TENSOR, Pair, pair_of, put_pair, put_tensors, tensors_of
from raceway.core.signatures import MATRIX, SYSTEM, VECTOR

#: Steps after which a ball begins anew; after twice as many its imbalance has to shrink at every step.
PATIENCE = 60
_ITERATIONS = 300
#: Rows that the iteration has done with, used again for what goes to the ring: force [N], its derivatives by e and its velocity
#: [N/m, N s/m] (two rows each); couple [N m] and its derivative by the section's turn, that of the force, of the couple by e and by its velocity.
_CARRIED, _STIFF, _VISCOUS, _COUPLES, _BY_VELOCITY = 8, 5, 21, 33, 36


@jit(void(int64, boolean, VECTOR, VECTOR, MATRIX, MATRIX, MATRIX, MATRIX), inline=True)
def _first_guess(k, rolls, q, scalars, table, ball, ball_history, work):
    """Begin with ball k; where nothing presses it on either race it lies midway, without forces."""
    z = table.shape[0]
    li, lo = ring.offsets_of(k, scalars, table)
    ea, er, shift = work[ring.BALL_CENTRE, k], work[ring.BALL_CENTRE, z + k], work[rows.SHIFT, z + k]
    turn = q[3] * work[at.DIRECTION, z + k] - q[4] * work[at.DIRECTION, k]
    turn_arc = (scalars[ring.OFFSET_INNER] + 0.5 * scalars[ring.DIAMETER]) * table[k, ring.SIDE] * turn
    length = np.sqrt(ea * ea + er * er)
    room = li + lo + work[rows.SHIFT, k] + shift
    work[at.CENTRIFUGAL, k], work[at.TURNED, z + k] = table[k, ring.CENTRIFUGAL], turn_arc
    work[rows.OFFSET, k], work[rows.OFFSET, z + k] = li, lo
    work[at.STATE, z + k], work[rows.PLACE, k], work[rows.PLACE, z + k] = at.MOVES, ball[k, 0], ball[k, 1]
    for c in range(2):
        work[rows.HISTORY, k + c * z] = ball_history[k, c]
        if rolls:
            work[at.COMMITTED, k + c * z] = ball_history[k, ring.SLIPS + c]
            work[at.SLIP, k + c * z] = ball[k, ring.SLIPS + c]
    _forget(k, z, work)
    if table[k, ring.CENTRIFUGAL] == 0.0 and length <= room:
        scale, angle = (lo + shift + 0.5 * (length - room)) / length, np.arctan2(ea, er)
        work[rows.PLACE, k], work[rows.PLACE, z + k] = scale * ea, scale * er
        at_i, at_o = scalars[ring.OFFSET_INNER] * angle, scalars[ring.OFFSET_OUTER] * angle
        work[at.SLIP, k], work[at.SLIP, z + k] = at_i - turn_arc, at_o
        work[at.STATE, z + k] = at.LOOSE
    elif ball[k, 0] == 0.0 and ball[k, 1] == 0.0 or ball[k, 0] ** 2 + ball[k, 1] ** 2 <= lo * lo:
        work[rows.PLACE, k], work[rows.PLACE, z + k] = ring.first_place(k, ea, er, scalars, table)


@jit(void(int64, int64, MATRIX))
def _forget(k, z, work):
    work[at.SLOPE, k], work[at.MERIT, z + k], work[at.STEP, k], work[at.STEP, z + k] = 0.0, np.inf, 0.0, 0.0


@jit(at.CONTACTS(int64, MASK, LANES_PAIR, LANES_PAIR, LANES_PAIR, float64, MATRIX), inline=True)
def _contacts_of(k, live, force, by_gap, by_rate, ball_gain, work):
    """Both contacts of the balls from k on, of forces and their derivatives of the inner and the outer one."""
    (ia, ir), (oa, orr) = pair_of(work, ring.INNER, k, live), pair_of(work, ring.OUTER, k, live)
    by_si, by_so = pair_of(work, ring.BY_LENGTH, k, live)
    inner, outer = -by_gap.axial - ball_gain * by_rate.axial, -by_gap.radial - ball_gain * by_rate.radial
    return BallContact(ia, ir, by_si, force.axial, inner), BallContact(oa, orr, by_so, force.radial, outer)


@jit(MASK(int64, MASK, boolean, int64, float64, VECTOR, MATRIX), inline=True)
def _moving(k, live, rolls, attempt, ball_gain, scalars, work):
    """Move the balls from k on that have not settled by one step; those that go on.

    The imbalance of a ball at p is R = g_i - g_o + F_c. A step that goes beyond the balance is halved, balls that run in circles begin
    anew, and those that fail again have to come closer at every step.
    """
    z = work.shape[1] // 2
    slope, state = pair_of(work, at.SLOPE, k, live)
    active = live & (state == at.MOVES)
    force, (gap_i, gap_o) = pair_of(work, rows.CONTACT_FORCE, k, live), pair_of(work, rows.GAP, k, live)
    by_gap, by_rate = pair_of(work, rows.FORCE_BY_GAP, k, live), pair_of(work, rows.FORCE_BY_RATE, k, live)
    contacts = _contacts_of(k, live, force, by_gap, by_rate, ball_gain, work)
    (inner, outer), (fi, fo) = contacts, force
    h, slips = at.no_tangential(), pair_of(work, at.SLIP, k, live)
    if rolls and scalars[ring.FRICTION] != 0.0:
        h, slips = rub(k, live, contacts, scalars, work)
    if rolls and scalars[ring.GYROSCOPIC] != 0.0:
        rolling = at.Rolling(
            spread(scalars[ring.DIAMETER]), spread(scalars[ring.BALL_OVER_PITCH]), spread(scalars[ring.GYROSCOPIC]),
            spread(scalars[ring.OFFSET_INNER]), spread(scalars[ring.SHARE_INNER]), spread(scalars[ring.SHARE_OUTER]),
            spread(scalars[ring.TRACTION]),
        )  # fmt: skip
        h = with_gyroscopic(k, live, contacts, h, rolling, work)
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
    lo, balance = take(work, rows.OFFSET, z + k, live), plain_balance(contacts, inner.stiffness, spread(0.0))
    least = larger(1e-8 * at.shallower(gap_i, gap_o), 1e-14 * lo)  # below rounding nothing can be asked
    if rolls:
        balance = linear_balance(contacts, inner.stiffness, spread(0.0), h)
        least = 1e-10 * larger(larger(-gap_i, -gap_o), 1e-12)
    # -J^-1 R, regular where J = dR/dp is not, and no longer than a fifth of the groove's radius.
    j, longest = at.regular(balance.j), 0.2 * larger(lo, -lo)  # films can be thicker than the groove stands off
    inverse = -1.0 / (j.aa * j.rr - j.ar * j.ra)
    sa, sr = (j.rr * ra - j.ar * rr) * inverse, (j.aa * rr - j.ra * ra) * inverse
    reach = sa * sa + sr * sr
    ends = active & ~back & (reach <= least * least)
    if any_of(reach > longest * longest):
        scale = where(reach > longest * longest, longest / root(reach), 1.0)
        sa, sr = sa * scale, sr * scale
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
        along_i, along_o = inner.axial * sa + inner.radial * sr, outer.axial * sa + outer.radial * sr
        put_pair(work, rows.GAP, k, ends, gap_i + along_i, gap_o - along_o)
        if rolls:
            put_pair(work, at.SLIP, k, ends, slips.axial, slips.radial)
            for i in range(9):
                put_pair(work, at.TANGENTIAL + i, k, ends, h[2 * i], h[2 * i + 1])
    return active & ~ends


@jit(MASK(int64, MASK, boolean, float64, MATRIX), inline=True)
def _condense(k, live, rolls, ball_gain, work):
    """What the balls from k on do to the ring, and what elastic bodies ask for; returns the balls that have no tangent."""
    state, kept = take(work, at.STATE, work.shape[1] // 2 + k, live), pair_of(work, at.KEPT_FORCE, k, live)
    by_gap, by_rate = pair_of(work, at.KEPT_BY_GAP, k, live), pair_of(work, at.KEPT_BY_RATE, k, live)
    pressed = live & (state == at.SETTLED) & ~((kept.axial == 0.0) & (by_gap.axial == 0.0))
    (da, dr), (oa, orr) = pair_of(work, at.STEP, k, live), pair_of(work, ring.OUTER, k, live)
    along = oa * da + orr * dr
    closed_o = larger(kept.radial - (by_gap.radial + ball_gain * by_rate.radial) * along, 0.0)
    # What presses nothing is read as zeros, which all that follows makes zeros of.
    kept, by_gap = pair_of(work, at.KEPT_FORCE, k, pressed), pair_of(work, at.KEPT_BY_GAP, k, pressed)
    by_rate, none = pair_of(work, at.KEPT_BY_RATE, k, pressed), spread(0.0)
    contacts, h = _contacts_of(k, live, kept, by_gap, by_rate, ball_gain, work), at.no_tangential()
    inner, outer = contacts
    # Forces are those before the ball's last step: with what that changes they are off by its square.
    b = plain_balance(contacts, -by_gap.axial, -by_rate.axial)
    if rolls:
        h = at.tangential_of(work, k, pressed)
        b = linear_balance(contacts, -by_gap.axial, -by_rate.axial, h)
    force_a = inner.force * inner.axial + h.inner * inner.radial + b.p.aa * da + b.p.ar * dr
    force_r = inner.force * inner.radial - h.inner * inner.axial + b.p.ra * da + b.p.rr * dr
    closed_i = inner.force - inner.stiffness * (inner.axial * da + inner.radial * dr)
    # Balls that the inner race does not press keep their outer force, loose ones have none.
    put_pair(work, rows.CONTACT_FORCE, k, live, larger(closed_i, 0.0), where(state == at.SETTLED, closed_o, 0.0))
    det = b.j.aa * b.j.rr - b.j.ar * b.j.ra
    inverse = where(pressed, 1.0 / det, 0.0)
    t = tensors.times_adjugate(b.p, b.j)
    t = tensors.Tensor(t.aa * inverse, t.ar * inverse, t.ra * inverse, t.rr * inverse)
    stiffness, damping = tensors.less(b.e, t, b.x), tensors.less(b.m, t, b.m)
    put_pair(work, _CARRIED, k, live, force_a, force_r)
    put_tensors(work, _STIFF, k, live, stiffness)
    put_tensors(work, _VISCOUS, k, live, damping)
    u, by_turn, by_centre = Pair(none, none), Pair(none, none), Pair(none, none)
    if rolls:
        # The couple by e, and by the ball's place; turning the section moves both forces alike.
        by_e, by_place = at.couple_slopes(contacts, h)
        u, couple = tensors.row_times_adjugate(by_place, b.j), h.couple + by_place.axial * da + by_place.radial * dr
        u = Pair(u.axial * inverse, u.radial * inverse)
        by_turn, by_centre = tensors.less_column(b.by_turn, t, b.by_turn), tensors.less_row(by_e, u, b.x)
        couple_by_turn = h.couple_by_turn - u.axial * b.by_turn.axial - u.radial * b.by_turn.radial
        by_velocity = tensors.less_row(Pair(none, none), u, b.m)
        put_pair(work, _COUPLES, k, live, couple, couple_by_turn)
        put_pair(work, _COUPLES + 1, k, live, by_turn.axial, by_turn.radial)
        put_pair(work, _COUPLES + 2, k, live, by_centre.axial, by_centre.radial)
        put_pair(work, _BY_VELOCITY, k, live, by_velocity.axial, by_velocity.radial)
    if work.shape[0] > rows.WORK_ROWS:
        put_pair(work, rows.FORCE, k, live, force_a, force_r)
        put_tensors(work, rows.FORCE_BY_CENTRE, k, live, stiffness)
        put_tensors(work, rows.FORCE_BY_SPEED, k, live, damping)
        put_pair(work, rows.FORCE_BY_TURN, k, live, by_turn.axial, by_turn.radial)
        put_pair(work, rows.COUPLE_BY_CENTRE, k, live, by_centre.axial, by_centre.radial)
        _keep_for_bodies(k, live, contacts, h, -by_gap.axial, -by_rate.axial, b, t, u, inverse, work)
    return pressed & ~(larger(det, -det) > 0.0)


@jit(void(int64, MASK, at.CONTACTS, at.TANGENTIALS, LANES, LANES, at.BALANCE, LANES_TENSOR, LANES_PAIR, LANES, MATRIX))
def _keep_for_bodies(k, live, contacts, h, elastic, viscous, b, t, u, inverse, work):
    """Contact forces by e, its velocity, shifts and turn; the balls' forces on the ring and their couples by shifts.

    Both contacts have dQ = g (dR), g = dQ/dp J^-1, on top of what they feel at a ball that stays where it is.
    """
    (na, nr, _, _, ki), (oa, orr, _, _, ko) = contacts
    gi, go = tensors.row_times_adjugate(Pair(na, nr), b.j), tensors.row_times_adjugate(Pair(oa, orr), b.j)
    gi = Pair(-ki * gi.axial * inverse, -ki * gi.radial * inverse)
    go, none = Pair(ko * go.axial * inverse, ko * go.radial * inverse), Pair(spread(0.0), spread(0.0))
    inner, outer = tensors.less_row(Pair(elastic * na, elastic * nr), gi, b.x), tensors.less_row(none, go, b.x)
    put_pair(work, rows.BY_AXIAL, k, live, inner.axial, outer.axial)
    put_pair(work, rows.BY_RADIAL, k, live, inner.radial, outer.radial)
    inner, outer = tensors.less_row(Pair(viscous * na, viscous * nr), gi, b.m), tensors.less_row(none, go, b.m)
    put_pair(work, rows.BY_AXIAL_SPEED, k, live, inner.axial, outer.axial)
    put_pair(work, rows.BY_RADIAL_SPEED, k, live, inner.radial, outer.radial)
    # The ring's force and R by the inner shift, R by the outer one.
    by_shift = Pair(h.inner_by_shift * nr - ki * na, -h.inner_by_shift * na - ki * nr)
    ri = Pair(by_shift.axial + h.grows * orr, by_shift.radial - h.grows * oa)
    ro = Pair(ko * oa - h.outer_by_shift * orr, ko * orr + h.outer_by_shift * oa)
    own_i, own_o = -ki - gi.axial * ri.axial - gi.radial * ri.radial, -ko - go.axial * ro.axial - go.radial * ro.radial
    put_pair(work, rows.BY_OWN, k, live, own_i, own_o)
    by_o, by_i = -gi.axial * ro.axial - gi.radial * ro.radial, -go.axial * ri.axial - go.radial * ri.radial
    put_pair(work, rows.BY_OTHER, k, live, by_o, by_i)
    turn_i = gi.axial * b.by_turn.axial + gi.radial * b.by_turn.radial
    turn_o = go.axial * b.by_turn.axial + go.radial * b.by_turn.radial
    put_pair(work, rows.BY_TURN, k, live, -turn_i, -turn_o)
    inner, outer = tensors.less_column(by_shift, t, ri), tensors.less_column(none, t, ro)
    put_pair(work, rows.AXIAL_BY_SHIFT, k, live, inner.axial, outer.axial)
    put_pair(work, rows.RADIAL_BY_SHIFT, k, live, inner.radial, outer.radial)
    couple = h.couple_by_shift - u.axial * ri.axial - u.radial * ri.radial
    put_pair(work, rows.COUPLE_BY_SHIFT, k, live, couple, -u.axial * ro.axial - u.radial * ro.radial)


@jit(SYSTEM)
def rigid_inertial(t, q, v, balls, contacts, constants, response):
    """See ``raceway.core.ring.kernels``; ball (Z, 2 to 8): p [m]; a row of zeros asks for a first guess; slips [m] where balls have them."""
    ball, ball_gain, ball_history = balls
    scalars, table = constants
    f, K, C, work = response
    z, arm, elastic_bodies = table.shape[0], scalars[ring.TILT_ARM], work.shape[0] > rows.WORK_ROWS
    rolls = ring.slips_end(scalars, ball) > ring.SLIPS
    ring.place(t, q, v, constants, work, (at.DIRECTION, ring.BALL_CENTRE, ring.BALL_VELOCITY))
    for c in range(2 * z if elastic_bodies else 0):  # their elasticity moves the groove centres
        work[ring.BALL_CENTRE, c] += work[rows.MOVED, c]
        work[ring.BALL_VELOCITY, c] += work[rows.MOVED_RATE, c]
    for k in range(z):
        _first_guess(k, rolls, q, scalars, table, ball, ball_history, work)
    for attempt in range(_ITERATIONS):
        if attempt == PATIENCE:
            # Forces without a potential can lead in circles: once more from the seat on the outer race.
            for k in range(z):
                if work[at.STATE, z + k] == at.MOVES:
                    depth = (table[k, ring.CENTRIFUGAL] / table[k, ring.OUTER_FACTOR]) ** (2.0 / 3.0)
                    work[rows.PLACE, k], work[rows.PLACE, z + k] = 0.0, work[rows.OFFSET, z + k] + depth
                    _forget(k, z, work)
        for k in range(0, z, WIDTH):
            # Directions of balls that have settled are those before their last step, as their forces are.
            live = live_of(k, z)
            ring.approach(k, live & ~(take(work, at.STATE, z + k, live) == at.SETTLED), ball_gain, work)
        ring.normal_forces(contacts, scalars, work)
        moving = False
        for k in range(0, z, WIDTH):
            moving |= any_of(_moving(k, live_of(k, z), rolls, attempt, ball_gain, scalars, work))
        if not moving:
            break
    if moving:
        return 1
    singular = False
    for k in range(0, z, WIDTH):
        singular |= any_of(_condense(k, live_of(k, z), rolls, ball_gain, work))
    if singular:
        return 1
    for k in range(z):
        for c in range(2):
            ball[k, c] = work[rows.PLACE, k + c * z]
            if rolls:
                ball[k, ring.SLIPS + c] = work[at.SLIP, k + c * z]
    force, stiffness, damping, none, damped = ring.no_force(), ring.no_tangent(), ring.no_tangent(), spread(0.0), False
    couple, turn, by_turn, by_centre, by_velocity = none, none, Pair(none, none), Pair(none, none), Pair(none, none)
    for k in range(0, z, WIDTH):
        live = live_of(k, z)
        seat, (axial, radial) = ring.seats_of(k, live, arm, table, work, at.DIRECTION), pair_of(work, _CARRIED, k, live)
        if rolls:
            (couple, turn), by_turn = pair_of(work, _COUPLES, k, live), pair_of(work, _COUPLES + 1, k, live)
            by_centre = pair_of(work, _COUPLES + 2, k, live)
        force = ring.with_force(force, seat, axial, radial, couple)
        if K.size > 0:
            stiffness = ring.with_tangent(stiffness, seat, tensors_of(work, _STIFF, k, live), by_turn, by_centre, turn)
        damped |= any_of(~(take(work, at.KEPT_BY_RATE, k, live) == 0.0))
    for k in range(0, z if damped and K.size > 0 else 0, WIDTH):
        live = live_of(k, z)
        if rolls:
            by_velocity = pair_of(work, _BY_VELOCITY, k, live)
        seat = ring.seats_of(k, live, arm, table, work, at.DIRECTION)
        damping = ring.with_tangent(damping, seat, tensors_of(work, _VISCOUS, k, live), Pair(none, none), by_velocity, none)
    ring.put_force(force, f)
    if K.size > 0:
        ring.put_tangent(stiffness, K)
        ring.put_tangent(damping, C)
    return 0


@jit(SYSTEM)
def rigid_tangential(t, q, v, balls, contacts, constants, response):
    """The same of balls with columns of slips, under friction or gyroscopic moments, whose forces have no potential."""
    return rigid_inertial(t, q, v, balls, contacts, constants, response)
