"""Equilibria of four points in lockstep: each lane of a value is a point, and one Newton iteration moves ring and balls.

A ball's place p is eliminated from each step: with R its imbalance and F its force on the ring, p follows e by -J^-1 (R + X de), and the ring
sees F - P J^-1 R and the tangent E - P J^-1 X (``raceway.core.ring.kernels.rolling.Balance``).  Without gyroscopic moments the potential is
convex in all unknowns together, so that what balances is the one equilibrium; moments are put on where that is nearly found: from the
first guess on, or from where a point comes near.
Elastic bodies' approaches are eliminated before it (``raceway.core.ring.compliances``).
There is no safeguard: a point that does not balance within some steps, or is held loosely, is left to the trust region.
"""

import numpy as np
from numba import boolean, int64, types, void

from raceway.core.jit import jit
from raceway.core.lanes import LANES, MASK, WIDTH, any_of, larger, live_of, put, root, smaller, spread, take, where
from raceway.core.ring import compliances as soft
from raceway.core.ring import kernels as rows
from raceway.core.ring.kernels import layout as ring
from raceway.core.ring.kernels import rolling as at
from raceway.core.ring.kernels.layout import Seat, no_force, no_tangent, rows_of_tangent, with_force, with_tangent
from raceway.core.ring.kernels.rolling import BallContact, Rolling
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
from raceway.core.signatures import LAW_POINTER, LEAST, LINEAR, MATRIX, POINTS, STATES, TOLERANCE, VECTOR

#: Rows of ``work`` behind the law's, halves of 4 Z: azimuth; side and lever [m]; reach of the tilts [m] and centrifugal force [N]; e at
#: rest [m]; offsets [m]; of balls that nothing pushes off the line of the groove centres the outer race's share of the approach, else 0;
#: place p [m]; its step by R [m]; its derivatives by e; directions of its contacts and 1 over their lengths [1/m].
DIRECTION, SEAT, REACH, REST, OFFSET, SHARE, PLACE, STEP, BY_CENTRE, INNER, OUTER, BY_LENGTH = (*range(5, 14), 18, 19, 20)
#: Of damped motions: rate of the place [m/s]; gap that a contact with a time constant answers to [m].
PLACE_RATE, AHEAD = 25, 26
#: At the first guess of equilibria 1 where a ball differs in its azimuth alone from the one before.
LIKE = AHEAD
WORK_ROWS = 28
#: Rows of ``of_points``, one number of each point: q, its step, load, shaft against tilts, reach of the tilts; numbers of rolling; the tangent
#: and its right side.
Q, DQ, LOAD, SHAFT, ARM, ROLLS, TANGENT = 0, 5, 10, 15, 16, 17, 24
POINT_ROWS = TANGENT + 30
_ITERATIONS = 25
#: Relative imbalance from which on a point's moments act; steps of balls over their contacts' approach that end the iteration.
_NEAR, _SETTLED = 0.1, 1e-11
#: Longest step of the ring over the groove centres' distance.
_LONGEST = 0.1


