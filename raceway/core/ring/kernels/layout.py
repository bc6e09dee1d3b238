"""The inner ring's rigid motion seen from each ball's meridian plane.

A row of balls has a side (+1: a positive axial motion of the inner ring seats it, -1: the mirror image), a lever X (its
axial distance from the reference point) and a shift (axial approach built in by the preload of a set).  With
u = tilt_y sin - tilt_z cos and rho = y cos + z sin, the vector from the outer to the inner groove centre is
e = (e_rest + shift + side (x + R u), e_rest + rho - X u).  What ``scalars`` say of the grooves holds for all rows; a row that
differs has the difference in its own columns of ``table``.
"""

from collections import namedtuple
from typing import NamedTuple

import numpy as np
from numba import float64, int64, types, void
from numba.extending import register_jitable

from raceway.core.contact.damping import add_damping
from raceway.core.jit import jit
from raceway.core.lanes import LANES, MASK, WIDTH, column_of, live_of, root, spread, sum_of, where
from raceway.core.ring import kernels as rows
from raceway.core.ring.kernels.tensors import LANES_PAIR, LANES_TENSOR, PAIR, TENSOR, Pair, pair_of, put_pair, tensors_of
from raceway.core.signatures import CONSTANTS, CONTACTS, MATRIX, VECTOR

#: Entries of ``scalars``.  CAGE: speed of orbiting balls [rad/s].  The last ones belong to moments and friction:
#: friction coefficient, stick stiffness [N/m], shares of the gyroscopic moment (inner + outer = 2), D / d_m,
#: J * spin * cage speed [N m], ball diameter [m].  TIME_CONSTANT: of the contacts' damping [s].  TRACTION: largest traction
#: coefficient by which contacts carry the moment; 0: an outer contact carries any.
(
    REST_AXIAL, REST_RADIAL, OFFSET_INNER, OFFSET_OUTER, TILT_ARM, DAMPING, CAGE,
    FRICTION, STICK, SHARE_INNER, SHARE_OUTER, BALL_OVER_PITCH, GYROSCOPIC, DIAMETER, TIME_CONSTANT, TRACTION,
) = range(16)  # fmt: skip
SCALARS = 16
#: Columns of ``table``, one row a ball: direction of the azimuth at time zero, centrifugal force [N], share of the
#: approach that the outer race takes under Hertz, Hertz factor of the outer race [N/m^1.5], side, lever [m], shift [m].
COSINE, SINE, CENTRIFUGAL, OUTER_SHARE, OUTER_FACTOR, SIDE, LEVER, SHIFT = range(8)
#: Columns of what a ball's row has beyond the scalars of the same name without OWN: 0 in a set of equal rows.
OWN_REST_AXIAL, OWN_REST_RADIAL, OWN_OFFSET_INNER, OWN_OFFSET_OUTER, OWN_TILT_ARM = range(8, 13)
COLUMNS = 13


@jit(void(float64, VECTOR, VECTOR, CONSTANTS, MATRIX, types.UniTuple(int64, 3)))
def place(t, q, v, constants, work, rows):
    """Of every ball: the azimuth's cos and sin, e (axial, radial) and its velocity, into three ``rows`` of ``work``.

    A ball that orbits meets the ring at another place every moment: de/dt has a part of the cage speed.
    """
    scalars, table = constants
    direction, centre, velocity = rows
    n = table.shape[0]
    rest_a, rest_r, arm, cage = scalars[REST_AXIAL], scalars[REST_RADIAL], scalars[TILT_ARM], scalars[CAGE]
    turn_c, turn_s = 1.0, 0.0
    if cage != 0.0:
        turn_c, turn_s = np.cos(cage * t), np.sin(cage * t)
    # Everything that the balls share is read before the first row is written: afterwards it would be read again for each.
    x, y, z, tilt_y, tilt_z = q[0], q[1], q[2], q[3], q[4]
    vx, vy, vz, turn_y, turn_z = v[0], v[1] + cage * z, v[2] - cage * y, v[3] + cage * tilt_z, v[4] - cage * tilt_y
    for k in range(n):
        cosine, sine = table[k, COSINE], table[k, SINE]
        side, lever, shift = table[k, SIDE], table[k, LEVER], table[k, OWN_REST_AXIAL] + table[k, SHIFT]
        radial, reach = table[k, OWN_REST_RADIAL], arm + table[k, OWN_TILT_ARM]
        c, s = cosine * turn_c - sine * turn_s, sine * turn_c + cosine * turn_s
        u, u_rate = tilt_y * s - tilt_z * c, turn_y * s - turn_z * c
        work[direction, k], work[direction, n + k] = c, s
        work[centre, k] = rest_a + shift + side * (x + reach * u)
        work[centre, n + k] = rest_r + radial + y * c + z * s - lever * u
        work[velocity, k] = side * (vx + reach * u_rate)
        work[velocity, n + k] = vy * c + vz * s - lever * u_rate


