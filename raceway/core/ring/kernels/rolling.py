"""Balls that roll: gyroscopic moments, traction at the contacts, and the linear balance of a ball with its contacts."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import float64, int64, types, void

from raceway.core.jit import jit
from raceway.core.ring import kernels as rows
from raceway.core.ring.kernels import layout as ring
from raceway.core.ring.kernels.tensors import PAIR, TENSOR, Pair, Tensor
from raceway.core.signatures import MATRIX, VECTOR

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


class BallContact(NamedTuple):
    """Direction n of a contact, distance of ball and groove centre [m], normal force [N] and its derivative by that [N/m]."""

    axial: float
    radial: float
    length: float
    force: float
    stiffness: float


CONTACT = types.NamedUniTuple(float64, 5, BallContact)
#: Inner and outer contact of a ball.
CONTACTS = types.UniTuple(CONTACT, 2)


class Moment(NamedTuple):
    """A ball's gyroscopic moment [N m], and its derivatives by the inner and the outer contact angle."""

    size: float
    by_inner: float
    by_outer: float


@jit(types.NamedUniTuple(float64, 3, Moment)(PAIR, PAIR, float64, float64), inline=True)
def gyroscopic_moment(inner, outer, ratio, scale):
    """M at the directions n = (sin a, cos a) of the contacts; ratio r = D / d_m, scale = J * (inner ring's speed) * w_c.

    Notes
    -----
    With tan(beta) = sin(a_o) / (cos(a_o) + r), the ball's axis under control of the outer race, its speed is the ring's over
    r cos(beta) [(cos a_o + tan(beta) sin a_o) / (1 + r cos a_o) + (cos a_i + tan(beta) sin a_i) / (1 - r cos a_i)].  The
    first fraction is 1 / (cos a_o + r), so that M = scale sin(a_o) (1 - r cos a_i) / [r (1 + cos(a_i - a_o))]: no function
    of an angle is left.
    """
    si, ci, so, co = inner.axial, inner.radial, outer.axial, outer.radial
    inverse = 1.0 / (1.0 + ci * co + si * so)
    part, rest, sine = scale * inverse / ratio, 1.0 - ratio * ci, (si * co - ci * so) * inverse
    return Moment(part * so * rest, part * so * (ratio * si + rest * sine), part * rest * (co - so * sine))


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
def add_gyroscopic(k, contacts, scalars, work):
    """Add what ball k's moment does to its tangential forces and to the couple on the ring's section.

    T = share * M / D with M = J w_R w_c sin(beta): ``gyroscopic_moment``. The inner race carries no more than its
    normal force, the outer one the rest: so it fades continuously where the inner contact opens.  With TRACTION both carry
    what ``traction_within`` leaves: the inner race of its share, the outer one of the rest.

    Harris & Kotzalas, Advanced Concepts of Bearing Technology, 5th ed., chapters 2 and 3 (control of the outer race).
    """
    z = work.shape[1] // 2
    diameter, ratio, scale = scalars[ring.DIAMETER], scalars[ring.BALL_OVER_PITCH], scalars[ring.GYROSCOPIC]
    groove, limit = scalars[ring.OFFSET_INNER] + 0.5 * diameter, scalars[ring.TRACTION]
    force, stiffness = contacts[0].force, contacts[0].stiffness
    inner, outer = Pair(contacts[0].axial, contacts[0].radial), Pair(contacts[1].axial, contacts[1].radial)
    share_i, share_o = scalars[ring.SHARE_INNER] / diameter, scalars[ring.SHARE_OUTER] / diameter
    moment, by_i, by_o = gyroscopic_moment(inner, outer, ratio, scale)
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
def roll(k, work):
    """No tangential forces of ball k and no couple."""
    z = work.shape[1] // 2
    work[TANGENTIAL, k], work[BY_ANGLE, k], work[BY_LENGTH, k], work[BY_SHIFT, k] = 0.0, 0.0, 0.0, 0.0
    o = z + k
    work[TANGENTIAL, o], work[BY_ANGLE, o], work[BY_LENGTH, o], work[BY_SHIFT, o] = 0.0, 0.0, 0.0, 0.0
    work[COUPLE, k], work[COUPLE_BY_ANGLE, k], work[COUPLE_BY_TURN, k] = 0.0, 0.0, 0.0
    work[BY_TURN, o], work[COUPLE_BY_LENGTH, o], work[COUPLE_BY_SHIFT, k] = 0.0, 0.0, 0.0


@jit(void(int64, CONTACTS, VECTOR, MATRIX, MATRIX, MATRIX), inline=True)
def rub(k, contacts, scalars, ball, ball_history, work):
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
def linear_balance(k, contacts, work):
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
    e = contact_matrix(BallContact(na, nr, inner.length, inner.force, elastic), k, work)
    g, o = contact_matrix(inner, k, work), contact_matrix(outer, z + k, work)
    p = Tensor(-g.aa + ii_a * to_a * wo, -g.ar + ii_a * to_r * wo, -g.ra + ii_r * to_a * wo, -g.rr + ii_r * to_r * wo)
    j = Tensor(p.aa - o.aa + to_a * oi_a, p.ar - o.ar + to_a * oi_r, p.ra - o.ra + to_r * oi_a, p.rr - o.rr + to_r * oi_r)
    x = Tensor(e.aa - to_a * oi_a, e.ar - to_a * oi_r, e.ra - to_r * oi_a, e.rr - to_r * oi_r)
    m = Tensor(viscous * na**2, viscous * na * nr, viscous * na * nr, viscous * nr**2)
    turn = work[BY_TURN, z + k]
    return _Balance(e, p, x, j, m, Pair(turn * nr, turn * -na))


@jit(TENSOR(CONTACT, int64, MATRIX), inline=True)
def contact_matrix(contact, c, work):
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