@jit(void(int64, POINTS, MATRIX, MATRIX, MATRIX, MATRIX))
def gather(first, points, params, bodies, work, of_points):
    """The numbers of the block's points into lanes; behind the last point it stands again."""
    n, z = points.table.shape[:2]
    for lane in range(WIDTH):
        p = min(first + lane, n - 1)
        scalars, table = points.scalars[p], points.table[p]
        arm, q = scalars[ring.TILT_ARM], points.guess[p]
        of_points[SHAFT, lane], of_points[ARM, lane] = points.shaft[p], arm
        for i in range(scalars.size if bodies.shape[0] > 0 else 0):
            bodies[lane, i] = scalars[i]
        for i in range(5):
            of_points[Q + i, lane], of_points[DQ + i, lane], of_points[LOAD + i, lane] = q[i], 0.0, points.load[p, i]
        for i, source in enumerate(at.ROLLING_SCALARS):
            of_points[ROLLS + i, lane] = scalars[source]
        for k in range(z):
            c, o = WIDTH * k + lane, WIDTH * (z + k) + lane
            cosine, sine, side, lever = table[k, ring.COSINE], table[k, ring.SINE], table[k, ring.SIDE], table[k, ring.LEVER]
            reach = arm + table[k, ring.OWN_TILT_ARM]
            rest_a = scalars[ring.REST_AXIAL] + (table[k, ring.OWN_REST_AXIAL] + table[k, ring.SHIFT])
            rest_r = scalars[ring.REST_RADIAL] + table[k, ring.OWN_REST_RADIAL]
            turn = q[3] * sine - q[4] * cosine
            middle = Pair(rest_a + side * (q[0] + reach * turn), rest_r + q[1] * cosine + q[2] * sine - lever * turn)
            work[DIRECTION, c], work[DIRECTION, o], work[SEAT, c], work[SEAT, o] = cosine, sine, side, lever
            work[REACH, c], work[REACH, o], work[REST, c], work[REST, o] = reach, table[k, ring.CENTRIFUGAL], rest_a, rest_r
            work[OFFSET, c], work[OFFSET, o] = ring.offsets_of(k, scalars, table)
            pushed = table[k, ring.CENTRIFUGAL] != 0.0 or scalars[ring.GYROSCOPIC] != 0.0
            work[SHARE, c] = 0.0 if pushed else table[k, ring.OUTER_SHARE]
            alike = k > 0 and q[1] == q[2] == q[3] == q[4] == 0.0
            for i in range(ring.CENTRIFUGAL if alike else ring.COLUMNS, ring.COLUMNS):
                alike &= table[k, i] == table[k - 1, i]
            for i in range(params.shape[1] if alike else 0):
                alike &= points.params[p, k, i] == points.params[p, k - 1, i]
                alike &= points.params[p, z + k, i] == points.params[p, z + k - 1, i]
            work[LIKE, c] = alike
            if alike:
                work[PLACE, c], work[PLACE, o] = work[PLACE, c - WIDTH], work[PLACE, o - WIDTH]
            else:
                work[PLACE, c], work[PLACE, o] = ring.first_place(k, middle.axial, middle.radial, scalars, table)
            work[rows.GAP_RATE, c] = work[rows.GAP_RATE, o] = 0.0
            for row in range(STEP, INNER):
                work[row, c] = work[row, o] = 0.0
            work[soft.SHIFT, c] = work[soft.SHIFT, o] = 0.0
            for i in range(params.shape[1]):
                params[c, i], params[o, i] = points.params[p, k, i], points.params[p, z + k, i]


@jit(ring.SEATS(int64, MASK, MATRIX), inline=True)
def seats(k, live, work):
    """The seats of ball k / WIDTH of each point."""
    (c, s), (side, lever) = pair_of(work, DIRECTION, k, live), pair_of(work, SEAT, k, live)
    return Seat(c, s, take(work, REACH, k, live), side, lever)


@jit(LANES_PAIR(ring.SEATS, MATRIX, int64, MASK), inline=True)
def centre(seat, of_points, row, live):
    """J q, or J dq: how far the inner groove centre moves (axial, radial)."""
    c, s, reach, side, lever = seat
    turn = take(of_points, row + 3, 0, live) * s - take(of_points, row + 4, 0, live) * c
    axial = side * (take(of_points, row, 0, live) + reach * turn)
    return Pair(axial, take(of_points, row + 1, 0, live) * c + take(of_points, row + 2, 0, live) * s - lever * turn)


