"""Balls that roll: gyroscopic moments, traction at the contacts, Coulomb friction, and the linear balance of a ball with its contacts."""

from typing import NamedTuple

import numpy as np
from numba import float64, int64, types
from numba.extending import register_jitable

from raceway.core.jit import jit
from raceway.core.lanes import LANES, MASK, any_of, larger, root, smaller, spread, take, where
from raceway.core.ring import kernels as rows
from raceway.core.ring.kernels import layout as ring
from raceway.core.ring.kernels.tensors import LANES_PAIR, LANES_TENSOR, Pair, Tensor, pair_of
from raceway.core.signatures import MATRIX, VECTOR

#: Rows of ``work`` beyond the law's and those of ``layout.approach``, two quantities of a ball each: the second one begins at Z + k.
#: Last step of the ball [m]; imbalance along it [N m], then what the ball is doing.
STEP, SLOPE, STATE = 7, 8, 8
#: Values of STATE: it moves, it has settled, it lies between the races without forces.
MOVES, SETTLED, LOOSE = 0.0, 1.0, 2.0
#: Of settled balls, since the law is called again for others: normal force [N], its derivatives by gap and gap rate.
KEPT_FORCE, KEPT_BY_GAP, KEPT_BY_RATE = 12, 13, 14
#: cos and sin of the azimuth; centrifugal force [N], then how far the section's turn moves the inner groove [m]; size of the imbalance
#: at the last step [N]; slips of the inner and the outer contact, now and committed [m].
DIRECTION, CENTRIFUGAL, TURNED, MERIT, SLIP, COMMITTED = 16, 17, 17, 18, 19, 20
#: Of settled balls, what ``Tangential`` has, two each.
TANGENTIAL = 33


class BallContact(NamedTuple):
    """Direction n of a contact, 1/s of ball and groove centre, 0 for s = 0 [1/m], normal force [N] and its derivative by s [N/m]."""

    axial: float
    radial: float
    by_length: float
    force: float
    stiffness: float


#: Inner and outer contact of balls.
CONTACT = types.NamedUniTuple(LANES, 5, BallContact)
CONTACTS = types.UniTuple(CONTACT, 2)


class Tangential(NamedTuple):
    """Tangential forces h of the inner and the outer contact [N], and the couple on the ring's section [N m].

    Derivatives by_length by the contact's own length [N/m], by_angle and by_other by its own and the other contact's angle [N], by_shift by its
    shift [N/m], by_turn by the section's turn; ``grows`` of the outer h by the inner length [N/m].
    """

    inner: float
    outer: float
    inner_by_length: float
    outer_by_length: float
    inner_by_angle: float
    outer_by_angle: float
    inner_by_other: float
    outer_by_other: float
    inner_by_shift: float
    outer_by_shift: float
    couple: float
    couple_by_length: float
    couple_by_inner: float
    couple_by_outer: float
    couple_by_turn: float
    inner_by_turn: float
    grows: float
    couple_by_shift: float


TANGENTIALS = types.NamedUniTuple(LANES, 18, Tangential)


class Moment(NamedTuple):
    """A ball's gyroscopic moment [N m], and its derivatives by the inner and the outer contact angle."""

    size: float
    by_inner: float
    by_outer: float


@register_jitable
def gyroscopic_moment(inner, outer, ratio, scale):
    """M at the directions n = (sin a, cos a) of the contacts; ratio r = D / d_m, scale = J * (inner ring's speed) * w_c.

    Under control of the outer race the ball's axis lies at tan(beta) = sin(a_o) / (cos(a_o) + r); its spin is the ring's speed over
    r cos(beta) [(cos a_o + tan(beta) sin a_o) / (1 + r cos a_o) + (cos a_i + tan(beta) sin a_i) / (1 - r cos a_i)].  The
    first fraction is 1 / (cos a_o + r), so that M = scale sin(a_o) (1 - r cos a_i) / [r (1 + cos(a_i - a_o))]: no function
    of an angle is left.
    """
    si, ci, so, co = inner.axial, inner.radial, outer.axial, outer.radial
    inverse = 1.0 / (1.0 + ci * co + si * so)
    part, rest, sine = scale / ratio * inverse, 1.0 - ratio * ci, (si * co - ci * so) * inverse
    return Moment(part * so * rest, part * so * (ratio * si + rest * sine), part * rest * (co - so * sine))


