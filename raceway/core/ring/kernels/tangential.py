"""Balls with tangential contact forces in their meridian plane: gyroscopic moments, Coulomb friction, or both.

Notes
-----
With n = (sin a, cos a) the direction of a contact at its angle a and t = (cos a, -sin a), the inner race gives a ball
g_i = f_i n_i + (tau_i - T_i) t_i and the outer one takes g_o = f_o n_o + (tau_o - T_o) t_o; g_i - g_o + F_c = 0.  T comes from
the gyroscopic moment, tau from friction; both put the couple -r h, h = tau - T, on the section of the inner ring (of friction
-r k_t u, which belongs to the stored energy).  Gyroscopic moments and sliding have no potential: tangents are not symmetric.
"""

import numpy as np
from numba import boolean, float64, int64, void

from raceway.core.jit import jit
from raceway.core.ring import kernels as rows
from raceway.core.ring.kernels import layout as ring
from raceway.core.ring.kernels import rolling as at
from raceway.core.ring.kernels import tensors
from raceway.core.ring.kernels.layout import SEAT, Seat, add_ball, add_couple, move_centres, normal_forces, offsets_of, place
from raceway.core.ring.kernels.rolling import BallContact, add_gyroscopic, contact_matrix, linear_balance, roll, rub
from raceway.core.signatures import MATRIX, SYSTEM, VECTOR


@jit(at.CONTACTS(int64, float64, MATRIX), inline=True)
def _contacts_of(k, ball_gain, work):
    """Both contacts of ball k as the law has left them."""
    z = work.shape[1] // 2
    inner = -work[rows.FORCE_BY_GAP, k] - ball_gain * work[rows.FORCE_BY_RATE, k]
    outer = -work[rows.FORCE_BY_GAP, z + k] - ball_gain * work[rows.FORCE_BY_RATE, z + k]
    return (
        BallContact(work[at.INNER, k], work[at.INNER, z + k], work[at.LENGTH, k], work[rows.CONTACT_FORCE, k], inner),
        BallContact(
            work[at.OUTER, k], work[at.OUTER, z + k], work[at.LENGTH, z + k], work[rows.CONTACT_FORCE, z + k], outer
        ),
    )


#: Steps after which a ball begins anew; after twice as many its imbalance has to shrink at every step.
PATIENCE = 60


@jit(boolean(int64, VECTOR, VECTOR, MATRIX, MATRIX, MATRIX), inline=True)
def _first_guess(k, q, scalars, table, ball, work):
    """Begin with ball k; False where nothing presses it on either race: it then lies midway, without forces."""
    z = table.shape[0]
    li, lo = offsets_of(k, scalars, table)
    ea, er, shift = work[at.CENTRE, k], work[at.CENTRE, z + k], work[rows.SHIFT, z + k]
    turn = q[3] * work[at.DIRECTION, z + k] - q[4] * work[at.DIRECTION, k]
    turn_arc = (scalars[ring.OFFSET_INNER] + 0.5 * scalars[ring.DIAMETER]) * table[k, ring.SIDE] * turn
    length = np.sqrt(ea * ea + er * er)
    room = li + lo + work[rows.SHIFT, k] + shift
    work[at.TURNED, z + k] = turn_arc
    work[at.SLOPE, k], work[at.STATE, z + k], work[at.MERIT, z + k] = 0.0, at.MOVES, np.inf
    work[at.STEP, k], work[at.STEP, z + k] = 0.0, 0.0
    # Of gyroscopic moments alone.
    work[at.BY_OTHER_ANGLE, k], work[at.BY_OTHER_ANGLE, z + k] = 0.0, 0.0
    work[at.COUPLE_BY_ANGLE, z + k], work[at.OUTER_BY_INNER_LENGTH, k] = 0.0, 0.0
    if table[k, ring.CENTRIFUGAL] == 0.0 and length <= room:
        scale, angle = (lo + shift + 0.5 * (length - room)) / length, np.arctan2(ea, er)
        ball[k, 0], ball[k, 1] = scale * ea, scale * er
        at_i, at_o = scalars[ring.OFFSET_INNER] * angle, scalars[ring.OFFSET_OUTER] * angle
        ball[k, ring.SLIPS], ball[k, ring.SLIPS + 1] = at_i - turn_arc, at_o
        work[at.STATE, z + k] = at.LOOSE
        return False
    if ball[k, 0] == 0.0 and ball[k, 1] == 0.0 or ball[k, 0] ** 2 + ball[k, 1] ** 2 <= lo * lo:
        if length > li + lo:
            scale = (lo + table[k, ring.OUTER_SHARE] * (length - li - lo)) / length
            ball[k, 0], ball[k, 1] = scale * ea, scale * er
        else:
            _seat_outside(k, scalars, table, ball, work)
    return True


