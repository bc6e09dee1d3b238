"""Steady orbits of four points in lockstep, by Fourier collocation and Newton's method.

The motion is sampled at N equidistant angles of its span, of the force's angle: a turn, or one ball pitch where a turning force acts
on equal balls.  Then it is looked at from the frame that turns with the force, u = R^T q, in which it repeats itself after a pitch
and its 1x part stands still: few samples do.  Derivatives are those of the trigonometric polynomial through the samples,

    M w^2 (u'' + 2 G u' + G^2 u) + C w (u' + G u) + S u + R^T f(R u) = R^T (load + F),

G the generator of R, 0 in a frame that stands.  Balls are those of ``raceway.core.ring.lockstep``, moved together with the ring, or
any that a kernel finds a place for in every sample (``forces_alone``); steps are those of ``raceway.core.periodic.steps``.  Lanes do not
feel each other beyond rounding.

Trefethen, Spectral Methods in MATLAB (2000), chapter 3 (differentiation matrices of periodic functions).
Krack, Gross, Harmonic Balance for Nonlinear Vibration Problems (2019), chapters 2 and 4.
"""

import numpy as np
from numba import boolean, float64, int64, types, void

from raceway.core.jit import jit
from raceway.core.lanes import LANES, MASK, WIDTH, any_of, larger, live_of, put, smaller, spread, take, where
from raceway.core.periodic import fourier
from raceway.core.periodic import steps as at
from raceway.core.periodic.steps import invert, newton_steps
from raceway.core.ring import kernels as ring_rows
from raceway.core.ring.elimination import copy_matrix
from raceway.core.ring.kernels import rolling as roll
from raceway.core.ring.kernels.layout import DAMPING, TIME_CONSTANT, keep_slips, no_tangent, rows_of_tangent, with_tangent
from raceway.core.ring.kernels.tensors import (
    Pair,
    Tensor,
    less,
    less_row,
    pair_of,
    put_pair,
    row_times_adjugate,
    times_adjugate,
)
from raceway.core.ring.lockstep import (
    AHEAD,
    ARM,
    DQ,
    INNER,
    LOAD,
    OUTER,
    PLACE,
    PLACE_RATE,
    SHAFT,
    TANGENT,
    Q,
    centre,
    contacts_of,
    move_balls,
    ring_forces,
    rolling_of,
    seats,
)
from raceway.core.signatures import (
    CUBE,
    KERNELS,
    LAW_POINTER,
    MATRIX,
    POINTS,
    STATES,
    VECTOR,
    Balls,
    Constants,
    Contacts,
    Response,
)

#: Iterations of a level, and with balls found in every sample; the last step over the motion.
_ITERATIONS, _NESTED, _ROUNDED = 15, 30, 1e-8
#: Step over the one before from which on dampers are left to a kernel.
_SLOW = 0.3
#: Iterations with new inverses.
_INVERSES = 3


@jit(types.UniTuple(LANES, 2)(MATRIX, int64, MASK), inline=True)
def pair_at(rows, row, live):
    """A row and the next one."""
    return take(rows, row, 0, live), take(rows, row + 1, 0, live)