@jit(void(float64, VECTOR, MATRIX))
def stop(t, scalars, table):
    """Let orbiting balls stand still where they are at a time: a static state has no rates."""
    c, s = np.cos(scalars[CAGE] * t), np.sin(scalars[CAGE] * t)
    for k in range(table.shape[0]):
        cosine, sine = table[k, COSINE], table[k, SINE]
        table[k, COSINE], table[k, SINE] = cosine * c - sine * s, sine * c + cosine * s
    scalars[CAGE] = 0.0


class Seat(NamedTuple):
    """How a ball's meridian plane meets the ring: azimuth, radius of the tilts' lever [m], side (+1, -1), lever X [m]."""

    cosine: float
    sine: float
    arm: float
    side: float
    lever: float


SEAT, SEATS = types.NamedUniTuple(float64, 5, Seat), types.NamedUniTuple(LANES, 5, Seat)


#: Sums over balls of their forces and couples on the ring, lane by lane [N, N m].
RingForce = namedtuple("RingForce", "x y z tilt_y tilt_z")
FORCES = types.NamedUniTuple(LANES, 5, RingForce)


@register_jitable
def no_force():
    """Of no balls."""
    o = spread(0.0)
    return RingForce(o, o, o, o, o)


@jit(FORCES(FORCES, SEATS, LANES, LANES, LANES), inline=True)
def with_force(total, seat, axial, radial, couple):
    """With the forces of balls and their couples on the section."""
    c, s, reach, side, lever = seat
    turn = reach * (side * axial) - lever * radial + side * couple
    return RingForce(
        total.x + side * axial, total.y + radial * c, total.z + radial * s, total.tilt_y + turn * s, total.tilt_z - turn * c
    )


#: Sums over balls of a tangent's entries between x, the radial r and the section's turn u, times cosines and sines, lane by lane: all entries
#: of K are such sums, held in registers: three times as fast as adding each ball to K in memory.
RingTangent = namedtuple(
    "RingTangent",
    "xx xr_c xr_s rx_c rx_s xu_c xu_s ux_c ux_s rr_cc rr_cs rr_ss ru_cc ru_cs ru_ss ur_cc ur_cs ur_ss uu_cc uu_cs uu_ss",
)
TANGENTS = types.NamedUniTuple(LANES, 21, RingTangent)


@register_jitable
def no_tangent():
    """Of no balls."""
    o = spread(0.0)
    return RingTangent(o, o, o, o, o, o, o, o, o, o, o, o, o, o, o, o, o, o, o, o, o)


@jit(TANGENTS(TANGENTS, SEATS, LANES_TENSOR, LANES_PAIR, LANES_PAIR, LANES), inline=True)
def with_tangent(total, seat, stiffness, by_turn, by_centre, turn):
    """With J^T [[aa, ar], [ra, rr]] J of balls, derivatives of their forces by the section's turn side u, of the couples by e and by turn."""
    c, s, reach, side, lever = seat
    ar, ra = side * stiffness.ar, side * stiffness.ra
    cc, cs, ss = c * c, c * s, s * s
    xu, ux = reach * stiffness.aa - lever * ar + by_turn.axial, reach * stiffness.aa - lever * ra
    ru, ur = reach * ra - lever * stiffness.rr + side * by_turn.radial, reach * ar - lever * stiffness.rr
    uu = reach * (xu + by_centre.axial) - lever * (ru + side * by_centre.radial) + turn
    ux, ur = ux + by_centre.axial, ur + side * by_centre.radial
    t, rr = total, stiffness.rr
    return RingTangent(
        t.xx + stiffness.aa, t.xr_c + ar * c, t.xr_s + ar * s, t.rx_c + ra * c, t.rx_s + ra * s,
        t.xu_c + xu * c, t.xu_s + xu * s, t.ux_c + ux * c, t.ux_s + ux * s,
        t.rr_cc + rr * cc, t.rr_cs + rr * cs, t.rr_ss + rr * ss, t.ru_cc + ru * cc, t.ru_cs + ru * cs, t.ru_ss + ru * ss,
        t.ur_cc + ur * cc, t.ur_cs + ur * cs, t.ur_ss + ur * ss, t.uu_cc + uu * cc, t.uu_cs + uu * cs, t.uu_ss + uu * ss,
    )  # fmt: skip


