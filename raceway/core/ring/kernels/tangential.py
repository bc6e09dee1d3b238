"""Balls with tangential contact forces in their meridian plane: gyroscopic moments, Coulomb friction, or both.

Notes
-----
With n = (sin a, cos a) the direction of a contact at its angle a and t = (cos a, -sin a), the inner race gives a ball
g_i = f_i n_i + (tau_i - T_i) t_i and the outer one takes g_o = f_o n_o + (tau_o - T_o) t_o; g_i - g_o + F_c = 0.  T comes from
the gyroscopic moment, tau from friction; both put the couple -r h, h = tau - T, on the section of the inner ring (of friction
-r k_t u, which belongs to the stored energy).  Gyroscopic moments and sliding have no potential: tangents are not symmetric.
"""

from typing import NamedTuple

import numpy as np
from numba import boolean, float64, int64, types, void

from raceway.core.jit import jit
from raceway.core.ring import kernels as rows
from raceway.core.ring.kernels import layout as ring
from raceway.core.ring.kernels.layout import (
    NOTHING,
    PAIR,
    SEAT,
    TENSOR,
    Pair,
    Seat,
    Tensor,
    add_ball,
    add_couple,
    less,
    less_column,
    less_row,
    move_centres,
    normal_forces,
    offsets_of,
    place,
    put_tensor,
    row_times_adjugate,
    times_adjugate,
)
from raceway.core.signatures import MATRIX, SYSTEM, VECTOR

#: Rows of ``work`` beyond the law's, 2 Z long: index k is a ball's inner contact or axial component, Z + k its outer contact or
#: radial component.  Where a row holds two quantities of a ball, the second one begins at Z + k.
#: Vectors (axial, radial): groove centre e [m] and its velocity [m/s], last step of the ball [m], directions of its contacts.
CENTRE, VELOCITY, STEP = 5, 6, 7
INNER, OUTER = 9, 10
#: Imbalance along the last step [N m], then what a ball is doing.
SLOPE, STATE = 8, 8
#: Values of STATE: it moves, it has settled, it lies between the races without forces.
MOVES, SETTLED, LOOSE = 0.0, 1.0, 2.0
#: Distance of the ball from the groove's centre [m].
LENGTH = 11
#: Of settled balls, since the law is called again for others: normal force [N], its derivatives by gap and gap rate.
KEPT_FORCE, KEPT_BY_GAP, KEPT_BY_RATE = 12, 13, 14
#: cos and sin of the azimuth.
DIRECTION = 16
#: Tangential force h of a contact [N] with its derivatives by the contact's length [N/m], its angle [N] and its shift [N/m].
TANGENTIAL, BY_LENGTH, BY_ANGLE, BY_SHIFT = 15, 17, 18, 24
#: Derivative of the inner h by the outer angle [N], then of the outer h by the inner angle [N].
BY_OTHER_ANGLE = 19
#: Couple on the ring's section [N m], then its derivative by the inner length [N].
COUPLE, COUPLE_BY_LENGTH = 20, 20
#: Its derivatives by the inner angle, then by the outer angle [N m].
COUPLE_BY_ANGLE = 21
#: Its derivative by the section's turn [N m], then that of the inner h [N].
COUPLE_BY_TURN, BY_TURN = 22, 22
#: Derivative of the outer h by the inner length [N/m], then the size of the imbalance at the last step [N].
OUTER_BY_INNER_LENGTH, MERIT = 23, 23
#: Derivative of the couple by the inner shift [N], then how far the section's turn moves the inner groove [m].
COUPLE_BY_SHIFT, TURNED = 25, 25


class _Contact(NamedTuple):
    """Direction n of a contact, distance of ball and groove centre [m], normal force [N] and its derivative by that [N/m]."""

    axial: float
    radial: float
    length: float
    force: float
    stiffness: float


CONTACT = types.NamedUniTuple(float64, 5, _Contact)
#: Inner and outer contact of a ball.
CONTACTS = types.UniTuple(CONTACT, 2)


@jit(CONTACTS(int64, float64, MATRIX), inline=True)
def _contacts_of(k, ball_gain, work):
    """Both contacts of ball k as the law has left them."""
    z = work.shape[1] // 2
    inner = -work[rows.FORCE_BY_GAP, k] - ball_gain * work[rows.FORCE_BY_RATE, k]
    outer = -work[rows.FORCE_BY_GAP, z + k] - ball_gain * work[rows.FORCE_BY_RATE, z + k]
    return (
        _Contact(work[INNER, k], work[INNER, z + k], work[LENGTH, k], work[rows.CONTACT_FORCE, k], inner),
        _Contact(work[OUTER, k], work[OUTER, z + k], work[LENGTH, z + k], work[rows.CONTACT_FORCE, z + k], outer),
    )


