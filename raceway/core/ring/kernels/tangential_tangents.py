"""Balls with tangential forces, eliminated: what the ring and elastic bodies feel of them.

Notes
-----
At the balance R(p; e, w, turn) = 0 of ball place p, groove centre e, shifts w and turn of the section, dp = -J^-1 dR with
J = dR/dp.  With P the derivative of the ring's force by p, that force follows e by E - T X, T = P J^-1, X = dR/de.
"""

from typing import NamedTuple

from numba import boolean, float64, int64, types, void

from raceway.core.jit import jit
from raceway.core.ring.kernels import (
    AXIAL_BY_SHIFT,
    BY_AXIAL,
    BY_AXIAL_SPEED,
    BY_OTHER,
    BY_OWN,
    BY_RADIAL,
    BY_RADIAL_SPEED,
    BY_TURN,
    CONTACT_FORCE,
    COUPLE_BY_CENTRE,
    COUPLE_BY_SHIFT,
    FORCE,
    FORCE_BY_CENTRE,
    FORCE_BY_GAP,
    FORCE_BY_RATE,
    FORCE_BY_SPEED,
    FORCE_BY_TURN,
    RADIAL_BY_SHIFT,
    WORK_ROWS,
)
from raceway.core.ring.kernels import tangential_rows as row
from raceway.core.ring.kernels.planar import (
    NOTHING,
    PAIR,
    TENSOR,
    Pair,
    Tensor,
    less,
    less_column,
    less_row,
    row_times_adjugate,
    times_adjugate,
)
from raceway.core.ring.kernels.section import SEAT, add_ball, add_couple
from raceway.core.ring.kernels.tangential_newton import contact_matrix
from raceway.core.ring.kernels.tangential_rows import CONTACTS, Contact, contacts_of
from raceway.core.signatures import MATRIX, VECTOR


class Balance(NamedTuple):
    """A settled ball, linearised: E, P, X and J, M the damping by the velocity of e.

    by_turn : derivative of the ball's force by the turn of its section [N]
    """

    e: Tensor
    p: Tensor
    x: Tensor
    j: Tensor
    m: Tensor
    by_turn: Pair


BALANCE = types.NamedTuple((*(TENSOR,) * 5, PAIR), Balance)


@jit(BALANCE(int64, CONTACTS, MATRIX), inline=True)
def _linearised(k, contacts, work):
    """Ball k at its balance."""
    z = work.shape[1] // 2
    inner, outer = contacts
    elastic, viscous = -work[FORCE_BY_GAP, k], -work[FORCE_BY_RATE, k]
    na, nr, to_a, to_r = inner.axial, inner.radial, outer.radial, -outer.axial
    wi, wo = 1.0 / inner.length, 1.0 / outer.length
    # Inner and outer tangential force by the angle, the outer one also by the length, of the other contact.
    cross_o, grows = work[row.BY_OTHER_ANGLE, z + k], work[row.OUTER_BY_INNER_LENGTH, k]
    ii_a, ii_r = work[row.BY_OTHER_ANGLE, k] * nr, work[row.BY_OTHER_ANGLE, k] * -na
    oi_a, oi_r = cross_o * nr * wi + grows * na, cross_o * -na * wi + grows * nr
    e = contact_matrix(Contact(na, nr, inner.length, inner.force, elastic), k, work)
    g, o = contact_matrix(inner, k, work), contact_matrix(outer, z + k, work)
    p = Tensor(-g.aa + ii_a * to_a * wo, -g.ar + ii_a * to_r * wo, -g.ra + ii_r * to_a * wo, -g.rr + ii_r * to_r * wo)
    j = Tensor(p.aa - o.aa + to_a * oi_a, p.ar - o.ar + to_a * oi_r, p.ra - o.ra + to_r * oi_a, p.rr - o.rr + to_r * oi_r)
    x = Tensor(e.aa - to_a * oi_a, e.ar - to_a * oi_r, e.ra - to_r * oi_a, e.rr - to_r * oi_r)
    m = Tensor(viscous * na**2, viscous * na * nr, viscous * na * nr, viscous * nr**2)
    turn = work[row.BY_TURN, z + k]
    return Balance(e, p, x, j, m, Pair(turn * nr, turn * -na))