@jit(TANGENTIALS(MATRIX, int64, MASK), inline=True)
def tangential_of(work, k, live):
    """The tangential forces of balls from k on that were kept."""
    at, by_length = pair_of(work, TANGENTIAL, k, live), pair_of(work, TANGENTIAL + 1, k, live)
    by_angle, by_other = pair_of(work, TANGENTIAL + 2, k, live), pair_of(work, TANGENTIAL + 3, k, live)
    by_shift, couple = pair_of(work, TANGENTIAL + 4, k, live), pair_of(work, TANGENTIAL + 5, k, live)
    by_angles, by_turn = pair_of(work, TANGENTIAL + 6, k, live), pair_of(work, TANGENTIAL + 7, k, live)
    rest = pair_of(work, TANGENTIAL + 8, k, live)
    return Tangential(
        at[0], at[1], by_length[0], by_length[1], by_angle[0], by_angle[1], by_other[0], by_other[1], by_shift[0], by_shift[1],
        couple[0], couple[1], by_angles[0], by_angles[1], by_turn[0], by_turn[1], rest[0], rest[1],
    )  # fmt: skip


class TractionForce(NamedTuple):
    """Traction of a contact [N], its derivatives by what is asked of it and by the contact's normal force."""

    force: float
    by_asked: float
    by_normal: float


@jit(types.NamedUniTuple(LANES, 3, TractionForce)(LANES, LANES, LANES), inline=True)
def traction_within(demand, normal, limit):
    """demand / sqrt(1 + (demand / (limit normal))^2): all of a small part, never more than ``limit`` times the normal force."""
    most = limit * normal
    size = root(demand * demand + most * most)
    inverse = where(size > 0.0, 1.0 / size, 0.0)
    a, m = demand * inverse, most * inverse
    return TractionForce(most * a, m * m * m, limit * (a * a * a))


class Rolling(NamedTuple):
    """What moments take of the constants, see ``layout``: D [m], D / d_m, scale [N m], radius of the inner groove [m], shares, traction."""

    diameter: float
    ratio: float
    scale: float
    groove: float
    share_inner: float
    share_outer: float
    limit: float


ROLLING = types.NamedUniTuple(LANES, 7, Rolling)
#: Where they stand.
ROLLING_SCALARS = (
    ring.DIAMETER, ring.BALL_OVER_PITCH, ring.GYROSCOPIC, ring.OFFSET_INNER, ring.SHARE_INNER, ring.SHARE_OUTER, ring.TRACTION
)  # fmt: skip


@register_jitable
def no_tangential():
    """Of contacts without tangential forces."""
    o = spread(0.0)
    return Tangential(o, o, o, o, o, o, o, o, o, o, o, o, o, o, o, o, o, o)