#: Steps after which a ball begins anew; after twice as many its imbalance has to shrink at every step.
PATIENCE = 60


@jit(boolean(int64, VECTOR, VECTOR, MATRIX, MATRIX, MATRIX), inline=True)
def _first_guess(k, q, scalars, table, ball, work):
    """Begin with ball k; False where nothing presses it on either race: it then lies midway, without forces."""
    z = table.shape[0]
    li, lo = offsets_of(k, scalars, table)
    ea, er, shift = work[CENTRE, k], work[CENTRE, z + k], work[rows.SHIFT, z + k]
    turn = q[3] * work[DIRECTION, z + k] - q[4] * work[DIRECTION, k]
    turn_arc = (scalars[ring.OFFSET_INNER] + 0.5 * scalars[ring.DIAMETER]) * table[k, ring.SIDE] * turn
    length = np.sqrt(ea * ea + er * er)
    room = li + lo + work[rows.SHIFT, k] + shift
    work[TURNED, z + k] = turn_arc
    work[SLOPE, k], work[STATE, z + k], work[MERIT, z + k] = 0.0, MOVES, np.inf
    work[STEP, k], work[STEP, z + k] = 0.0, 0.0
    # Of gyroscopic moments alone.
    work[BY_OTHER_ANGLE, k], work[BY_OTHER_ANGLE, z + k] = 0.0, 0.0
    work[COUPLE_BY_ANGLE, z + k], work[OUTER_BY_INNER_LENGTH, k] = 0.0, 0.0
    if table[k, ring.CENTRIFUGAL] == 0.0 and length <= room:
        scale, angle = (lo + shift + 0.5 * (length - room)) / length, np.arctan2(ea, er)
        ball[k, 0], ball[k, 1] = scale * ea, scale * er
        at_i, at_o = scalars[ring.OFFSET_INNER] * angle, scalars[ring.OFFSET_OUTER] * angle
        ball[k, ring.SLIPS], ball[k, ring.SLIPS + 1] = at_i - turn_arc, at_o
        work[STATE, z + k] = LOOSE
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
    work[SLOPE, k], work[MERIT, z + k] = 0.0, np.inf
    work[STEP, k], work[STEP, z + k] = 0.0, 0.0


@jit(void(int64, VECTOR, MATRIX, MATRIX, float64, MATRIX, MATRIX), inline=True)
def _approach(k, scalars, table, ball, ball_gain, ball_history, work):
    """Directions, lengths, gaps and gap rates of both contacts of ball k."""
    z = ball.shape[0]
    pa, pr = ball[k, 0], ball[k, 1]
    xa, xr = work[CENTRE, k] - pa, work[CENTRE, z + k] - pr
    so, si = np.sqrt(pa * pa + pr * pr), np.sqrt(xa * xa + xr * xr)
    no_a, no_r = pa / so, pr / so
    ni_a, ni_r = (xa / si, xr / si) if si > 0.0 else (no_a, no_r)
    own_a, own_r = ball_gain * pa + ball_history[k, 0], ball_gain * pr + ball_history[k, 1]
    rate_i = -(ni_a * (work[VELOCITY, k] - own_a) + ni_r * (work[VELOCITY, z + k] - own_r))
    rate_o = -(no_a * own_a + no_r * own_r)
    li, lo = offsets_of(k, scalars, table)
    gap_i, gap_o = li - si + work[rows.SHIFT, k], lo - so + work[rows.SHIFT, z + k]
    rate_i, rate_o = rate_i + work[rows.SHIFT_RATE, k], rate_o + work[rows.SHIFT_RATE, z + k]
    work[LENGTH, k], work[LENGTH, z + k] = si, so
    work[INNER, k], work[INNER, z + k] = ni_a, ni_r
    work[OUTER, k], work[OUTER, z + k] = no_a, no_r
    work[rows.GAP, k], work[rows.GAP, z + k] = gap_i, gap_o
    work[rows.GAP_RATE, k], work[rows.GAP_RATE, z + k] = rate_i, rate_o