@jit(void(int64, MASK, MATRIX, MATRIX, MATRIX), inline=True)
def _follow(k, live, of_points, bodies, work):
    """Move balls with the ring's step and by their own, and see how far their contacts approach."""
    seat = seats(k, live, work)
    (ra, rr), (li, lo) = pair_of(work, REST, k, live), pair_of(work, OFFSET, k, live)
    (ea, er), (da, dr) = centre(seat, of_points, Q, live), centre(seat, of_points, DQ, live)
    (sa, sr), t, (pa, pr) = pair_of(work, STEP, k, live), tensors_of(work, BY_CENTRE, k, live), pair_of(work, PLACE, k, live)
    sa, sr = sa + t.aa * da + t.ar * dr, sr + t.ra * da + t.rr * dr
    size, most, scale = larger(sa, -sa) + larger(sr, -sr), 0.2 * larger(lo, -lo), spread(1.0)
    if any_of(size > most):
        scale = where(size > most, most / size, 1.0)
        sa, sr = scale * sa, scale * sr
    pa, pr, ea, er = pa + sa, pr + sr, ra + ea, rr + er
    if bodies.shape[0] > 0:
        wi, wo = soft.move_shifts(k, live, Pair(ea, er), Pair(da, dr), scale, bodies, work)
        li, lo = li + wi, lo + wo
    share = take(work, SHARE, k, live)
    if any_of(share > 0.0):
        # The races in series; what lies outside of them begins anew, what nothing presses lies midway.
        length, so = root(ea * ea + er * er), root(pa * pa + pr * pr)
        deep = length - li - lo
        so = where((so > lo) & (so < lo + deep), so, lo + where(deep > 0.0, share, 0.5) * deep) / length
        pa, pr = where(share > 0.0, so * ea, pa), where(share > 0.0, so * er, pr)
    xa, xr = ea - pa, er - pr
    so, si = root(pa * pa + pr * pr), root(xa * xa + xr * xr)
    by_so, by_si = 1.0 / so, 1.0 / si
    put_pair(work, PLACE, k, live, pa, pr)
    put_pair(work, INNER, k, live, xa * by_si, xr * by_si)
    put_pair(work, OUTER, k, live, pa * by_so, pr * by_so)
    put_pair(work, BY_LENGTH, k, live, by_si, by_so)
    put_pair(work, rows.GAP, k, live, li - si, lo - so)


@jit(LANES(MATRIX, MASK), inline=True)
def _eliminate(of_points, live):
    """Solve for the step; the least pivot."""
    least = spread(np.inf)
    for c in range(5):
        pivot = take(of_points, TANGENT + 7 * c, 0, live)
        least, inverse = smaller(pivot, least), 1.0 / pivot
        for r in range(c + 1, 5):
            factor = take(of_points, TANGENT + 6 * r + c, 0, live) * inverse
            for j in range(c + 1, 6):
                entry = take(of_points, TANGENT + 6 * r + j, 0, live)
                put(of_points, TANGENT + 6 * r + j, 0, live, entry - factor * take(of_points, TANGENT + 6 * c + j, 0, live))
    for r in range(4, -1, -1):
        total = take(of_points, TANGENT + 6 * r + 5, 0, live)
        for j in range(r + 1, 5):
            total = total - take(of_points, TANGENT + 6 * r + j, 0, live) * take(of_points, DQ + j, 0, live)
        put(of_points, DQ + r, 0, live, total / take(of_points, TANGENT + 7 * r, 0, live))
    return least


@jit(at.CONTACTS(int64, MASK, MATRIX), inline=True)
def contacts_of(k, live, work):
    """Both contacts of a ball."""
    (ia, ir), (oa, orr) = pair_of(work, INNER, k, live), pair_of(work, OUTER, k, live)
    (by_si, by_so), (fi, fo) = pair_of(work, BY_LENGTH, k, live), pair_of(work, rows.CONTACT_FORCE, k, live)
    by_gap_i, by_gap_o = pair_of(work, rows.FORCE_BY_GAP, k, live)
    return BallContact(ia, ir, by_si, fi, -by_gap_i), BallContact(oa, orr, by_so, fo, -by_gap_o)