@register_jitable
def rows_of_tangent(t):
    """The rows of K (5, 5), lane by lane."""
    return (
        (t.xx, t.xr_c, t.xr_s, t.xu_s, -t.xu_c),
        (t.rx_c, t.rr_cc, t.rr_cs, t.ru_cs, -t.ru_cc),
        (t.rx_s, t.rr_cs, t.rr_ss, t.ru_ss, -t.ru_cs),
        (t.ux_s, t.ur_cs, t.ur_ss, t.uu_ss, -t.uu_cs),
        (-t.ux_c, -t.ur_cc, -t.ur_cs, -t.uu_cs, t.uu_cc),
    )


@jit(SEATS(int64, MASK, float64, MATRIX, MATRIX, int64), inline=True)
def seats_of(k, live, arm, table, work, direction):
    """The seats of balls from k on, whose azimuths are in the row ``direction`` of ``work``."""
    c, s = pair_of(work, direction, k, live)
    reach = arm + column_of(table, k, OWN_TILT_ARM, live)
    return Seat(c, s, reach, column_of(table, k, SIDE, live), column_of(table, k, LEVER, live))


@jit(void(FORCES, VECTOR), inline=True)
def put_force(total, f):
    """The sums of all lanes into f (5,)."""
    for i, part in enumerate(total):
        f[i] = sum_of(part)


@jit(void(TANGENTS, MATRIX), inline=True)
def put_tangent(total, K):
    """The sums of all lanes into K (5, 5)."""
    for i, entries in enumerate(rows_of_tangent(total)):
        for j, entry in enumerate(entries):
            K[i, j] = sum_of(entry)


@jit(void(MATRIX, float64, MATRIX, int64, int64, VECTOR), inline=True)
def ring_force(table, arm, work, direction, row, f):
    """f (5,): the balls' forces on the ring [N], from work[row] = axial (Z,), radial (Z,); f = sum J^T (axial, radial).

    ``direction`` is the row that ``place`` put the azimuths in.
    """
    n, total = table.shape[0], no_force()
    for k in range(0, n, WIDTH):
        live = live_of(k, n)
        axial, radial = pair_of(work, row, k, live)
        total = with_force(total, seats_of(k, live, arm, table, work, direction), axial, radial, spread(0.0))
    put_force(total, f)


@jit(void(MATRIX, float64, MATRIX, int64, int64, MATRIX))
def ring_tangent(table, arm, work, direction, row, K):
    """K (5, 5): sum of J^T [[aa, ar], [ra, rr]] J over the balls; work[row] = aa (Z,), ar (Z,), work[row + 1] = ra (Z,), rr (Z,)."""
    none, total, z = Pair(spread(0.0), spread(0.0)), no_tangent(), table.shape[0]
    for k in range(0, z, WIDTH):
        live = live_of(k, z)
        seat, stiffness = seats_of(k, live, arm, table, work, direction), tensors_of(work, row, k, live)
        total = with_tangent(total, seat, stiffness, none, none, spread(0.0))
    put_tangent(total, K)


#: Rows of the solvers of balls with two unknowns, see there: groove centre e [m] and its velocity [m/s], directions of a ball's contacts
#: and 1 over its distances from both groove centres [1/m].
BALL_CENTRE, BALL_VELOCITY, INNER, OUTER, BY_LENGTH = 5, 6, 9, 10, 11