@jit(void(int64, VECTOR, MATRIX, MATRIX, MATRIX))
def _seat_outside(k, scalars, table, ball, work):
    """Put ball k where its centrifugal force alone holds it, on the outer race, and forget its steps."""
    z = table.shape[0]
    depth = (table[k, ring.CENTRIFUGAL] / table[k, ring.OUTER_FACTOR]) ** (2.0 / 3.0)
    ball[k, 0], ball[k, 1] = 0.0, offsets_of(k, scalars, table)[1] + depth
    work[at.SLOPE, k], work[at.MERIT, z + k] = 0.0, np.inf
    work[at.STEP, k], work[at.STEP, z + k] = 0.0, 0.0


@jit(void(int64, VECTOR, MATRIX, MATRIX, float64, MATRIX, MATRIX), inline=True)
def _approach(k, scalars, table, ball, ball_gain, ball_history, work):
    """Directions, lengths, gaps and gap rates of both contacts of ball k."""
    z = ball.shape[0]
    pa, pr = ball[k, 0], ball[k, 1]
    xa, xr = work[at.CENTRE, k] - pa, work[at.CENTRE, z + k] - pr
    so, si = np.sqrt(pa * pa + pr * pr), np.sqrt(xa * xa + xr * xr)
    no_a, no_r = pa / so, pr / so
    ni_a, ni_r = (xa / si, xr / si) if si > 0.0 else (no_a, no_r)
    own_a, own_r = ball_gain * pa + ball_history[k, 0], ball_gain * pr + ball_history[k, 1]
    rate_i = -(ni_a * (work[at.VELOCITY, k] - own_a) + ni_r * (work[at.VELOCITY, z + k] - own_r))
    rate_o = -(no_a * own_a + no_r * own_r)
    li, lo = offsets_of(k, scalars, table)
    gap_i, gap_o = li - si + work[rows.SHIFT, k], lo - so + work[rows.SHIFT, z + k]
    rate_i, rate_o = rate_i + work[rows.SHIFT_RATE, k], rate_o + work[rows.SHIFT_RATE, z + k]
    work[at.LENGTH, k], work[at.LENGTH, z + k] = si, so
    work[at.INNER, k], work[at.INNER, z + k] = ni_a, ni_r
    work[at.OUTER, k], work[at.OUTER, z + k] = no_a, no_r
    work[rows.GAP, k], work[rows.GAP, z + k] = gap_i, gap_o
    work[rows.GAP_RATE, k], work[rows.GAP_RATE, z + k] = rate_i, rate_o


@jit(tensors.PAIR(int64, at.CONTACTS, float64, float64, float64, MATRIX), inline=True)
def _ball_step(k, contacts, ra, rr, longest, work):
    """-J^-1 R [m], regular where J is not, and no longer than ``longest``.

    J = dR/dp = -G_i - G_o + cross terms through the moment's dependence on both angles.
    """
    z = work.shape[1] // 2
    inner, outer = contacts
    ti_a, ti_r, to_a, to_r = inner.radial, -inner.axial, outer.radial, -outer.axial
    wi, wo = (1.0 / inner.length if inner.length > 0.0 else 0.0), 1.0 / outer.length
    cross_i, cross_o = work[at.BY_OTHER_ANGLE, k], work[at.BY_OTHER_ANGLE, z + k]
    grows = work[at.OUTER_BY_INNER_LENGTH, k]
    oi_a, oi_r = cross_o * ti_a * wi + grows * inner.axial, cross_o * ti_r * wi + grows * inner.radial
    gi, go = contact_matrix(inner, k, work), contact_matrix(outer, z + k, work)
    jaa = -gi.aa - go.aa + cross_i * ti_a * to_a * wo + to_a * oi_a
    jar = -gi.ar - go.ar + cross_i * ti_a * to_r * wo + to_a * oi_r
    jra = -gi.ra - go.ra + cross_i * ti_r * to_a * wo + to_r * oi_a
    jrr = -gi.rr - go.rr + cross_i * ti_r * to_r * wo + to_r * oi_r
    det = jaa * jrr - jar * jra
    if not abs(det) > 1e-14 * (jaa + jrr) ** 2:
        shift = -1e-7 * abs(jaa + jrr) - 1.0
        jaa += shift
        jrr += shift
        det = jaa * jrr - jar * jra
    axial, radial = -(jrr * ra - jar * rr) / det, -(jaa * rr - jra * ra) / det
    size = np.sqrt(axial * axial + radial * radial)
    scale = longest / size if size > longest else 1.0
    return tensors.Pair(axial * scale, radial * scale)