@jit(TENSOR(CONTACT, int64, MATRIX), inline=True)
def _contact_matrix(contact, c, work):
    """d(f n + h t)/dx of contact c for x = s n."""
    k, f = contact.stiffness, contact.force
    h, h_s, h_a = work[TANGENTIAL, c], work[BY_LENGTH, c], work[BY_ANGLE, c]
    w = 1.0 / contact.length if contact.length > 0.0 else 0.0
    na, nr = contact.axial, contact.radial
    ta, tr = nr, -na
    tt, nt = (f + h_a) * w, -h * w
    return Tensor(
        k * na * na + nt * na * ta + h_s * ta * na + tt * ta * ta,
        k * na * nr + nt * na * tr + h_s * ta * nr + tt * ta * tr,
        k * nr * na + nt * nr * ta + h_s * tr * na + tt * tr * ta,
        k * nr * nr + nt * nr * tr + h_s * tr * nr + tt * tr * tr,
    )


@jit(PAIR(int64, CONTACTS, float64, float64, float64, MATRIX), inline=True)
def _ball_step(k, contacts, ra, rr, longest, work):
    """-J^-1 R [m], regular where J is not, and no longer than ``longest``.

    J = dR/dp = -G_i - G_o + cross terms through the moment's dependence on both angles.
    """
    z = work.shape[1] // 2
    inner, outer = contacts
    ti_a, ti_r, to_a, to_r = inner.radial, -inner.axial, outer.radial, -outer.axial
    wi, wo = (1.0 / inner.length if inner.length > 0.0 else 0.0), 1.0 / outer.length
    cross_i, cross_o = work[BY_OTHER_ANGLE, k], work[BY_OTHER_ANGLE, z + k]
    grows = work[OUTER_BY_INNER_LENGTH, k]
    oi_a, oi_r = cross_o * ti_a * wi + grows * inner.axial, cross_o * ti_r * wi + grows * inner.radial
    gi, go = _contact_matrix(inner, k, work), _contact_matrix(outer, z + k, work)
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
    return Pair(axial * scale, radial * scale)


@jit(boolean(int64, int64, CONTACTS, float64, MATRIX, MATRIX, MATRIX), inline=True)
def _settles(k, attempt, contacts, lo, table, ball, work):
    """Move ball k by one step; whether that was the last one, small enough to leave nothing but second order.

    With n = (sin a, cos a) the direction of a contact at its angle a and t = (cos a, -sin a), the imbalance of a ball at p
    is R = f_i n_i + h_i t_i - f_o n_o - h_o t_o + F_c. It has no potential: a step that goes beyond the balance is halved,
    balls that run in circles begin anew, and those that fail again have to come closer at every step.
    """
    z = table.shape[0]
    inner, outer = contacts
    hi, ho = work[TANGENTIAL, k], work[TANGENTIAL, z + k]
    ra = inner.force * inner.axial + hi * inner.radial - outer.force * outer.axial - ho * outer.radial
    rr = inner.force * inner.radial - hi * inner.axial - outer.force * outer.radial + ho * outer.axial
    rr += table[k, ring.CENTRIFUGAL]
    size = np.sqrt(ra * ra + rr * rr)
    da, dr, slope = work[STEP, k], work[STEP, z + k], work[SLOPE, k]
    too_far = slope > 0.0 and -(ra * da + rr * dr) > 0.9 * slope
    if attempt > 2 * PATIENCE and np.sqrt(da * da + dr * dr) > 1e-13:
        # Twice in circles: descend at every step instead.
        too_far = size > 0.9999 * work[MERIT, z + k]
    if too_far:
        # Beyond the balance along the last step by more than it began with: go half-way back.
        da, dr = 0.5 * da, 0.5 * dr
        work[STEP, k], work[STEP, z + k], work[SLOPE, k] = da, dr, 0.5 * slope
        ball[k, 0] -= da
        ball[k, 1] -= dr
        return False
    da, dr = _ball_step(k, contacts, ra, rr, 0.2 * lo, work)
    ball[k, 0] += da
    ball[k, 1] += dr
    work[STEP, k], work[STEP, z + k], work[SLOPE, k] = da, dr, ra * da + rr * dr
    work[MERIT, z + k] = size
    if not np.sqrt(da * da + dr * dr) <= 1e-10 * max(-work[rows.GAP, k], -work[rows.GAP, z + k], 1e-12):
        return False
    # Forces and tangents are kept from before this step, which ``_add_settled`` adds to the forces.
    work[KEPT_FORCE, k], work[KEPT_FORCE, z + k] = inner.force, outer.force
    work[KEPT_BY_GAP, k], work[KEPT_BY_GAP, z + k] = work[rows.FORCE_BY_GAP, k], work[rows.FORCE_BY_GAP, z + k]
    work[KEPT_BY_RATE, k], work[KEPT_BY_RATE, z + k] = work[rows.FORCE_BY_RATE, k], work[rows.FORCE_BY_RATE, z + k]
    work[STATE, z + k] = SETTLED
    return True