@jit(void(int64, MASK, float64, MATRIX), inline=True)
def approach(k, live, ball_gain, work):
    """Directions, 1 over lengths, gaps and gap rates of both contacts of balls from k on."""
    (pa, pr), (ea, er) = pair_of(work, rows.PLACE, k, live), pair_of(work, BALL_CENTRE, k, live)
    xa, xr = ea - pa, er - pr
    so, si = root(pa * pa + pr * pr), root(xa * xa + xr * xr)
    by_so, apart = 1.0 / so, si > 0.0
    by_si = where(apart, 1.0 / si, 0.0)
    oa, orr = pa * by_so, pr * by_so
    ia, ir = where(apart, xa * by_si, oa), where(apart, xr * by_si, orr)
    (va, vr), (known_a, known_r) = pair_of(work, BALL_VELOCITY, k, live), pair_of(work, rows.HISTORY, k, live)
    own_a, own_r = ball_gain * pa + known_a, ball_gain * pr + known_r
    (li, lo), (shift_i, shift_o) = pair_of(work, rows.OFFSET, k, live), pair_of(work, rows.SHIFT, k, live)
    rate_i, rate_o = pair_of(work, rows.SHIFT_RATE, k, live)
    put_pair(work, BY_LENGTH, k, live, by_si, by_so)
    put_pair(work, OUTER, k, live, oa, orr)
    put_pair(work, INNER, k, live, ia, ir)
    put_pair(work, rows.GAP, k, live, li - si + shift_i, lo - so + shift_o)
    rate_i, rate_o = rate_i - (ia * (va - own_a) + ir * (vr - own_r)), rate_o - (oa * own_a + orr * own_r)
    put_pair(work, rows.GAP_RATE, k, live, rate_i, rate_o)


_FIRST = rows.WORK_ROWS + rows.KERNEL_ROWS + 2
#: Of ``structural``: azimuths, e and its velocity, derivative of the angle by e, compliances with slopes and curvatures, steps
#: of the structural approaches, inverses, and the size of what is left.
DIRECTION, CENTRE, SPEED, TURNING, OWN, SLOPE, CURVE, STEP, LAST, INVERSE, INVERSE_2, NORM = range(_FIRST, _FIRST + 12)
# Five rows each: forces by q and by v, the ring's force by w or d, by Q at fixed w, and weights of C Q in it.
BY_Q = NORM + 1
BY_V, RING, TURN, WEIGHT = BY_Q + 5, BY_Q + 10, BY_Q + 15, BY_Q + 20
#: Of ``between``: force of each ball on the ring, displacement by centrifugal forces, what is left of the displacements and
#: their steps, tangents of each ball (two rows), its approaches by e (two rows), and one row of balls in its own order.
CARRIED, CENTRIFUGAL_MOVED, MOVED_REST, MOVED_STEP, MOVED_LAST, BALL_TANGENT = range(WEIGHT + 5, WEIGHT + 11)
APPROACH_BY_CENTRE = BALL_TANGENT + 2
LOCAL = APPROACH_BY_CENTRE + 2
#: Rows of all that, less a matrix of 2 Z rows behind them.
ELASTIC_ROWS = LOCAL + 1 - rows.WORK_ROWS
MATRIX_ROWS = rows.WORK_ROWS + ELASTIC_ROWS


@jit(types.UniTuple(float64, 2)(int64, VECTOR, MATRIX), inline=True)
def offsets_of(k, scalars, table):
    """Distances of ball k and the inner and the outer groove centre at first touch [m]."""
    inner = scalars[OFFSET_INNER] + table[k, OWN_OFFSET_INNER]
    return inner, scalars[OFFSET_OUTER] + table[k, OWN_OFFSET_OUTER]


@jit(PAIR(int64, float64, float64, VECTOR, MATRIX), inline=True)
def first_place(k, ea, er, scalars, table):
    """Where ball k begins with its inner groove centre at e: beside the line of the groove centres, or on its seat on the outer race.

    By t out of the line the contacts, which press it back, approach by D + t^2 / 2h, 1/h = 1/l_i + 1/l_o; the centrifugal force pushes it
    out: K (D + t^2 / 2h)^1.5 t / h = F_c sin a, by Newton's method from above.
    """
    li, lo = offsets_of(k, scalars, table)
    length = max(np.sqrt(ea * ea + er * er), 1e-30)
    push, factor, share = table[k, CENTRIFUGAL], table[k, OUTER_FACTOR], table[k, OUTER_SHARE]
    by_length, deep, h, t = 1.0 / length, length - li - lo, li * lo / (li + lo), 0.0
    cosine, sine = er * by_length, abs(ea) * by_length
    driven = push * sine * h / (factor * share * np.sqrt(share))
    if deep > 0.0:
        t = driven / (deep * np.sqrt(deep))
    if driven > 0.0 and t * t >= 0.2 * h * deep:
        most = np.sqrt(max(-2.0 * h * deep, 0.0)) + np.sqrt(np.sqrt(driven * 2.0 * h * np.sqrt(2.0 * h)))
        t = min(t, most) if deep > 0.0 else most
        for _ in range(3):
            closer = deep + 0.5 * t * t / h
            third = np.sqrt(closer)
            t -= (closer * third * t - driven) / (third * (closer + 1.5 * t * t / h))
    turn, closer = t / lo, deep + 0.5 * t * t / h
    along, beside = 1.0 - 0.5 * turn * turn, turn * (1.0 - turn * turn / 6.0)
    axial, reach = sine * along - cosine * beside, lo + share * closer
    if closer <= 0.0 or axial < 0.0:
        return Pair(0.0, lo + (push / factor) ** (2.0 / 3.0))
    return Pair(reach * (axial if ea > 0.0 else -axial), reach * (cosine * along + sine * beside))