@jit(boolean(int64, int64, at.CONTACTS, float64, MATRIX, MATRIX, MATRIX), inline=True)
def _settles(k, attempt, contacts, lo, table, ball, work):
    """Move ball k by one step; whether that was the last one, small enough to leave nothing but second order.

    With n = (sin a, cos a) the direction of a contact at its angle a and t = (cos a, -sin a), the imbalance of a ball at p
    is R = f_i n_i + h_i t_i - f_o n_o - h_o t_o + F_c. It has no potential: a step that goes beyond the balance is halved,
    balls that run in circles begin anew, and those that fail again have to come closer at every step.
    """
    z = table.shape[0]
    inner, outer = contacts
    hi, ho = work[at.TANGENTIAL, k], work[at.TANGENTIAL, z + k]
    ra = inner.force * inner.axial + hi * inner.radial - outer.force * outer.axial - ho * outer.radial
    rr = inner.force * inner.radial - hi * inner.axial - outer.force * outer.radial + ho * outer.axial
    rr += table[k, ring.CENTRIFUGAL]
    size = np.sqrt(ra * ra + rr * rr)
    da, dr, slope = work[at.STEP, k], work[at.STEP, z + k], work[at.SLOPE, k]
    too_far = slope > 0.0 and -(ra * da + rr * dr) > 0.9 * slope
    if attempt > 2 * PATIENCE and np.sqrt(da * da + dr * dr) > 1e-13:
        # Twice in circles: descend at every step instead.
        too_far = size > 0.9999 * work[at.MERIT, z + k]
    if too_far:
        # Beyond the balance along the last step by more than it began with: go half-way back.
        da, dr = 0.5 * da, 0.5 * dr
        work[at.STEP, k], work[at.STEP, z + k], work[at.SLOPE, k] = da, dr, 0.5 * slope
        ball[k, 0] -= da
        ball[k, 1] -= dr
        return False
    da, dr = _ball_step(k, contacts, ra, rr, 0.2 * lo, work)
    ball[k, 0] += da
    ball[k, 1] += dr
    work[at.STEP, k], work[at.STEP, z + k], work[at.SLOPE, k] = da, dr, ra * da + rr * dr
    work[at.MERIT, z + k] = size
    if not np.sqrt(da * da + dr * dr) <= 1e-10 * max(-work[rows.GAP, k], -work[rows.GAP, z + k], 1e-12):
        return False
    # Forces and tangents are kept from before this step, which ``_add_settled`` adds to the forces.
    work[at.KEPT_FORCE, k], work[at.KEPT_FORCE, z + k] = inner.force, outer.force
    work[at.KEPT_BY_GAP, k], work[at.KEPT_BY_GAP, z + k] = work[rows.FORCE_BY_GAP, k], work[rows.FORCE_BY_GAP, z + k]
    work[at.KEPT_BY_RATE, k], work[at.KEPT_BY_RATE, z + k] = work[rows.FORCE_BY_RATE, k], work[rows.FORCE_BY_RATE, z + k]
    work[at.STATE, z + k] = at.SETTLED
    return True