#: Step of the difference quotients of the moment [rad]: their error is of the order 1e-10.
_ANGLE_STEP = 1e-5


class _Rolling(NamedTuple):
    """A ball that rolls without spin on the outer race: its axis beta, and that race's part of the speeds' ratio."""

    tangent: float
    sine: float
    cosine: float
    outer: float


_ROLLING = types.NamedUniTuple(float64, 4, _Rolling)


@jit(_ROLLING(float64, float64), inline=True)
def _rolling(outer, ratio):
    """At the outer contact angle."""
    sine, cosine = np.sin(outer), np.cos(outer)
    beta = np.arctan2(sine, cosine + ratio)
    tangent = np.tan(beta)
    return _Rolling(tangent, np.sin(beta), np.cos(beta), (cosine + tangent * sine) / (1.0 + ratio * cosine))


@jit(float64(float64, _ROLLING, float64, float64), inline=True)
def _moment(inner, ball, ratio, scale):
    """M [N m] at the inner contact angle."""
    cosine = np.cos(inner)
    rolling = ball.outer + (cosine + ball.tangent * np.sin(inner)) / (1.0 - ratio * cosine)
    return scale * ball.sine / (rolling * ratio * ball.cosine)


@jit(float64(float64, float64, float64, float64))
def gyroscopic_moment(inner, outer, ratio, scale):
    """M [N m] at the contact angles; ratio = D / d_m, scale = J * (inner ring's speed) * w_c."""
    return _moment(inner, _rolling(outer, ratio), ratio, scale)


class _Traction(NamedTuple):
    """Traction of a contact [N], its derivatives by what is asked of it and by the contact's normal force."""

    force: float
    by_asked: float
    by_normal: float


@jit(types.NamedUniTuple(float64, 3, _Traction)(float64, float64, float64))
def traction_within(demand, normal, limit):
    """demand / sqrt(1 + (demand / (limit normal))^2): all of a small part, never more than ``limit`` times the normal force."""
    most = limit * normal
    size = np.sqrt(demand * demand + most * most)
    if not size > 0.0:
        return _Traction(0.0, 0.0, 0.0)
    a, m = demand / size, most / size
    return _Traction(most * a, m**3, limit * a**3)


@jit(void(int64, CONTACTS, VECTOR, MATRIX), inline=True)
def _add_gyroscopic(k, contacts, scalars, work):
    """Add what ball k's moment does to its tangential forces and to the couple on the ring's section.

    T = share * M / D with M = J w_R w_c sin(beta), tan(beta) = sin(a_o) / (cos(a_o) + D/d_m); the ball's spin w_R follows
    from rolling on both races. M follows the contact angles a, with derivatives. The inner race carries no more than its
    normal force, the outer one the rest: so it fades continuously where the inner contact opens.  With TRACTION both carry
    what ``traction_within`` leaves: the inner race of its share, the outer one of the rest.

    Harris & Kotzalas, Advanced Concepts of Bearing Technology, 5th ed., chapters 2 and 3 (control of the outer race).
    """
    z = work.shape[1] // 2
    diameter, ratio, scale = scalars[ring.DIAMETER], scalars[ring.BALL_OVER_PITCH], scalars[ring.GYROSCOPIC]
    groove, limit = scalars[ring.OFFSET_INNER] + 0.5 * diameter, scalars[ring.TRACTION]
    force, stiffness = contacts[0].force, contacts[0].stiffness
    inner, outer = np.arctan2(contacts[0].axial, contacts[0].radial), np.arctan2(contacts[1].axial, contacts[1].radial)
    share_i, share_o = scalars[ring.SHARE_INNER] / diameter, scalars[ring.SHARE_OUTER] / diameter
    here, step = _rolling(outer, ratio), _ANGLE_STEP
    moment = _moment(inner, here, ratio, scale)
    by_i = (_moment(inner + step, here, ratio, scale) - _moment(inner - step, here, ratio, scale)) / (2.0 * step)
    by_o = _moment(inner, _rolling(outer + step, ratio), ratio, scale)
    by_o = (by_o - _moment(inner, _rolling(outer - step, ratio), ratio, scale)) / (2.0 * step)
    traction, rest, grows, coupling = share_i * moment, share_o * moment, 0.0, 0.0
    if limit > 0.0:
        # Dashpots carry no traction: it is limited by the elastic forces, and rates of gaps leave it alone.
        force -= work[rows.FORCE_BY_RATE, k] * work[rows.GAP_RATE, k]
        outer_force = contacts[1].force - work[rows.FORCE_BY_RATE, z + k] * work[rows.GAP_RATE, z + k]
        at_i = traction_within(traction, max(force, 0.0), limit)
        at_o = traction_within(2.0 / diameter * moment - at_i.force, max(outer_force, 0.0), limit)
        traction, rest, share_i = at_i.force, at_o.force, share_i * at_i.by_asked
        share_o = at_o.by_asked * (2.0 / diameter - share_i)
        grows = at_i.by_normal * -work[rows.FORCE_BY_GAP, k]
        coupling, own = at_o.by_asked * grows, at_o.by_normal * -work[rows.FORCE_BY_GAP, z + k]
        work[BY_LENGTH, z + k] -= own
        work[BY_SHIFT, z + k] += own
    elif abs(traction) > force:
        # No more than the normal force; the outer race takes the rest.
        sign = 1.0 if moment > 0.0 else -1.0
        traction, grows, coupling = sign * force, sign * stiffness, sign * stiffness
        share_i, share_o = 0.0, 2.0 / diameter
        rest = share_o * moment - traction
    work[TANGENTIAL, k] -= traction
    work[BY_LENGTH, k] -= grows
    work[BY_SHIFT, k] += grows
    work[COUPLE_BY_SHIFT, k] -= groove * grows
    work[BY_ANGLE, k] -= share_i * by_i
    work[TANGENTIAL, z + k] -= rest
    work[BY_ANGLE, z + k] -= share_o * by_o
    work[BY_OTHER_ANGLE, k], work[BY_OTHER_ANGLE, z + k] = -share_i * by_o, -share_o * by_i
    work[OUTER_BY_INNER_LENGTH, k] = coupling
    work[COUPLE, k] += groove * traction
    work[COUPLE_BY_LENGTH, z + k] += groove * grows
    work[COUPLE_BY_ANGLE, k] += groove * share_i * by_i
    work[COUPLE_BY_ANGLE, z + k] = groove * share_i * by_o