@jit(TANGENTIALS(int64, MASK, CONTACTS, TANGENTIALS, ROLLING, MATRIX), inline=True)
def with_gyroscopic(k, live, contacts, rub, rolling, work):
    """Add what the moments of the balls from k on do to their tangential forces and to the couples on the ring's section.

    T = share * M / D with M = J w_R w_c sin(beta): ``gyroscopic_moment``. The inner race carries no more than its
    normal force, the outer one the rest: so it fades continuously where the inner contact opens.  With TRACTION both carry
    what ``traction_within`` leaves: the inner race of its share, the outer one of the rest.

    Harris & Kotzalas, Advanced Concepts of Bearing Technology, 5th ed., chapters 2 and 3 (control of the outer race).
    """
    inner, outer = contacts
    diameter, ratio, scale, offset, share_i, share_o, limit = rolling
    groove, whole, own = offset + 0.5 * diameter, 2.0 / diameter, spread(0.0)
    share_i, share_o = share_i / diameter, share_o / diameter
    moment, by_i, by_o = gyroscopic_moment(Pair(inner.axial, inner.radial), Pair(outer.axial, outer.radial), ratio, scale)
    if any_of(limit > 0.0):
        # Dashpots carry no traction: it is limited by the elastic forces, and rates of gaps leave it alone.
        rate_i, rate_o = pair_of(work, rows.GAP_RATE, k, live)
        by_rate_i, by_rate_o = pair_of(work, rows.FORCE_BY_RATE, k, live)
        by_gap_i, by_gap_o = pair_of(work, rows.FORCE_BY_GAP, k, live)
        at_i = traction_within(share_i * moment, larger(inner.force - by_rate_i * rate_i, 0.0), limit)
        at_o = traction_within(whole * moment - at_i.force, larger(outer.force - by_rate_o * rate_o, 0.0), limit)
        traction, rest, share_i = at_i.force, at_o.force, share_i * at_i.by_asked
        share_o = at_o.by_asked * (whole - share_i)
        grows = -by_gap_i * at_i.by_normal
        coupling, own = at_o.by_asked * grows, -by_gap_o * at_o.by_normal
    else:
        # No more than the normal force; the outer race takes the rest.
        traction, sign = share_i * moment, where(moment > 0.0, 1.0, -1.0)
        most = larger(traction, -traction) > inner.force
        traction, grows = where(most, sign * inner.force, traction), where(most, sign * inner.stiffness, 0.0)
        share_i, share_o, coupling = where(most, 0.0, share_i), where(most, whole, share_o), grows
        rest = share_o * moment - where(most, traction, 0.0)
    return Tangential(
        rub.inner - traction, rub.outer - rest, rub.inner_by_length - grows, rub.outer_by_length - own,
        rub.inner_by_angle - share_i * by_i, rub.outer_by_angle - share_o * by_o, -share_i * by_o, -share_o * by_i,
        rub.inner_by_shift + grows, rub.outer_by_shift + own, rub.couple + groove * traction,
        rub.couple_by_length + groove * grows, rub.couple_by_inner + groove * share_i * by_i, groove * share_i * by_o,
        rub.couple_by_turn, rub.inner_by_turn, coupling, rub.couple_by_shift - groove * grows,
    )  # fmt: skip


@jit(LANES(LANES, LANES), inline=True)
def angle_of(sine, cosine):
    """The angle of each lane's sine and cosine, or multiples of them, to 4e-16 of it.

    Moshier's rational function for arc tangents (Cephes, atan.c), within a sixteenth of a turn of an axis or a diagonal.
    """
    s, c = larger(sine, -sine), larger(cosine, -cosine)
    low, high = smaller(s, c), larger(s, c)
    diagonal = low > 0.41421356237309503 * high
    x = where(diagonal, low - high, low) / where(diagonal, low + high, where(high > 0.0, high, 1.0))
    z = x * x
    p = (((-8.750608600031904e-1 * z - 1.615753718733365e1) * z - 7.500855792314705e1) * z - 1.228866684490136e2) * z
    q = ((((z + 2.485846490142306e1) * z + 1.650270098316989e2) * z + 4.328810604912903e2) * z + 4.853903996359137e2) * z
    angle = x + x * (z * (p - 6.485021904942025e1) / (q + 1.945506571482614e2)) + where(diagonal, 0.25 * np.pi, 0.0)
    angle = where(s > c, 0.5 * np.pi - angle, angle)
    angle = where(cosine < 0.0, np.pi - angle, angle)
    return where(sine < 0.0, -angle, angle)


class _Grip(NamedTuple):
    """Tangential force of a contact [N], its derivatives by angle (zero where it slides), length and shift, and u [m]."""

    force: float
    by_angle: float
    by_length: float
    by_shift: float
    stretch: float