@jit(void(CONTACTS, VECTOR, MATRIX), inline=True)
def normal_forces(contacts, scalars, work):
    """Rows CONTACT_FORCE, FORCE_BY_GAP and FORCE_BY_RATE of ``work`` from rows GAP and GAP_RATE.

    A time constant tau makes a contact that answers as its spring does to g + tau dg/dt: for small motions that is a dashpot
    c = tau k beside the spring, with k the law's own stiffness at every gap. The force stays continuous, never pulls and
    never gives energy: as the law's force grows with the approach, its excess over the spring's has the sign of the
    approach's rate. The viscous part of the approach is at most as large as the elastic one, so that a contact which begins
    to touch carries nothing.
    """
    law, params, old, new, dt = contacts
    gap, rate, force = work[rows.GAP], work[rows.GAP_RATE], work[rows.CONTACT_FORCE]
    by_gap, by_rate = work[rows.FORCE_BY_GAP], work[rows.FORCE_BY_RATE]
    tau = scalars[TIME_CONSTANT]
    if tau == 0.0:
        law(gap, rate, params, old, new, dt, force, by_gap, by_rate)
        add_damping(scalars[DAMPING], gap, rate, force, by_gap, by_rate)
        return
    ahead = work[rows.AHEAD]
    for i in range(gap.size):
        viscous = tau * rate[i]
        ahead[i] = gap[i] + max(viscous, gap[i]) if gap[i] < 0.0 else gap[i]
    law(ahead, rate, params, old, new, dt, force, by_gap, by_rate)
    for i in range(gap.size):
        if tau * rate[i] > gap[i]:
            by_rate[i] += tau * by_gap[i]
        else:
            by_gap[i] *= 2.0


#: Entries of ``scalars`` beyond the rigid ones: compliance of a ball by the load on its other race [m/N]; 1 where balls act
#: on each other through the rings; balls of a row; first angle [rad] and distance of the table's angles, their number n;
#: then the table: inner compliance (n,), its slopes by angle over that distance (n,), and both again for the outer race.
#: Where balls act on each other, ``BLOCK`` numbers follow for each distance of two balls, 0 to Z - 1, see ``between``.
BALL_CROSS, COUPLED, ROW, FIRST, DISTANCE, KNOTS, VALUES = range(SCALARS, SCALARS + 7)
BLOCK = 5
#: Column of ``ball`` that the slips of friction begin at, inner and outer contact [m].
SLIPS = 2


@register_jitable
def are_condensed(scalars):
    """Whether these constants belong to condensed bodies."""
    return scalars.size > SCALARS


@register_jitable
def elastic_columns(scalars):
    """Columns of ``ball`` for the elasticity of the bodies, the last ones.

    Columns 0 and 1 of a ball are positions; columns 2 and 3 are slips where there is friction; then come, of condensed
    bodies, two structural approaches and, where balls act on each other through the rings, two displacements of groove
    centres. All but slips have rates, slips are only committed.
    """
    if not are_condensed(scalars):
        return 0
    return 4 if scalars[COUPLED] != 0.0 else 2


@register_jitable
def work_rows(scalars, table):
    """Rows of ``work`` that a system needs."""
    if not are_condensed(scalars):
        return rows.WORK_ROWS
    return rows.WORK_ROWS + ELASTIC_ROWS + 2 * table.shape[0]


@jit(int64(VECTOR, MATRIX))
def slips_end(scalars, ball):
    """The column after the slips, which begin at ``SLIPS``."""
    return ball.shape[1] - elastic_columns(scalars)