class _Grip(NamedTuple):
    """Tangential force of a contact [N], its derivatives by angle (zero where it slides), length and shift, and u [m]."""

    force: float
    by_angle: float
    by_length: float
    by_shift: float
    stretch: float


_GRIP = types.NamedUniTuple(float64, 5, _Grip)


@jit(_GRIP(CONTACT, float64, float64, float64, float64), inline=True)
def _grip(contact, reach, stretch, mu, stick):
    """The return map: what sticks at the elastic displacement ``stretch``, or slides; reach = L."""
    lever = reach / contact.length if contact.length > 0.0 else 1.0
    tau, limit = stick * stretch * lever, mu * contact.force
    if abs(tau) <= limit:
        return _Grip(tau, stick * reach * lever, -tau * lever / reach, 0.0, stretch)
    sign = 1.0 if tau > 0.0 else -1.0
    by_shift = -sign * mu * contact.stiffness
    return _Grip(sign * limit, 0.0, -by_shift, by_shift, sign * limit / (stick * lever))


@jit(void(int64, MATRIX), inline=True)
def _roll(k, work):
    """No tangential forces of ball k and no couple."""
    z = work.shape[1] // 2
    work[TANGENTIAL, k], work[BY_ANGLE, k], work[BY_LENGTH, k], work[BY_SHIFT, k] = 0.0, 0.0, 0.0, 0.0
    o = z + k
    work[TANGENTIAL, o], work[BY_ANGLE, o], work[BY_LENGTH, o], work[BY_SHIFT, o] = 0.0, 0.0, 0.0, 0.0
    work[COUPLE, k], work[COUPLE_BY_ANGLE, k], work[COUPLE_BY_TURN, k] = 0.0, 0.0, 0.0
    work[BY_TURN, o], work[COUPLE_BY_LENGTH, o], work[COUPLE_BY_SHIFT, k] = 0.0, 0.0, 0.0