@jit(types.NamedUniTuple(LANES, 5, _Grip)(CONTACT, LANES, float64, LANES, float64, float64), inline=True)
def _grip(contact, lever, reach, stretch, mu, stick):
    """The return map: what sticks at the elastic displacement ``stretch``, or slides; reach = L."""
    tau, limit = stick * stretch * lever, mu * contact.force
    sticks, sign = larger(tau, -tau) <= limit, where(tau > 0.0, 1.0, -1.0)
    by_shift = -sign * mu * contact.stiffness
    return _Grip(
        where(sticks, tau, sign * limit),
        where(sticks, stick * reach * lever, 0.0),
        where(sticks, -tau * lever / reach, -by_shift),
        where(sticks, 0.0, by_shift),
        where(sticks, stretch, sign * limit / (stick * lever)),
    )


@jit(types.Tuple((TANGENTIALS, LANES_PAIR))(int64, MASK, CONTACTS, VECTOR, MATRIX), inline=True)
def rub(k, live, contacts, scalars, work):
    """Tangential forces of the balls from k on by friction, their couples on the ring's section, and their slips.

    A contact that sticks stores k_t u^2 / 2 with u = L a - slip outside, L a - r turn - slip inside: L is the distance of
    ball and groove centre at the first touch, a the contact's angle, r the groove's radius, turn that of the ring's section
    by its tilts, the slip is memory. So tau = k_t u L / s, at most mu f (return mapping), and work is stored or lost, never
    gained. A ball does not roll in this plane, so sticking contacts add a tangential stiffness that rolling balls do not
    have. The couple on the section is -r k_t u.
    """
    z, mu, stick = work.shape[1] // 2, scalars[ring.FRICTION], scalars[ring.STICK]
    reach, lo = scalars[ring.OFFSET_INNER], scalars[ring.OFFSET_OUTER]
    (inner, outer), groove, o = contacts, reach + 0.5 * scalars[ring.DIAMETER], spread(0.0)
    slip_i, slip_o = pair_of(work, COMMITTED, k, live)
    at_i = reach * angle_of(inner.axial, inner.radial) - take(work, TURNED, z + k, live)
    at_o = lo * angle_of(outer.axial, outer.radial)
    lever, lever_o = where(inner.by_length > 0.0, reach * inner.by_length, 1.0), lo * outer.by_length
    gi, go = _grip(inner, lever, reach, at_i - slip_i, mu, stick), _grip(outer, lever_o, lo, at_o - slip_o, mu, stick)
    sticks = ~(gi.by_angle == 0.0)
    forces = Tangential(
        gi.force, go.force, gi.by_length, go.by_length, gi.by_angle, go.by_angle, o, o, gi.by_shift, go.by_shift,
        -groove * stick * gi.stretch, where(sticks, 0.0, -groove * (gi.by_length / lever + gi.force / reach)),
        where(sticks, -groove * stick * reach, 0.0), o, where(sticks, groove * groove * stick, 0.0),
        where(sticks, -stick * groove * lever, o), o, where(sticks, 0.0, -groove * gi.by_shift / lever),
    )  # fmt: skip
    return forces, Pair(at_i - gi.stretch, at_o - go.stretch)