@jit(
    types.Tuple((LANES_PAIR, LANES_TENSOR, LANES, LANES_PAIR, LANES, MASK))(
        int64, MASK, boolean, at.ROLLING, MATRIX, MATRIX
    ),
    inline=True,
)
def _eliminated(k, live, rolls, rolling, bodies, work):
    """What a ball does to the ring, its own place eliminated; its next step stays in ``work``.

    That is its force [N] with the tangent by e, its couple [N m] with that, the size of its contacts' forces, and whether it still moves.
    """
    z, contacts, h, o = work.shape[1] // 2, contacts_of(k, live, work), at.no_tangential(), spread(0.0)
    (ia, ir, _, fi, ki), (oa, orr, _, fo, _) = contacts
    by_e, by_p, by_centre = Pair(o, o), Pair(o, o), Pair(o, o)
    if rolls:
        h = at.with_gyroscopic(k, live, contacts, h, rolling, work)
        balance, (by_e, by_p) = at.linear_balance(contacts, ki, o, h), at.couple_slopes(contacts, h)
    else:
        balance = at.plain_balance(contacts, ki, o)
    force_a, force_r = fi * ia + h.inner * ir, fi * ir - h.inner * ia
    ra = force_a - fo * oa - h.outer * orr
    rr = force_r - fo * orr + h.outer * oa + take(work, REACH, z + k, live)
    ball = soft.Ball(Pair(force_a, force_r), Pair(ra, rr), h.couple, by_e, by_p, balance)
    if bodies.shape[0] > 0:
        ball, fall = soft.with_compliances(k, live, contacts, h, ball, bodies, work)
    force, rest, couple, by_e, by_p, balance = ball
    j, p = at.regular(balance.j), balance.p
    scale = 1.0 / (j.aa * j.rr - j.ar * j.ra)
    inverse = Tensor(j.rr * scale, -j.ar * scale, -j.ra * scale, j.aa * scale)
    minus = Tensor(-p.aa, -p.ar, -p.ra, -p.rr)
    step, follows = less_column(Pair(o, o), inverse, rest), less(Tensor(o, o, o, o), inverse, balance.x)
    put_pair(work, STEP, k, live, step.axial, step.radial)
    put_tensors(work, BY_CENTRE, k, live, follows)
    (gap_i, gap_o), lo = pair_of(work, rows.GAP, k, live), take(work, OFFSET, z + k, live)
    least = larger(_SETTLED * at.shallower(gap_i, gap_o), 1e-14 * lo)
    moves = step.axial * step.axial + step.radial * step.radial > least * least
    if bodies.shape[0] > 0:
        moves = moves | soft.put_shifts(k, live, fall, step, follows, least, work)
    if rolls:
        couple = couple + by_p.axial * step.axial + by_p.radial * step.radial
        by_centre = less_row(by_e, Pair(-by_p.axial, -by_p.radial), follows)
    force, stiffness = less_column(force, minus, step), less(balance.e, minus, follows)
    size = larger(fi, -fi) + 1e-4 * larger(fo, -fo)
    return force, stiffness, couple, by_centre, size, moves


@jit(LANES(ring.FORCES, VECTOR, MATRIX, MASK), inline=True)
def _imbalance(force, free, of_points, live):
    """What is left of the loads, couples over the reach of the tilts, beside the tangent; the largest of it [N]."""
    arm, shaft, norm = take(of_points, ARM, 0, live), take(of_points, SHAFT, 0, live), spread(0.0)
    for i, part in enumerate(force):
        r = take(of_points, LOAD + i, 0, live) - part
        if i > 2:
            r = (r - shaft * take(of_points, Q + i, 0, live)) / arm
        r = free[i] * r
        put(of_points, TANGENT + 6 * i + 5, 0, live, r)
        size = larger(r, -r)
        norm = larger(where(size >= 0.0, size, np.inf), norm)
    return norm


@jit(LANES(ring.TANGENTS, LANES, boolean, VECTOR, MATRIX, MASK), inline=True)
def _put_tangent(tangent, shift, symmetric, free, of_points, live):
    """The tangent of all forces in lengths, tilts times their reach, held unknowns with its largest entry, which is the answer, on the diagonal.

    shift : what is added there [N/m]
    """
    arm, shaft, largest = take(of_points, ARM, 0, live), take(of_points, SHAFT, 0, live), spread(0.0)
    entries, by_arm, one = rows_of_tangent(tangent), 1.0 / arm, spread(1.0)
    for i in range(5):
        for j in range(5):
            k = 0.5 * (entries[i][j] + entries[j][i]) if symmetric else entries[i][j]
            if i == j and i > 2:
                k = k + shaft
            k = free[i] * free[j] * k * (by_arm if i > 2 else one) * (by_arm if j > 2 else one)
            if i == j:
                largest, k = larger(k, largest), k + shift
            put(of_points, TANGENT + 6 * i + j, 0, live, k)
    for i in range(5):
        if free[i] == 0.0:
            put(of_points, TANGENT + 7 * i, 0, live, largest + shift)
    return largest