@jit(void(int64, CONTACTS, VECTOR, MATRIX, MATRIX, MATRIX), inline=True)
def _rub(k, contacts, scalars, ball, ball_history, work):
    """Tangential forces of ball k by friction, its couple on the ring's section, and its slips in ``ball``.

    A contact that sticks stores k_t u^2 / 2 with u = L a - slip outside, L a - r turn - slip inside: L is the distance of
    ball and groove centre at the first touch, a the contact's angle, r the groove's radius, turn that of the ring's section
    by its tilts, the slip is memory. So tau = k_t u L / s, at most mu f (return mapping), and work is stored or lost, never
    gained. A ball does not roll in this plane, so sticking contacts add a tangential stiffness that rolling balls do not
    have. The couple on the section is -r k_t u.
    """
    z, mu, stick = work.shape[1] // 2, scalars[ring.FRICTION], scalars[ring.STICK]
    li, lo = scalars[ring.OFFSET_INNER], scalars[ring.OFFSET_OUTER]
    inner, outer = contacts
    at_i = li * np.arctan2(inner.axial, inner.radial) - work[TURNED, z + k]
    at_o = lo * np.arctan2(outer.axial, outer.radial)
    gi = _grip(inner, li, at_i - ball_history[k, ring.SLIPS], mu, stick)
    go = _grip(outer, lo, at_o - ball_history[k, ring.SLIPS + 1], mu, stick)
    ball[k, ring.SLIPS], ball[k, ring.SLIPS + 1] = at_i - gi.stretch, at_o - go.stretch
    work[TANGENTIAL, k], work[TANGENTIAL, z + k] = gi.force, go.force
    work[BY_ANGLE, k], work[BY_ANGLE, z + k] = gi.by_angle, go.by_angle
    work[BY_LENGTH, k], work[BY_LENGTH, z + k] = gi.by_length, go.by_length
    work[BY_SHIFT, k], work[BY_SHIFT, z + k] = gi.by_shift, go.by_shift
    z, stick, reach = work.shape[1] // 2, scalars[ring.STICK], scalars[ring.OFFSET_INNER]
    groove = reach + 0.5 * scalars[ring.DIAMETER]
    lever = reach / inner.length if inner.length > 0.0 else 1.0
    work[COUPLE, k] = -groove * stick * gi.stretch
    if gi.by_angle != 0.0:
        work[COUPLE_BY_ANGLE, k], work[COUPLE_BY_TURN, k] = -groove * stick * reach, groove * groove * stick
        work[BY_TURN, z + k], work[COUPLE_BY_LENGTH, z + k] = -stick * groove * lever, 0.0
        work[COUPLE_BY_SHIFT, k] = 0.0
    else:
        work[COUPLE_BY_ANGLE, k], work[COUPLE_BY_TURN, k], work[BY_TURN, z + k] = 0.0, 0.0, 0.0
        work[COUPLE_BY_LENGTH, z + k] = -groove * (gi.by_length / lever + gi.force / reach)
        work[COUPLE_BY_SHIFT, k] = -groove * gi.by_shift / lever


class _Balance(NamedTuple):
    """A settled ball, linearised: E, P, X and J, M the damping by the velocity of e.

    by_turn : derivative of the ball's force by the turn of its section [N]

    At the balance R(p; e, w, turn) = 0 of ball place p, groove centre e, shifts w and turn of the section, dp = -J^-1 dR
    with J = dR/dp. With P the derivative of the ring's force by p, that force follows e by E - T X, T = P J^-1, X = dR/de.
    """

    e: Tensor
    p: Tensor
    x: Tensor
    j: Tensor
    m: Tensor
    by_turn: Pair


BALANCE = types.NamedTuple((*(TENSOR,) * 5, PAIR), _Balance)


@jit(BALANCE(int64, CONTACTS, MATRIX), inline=True)
def _linear_balance(k, contacts, work):
    """Ball k at its balance."""
    z = work.shape[1] // 2
    inner, outer = contacts
    elastic, viscous = -work[rows.FORCE_BY_GAP, k], -work[rows.FORCE_BY_RATE, k]
    na, nr, to_a, to_r = inner.axial, inner.radial, outer.radial, -outer.axial
    wi, wo = 1.0 / inner.length, 1.0 / outer.length
    # Inner and outer tangential force by the angle, the outer one also by the length, of the other contact.
    cross_o, grows = work[BY_OTHER_ANGLE, z + k], work[OUTER_BY_INNER_LENGTH, k]
    ii_a, ii_r = work[BY_OTHER_ANGLE, k] * nr, work[BY_OTHER_ANGLE, k] * -na
    oi_a, oi_r = cross_o * nr * wi + grows * na, cross_o * -na * wi + grows * nr
    e = _contact_matrix(_Contact(na, nr, inner.length, inner.force, elastic), k, work)
    g, o = _contact_matrix(inner, k, work), _contact_matrix(outer, z + k, work)
    p = Tensor(-g.aa + ii_a * to_a * wo, -g.ar + ii_a * to_r * wo, -g.ra + ii_r * to_a * wo, -g.rr + ii_r * to_r * wo)
    j = Tensor(p.aa - o.aa + to_a * oi_a, p.ar - o.ar + to_a * oi_r, p.ra - o.ra + to_r * oi_a, p.rr - o.rr + to_r * oi_r)
    x = Tensor(e.aa - to_a * oi_a, e.ar - to_a * oi_r, e.ra - to_r * oi_a, e.rr - to_r * oi_r)
    m = Tensor(viscous * na**2, viscous * na * nr, viscous * na * nr, viscous * nr**2)
    turn = work[BY_TURN, z + k]
    return _Balance(e, p, x, j, m, Pair(turn * nr, turn * -na))


