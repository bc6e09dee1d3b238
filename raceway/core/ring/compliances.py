"""Structural compliances of balls in lanes: ``raceway.core.ring.kernels.structural`` without coupling between balls, in a ball's balance.

A ball has two unknowns more, its structural approaches w.  With K the contacts' stiffnesses, N their lengths' derivatives by the ball's place p
or by e, and D = c' Q times g, the derivative of the angle by e, their balance w = C Q is, linearised,

    (1 + C K) dw = C Q - w + C K (N_p dp + N_e de) + D g de,

which is eliminated from the ball's balance and from its force on the ring, before its place is.
"""

from typing import NamedTuple

from numba import int64, types

from raceway.core.jit import jit
from raceway.core.lanes import LANES, MASK, WIDTH, column_of, live_of, put, spread, take
from raceway.core.ring.kernels import layout as ring
from raceway.core.ring.kernels.rolling import BALANCE, CONTACTS, TANGENTIALS, Balance, angle_of
from raceway.core.ring.kernels.structural import knot_before, spline
from raceway.core.ring.kernels.tensors import (
    LANES_PAIR,
    LANES_TENSOR,
    Pair,
    Tensor,
    less,
    less_column,
    less_row,
    pair_of,
    put_pair,
    put_tensors,
    tensors_of,
)
from raceway.core.signatures import MATRIX

#: Rows of ``work`` in ``raceway.core.ring.lockstep``: steps of the structural approaches w by what is left of their balance [m], their derivatives by
#: e; derivative of the angle by e [1/m]; compliances [m/N] of both contacts, their slopes and curvatures by the angle; w [m].
SHIFT_STEP, SHIFT_BY_E = 15, 16
TURNING, OWN, SLOPE, CURVE, SHIFT = (*range(21, 25), 27)


@jit(LANES_PAIR(int64, MASK, LANES_PAIR, LANES_PAIR, LANES, MATRIX, MATRIX))
def move_shifts(k, live, centre, moved, scale, bodies, work):
    """Structural approaches after parts ``scale`` of their steps, with e at ``centre``, which ``moved``; compliances there.

    Rows of steps are then used for the table's entries.
    """
    (wi, wo), (si, so), t = (
        pair_of(work, SHIFT, k, live),
        pair_of(work, SHIFT_STEP, k, live),
        tensors_of(work, SHIFT_BY_E, k, live),
    )
    (axial, radial), (da, dr) = centre, moved
    wi, wo = wi + scale * (si + t.aa * da + t.ar * dr), wo + scale * (so + t.ra * da + t.rr * dr)
    put_pair(work, SHIFT, k, live, wi, wo)
    z, inverse, lanes = work.shape[1] // 2, 1.0 / (axial * axial + radial * radial), live_of(0, WIDTH)
    first, distance = column_of(bodies, 0, ring.FIRST, lanes), column_of(bodies, 0, ring.DISTANCE, lanes)
    put_pair(work, TURNING, k, live, radial * inverse, -axial * inverse)
    put(work, SHIFT_STEP, k, live, (angle_of(axial, radial) - first) / distance)
    for lane in range(WIDTH):
        scalars = bodies[lane]
        i, u, inside = knot_before(work[SHIFT_STEP, k + lane], scalars)
        work[SHIFT_STEP, k + lane], work[SHIFT_STEP, z + k + lane] = u, inside
        knots = int(scalars[ring.KNOTS])
        for race in range(2):
            entry, c = ring.VALUES + i + 2 * knots * race, k + lane + race * z
            work[OWN, c], work[SLOPE, c] = scalars[entry], scalars[entry + 1]
            work[CURVE, c], work[SHIFT_BY_E, c] = scalars[entry + knots], scalars[entry + knots + 1]
    u, inside = pair_of(work, SHIFT_STEP, k, live)
    inside = inside / distance
    for c in (k, z + k):
        (p, q), (m, n) = (
            (take(work, OWN, c, live), take(work, SLOPE, c, live)),
            (take(work, CURVE, c, live), take(work, SHIFT_BY_E, c, live)),
        )
        own, slope, curve = spline(u, p, q, m, n)
        put(work, OWN, c, live, own)
        put(work, SLOPE, c, live, inside * slope)
        put(work, CURVE, c, live, inside * inside * curve)
    return Pair(wi, wo)


class Ball(NamedTuple):
    """Forces on the ring and imbalances of balls [N], couples on the section [N m], what couples follow e and the place by, and what the rest does."""

    force: Pair
    rest: Pair
    couple: float
    by_e: Pair
    by_place: Pair
    balance: Balance


class Relief(NamedTuple):
    """By how much structural approaches fall: by what is left of their own balance [m], with the ball's place, and with e; det (1 + C K)."""

    own: Pair
    by_place: Tensor
    by_e: Tensor
    det: float


BALL = types.NamedTuple((LANES_PAIR, LANES_PAIR, LANES, LANES_PAIR, LANES_PAIR, BALANCE), Ball)
RELIEF = types.NamedTuple((LANES_PAIR, LANES_TENSOR, LANES_TENSOR, LANES), Relief)