@jit(boolean(int64, float64, SEAT, MATRIX, VECTOR, MATRIX, MATRIX), inline=True)
def add_settled(k, ball_gain, seat, work, f, K, C):
    """Add ball k to f (5,), K and C (5, 5), and keep for elastic bodies what they ask for; False where J has no inverse."""
    z = work.shape[1] // 2
    contacts = contacts_of(k, ball_gain, work)
    inner, outer = contacts
    # Forces are those before the ball's last step: with what that changes they are off by its square.
    b, h, da, dr = _linearised(k, contacts, work), work[row.TANGENTIAL, k], work[row.STEP, k], work[row.STEP, z + k]
    force = Pair(
        inner.force * inner.axial + h * inner.radial + b.p.aa * da + b.p.ar * dr,
        inner.force * inner.radial + h * -inner.axial + b.p.ra * da + b.p.rr * dr,
    )
    lost, gained = inner.axial * da + inner.radial * dr, outer.axial * da + outer.radial * dr
    work[CONTACT_FORCE, k] = max(inner.force - inner.stiffness * lost, 0.0)
    work[CONTACT_FORCE, z + k] = max(outer.force + outer.stiffness * gained, 0.0)
    det = b.j.aa * b.j.rr - b.j.ar * b.j.ra
    if det == 0.0:
        return False
    t = times_adjugate(b.p, b.j)
    t = Tensor(t.aa / det, t.ar / det, t.ra / det, t.rr / det)
    # The couple by e, and by the ball's place; turning the section moves both forces alike.
    stretch, angle = work[row.COUPLE_BY_LENGTH, z + k], work[row.COUPLE_BY_ANGLE, k] * (1.0 / inner.length)
    by_e = Pair(stretch * inner.axial + angle * inner.radial, stretch * inner.radial + angle * -inner.axial)
    angle = work[row.COUPLE_BY_ANGLE, z + k] * (1.0 / outer.length)
    by_place = Pair(angle * outer.radial - by_e.axial, angle * -outer.axial - by_e.radial)
    u, couple = row_times_adjugate(by_place, b.j), work[row.COUPLE, k] + by_place.axial * da + by_place.radial * dr
    u = Pair(u.axial / det, u.radial / det)
    force_by_turn, couple_by_centre = less_column(b.by_turn, t, b.by_turn), less_row(by_e, u, b.x)
    couple_by_turn = work[row.COUPLE_BY_TURN, k] - u.axial * b.by_turn.axial - u.radial * b.by_turn.radial
    add_couple(seat, couple, force_by_turn, couple_by_centre, couple_by_turn, f, K)
    by_centre, by_speed = less(b.e, t, b.x), less(b.m, t, b.m)
    if work.shape[0] > WORK_ROWS:
        work[FORCE, k], work[FORCE, z + k] = force
        work[FORCE_BY_CENTRE, k], work[FORCE_BY_CENTRE, z + k] = by_centre.aa, by_centre.ar
        work[FORCE_BY_CENTRE + 1, k], work[FORCE_BY_CENTRE + 1, z + k] = by_centre.ra, by_centre.rr
        work[FORCE_BY_SPEED, k], work[FORCE_BY_SPEED, z + k] = by_speed.aa, by_speed.ar
        work[FORCE_BY_SPEED + 1, k], work[FORCE_BY_SPEED + 1, z + k] = by_speed.ra, by_speed.rr
        work[FORCE_BY_TURN, k], work[FORCE_BY_TURN, z + k] = force_by_turn
        work[COUPLE_BY_CENTRE, k], work[COUPLE_BY_CENTRE, z + k] = couple_by_centre
        _keep_for_bodies(k, contacts, b, t, u, work)
    add_ball(seat, force, by_centre, by_speed, f, K, C)
    return True


@jit(void(int64, CONTACTS, BALANCE, TENSOR, PAIR, MATRIX))
def _keep_for_bodies(k, contacts, b, t, u, work):
    """Contact forces by e, its velocity, shifts and turn; the ball's force on the ring and its couple by shifts.

    Notes
    -----
    Both contacts have dQ = g (dR), g = dQ/dp J^-1, on top of what they feel at a ball that stays where it is.
    """
    z = work.shape[1] // 2
    det = b.j.aa * b.j.rr - b.j.ar * b.j.ra
    (na, nr, _, _, ki), (oa, orr, _, _, ko) = contacts
    gi, go = row_times_adjugate(Pair(na, nr), b.j), row_times_adjugate(Pair(oa, orr), b.j)
    gi, go = Pair(-ki * gi.axial / det, -ki * gi.radial / det), Pair(ko * go.axial / det, ko * go.radial / det)
    elastic, viscous = -work[FORCE_BY_GAP, k], -work[FORCE_BY_RATE, k]
    work[BY_AXIAL, k], work[BY_RADIAL, k] = less_row(Pair(elastic * na, elastic * nr), gi, b.x)
    work[BY_AXIAL, z + k], work[BY_RADIAL, z + k] = less_row(NOTHING, go, b.x)
    work[BY_AXIAL_SPEED, k], work[BY_RADIAL_SPEED, k] = less_row(Pair(viscous * na, viscous * nr), gi, b.m)
    work[BY_AXIAL_SPEED, z + k], work[BY_RADIAL_SPEED, z + k] = less_row(NOTHING, go, b.m)
    # The ring's force and R by the inner shift, R by the outer one.
    hi, ho, grows = work[row.BY_SHIFT, k], work[row.BY_SHIFT, z + k], work[row.OUTER_BY_INNER_LENGTH, k]
    by_shift = Pair(-ki * na + hi * nr, -ki * nr + hi * -na)
    ri = Pair(by_shift.axial + grows * orr, by_shift.radial + grows * -oa)
    ro = Pair(ko * oa - ho * orr, ko * orr - ho * -oa)
    work[BY_OWN, k] = -ki - gi.axial * ri.axial - gi.radial * ri.radial
    work[BY_OTHER, k] = -gi.axial * ro.axial - gi.radial * ro.radial
    work[BY_OTHER, z + k] = -go.axial * ri.axial - go.radial * ri.radial
    work[BY_OWN, z + k] = -ko - go.axial * ro.axial - go.radial * ro.radial
    work[BY_TURN, k] = -gi.axial * b.by_turn.axial - gi.radial * b.by_turn.radial
    work[BY_TURN, z + k] = -go.axial * b.by_turn.axial - go.radial * b.by_turn.radial
    work[AXIAL_BY_SHIFT, k], work[RADIAL_BY_SHIFT, k] = less_column(by_shift, t, ri)
    work[AXIAL_BY_SHIFT, z + k], work[RADIAL_BY_SHIFT, z + k] = less_column(NOTHING, t, ro)
    work[COUPLE_BY_SHIFT, k] = work[row.COUPLE_BY_SHIFT, k] - u.axial * ri.axial - u.radial * ri.radial
    work[COUPLE_BY_SHIFT, z + k] = -u.axial * ro.axial - u.radial * ro.radial