@jit(void(VECTOR, MATRIX, MATRIX))
def keep_slips(scalars, ball, history):
    """history, like ball, of balls at rest: zeros, and the committed slips."""
    end = slips_end(scalars, ball)
    for k in range(ball.shape[0]):
        for c in range(ball.shape[1]):
            history[k, c] = ball[k, c] if 2 <= c < end else 0.0


@jit(void(VECTOR, float64, MATRIX, MATRIX, MATRIX, MATRIX), inline=True)
def next_balls(scalars, dt, ball, before, history, trial):
    """First guess of the balls after a step, and the part of their rates that is known by then.

    Rates follow the second-order backward difference (1.5 new - 2 now + 0.5 before) / dt.
    """
    end, inverse = slips_end(scalars, ball), 1.0 / dt
    for k in range(ball.shape[0]):
        for c in range(ball.shape[1]):
            now, last = ball[k, c], before[k, c]
            is_slip = SLIPS <= c < end
            history[k, c] = now if is_slip else (0.5 * last - 2.0 * now) * inverse
            trial[k, c] = now if is_slip else 2.0 * now - last


@jit(void(VECTOR, float64, MATRIX, MATRIX, MATRIX, MATRIX, MATRIX), inline=True)
def accept_balls(scalars, dt, ball, before, history, trial, bend):
    """Commit ``trial``, then what ``next_balls`` gives for the step after it: in one pass.

    bend : their second differences, like ball and at first zeros, which foretell the balls to the third order; none: to the first
    """
    end, inverse = slips_end(scalars, ball), 1.0 / dt
    for k in range(ball.shape[0]):
        for c in range(ball.shape[1]):
            now, last, further, is_slip = trial[k, c], ball[k, c], 0.0, SLIPS <= c < end
            if bend.shape[0] > 0:
                second = now - 2.0 * last + before[k, c]
                further, bend[k, c] = 2.0 * second - bend[k, c], second
            before[k, c], ball[k, c] = last, now
            history[k, c] = now if is_slip else (0.5 * last - 2.0 * now) * inverse
            trial[k, c] = now if is_slip else 2.0 * now - last + further


@jit(SEAT(int64, float64, MATRIX, MATRIX, int64), inline=True)
def seat_of(k, arm, table, work, direction):
    """The seat of ball k, whose azimuth is in the row ``direction`` of ``work``."""
    reach = arm + table[k, OWN_TILT_ARM]
    return Seat(work[direction, k], work[direction, table.shape[0] + k], reach, table[k, SIDE], table[k, LEVER])


@jit(void(SEAT, PAIR, TENSOR, VECTOR, MATRIX))
def add_ball(seat, force, stiffness, f, K):
    """Add one ball's force [N] and its derivatives by e to the ring's f (5,) and K (5, 5) or (0, 0).

    e = J q with the rows J_a = side (1, 0, 0, R s, -R c) and J_r = (0, c, s, -X s, X c).
    """
    c, s, arm, side, lever = seat
    ja = (side, 0.0, 0.0, side * arm * s, -side * arm * c)
    jr = (0.0, c, s, -lever * s, lever * c)
    for i in range(5):
        f[i] += ja[i] * force.axial + jr[i] * force.radial
    if K.size == 0:
        return
    for j in range(5):
        ga, gr = stiffness.aa * ja[j] + stiffness.ar * jr[j], stiffness.ra * ja[j] + stiffness.rr * jr[j]
        for i in range(5):
            K[i, j] += ja[i] * ga + jr[i] * gr


@jit(void(SEAT, PAIR, float64, MATRIX, int64, int64))
def to_ring(seat, force, turn, work, row, column):
    """J^T force and the turn of the ball's section, into a column of the five rows of ``work`` from ``row`` on."""
    axial = force.axial * seat.side
    couple = seat.arm * axial - seat.lever * force.radial + seat.side * turn
    work[row, column] = axial
    work[row + 1, column], work[row + 2, column] = force.radial * seat.cosine, force.radial * seat.sine
    work[row + 3, column], work[row + 4, column] = couple * seat.sine, -couple * seat.cosine


@jit(void(MATRIX, int64, float64, MATRIX))
def add_products(work, row, sign, out):
    """Add sign times WEIGHT^T B, B five rows of ``work`` from ``row`` on, to out (5, 5)."""
    for i in range(5):
        for j in range(5):
            total = 0.0
            for c in range(work.shape[1]):
                total += work[WEIGHT + i, c] * work[row + j, c]
            out[i, j] += sign * total