@jit(boolean(int64, float64, SEAT, MATRIX, VECTOR, MATRIX, MATRIX), inline=True)
def _add_settled(k, ball_gain, seat, work, f, K, C):
    """Add ball k to f (5,), K and C (5, 5), and keep for elastic bodies what they ask for; False where J has no inverse."""
    z = work.shape[1] // 2
    contacts = _contacts_of(k, ball_gain, work)
    inner, outer = contacts
    # Forces are those before the ball's last step: with what that changes they are off by its square.
    b, h, da, dr = _linear_balance(k, contacts, work), work[TANGENTIAL, k], work[STEP, k], work[STEP, z + k]
    force = Pair(
        inner.force * inner.axial + h * inner.radial + b.p.aa * da + b.p.ar * dr,
        inner.force * inner.radial + h * -inner.axial + b.p.ra * da + b.p.rr * dr,
    )
    inner_closing, outer_closing = inner.axial * da + inner.radial * dr, outer.axial * da + outer.radial * dr
    work[rows.CONTACT_FORCE, k] = max(inner.force - inner.stiffness * inner_closing, 0.0)
    work[rows.CONTACT_FORCE, z + k] = max(outer.force + outer.stiffness * outer_closing, 0.0)
    det = b.j.aa * b.j.rr - b.j.ar * b.j.ra
    if det == 0.0:
        return False
    t = times_adjugate(b.p, b.j)
    t = Tensor(t.aa / det, t.ar / det, t.ra / det, t.rr / det)
    # The couple by e, and by the ball's place; turning the section moves both forces alike.
    stretch, angle = work[COUPLE_BY_LENGTH, z + k], work[COUPLE_BY_ANGLE, k] * (1.0 / inner.length)
    by_e = Pair(stretch * inner.axial + angle * inner.radial, stretch * inner.radial + angle * -inner.axial)
    angle = work[COUPLE_BY_ANGLE, z + k] * (1.0 / outer.length)
    by_place = Pair(angle * outer.radial - by_e.axial, angle * -outer.axial - by_e.radial)
    u, couple = row_times_adjugate(by_place, b.j), work[COUPLE, k] + by_place.axial * da + by_place.radial * dr
    u = Pair(u.axial / det, u.radial / det)
    force_by_turn, couple_by_centre = less_column(b.by_turn, t, b.by_turn), less_row(by_e, u, b.x)
    couple_by_turn = work[COUPLE_BY_TURN, k] - u.axial * b.by_turn.axial - u.radial * b.by_turn.radial
    add_couple(seat, couple, force_by_turn, couple_by_centre, couple_by_turn, f, K)
    add_couple(seat, 0.0, NOTHING, less_row(NOTHING, u, b.m), 0.0, f, C)
    by_centre, by_speed = less(b.e, t, b.x), less(b.m, t, b.m)
    if work.shape[0] > rows.WORK_ROWS:
        work[rows.FORCE, k], work[rows.FORCE, z + k] = force
        put_tensor(by_centre, work, rows.FORCE_BY_CENTRE, k)
        put_tensor(by_speed, work, rows.FORCE_BY_SPEED, k)
        work[rows.FORCE_BY_TURN, k], work[rows.FORCE_BY_TURN, z + k] = force_by_turn
        work[rows.COUPLE_BY_CENTRE, k], work[rows.COUPLE_BY_CENTRE, z + k] = couple_by_centre
        _keep_for_bodies(k, contacts, b, t, u, work)
    add_ball(seat, force, by_centre, by_speed, f, K, C)
    return True