@jit(types.Tuple((BALL, RELIEF))(int64, MASK, CONTACTS, TANGENTIALS, BALL, MATRIX, MATRIX), inline=True)
def with_compliances(k, live, contacts, h, ball, bodies, work):
    """Balls that are in balance at given structural approaches as their own approaches make them."""
    (na, nr, _, fi, ki), (oa, orr, _, fo, ko) = contacts
    (ga, gr), (ci, co), (wi, wo) = (
        pair_of(work, TURNING, k, live),
        pair_of(work, OWN, k, live),
        pair_of(work, SHIFT, k, live),
    )
    (di, do), (curve_i, curve_o) = pair_of(work, SLOPE, k, live), pair_of(work, CURVE, k, live)
    cross, none, b = column_of(bodies, 0, ring.BALL_CROSS, live_of(0, WIDTH)), spread(0.0), ball.balance
    nothing, zero, di, do = Pair(none, none), Tensor(none, none, none, none), di * fi, do * fo
    # (inner, outer) contact x (axial, radial): forces by the lengths' derivatives, D, and the right side above
    ia, ir, pa, pr = ki * na, ki * nr, ko * oa, ko * orr
    d = Tensor(di * ga, di * gr, do * ga, do * gr)
    by_place = Tensor(cross * pa - ci * ia, cross * pr - ci * ir, co * pa - cross * ia, co * pr - cross * ir)
    by_e = Tensor(ci * ia + d.aa, ci * ir + d.ar, cross * ia + d.ra, cross * ir + d.rr)
    mii, mio, moi, moo = 1.0 + ci * ki, cross * ko, cross * ki, 1.0 + co * ko
    det = mii * moo - mio * moi
    inverse = 1.0 / det
    m = Tensor(moo * inverse, -mio * inverse, -moi * inverse, mii * inverse)
    own = less_column(nothing, m, Pair(ci * fi + cross * fo - wi, cross * fi + co * fo - wo))
    fall = Relief(own, less(zero, m, by_place), less(zero, m, by_e), det)
    # Derivatives by the approaches: of the ring's force, of the imbalance, of the couple
    wa, wr = h.inner_by_shift * nr - ia, -h.inner_by_shift * na - ir
    on_ring, on_couple = Tensor(wa, none, wr, none), Pair(h.couple_by_shift, none)
    on_ball = Tensor(wa + h.grows * orr, pa - h.outer_by_shift * orr, wr - h.grows * oa, pr + h.outer_by_shift * oa)
    # Contact forces turn the ring by -Q^2 c' / 2; how they change, all told
    t, p, e = Tensor(d.aa, d.ra, d.ar, d.rr), fall.by_place, fall.by_e
    turn, twice = -0.5 * (fi * di + fo * do), -0.5 * (fi * fi * curve_i + fo * fo * curve_o)
    haa, har = turn * (2.0 * ga * gr), turn * (gr * gr - ga * ga)
    bent = Tensor(
        b.e.aa + twice * ga * ga + haa,
        b.e.ar + twice * ga * gr + har,
        b.e.ra + twice * ga * gr + har,
        b.e.rr + twice * gr * gr - haa,
    )
    turned = Pair(ball.force.axial + turn * ga, ball.force.radial + turn * gr)
    q = Pair(ki * own.axial, ko * own.radial)
    q_place = Tensor(ki * p.aa - ia, ki * p.ar - ir, ko * p.ra + pa, ko * p.rr + pr)
    q_e = Tensor(ki * e.aa + ia, ki * e.ar + ir, ko * e.ra, ko * e.rr)
    soft = Ball(
        less_column(less_column(turned, on_ring, own), t, q), less_column(ball.rest, on_ball, own),
        ball.couple - on_couple.axial * own.axial, less_row(ball.by_e, on_couple, e), less_row(ball.by_place, on_couple, p),
        Balance(
            less(less(bent, on_ring, e), t, q_e), less(less(b.p, on_ring, p), t, q_place),
            less(b.x, on_ball, e), less(b.j, on_ball, p), b.m, b.by_turn,
        ),
    )  # fmt: skip
    return soft, fall


@jit(MASK(int64, MASK, RELIEF, LANES_PAIR, LANES_TENSOR, LANES, MATRIX), inline=True)
def put_shifts(k, live, fall, step, by_e, least, work):
    """Steps of structural approaches beside those of the balls' places; which exceed ``least``, or have no balance to go to."""
    own, of_e = fall.own, fall.by_e
    si, so = less_column(Pair(-own.axial, -own.radial), fall.by_place, step)
    put_pair(work, SHIFT_STEP, k, live, si, so)
    put_tensors(work, SHIFT_BY_E, k, live, less(Tensor(-of_e.aa, -of_e.ar, -of_e.ra, -of_e.rr), fall.by_place, by_e))
    return ~((si * si + so * so <= least * least) & (fall.det > 0.0))