@jit(void(int64, boolean, MATRIX, MATRIX, STATES))
def _scatter(first, elastic, work, of_points, states):
    """The states of the block's points out of lanes."""
    n, z = states.status.size, work.shape[1] // (2 * WIDTH)
    for lane in range(min(WIDTH, n - first)):
        p = first + lane
        states.status[p] = int(of_points[SHAFT, lane])
        for i in range(5):
            states.q[p, i] = of_points[Q + i, lane]
            for j in range(5):
                states.stiffness[p, i, j] = of_points[TANGENT + 5 * i + j, lane]
        for k in range(z):
            c, o = WIDTH * k + lane, WIDTH * (z + k) + lane
            for i in range(2, states.ball.shape[2]):
                states.ball[p, k, i] = 0.0
            states.ball[p, k, 0], states.ball[p, k, 1] = work[PLACE, c], work[PLACE, o]
            if elastic:
                states.ball[p, k, -2], states.ball[p, k, -1] = work[soft.SHIFT, c], work[soft.SHIFT, o]
            states.force[p, k], states.force[p, z + k] = work[rows.CONTACT_FORCE, c], work[rows.CONTACT_FORCE, o]


@jit(at.ROLLING(MATRIX, MASK), inline=True)
def rolling_of(of_points, live):
    """What the moments of the points' balls depend on."""
    return Rolling(
        take(of_points, ROLLS, 0, live), take(of_points, ROLLS + 1, 0, live), take(of_points, ROLLS + 2, 0, live),
        take(of_points, ROLLS + 3, 0, live), take(of_points, ROLLS + 4, 0, live), take(of_points, ROLLS + 5, 0, live),
        take(of_points, ROLLS + 6, 0, live),
    )  # fmt: skip


@jit(boolean(boolean, int64, MATRIX, int64, int64), inline=True)
def _like_before(alike, k, work, first, end):
    """Whether ball k / WIDTH of each point is like the one before, whose gaps and rows ``first`` to ``end`` it then gets."""
    live, z = live_of(0, WIDTH), work.shape[1] // 2
    if not alike or any_of(take(work, LIKE, k, live) == 0.0):
        return False
    for i in range(first - 1, end):
        row = i if i >= first else rows.GAP
        put_pair(work, row, k, live, take(work, row, k - WIDTH, live), take(work, row, z + k - WIDTH, live))
    return True