@jit(boolean(int64, float64, SEAT, MATRIX, VECTOR, MATRIX, MATRIX), inline=True)
def _add_settled(k, ball_gain, seat, work, f, K, C):
    """Add ball k to f (5,), K and C (5, 5), and keep for elastic bodies what they ask for; False where J has no inverse."""
    z = work.shape[1] // 2
    contacts = _contacts_of(k, ball_gain, work)
    inner, outer = contacts
    # Forces are those before the ball's last step: with what that changes they are off by its square.
    b, h, da, dr = linear_balance(k, contacts, work), work[at.TANGENTIAL, k], work[at.STEP, k], work[at.STEP, z + k]
    force = tensors.Pair(
        inner.force * inner.axial + h * inner.radial + b.p.aa * da + b.p.ar * dr,
        inner.force * inner.radial + h * -inner.axial + b.p.ra * da + b.p.rr * dr,
    )
    inner_closing, outer_closing = inner.axial * da + inner.radial * dr, outer.axial * da + outer.radial * dr
    work[rows.CONTACT_FORCE, k] = max(inner.force - inner.stiffness * inner_closing, 0.0)
    work[rows.CONTACT_FORCE, z + k] = max(outer.force + outer.stiffness * outer_closing, 0.0)
    det = b.j.aa * b.j.rr - b.j.ar * b.j.ra
    if det == 0.0:
        return False
    t = tensors.times_adjugate(b.p, b.j)
    t = tensors.Tensor(t.aa / det, t.ar / det, t.ra / det, t.rr / det)
    # The couple by e, and by the ball's place; turning the section moves both forces alike.
    stretch, angle = work[at.COUPLE_BY_LENGTH, z + k], work[at.COUPLE_BY_ANGLE, k] * (1.0 / inner.length)
    by_e = tensors.Pair(stretch * inner.axial + angle * inner.radial, stretch * inner.radial + angle * -inner.axial)
    angle = work[at.COUPLE_BY_ANGLE, z + k] * (1.0 / outer.length)
    by_place = tensors.Pair(angle * outer.radial - by_e.axial, angle * -outer.axial - by_e.radial)
    u, couple = tensors.row_times_adjugate(by_place, b.j), work[at.COUPLE, k] + by_place.axial * da + by_place.radial * dr
    u = tensors.Pair(u.axial / det, u.radial / det)
    force_by_turn, couple_by_centre = tensors.less_column(b.by_turn, t, b.by_turn), tensors.less_row(by_e, u, b.x)
    couple_by_turn = work[at.COUPLE_BY_TURN, k] - u.axial * b.by_turn.axial - u.radial * b.by_turn.radial
    add_couple(seat, couple, force_by_turn, couple_by_centre, couple_by_turn, f, K)
    add_couple(seat, 0.0, tensors.NOTHING, tensors.less_row(tensors.NOTHING, u, b.m), 0.0, f, C)
    by_centre, by_speed = tensors.less(b.e, t, b.x), tensors.less(b.m, t, b.m)
    if work.shape[0] > rows.WORK_ROWS:
        work[rows.FORCE, k], work[rows.FORCE, z + k] = force
        tensors.put_tensor(by_centre, work, rows.FORCE_BY_CENTRE, k)
        tensors.put_tensor(by_speed, work, rows.FORCE_BY_SPEED, k)
        work[rows.FORCE_BY_TURN, k], work[rows.FORCE_BY_TURN, z + k] = force_by_turn
        work[rows.COUPLE_BY_CENTRE, k], work[rows.COUPLE_BY_CENTRE, z + k] = couple_by_centre
        _keep_for_bodies(k, contacts, b, t, u, work)
    add_ball(seat, force, by_centre, by_speed, f, K, C)
    return True


@jit(void(int64, at.CONTACTS, at.BALANCE, tensors.TENSOR, tensors.PAIR, MATRIX))
def _keep_for_bodies(k, contacts, b, t, u, work):
    """Contact forces by e, its velocity, shifts and turn; the ball's force on the ring and its couple by shifts.

    Both contacts have dQ = g (dR), g = dQ/dp J^-1, on top of what they feel at a ball that stays where it is.
    """
    z = work.shape[1] // 2
    det = b.j.aa * b.j.rr - b.j.ar * b.j.ra
    (na, nr, _, _, ki), (oa, orr, _, _, ko) = contacts
    gi, go = tensors.row_times_adjugate(tensors.Pair(na, nr), b.j), tensors.row_times_adjugate(tensors.Pair(oa, orr), b.j)
    gi, go = (
        tensors.Pair(-ki * gi.axial / det, -ki * gi.radial / det),
        tensors.Pair(ko * go.axial / det, ko * go.radial / det),
    )
    elastic, viscous = -work[rows.FORCE_BY_GAP, k], -work[rows.FORCE_BY_RATE, k]
    work[rows.BY_AXIAL, k], work[rows.BY_RADIAL, k] = tensors.less_row(tensors.Pair(elastic * na, elastic * nr), gi, b.x)
    work[rows.BY_AXIAL, z + k], work[rows.BY_RADIAL, z + k] = tensors.less_row(tensors.NOTHING, go, b.x)
    work[rows.BY_AXIAL_SPEED, k], work[rows.BY_RADIAL_SPEED, k] = tensors.less_row(
        tensors.Pair(viscous * na, viscous * nr), gi, b.m
    )
    work[rows.BY_AXIAL_SPEED, z + k], work[rows.BY_RADIAL_SPEED, z + k] = tensors.less_row(tensors.NOTHING, go, b.m)
    # The ring's force and R by the inner shift, R by the outer one.
    hi, ho, grows = work[at.BY_SHIFT, k], work[at.BY_SHIFT, z + k], work[at.OUTER_BY_INNER_LENGTH, k]
    by_shift = tensors.Pair(-ki * na + hi * nr, -ki * nr + hi * -na)
    ri = tensors.Pair(by_shift.axial + grows * orr, by_shift.radial + grows * -oa)
    ro = tensors.Pair(ko * oa - ho * orr, ko * orr - ho * -oa)
    work[rows.BY_OWN, k] = -ki - gi.axial * ri.axial - gi.radial * ri.radial
    work[rows.BY_OTHER, k] = -gi.axial * ro.axial - gi.radial * ro.radial
    work[rows.BY_OTHER, z + k] = -go.axial * ri.axial - go.radial * ri.radial
    work[rows.BY_OWN, z + k] = -ko - go.axial * ro.axial - go.radial * ro.radial
    work[rows.BY_TURN, k] = -gi.axial * b.by_turn.axial - gi.radial * b.by_turn.radial
    work[rows.BY_TURN, z + k] = -go.axial * b.by_turn.axial - go.radial * b.by_turn.radial
    work[rows.AXIAL_BY_SHIFT, k], work[rows.RADIAL_BY_SHIFT, k] = tensors.less_column(by_shift, t, ri)
    work[rows.AXIAL_BY_SHIFT, z + k], work[rows.RADIAL_BY_SHIFT, z + k] = tensors.less_column(tensors.NOTHING, t, ro)
    work[rows.COUPLE_BY_SHIFT, k] = work[at.COUPLE_BY_SHIFT, k] - u.axial * ri.axial - u.radial * ri.radial
    work[rows.COUPLE_BY_SHIFT, z + k] = -u.axial * ro.axial - u.radial * ro.radial