@jit(void(int64, int64[::1], VECTOR, at.BLOCK))
def _move_with_rates(n, order, derivative, block):
    """Move the balls of all samples; rates of their places, ``fourier.ball_rates`` in lanes."""
    live, w, stride = live_of(0, WIDTH), take(block.shared, at.SPEED, 0, live_of(0, WIDTH)), block.rows.shape[0] // n
    total = derivative.size // 2
    for j in range(n):
        move_balls(False, block.rows[j * stride], block.bodies, block.work[j * stride])
    for k in range(block.work.shape[2] // (2 * WIDTH)):
        for j in range(n):
            axial, radial, follower = spread(0.0), spread(0.0), k
            for m in range(total // n):
                for i in range(n):
                    a, r = pair_of(block.work[i * stride], PLACE, WIDTH * follower, live)
                    weight = derivative[total - m * n - i + j]
                    axial, radial = axial + weight * a, radial + weight * r
                follower = order[follower]
            put_pair(block.work[j * stride], PLACE_RATE, WIDTH * k, live, w * axial, w * radial)


@jit(void(LAW_POINTER, MATRIX, at.BLOCK, MATRIX))
def _damped_forces(law, of_points, block, work):
    """Forces of contacts with dashpots or time constants and their derivatives, see ``layout.normal_forces``, of balls with known rates."""
    live, shared, memory = live_of(0, WIDTH), block.shared, block.memory
    c, tau, w = take(shared, at.DASHPOT, 0, live), take(shared, at.TIME, 0, live), take(shared, at.SPEED, 0, live)
    for k in range(0, work.shape[1] // 2, WIDTH):
        (ia, ir), (oa, orr) = pair_of(work, INNER, k, live), pair_of(work, OUTER, k, live)
        (ea, er), (pa, pr) = centre(seats(k, live, work), of_points, at.RATE, live), pair_of(work, PLACE_RATE, k, live)
        rate_i, rate_o = -(ia * (w * ea - pa) + ir * (w * er - pr)), -(oa * pa + orr * pr)
        put_pair(work, ring_rows.GAP_RATE, k, live, rate_i, rate_o)
        gap_i, gap_o = pair_of(work, ring_rows.GAP, k, live)
        ahead_i = where(gap_i < 0.0, gap_i + larger(tau * rate_i, gap_i), gap_i)
        ahead_o = where(gap_o < 0.0, gap_o + larger(tau * rate_o, gap_o), gap_o)
        put_pair(work, AHEAD, k, live, ahead_i, ahead_o)
    law(
        work[AHEAD], work[ring_rows.GAP_RATE], block.params, memory, memory, 0.0,
        work[ring_rows.CONTACT_FORCE], work[ring_rows.FORCE_BY_GAP], work[ring_rows.FORCE_BY_RATE],
    )  # fmt: skip
    for k in range(0, work.shape[1], WIDTH):
        gap, rate = take(work, ring_rows.GAP, k, live), take(work, ring_rows.GAP_RATE, k, live)
        by_gap, by_rate = take(work, ring_rows.FORCE_BY_GAP, k, live), take(work, ring_rows.FORCE_BY_RATE, k, live)
        limited = (tau > 0.0) & (gap < 0.0) & (tau * rate <= gap)
        by_rate = by_rate + where(limited, 0.0, tau * by_gap)
        by_gap = where(limited, 2.0 * by_gap, by_gap)
        force = take(work, ring_rows.CONTACT_FORCE, k, live)
        closed = (gap < 0.0) & (c > 0.0) & (tau == 0.0)
        total = force - c * rate
        pulls, pushes = closed & (total <= 0.0), closed & (total > 0.0)
        put(work, ring_rows.CONTACT_FORCE, k, live, where(pulls, 0.0, where(pushes, total, force)))
        put(work, ring_rows.FORCE_BY_GAP, k, live, where(pulls, 0.0, by_gap))
        put(work, ring_rows.FORCE_BY_RATE, k, live, where(pulls, 0.0, where(pushes, by_rate - c, by_rate)))


@jit(void(boolean, roll.ROLLING, float64, LANES, MATRIX, MATRIX))
def _put_damping(rolls, rolling, sense, w, r, work):
    """The tangent by the velocity, w C, each ball's place eliminated, and what it adds to that by u in a frame that turns, w C G."""
    live, none, damping = live_of(0, WIDTH), spread(0.0), no_tangent()
    nothing = Pair(none, none)
    for k in range(0, work.shape[1] // 2, WIDTH):
        contacts, by_velocity = contacts_of(k, live, work), nothing
        (by_rate, _), elastic = pair_of(work, ring_rows.FORCE_BY_RATE, k, live), contacts[0].stiffness
        h = roll.no_tangential()
        b = roll.plain_balance(contacts, elastic, -by_rate)
        if rolls:
            h = roll.with_gyroscopic(k, live, contacts, h, rolling, work)
            b = roll.linear_balance(contacts, elastic, -by_rate, h)
        j = roll.regular(b.j)
        inverse = 1.0 / (j.aa * j.rr - j.ar * j.ra)
        t = times_adjugate(b.p, j)
        t = Tensor(t.aa * inverse, t.ar * inverse, t.ra * inverse, t.rr * inverse)
        if rolls:
            u = row_times_adjugate(roll.couple_slopes(contacts, h)[1], j)
            by_velocity = less_row(nothing, Pair(u.axial * inverse, u.radial * inverse), b.m)
        damping = with_tangent(damping, seats(k, live, work), less(b.m, t, b.m), nothing, by_velocity, none)
    for i, entries in enumerate(rows_of_tangent(damping)):
        for m, entry in enumerate(entries):
            put(r, at.VISCOUS + 5 * i + m, 0, live, w * entry)
        for m in (1, 3):
            y, z = pair_at(r, at.VISCOUS + 5 * i + m, live)
            entry = TANGENT + 5 * i + m
            put(r, entry, 0, live, take(r, entry, 0, live) + sense * z)
            put(r, entry + 1, 0, live, take(r, entry + 1, 0, live) - sense * y)


@jit(MASK(LAW_POINTER, boolean, float64, int64, at.BLOCK))
def forces(law, damped, sense, n, block):
    """Move the balls; forces of the contacts into the imbalances, and their tangents; which points' balls still move."""
    rows, live, none, memory = block.rows, live_of(0, WIDTH), spread(0.0), block.memory
    rolling, moves, stride = rolling_of(rows[0], live), ~live, rows.shape[0] // n
    rolls = any_of(~(rolling.scale == 0.0))
    for j in range(n):
        r, work = rows[j * stride], block.work[j * stride]
        if damped:  # the balls are where their rates are known
            _damped_forces(law, r, block, work)
        else:
            move_balls(False, r, block.bodies, work)
            law(
                work[ring_rows.GAP], work[ring_rows.GAP_RATE], block.params, memory, memory, 0.0,
                work[ring_rows.CONTACT_FORCE], work[ring_rows.FORCE_BY_GAP], work[ring_rows.FORCE_BY_RATE],
            )  # fmt: skip
        force, tangent, _, moving = ring_forces(False, rolls, rolling, none, block.bodies, work)
        moves = moves | moving
        for i, part in enumerate(force):
            put(r, at.IMBALANCE + i, 0, live, part)
        for i, entries in enumerate(rows_of_tangent(tangent)):
            for m, entry in enumerate(entries):
                put(r, TANGENT + 5 * i + m, 0, live, entry)
        if damped:
            _put_damping(rolls, rolling, sense, take(block.shared, at.SPEED, 0, live), r, work)
    return moves


@jit(void(KERNELS, int64, int64, POINTS, fourier.TURNING, VECTOR, CUBE, CUBE, at.BLOCK), allocates=True)
def forces_alone(kernels, n, first, points, turning, derivative, places, rates, block):
    """The same of the lanes that are asked for, by a kernel that finds the balls' ``places`` (W n, Z, b) in each sample; NaN where it does not.

    derivative : its column (2 m,) over a turn, twice;  rates : of the places, of dampers, as the step before left them
    """
    f, K, C, half, turned = np.empty(5), np.empty((5, 5)), np.empty((5, 5)), np.empty((5, 5)), np.empty((5, 5))
    q, v, state, sense = np.empty(5), np.empty(5), np.empty(5), turning.sense
    response, history, stride = Response(f, K, C, block.own), np.zeros(places.shape[1:]), block.rows.shape[0] // n
    for lane in range(WIDTH):
        if block.shared[at.WANTED, lane] == 0.0:
            continue
        p, columns = first + lane, places.shape[2]
        w, constants, damped = turning.speed[p], Constants(points.scalars[p], points.table[p]), dampers(points, p)
        memory = np.zeros((points.params.shape[1], 0))
        contacts = Contacts(kernels.law, points.params[p], memory, memory, 0.0)
        for j in range(n):
            angle, ball = turning.span * j / n, places[lane * n + j]
            r, cosine, sine = block.rows[j * stride], np.cos(sense * angle), np.sin(sense * angle)
            for i in range(5):
                state[i] = r[Q + i, lane]
            fourier.turn_vector(cosine, sine, state, q)
            for i in range(5):
                state[i] = w * r[at.RATE + i, lane]
            fourier.turn_vector(cosine, sine, state, v)
            keep_slips(constants.scalars, ball, history)
            if damped:
                for k in range(history.shape[0]):
                    for c in range(columns):
                        if columns == kernels.columns or c < 2 or c > 3:  # slips have no rates
                            history[k, c] = rates[lane * n + j, k, c]
            if kernels.system(angle / w, q, v, Balls(ball, 0.0, history), contacts, constants, response) != 0:
                f[0] = f[1] = np.nan
            fourier.turn_vector(cosine, -sine, f, state)
            for i in range(5):
                r[at.IMBALANCE + i, lane] = state[i]
            fourier.turn_matrix(cosine, sine, C, half, turned)
            for i in range(5):
                for m in range(5):
                    r[at.VISCOUS + 5 * i + m, lane] = w * turned[i, m]
            fourier.turn_matrix(cosine, sine, K, half, turned)
            for i in range(5):
                for m in range(5):
                    r[TANGENT + 5 * i + m, lane] = turned[i, m]
                for m in (1, 3):  # w C G
                    r[TANGENT + 5 * i + m, lane] += sense * r[at.VISCOUS + 5 * i + m + 1, lane]
                    r[TANGENT + 5 * i + m + 1, lane] -= sense * r[at.VISCOUS + 5 * i + m, lane]
            for k in range(block.own.shape[1]):
                block.work[j * stride, ring_rows.CONTACT_FORCE, k * WIDTH + lane] = block.own[ring_rows.CONTACT_FORCE, k]
        if damped:
            fourier.ball_rates(
                places[lane * n : (lane + 1) * n], turning.order, derivative, w, rates[lane * n : (lane + 1) * n]
            )


@jit(boolean(POINTS, int64), inline=True)
def dampers(points, p):
    """Whether a point's contacts are damped beside their law."""
    return points.scalars[p, DAMPING] != 0.0 or points.scalars[p, TIME_CONSTANT] != 0.0


@jit(void(int64, float64, VECTOR, VECTOR, CUBE))
def _derivatives(n, sense, d1, d2, rows):
    live, stride = live_of(0, WIDTH), rows.shape[0] // n
    for j in range(n):
        r = rows[j * stride]
        for i in range(5):
            rate, bend = spread(0.0), spread(0.0)
            for m in range(n):
                u = take(rows[m * stride], Q + i, 0, live)
                rate, bend = rate + d1[(j - m) & (n - 1)] * u, bend + d2[(j - m) & (n - 1)] * u
            put(r, at.RATE + i, 0, live, rate)
            put(r, at.BEND + i, 0, live, bend)
        for i in (1, 3):
            (y, z), (y1, z1) = pair_at(r, Q + i, live), pair_at(r, at.RATE + i, live)
            y2, z2 = pair_at(r, at.BEND + i, live)
            put(r, at.BEND + i, 0, live, y2 - sense * (2.0 * z1 + sense * y))
            put(r, at.BEND + i + 1, 0, live, z2 + sense * (2.0 * y1 - sense * z))
            put(r, at.RATE + i, 0, live, y1 - sense * z)
            put(r, at.RATE + i + 1, 0, live, z1 + sense * y)


@jit(LANES(int64, CUBE, MATRIX))
def _imbalances(n, rows, shared):
    """What inertia, damping, shaft and loads leave of the forces, and means of the tangents; the change of the radial stiffness over its mean."""
    live, stride = live_of(0, WIDTH), rows.shape[0] // n
    low, high, size = spread(np.inf), spread(-np.inf), spread(1e-300)
    for i in range(50):
        mean = spread(0.0)
        for j in range(n):
            entry = take(rows[j * stride], TANGENT + i, 0, live)
            mean = mean + (1.0 / n) * entry
            if i == 6 or i == 12:
                entry = entry + take(shared, at.FIXED + i, 0, live)
                low, high, size = smaller(entry, low), larger(entry, high), size + (0.5 / n) * larger(entry, -entry)
        put(shared, at.MEAN + i, 0, live, mean)
    for j in range(n):
        r = rows[j * stride]
        shaft = take(r, SHAFT, 0, live)
        for i in range(5):
            left = take(r, at.IMBALANCE + i, 0, live) - take(r, LOAD + i, 0, live)
            left = left + take(shared, at.MASS + i, 0, live) * take(r, at.BEND + i, 0, live)
            if i > 2:
                left = left + shaft * take(r, Q + i, 0, live)
            for m in range(5):
                left = left + take(shared, at.DAMPED + 5 * i + m, 0, live) * take(r, at.RATE + m, 0, live)
            put(r, at.IMBALANCE + i, 0, live, left)
    return (high - low) / size


@jit(
    types.Tuple((MASK, LANES, LANES))(
        KERNELS, boolean, int64, int64, POINTS, STATES, fourier.TURNING, int64[::1], float64, at.BLOCK
    ),
    allocates=True,
)
def solve_level(kernels, alone, n, first, points, states, turning, dofs, closeness, block):
    """Converged lanes of n samples, last step over the motion, and change of the radial stiffness over its mean.

    alone : whether a kernel finds the balls in each sample;  closeness : last step over the motion
    """
    live, rows, shared, span, d = live_of(0, WIDTH), block.rows, block.shared, turning.span, dofs.size
    d1, d2, total = np.empty(n), np.empty(n), n * int(np.round(2.0 * np.pi / span))
    circle, inverse = np.empty(2 * n), np.empty((2 * d * d * (n // 2 + 1), WIDTH))
    fourier.circle(n, circle)
    fourier.circulants(n, span, d1, d2)
    places = np.empty((WIDTH * n * alone, states.ball.shape[1], states.ball.shape[2]))
    rates, derivative, damped = np.zeros(places.shape), np.empty(2 * total), False
    for lane in range(min(WIDTH, states.status.size - first)):
        damped |= dampers(points, first + lane)
        for j in range(n if alone else 0):
            copy_matrix(states.ball[first + lane], places[lane * n + j])
    if alone or damped:
        fourier.circulants(total, 2.0 * np.pi, derivative[:total], np.empty(total))
        for j in range(total):
            derivative[total + j] = derivative[j]
    before, error, change = spread(np.inf), spread(np.inf), spread(0.0)
    done, lost, moves = ~(take(shared, at.WANTED, 0, live) > 0.0), ~live, ~live
    loose = live if closeness > _ROUNDED else ~live  # balls settle among more samples
    for count in range(_NESTED if alone or damped else _ITERATIONS):
        _derivatives(n, turning.sense, d1, d2, rows)
        if alone:
            forces_alone(kernels, n, first, points, turning, derivative, places, rates, block)
        else:
            if damped:
                _move_with_rates(n, turning.order, derivative, block)
            moves = forces(kernels.law, damped, turning.sense, n, block)
        change = _imbalances(n, rows, shared)
        if count < _INVERSES:
            invert(n, 2.0 * np.pi / span, dofs, inverse, shared)
        newton_steps(n, alone or damped, dofs, d1, circle, inverse, rows, block.basis, shared)
        step, size = spread(0.0), spread(1e-300)
        for j in range(n):
            r = rows[j * (rows.shape[0] // n)]
            arm = take(r, ARM, 0, live)
            for i in range(5):
                weight, dq = arm if i > 2 else spread(1.0), where(done, 0.0, take(r, DQ + i, 0, live))
                u = take(r, Q + i, 0, live) + dq
                put(r, DQ + i, 0, live, dq)
                put(r, Q + i, 0, live, u)
                dq, away = dq * weight, (u - take(r, at.CENTRE + i, 0, live)) * weight
                step = larger(larger(dq, -dq), step) + (dq - dq)  # what is no number stays none
                if i > 0:
                    size = larger(larger(away, -away), size)
        fine = (step <= closeness * size) | ((step <= _ROUNDED * size) & (step > 0.5 * before))
        lost = lost | ~(step < 1e-2)
        if (
            damped and not alone and count > 3
        ):  # a ball follows its rates by as much as its dampers bear: a kernel is quicker
            lost = lost | ((step > _SLOW * before) & (step > _ROUNDED * size) & ~done)
        error, before = where(done, error, step / size), step
        if count > (2 if alone else 0) or not damped:  # a kernel knows the rates that its last step left
            done = done | (fine & (loose | ~moves))
        put(shared, at.WANTED, 0, live, where(done | lost, 0.0, 1.0))
        if not any_of(~(done | lost)):
            break
    return done & ~lost, error, change