@jit(void(boolean, MATRIX, MATRIX, MATRIX), inline=True)
def move_balls(alike, of_points, bodies, work):
    """Move the balls with the ring's step and by their own; gaps of their contacts.  ``alike`` : balls of a row at the first guess are."""
    live = live_of(0, WIDTH)
    for k in range(0, work.shape[1] // 2, WIDTH):
        if not _like_before(alike, k, work, INNER, soft.CURVE + 1 if bodies.shape[0] > 0 else BY_LENGTH + 1):
            _follow(k, live, of_points, bodies, work)


@jit(
    types.Tuple((ring.FORCES, ring.TANGENTS, LANES, MASK))(boolean, boolean, at.ROLLING, LANES, MATRIX, MATRIX), inline=True
)
def ring_forces(alike, rolls, rolling, loads, bodies, work):
    """Forces of the balls on the ring and the tangent, the size of contact forces on top of the loads', whether balls still move."""
    live, none = live_of(0, WIDTH), spread(0.0)
    force, tangent, size, moves = no_force(), no_tangent(), loads, ~live
    for k in range(0, work.shape[1] // 2, WIDTH):
        seat = seats(k, live, work)
        if not _like_before(alike, k, work, STEP, INNER if bodies.shape[0] > 0 else soft.SHIFT_STEP):
            own, stiffness, couple, by_centre, forces, moving = _eliminated(k, live, rolls, rolling, bodies, work)
        force = with_force(force, seat, own.axial, own.radial, couple)
        tangent = with_tangent(tangent, seat, stiffness, Pair(none, none), by_centre, none)
        size, moves = size + forces, moves | moving
    return force, tangent, size, moves


@jit(boolean(MATRIX), inline=True)
def asks_for_rates(work):
    """Whether the law depends on rates of the gaps."""
    live, rates = live_of(0, WIDTH), ~live_of(0, WIDTH)
    for k in range(0, work.shape[1] // 2, WIDTH):
        inner, outer = pair_of(work, rows.FORCE_BY_RATE, k, live)
        rates = rates | ~(inner == 0.0) | ~(outer == 0.0)
    return any_of(rates)


@jit(boolean(LAW_POINTER, LINEAR, int64, POINTS, STATES, MATRIX, MATRIX, MATRIX, MATRIX, MATRIX))
def lockstep(law, linear, first, points, states, params, memory, bodies, work, of_points):
    """The states of ``WIDTH`` points from ``first`` on, without their damping; whether the law depends on rates.

    Their status is 0, or -1 where the iteration did not end.
    """
    live, end, free = live_of(0, WIDTH), WIDTH * points.table.shape[1], linear.free
    gather(first, points, params, bodies, work, of_points)
    rolling = rolling_of(of_points, live)
    moments, near, acts, none = rolling.scale, ~live, live, spread(0.0)
    rolls = any_of(~(moments == 0.0))
    arm, loads = take(of_points, ARM, 0, live), spread(0.0)
    for i in range(5):
        load = take(of_points, LOAD + i, 0, live)
        loads = loads + (larger(load, -load) if i < 3 else larger(load, -load) / arm)
    tangent, done, (rest_a, rest_r) = no_tangent(), ~live, pair_of(work, REST, 0, live)
    most = _LONGEST * (larger(rest_a, -rest_a) + larger(rest_r, -rest_r))
    for count in range(_ITERATIONS):
        put(of_points, ROLLS + 2, 0, live, where(acts, moments, 0.0))
        rolling = rolling_of(of_points, live)
        move_balls(count == 0, of_points, bodies, work)
        law(
            work[rows.GAP], work[rows.GAP_RATE], params, memory, memory, 0.0,
            work[rows.CONTACT_FORCE], work[rows.FORCE_BY_GAP], work[rows.FORCE_BY_RATE],
        )  # fmt: skip
        force, tangent, size, moves = ring_forces(count == 0, rolls, rolling, loads, bodies, work)
        norm = _imbalance(force, free, of_points, live)
        done = acts & ~moves & (norm <= TOLERANCE * size)
        if not any_of(~done):
            break
        acts = near = near | (norm <= _NEAR * size)
        # Where nothing holds the ring it moves along what is left of the loads.
        _put_tangent(tangent, 1e-6 * norm / most, False, free, of_points, live)
        _eliminate(of_points, live)
        size = spread(0.0)
        for i in range(5):
            step = take(of_points, DQ + i, 0, live)
            size = size + larger(step, -step)
        scale = where(size > most, most / size, 1.0)
        for i in range(5):
            step = take(of_points, DQ + i, 0, live) * (scale if i < 3 else scale / arm)
            put(of_points, DQ + i, 0, live, step)
            put(of_points, Q + i, 0, live, take(of_points, Q + i, 0, live) + step)
    largest = _put_tangent(tangent, none, True, free, of_points, live)
    done = done & (_eliminate(of_points, live) > LEAST * largest)
    for k in range(0, end, WIDTH):
        inner, outer = contacts_of(k, live, work)
        (sa, sr), (pa, pr) = pair_of(work, STEP, k, live), pair_of(work, PLACE, k, live)
        # A ball without centrifugal force that nothing presses has no place off the line of the groove centres.
        loose = (inner.force == 0.0) & (inner.stiffness == 0.0) & (take(work, REACH, end + k, live) == 0.0)
        done = done & ~(loose & (take(work, SHARE, k, live) == 0.0))
        put_pair(work, PLACE, k, live, pa + sa, pr + sr)
        closed_i = inner.force - inner.stiffness * (inner.axial * sa + inner.radial * sr)
        closed_o = outer.force + outer.stiffness * (outer.axial * sa + outer.radial * sr)
        if bodies.shape[0] > 0:
            (wi, wo), (si, so) = pair_of(work, soft.SHIFT, k, live), pair_of(work, soft.SHIFT_STEP, k, live)
            put_pair(work, soft.SHIFT, k, live, wi + si, wo + so)
            closed_i, closed_o = closed_i - inner.stiffness * si, closed_o - outer.stiffness * so
        put_pair(work, rows.CONTACT_FORCE, k, live, larger(closed_i, 0.0), larger(closed_o, 0.0))
    put(of_points, SHAFT, 0, live, where(done, 0.0, -1.0))
    for i, entries in enumerate(rows_of_tangent(tangent)):
        for j, entry in enumerate(entries):
            put(of_points, TANGENT + 5 * i + j, 0, live, entry)
    _scatter(first, bodies.shape[0] > 0, work, of_points, states)
    return asks_for_rates(work)