_ITERATIONS = 300


@jit(SYSTEM)
def rigid_tangential(t, q, v, balls, contacts, constants, response):
    """See ``raceway.core.ring.kernels``; ball (Z, 4): p [m], slips [m]."""
    ball, ball_gain, ball_history = balls
    scalars, table = constants
    f, K, C, work = response
    force = work[rows.CONTACT_FORCE]
    by_gap, by_rate = work[rows.FORCE_BY_GAP], work[rows.FORCE_BY_RATE]
    elastic_bodies = work.shape[0] > rows.WORK_ROWS
    z = table.shape[0]
    place(t, q, v, constants, work, (at.DIRECTION, at.CENTRE, at.VELOCITY))
    if elastic_bodies:
        move_centres(work, at.CENTRE, at.VELOCITY)
    moving = 0
    for k in range(z):
        moving += _first_guess(k, q, scalars, table, ball, work)
    for attempt in range(_ITERATIONS):
        for k in range(z):
            if attempt == PATIENCE and work[at.STATE, z + k] == at.MOVES:
                # Forces without a potential can lead in circles: once more from the seat on the outer race.
                _seat_outside(k, scalars, table, ball, work)
            # Directions of balls that have settled are those before their last step, as their forces are.
            if work[at.STATE, z + k] != at.SETTLED:
                _approach(k, scalars, table, ball, ball_gain, ball_history, work)
        normal_forces(contacts, scalars, work)
        for k in range(z):
            if work[at.STATE, z + k] == at.MOVES:
                sides = _contacts_of(k, ball_gain, work)
                if scalars[ring.FRICTION] != 0.0:
                    rub(k, sides, scalars, ball, ball_history, work)
                else:
                    roll(k, work)
                if scalars[ring.GYROSCOPIC] != 0.0:
                    add_gyroscopic(k, sides, scalars, work)
                moving -= _settles(k, attempt, sides, scalars[ring.OFFSET_OUTER], table, ball, work)
        if moving == 0:
            break
    if moving > 0:
        return 1
    f[:], K[:], C[:] = 0.0, 0.0, 0.0
    for k in range(z):
        if elastic_bodies:
            for i in range(rows.WORK_ROWS, rows.WORK_ROWS + rows.KERNEL_ROWS):
                work[i, k], work[i, z + k] = 0.0, 0.0
        if work[at.STATE, z + k] == at.LOOSE:
            force[k], force[z + k] = 0.0, 0.0
            continue
        for c in (k, z + k):
            force[c], by_gap[c], by_rate[c] = work[at.KEPT_FORCE, c], work[at.KEPT_BY_GAP, c], work[at.KEPT_BY_RATE, c]
        if force[k] == 0.0 and by_gap[k] == 0.0:
            continue
        seat = Seat(
            work[at.DIRECTION, k],
            work[at.DIRECTION, z + k],
            scalars[ring.TILT_ARM],
            table[k, ring.SIDE],
            table[k, ring.LEVER],
        )
        if not _add_settled(k, ball_gain, seat, work, f, K, C):
            return 1
    return 0