@jit(void(int64, CONTACTS, BALANCE, TENSOR, PAIR, MATRIX))
def _keep_for_bodies(k, contacts, b, t, u, work):
    """Contact forces by e, its velocity, shifts and turn; the ball's force on the ring and its couple by shifts.

    Both contacts have dQ = g (dR), g = dQ/dp J^-1, on top of what they feel at a ball that stays where it is.
    """
    z = work.shape[1] // 2
    det = b.j.aa * b.j.rr - b.j.ar * b.j.ra
    (na, nr, _, _, ki), (oa, orr, _, _, ko) = contacts
    gi, go = row_times_adjugate(Pair(na, nr), b.j), row_times_adjugate(Pair(oa, orr), b.j)
    gi, go = Pair(-ki * gi.axial / det, -ki * gi.radial / det), Pair(ko * go.axial / det, ko * go.radial / det)
    elastic, viscous = -work[rows.FORCE_BY_GAP, k], -work[rows.FORCE_BY_RATE, k]
    work[rows.BY_AXIAL, k], work[rows.BY_RADIAL, k] = less_row(Pair(elastic * na, elastic * nr), gi, b.x)
    work[rows.BY_AXIAL, z + k], work[rows.BY_RADIAL, z + k] = less_row(NOTHING, go, b.x)
    work[rows.BY_AXIAL_SPEED, k], work[rows.BY_RADIAL_SPEED, k] = less_row(Pair(viscous * na, viscous * nr), gi, b.m)
    work[rows.BY_AXIAL_SPEED, z + k], work[rows.BY_RADIAL_SPEED, z + k] = less_row(NOTHING, go, b.m)
    # The ring's force and R by the inner shift, R by the outer one.
    hi, ho, grows = work[BY_SHIFT, k], work[BY_SHIFT, z + k], work[OUTER_BY_INNER_LENGTH, k]
    by_shift = Pair(-ki * na + hi * nr, -ki * nr + hi * -na)
    ri = Pair(by_shift.axial + grows * orr, by_shift.radial + grows * -oa)
    ro = Pair(ko * oa - ho * orr, ko * orr - ho * -oa)
    work[rows.BY_OWN, k] = -ki - gi.axial * ri.axial - gi.radial * ri.radial
    work[rows.BY_OTHER, k] = -gi.axial * ro.axial - gi.radial * ro.radial
    work[rows.BY_OTHER, z + k] = -go.axial * ri.axial - go.radial * ri.radial
    work[rows.BY_OWN, z + k] = -ko - go.axial * ro.axial - go.radial * ro.radial
    work[rows.BY_TURN, k] = -gi.axial * b.by_turn.axial - gi.radial * b.by_turn.radial
    work[rows.BY_TURN, z + k] = -go.axial * b.by_turn.axial - go.radial * b.by_turn.radial
    work[rows.AXIAL_BY_SHIFT, k], work[rows.RADIAL_BY_SHIFT, k] = less_column(by_shift, t, ri)
    work[rows.AXIAL_BY_SHIFT, z + k], work[rows.RADIAL_BY_SHIFT, z + k] = less_column(NOTHING, t, ro)
    work[rows.COUPLE_BY_SHIFT, k] = work[COUPLE_BY_SHIFT, k] - u.axial * ri.axial - u.radial * ri.radial
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
    place(t, q, v, constants, work, (DIRECTION, CENTRE, VELOCITY))
    if elastic_bodies:
        move_centres(work, CENTRE, VELOCITY)
    moving = 0
    for k in range(z):
        moving += _first_guess(k, q, scalars, table, ball, work)
    for attempt in range(_ITERATIONS):
        for k in range(z):
            if attempt == PATIENCE and work[STATE, z + k] == MOVES:
                # Forces without a potential can lead in circles: once more from the seat on the outer race.
                _seat_outside(k, scalars, table, ball, work)
            # Directions of balls that have settled are those before their last step, as their forces are.
            if work[STATE, z + k] != SETTLED:
                _approach(k, scalars, table, ball, ball_gain, ball_history, work)
        normal_forces(contacts, scalars, work)
        for k in range(z):
            if work[STATE, z + k] == MOVES:
                sides = _contacts_of(k, ball_gain, work)
                if scalars[ring.FRICTION] != 0.0:
                    _rub(k, sides, scalars, ball, ball_history, work)
                else:
                    _roll(k, work)
                if scalars[ring.GYROSCOPIC] != 0.0:
                    _add_gyroscopic(k, sides, scalars, work)
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
        if work[STATE, z + k] == LOOSE:
            force[k], force[z + k] = 0.0, 0.0
            continue
        for c in (k, z + k):
            force[c], by_gap[c], by_rate[c] = work[KEPT_FORCE, c], work[KEPT_BY_GAP, c], work[KEPT_BY_RATE, c]
        if force[k] == 0.0 and by_gap[k] == 0.0:
            continue
        seat = Seat(
            work[DIRECTION, k], work[DIRECTION, z + k], scalars[ring.TILT_ARM], table[k, ring.SIDE], table[k, ring.LEVER]
        )
        if not _add_settled(k, ball_gain, seat, work, f, K, C):
            return 1
    return 0