class Balance(NamedTuple):
    """Balls at their balance, linearised: E, P, X and J, M the damping by the velocity of e.

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


BALANCE = types.NamedTuple((*(LANES_TENSOR,) * 5, LANES_PAIR), Balance)


@jit(BALANCE(CONTACTS, LANES, LANES), inline=True)
def plain_balance(contacts, elastic, viscous):
    """``linear_balance`` of balls without tangential forces."""
    (na, nr, by_si, fi, ki), (oa, orr, by_so, fo, ko) = contacts
    none, wi, wo = spread(0.0), fi * by_si, fo * by_so
    x, y, far = elastic - wi, ki - wi, ko - wo
    e = Tensor(x * na * na + wi, x * na * nr, x * na * nr, x * nr * nr + wi)
    p = Tensor(-y * na * na - wi, -y * na * nr, -y * na * nr, -y * nr * nr - wi)
    j = Tensor(p.aa - far * oa * oa - wo, p.ar - far * oa * orr, p.ra - far * oa * orr, p.rr - far * orr * orr - wo)
    m = Tensor(viscous * na * na, viscous * na * nr, viscous * na * nr, viscous * nr * nr)
    return Balance(e, p, e, j, m, Pair(none, none))


@jit(BALANCE(CONTACTS, LANES, LANES, TANGENTIALS), inline=True)
def linear_balance(contacts, elastic, viscous, h):
    """Balls at their balance; elastic, viscous : stiffness and damping of their inner contacts."""
    inner, outer = contacts
    na, nr, to_a, to_r = inner.axial, inner.radial, outer.radial, -outer.axial
    wi, wo = inner.by_length, outer.by_length
    # Inner and outer tangential force by the angle, the outer one also by the length, of the other contact.
    ii_a, ii_r = h.inner_by_other * nr, -h.inner_by_other * na
    oi_a, oi_r = h.outer_by_other * nr * wi + h.grows * na, -h.outer_by_other * na * wi + h.grows * nr
    e = contact_matrix(BallContact(na, nr, wi, inner.force, elastic), h.inner, h.inner_by_length, h.inner_by_angle)
    g = contact_matrix(inner, h.inner, h.inner_by_length, h.inner_by_angle)
    o = contact_matrix(outer, h.outer, h.outer_by_length, h.outer_by_angle)
    p = Tensor(ii_a * to_a * wo - g.aa, ii_a * to_r * wo - g.ar, ii_r * to_a * wo - g.ra, ii_r * to_r * wo - g.rr)
    j = Tensor(p.aa - o.aa + to_a * oi_a, p.ar - o.ar + to_a * oi_r, p.ra - o.ra + to_r * oi_a, p.rr - o.rr + to_r * oi_r)
    x = Tensor(e.aa - to_a * oi_a, e.ar - to_a * oi_r, e.ra - to_r * oi_a, e.rr - to_r * oi_r)
    m = Tensor(viscous * na * na, viscous * na * nr, viscous * na * nr, viscous * nr * nr)
    return Balance(e, p, x, j, m, Pair(h.inner_by_turn * nr, -h.inner_by_turn * na))


@jit(LANES_TENSOR(LANES_TENSOR), inline=True)
def regular(j):
    """J of balls; of those that nothing holds in some direction, with a spring of 1 N/m or more that does."""
    trace, det = j.aa + j.rr, j.aa * j.rr - j.ar * j.ra
    shift = where(larger(det, -det) > 1e-14 * trace * trace, 0.0, -1e-7 * larger(trace, -trace) - 1.0)
    return Tensor(j.aa + shift, j.ar, j.ra, j.rr + shift)


@jit(LANES(LANES, LANES), inline=True)
def shallower(inner, outer):
    """Approach of the shallower of the closed contacts [m], of both gaps.

    It sets the scale of a ball's steps: under a light ring load the centrifugal force presses the ball far deeper into the outer race than
    the inner race is.
    """
    return where(inner >= 0.0, -outer, where(outer >= 0.0, -inner, smaller(-inner, -outer)))


@jit(types.UniTuple(LANES_PAIR, 2)(CONTACTS, TANGENTIALS), inline=True)
def couple_slopes(contacts, h):
    """Derivatives of the couple on the ring's section by e, and by the ball's place [N]."""
    inner, outer = contacts
    stretch, angle = h.couple_by_length, h.couple_by_inner * inner.by_length
    by_e = Pair(stretch * inner.axial + angle * inner.radial, stretch * inner.radial - angle * inner.axial)
    angle = h.couple_by_outer * outer.by_length
    return by_e, Pair(angle * outer.radial - by_e.axial, -angle * outer.axial - by_e.radial)


@jit(LANES_TENSOR(CONTACT, LANES, LANES, LANES), inline=True)
def contact_matrix(contact, h, h_s, h_a):
    """d(f n + h t)/dx of a contact for x = s n; h by the length and by the angle."""
    na, nr, w, f, k = contact
    tt, nt = (f + h_a) * w, -h * w
    # Along n and along t = (nr, -na), by x.
    along_a, along_r, across_a, across_r = k * na + nt * nr, k * nr - nt * na, h_s * na + tt * nr, h_s * nr - tt * na
    first = na * along_a + nr * across_a, na * along_r + nr * across_r
    return Tensor(*first, nr * along_a - na * across_a, nr * along_r - na * across_r)
