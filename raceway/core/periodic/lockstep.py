"""Steady orbits of four points in lockstep, by Fourier collocation and Newton's method.

Notes
-----
The motion is sampled at N equidistant angles of its span, of the force's angle: a turn, or one ball pitch where a turning force acts
on equal balls.  Then it is looked at from the frame that turns with the force, u = R^T q, in which it repeats itself after a pitch
and its 1x part stands still: few samples do.  Derivatives are those of the trigonometric polynomial through the samples,

    M w^2 (u'' + 2 G u' + G^2 u) + C w (u' + G u) + S u + R^T f(R u) = R^T (load + F),

G the generator of R, 0 in a frame that stands.  Balls are those of ``raceway.core.ring.lockstep``, moved together with the ring, or
any that a kernel finds a place for in every sample (``forces_alone``).  A step solves the linear system by generalised conjugate
residuals: with the mean tangent it falls into harmonics.  Lanes do not feel each other beyond rounding.

References
----------
Trefethen, Spectral Methods in MATLAB (2000), chapter 3 (differentiation matrices of periodic functions).
Krack, Gross, Harmonic Balance for Nonlinear Vibration Problems (2019), chapters 2 and 4.
Eisenstat, Elman, Schultz, SIAM J. Numer. Anal. 20 (1983) 345 (generalised conjugate residuals).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import boolean, float64, int64, types, void

from raceway.core.jit import jit
from raceway.core.lanes import LANES, MASK, WIDTH, any_of, larger, live_of, put, root, smaller, spread, take, where
from raceway.core.periodic import fourier
from raceway.core.ring import kernels as ring_rows
from raceway.core.ring.elimination import copy_matrix
from raceway.core.ring.kernels.layout import (
    DAMPING,
    TIME_CONSTANT,
    keep_slips,
    no_force,
    no_tangent,
    rows_of_tangent,
    with_force,
    with_tangent,
)
from raceway.core.ring.kernels.tensors import Pair, pair_of, put_pair, tensors_of
from raceway.core.ring.lockstep import (
    ARM,
    BY_CENTRE,
    DIRECTION,
    DQ,
    LOAD,
    PLACE,
    SHAFT,
    STEP,
    TANGENT,
    Q,
    centre,
    eliminated,
    follow,
    rolling_of,
    seats,
)
from raceway.core.ring.states import KERNELS, POINTS, STATES
from raceway.core.signatures import CUBE, LAW_POINTER, MATRIX, VECTOR, Balls, Constants, Contacts, Response, record

#: Rows of a sample behind its tangent: that by the velocity, w C; imbalance; u' + G u, u'' + 2 G u' + G^2 u; the equilibrium from the frame.
VISCOUS = TANGENT + 25
IMBALANCE, RATE, BEND, CENTRE = (VISCOUS + 25 + 5 * i for i in range(4))
ROWS = CENTRE + 5
#: Rows of ``shared``, numbers of each point: w^2 mass, w damping; derivatives of the imbalance by u beside the tangent and by u'; means of
#: the tangents by u and u', and those of the harmonics' inverses; which lanes are asked for, and answers of a level.
MASS, DAMPED, FIXED, BY_RATE, MEAN, KEPT, WANTED, ANSWER = 0, 5, 30, 55, 80, 130, 180, 181
SHARED_ROWS = ANSWER + 2
#: Iterations of a level, and with balls found in every sample; the last step over the motion.
_ITERATIONS, _NESTED, _ROUNDED = 15, 30, 1e-8
#: Iterations with new inverses; columns of a step, and what they may leave of the imbalance.
_INVERSES, COLUMNS, _LEFT = 3, 12, 1e-3


class Block(NamedTuple):
    """Arrays of four points: their law's ``params`` (W 2 Z, k) and none of its ``memory``; of each sample ``work`` (N, ..., W 2 Z) and
    ``rows`` (N, ``ROWS``, W), of level n each (N / n)th; ``basis`` (2 m + 3, 5 N, W) of a step; ``shared`` (``SHARED_ROWS``, W); ``own`` for the balls of a kernel."""

    params: np.ndarray
    memory: np.ndarray
    work: np.ndarray
    rows: np.ndarray
    basis: np.ndarray
    shared: np.ndarray
    own: np.ndarray


BLOCK = record(Block, MATRIX, MATRIX, CUBE, CUBE, CUBE, MATRIX, MATRIX)


@jit(void(float64, MATRIX, MATRIX), inline=True)
def turn_directions(angle, before, after):
    """The balls' azimuths seen from a frame that has turned by an angle."""
    c, s, live = np.cos(angle), np.sin(angle), live_of(0, WIDTH)
    for k in range(0, before.shape[1] // 2, WIDTH):
        cosine, sine = pair_of(before, DIRECTION, k, live)
        put_pair(after, DIRECTION, k, live, cosine * c + sine * s, sine * c - cosine * s)


@jit(void(float64, MATRIX, MATRIX))
def put_fixed(sense, row, shared):
    """Derivatives of the imbalances by u' and, beside the tangent, by u; mass, damping and shaft are in their rows."""
    live, none = live_of(0, WIDTH), spread(0.0)
    for i in range(5):
        damping = DAMPED + 5 * i
        put(shared, FIXED + 5 * i, 0, live, none)
        for m in (1, 3):
            put(shared, FIXED + 5 * i + m, 0, live, sense * take(shared, damping + m + 1, 0, live))
            put(shared, FIXED + 5 * i + m + 1, 0, live, -sense * take(shared, damping + m, 0, live))
        for m in range(5):
            put(shared, BY_RATE + 5 * i + m, 0, live, take(shared, damping + m, 0, live))
        own = take(shared, FIXED + 6 * i, 0, live) - (sense * sense if i > 0 else 0.0) * take(shared, MASS + i, 0, live)
        put(shared, FIXED + 6 * i, 0, live, own + take(row, SHAFT, 0, live) if i > 2 else own)
    for i in (1, 3):
        twice = 2.0 * sense * take(shared, MASS + i, 0, live)
        across, back = BY_RATE + 6 * i + 1, BY_RATE + 6 * i + 5
        put(shared, across, 0, live, take(shared, across, 0, live) - twice)
        put(shared, back, 0, live, take(shared, back, 0, live) + twice)


@jit(types.UniTuple(MASK, 2)(LAW_POINTER, int64, BLOCK))
def forces(law, n, block):
    """Move the balls; forces of the contacts into the imbalances, and their tangents; which points' balls still move, and whose law asks for rates."""
    params, memory, work, rows = block.params, block.memory, block.work, block.rows
    live, stride, none, end = live_of(0, WIDTH), work.shape[0] // n, spread(0.0), work.shape[2] // 2
    rolling, moves, rates = rolling_of(rows[0], live), ~live, ~live
    rolls = any_of(~(rolling.scale == 0.0))
    for j in range(n):
        w, r = work[j * stride], rows[j * stride]
        for k in range(0, end, WIDTH):
            follow(k, live, r, w)
        law(
            w[ring_rows.GAP], w[ring_rows.GAP_RATE], params, memory, memory, 0.0,
            w[ring_rows.CONTACT_FORCE], w[ring_rows.FORCE_BY_GAP], w[ring_rows.FORCE_BY_RATE],
        )  # fmt: skip
        force, tangent = no_force(), no_tangent()
        for k in range(0, end, WIDTH):
            seat = seats(k, live, w)
            own, stiffness, couple, by_centre, _, moving = eliminated(k, live, rolls, rolling, w)
            by_rate_i, by_rate_o = pair_of(w, ring_rows.FORCE_BY_RATE, k, live)
            force = with_force(force, seat, own.axial, own.radial, couple)
            tangent = with_tangent(tangent, seat, stiffness, Pair(none, none), by_centre, none)
            moves, rates = moves | moving, rates | ~(by_rate_i == 0.0) | ~(by_rate_o == 0.0)
        for i, part in enumerate(force):
            put(r, IMBALANCE + i, 0, live, part)
        for i, entries in enumerate(rows_of_tangent(tangent)):
            for m, entry in enumerate(entries):
                put(r, TANGENT + 5 * i + m, 0, live, entry)
    return moves, rates


@jit(void(KERNELS, int64, int64, POINTS, fourier.TURNING, VECTOR, CUBE, CUBE, BLOCK), allocates=True)
def forces_alone(kernels, n, first, points, turning, derivative, places, rates, block):
    """The same of the lanes that are asked for, by a kernel that finds the balls' ``places`` (W n, Z, b) in each sample; NaN where it does not.

    derivative : its column (2 m,) over a turn, twice;  rates : of the places, of dampers, as the step before left them
    """
    f, K, C, half, turned = np.empty(5), np.empty((5, 5)), np.empty((5, 5)), np.empty((5, 5)), np.empty((5, 5))
    q, v, state, sense = np.empty(5), np.empty(5), np.empty(5), turning.sense
    response, history, stride = Response(f, K, C, block.own), np.zeros(places.shape[1:]), block.rows.shape[0] // n
    for lane in range(WIDTH):
        if block.shared[WANTED, lane] == 0.0:
            continue
        p, columns = first + lane, places.shape[2]
        w, constants, damped = turning.speed[p], Constants(points.scalars[p], points.table[p]), dampers(points, p)
        memory = np.zeros((points.params.shape[1], 0))
        contacts = Contacts(kernels.law, points.params[p], memory, memory, 0.0)
        for j in range(n):
            at, angle, ball = lane * n + j, turning.span * j / n, places[lane * n + j]
            r = block.rows[j * stride]
            for i in range(5):
                state[i] = r[Q + i, lane]
            fourier.turn_vector(sense * angle, state, q)
            for i in range(5):
                state[i] = w * r[RATE + i, lane]
            fourier.turn_vector(sense * angle, state, v)
            keep_slips(constants.scalars, ball, history)
            if damped:
                for k in range(history.shape[0]):
                    for c in range(columns):
                        if columns == kernels.columns or c < 2 or c > 3:  # slips have no rates
                            history[k, c] = rates[at, k, c]
            if kernels.system(angle / w, q, v, Balls(ball, 0.0, history), contacts, constants, response) != 0:
                f[0] = f[1] = np.nan
            fourier.turn_vector(-sense * angle, f, state)
            for i in range(5):
                r[IMBALANCE + i, lane] = state[i]
            fourier.turn_matrix(sense * angle, C, half, turned)
            for i in range(5):
                for m in range(5):
                    r[VISCOUS + 5 * i + m, lane] = w * turned[i, m]
            fourier.turn_matrix(sense * angle, K, half, turned)
            for i in range(5):
                for m in range(5):
                    r[TANGENT + 5 * i + m, lane] = turned[i, m]
                for m in (1, 3):  # w C G
                    r[TANGENT + 5 * i + m, lane] += sense * r[VISCOUS + 5 * i + m + 1, lane]
                    r[TANGENT + 5 * i + m + 1, lane] -= sense * r[VISCOUS + 5 * i + m, lane]
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
    """Of the motion by the angle."""
    live, stride = live_of(0, WIDTH), rows.shape[0] // n
    for j in range(n):
        r = rows[j * stride]
        for i in range(5):
            rate, bend = spread(0.0), spread(0.0)
            for m in range(n):
                u = take(rows[m * stride], Q + i, 0, live)
                rate, bend = rate + d1[(j - m) & (n - 1)] * u, bend + d2[(j - m) & (n - 1)] * u
            put(r, RATE + i, 0, live, rate)
            put(r, BEND + i, 0, live, bend)
        for i in (1, 3):
            (y, z), (y1, z1) = pair_at(r, Q + i, live), pair_at(r, RATE + i, live)
            y2, z2 = pair_at(r, BEND + i, live)
            put(r, BEND + i, 0, live, y2 - sense * (2.0 * z1 + sense * y))
            put(r, BEND + i + 1, 0, live, z2 + sense * (2.0 * y1 - sense * z))
            put(r, RATE + i, 0, live, y1 - sense * z)
            put(r, RATE + i + 1, 0, live, z1 + sense * y)


@jit(types.UniTuple(LANES, 2)(MATRIX, int64, MASK), inline=True)
def pair_at(rows, row, live):
    """A row and the next one."""
    return take(rows, row, 0, live), take(rows, row + 1, 0, live)


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
                entry = entry + take(shared, FIXED + i, 0, live)
                low, high, size = smaller(entry, low), larger(entry, high), size + (0.5 / n) * larger(entry, -entry)
        put(shared, MEAN + i, 0, live, mean)
    for j in range(n):
        r = rows[j * stride]
        shaft = take(r, SHAFT, 0, live)
        for i in range(5):
            left = take(r, IMBALANCE + i, 0, live) - take(r, LOAD + i, 0, live)
            left = left + take(shared, MASS + i, 0, live) * take(r, BEND + i, 0, live)
            if i > 2:
                left = left + shaft * take(r, Q + i, 0, live)
            for m in range(5):
                left = left + take(shared, DAMPED + 5 * i + m, 0, live) * take(r, RATE + m, 0, live)
            put(r, IMBALANCE + i, 0, live, left)
    return (high - low) / size


@jit(void(int64, float64, int64[::1], MATRIX, MATRIX))
def _invert(n, wave, dofs, inverse, shared):
    """Inverse dynamic stiffness of each harmonic under the mean tangent, without pivots: complex entries (n / 2 + 1, d, d, 2) in rows.

    wave : 2 pi over the span
    """
    live, d = live_of(0, WIDTH), dofs.size
    for i in range(50):
        put(shared, KEPT + i, 0, live, take(shared, MEAN + i, 0, live))
    for h in range(n // 2 + 1):
        first, along = 2 * d * d * h, 0.0 if h == n // 2 else wave * h
        for a in range(d):
            for b in range(d):
                entry, row = 5 * dofs[a] + dofs[b], first + 2 * (d * a + b)
                re = take(shared, MEAN + entry, 0, live) + take(shared, FIXED + entry, 0, live)
                if a == b:
                    re = re - (wave * h) ** 2 * take(shared, MASS + dofs[a], 0, live)
                put(inverse, row, 0, live, re)
                by_rate = take(shared, MEAN + 25 + entry, 0, live) + take(shared, BY_RATE + entry, 0, live)
                put(inverse, row + 1, 0, live, along * by_rate)
        for c in range(d):
            own = first + 2 * d * c
            p, q = take(inverse, own + 2 * c, 0, live), take(inverse, own + 2 * c + 1, 0, live)
            size = 1.0 / (p * p + q * q)
            p, q = p * size, -(q * size)
            for k in range(0, 2 * d, 2):
                x, y = take(inverse, own + k, 0, live), take(inverse, own + k + 1, 0, live)
                put(inverse, own + k, 0, live, p if k == 2 * c else x * p - y * q)
                put(inverse, own + k + 1, 0, live, q if k == 2 * c else x * q + y * p)
            for a in range(d):
                if a == c:
                    continue
                row = first + 2 * d * a
                p, q = take(inverse, row + 2 * c, 0, live), take(inverse, row + 2 * c + 1, 0, live)
                for k in range(0, 2 * d, 2):
                    x, y = take(inverse, own + k, 0, live), take(inverse, own + k + 1, 0, live)
                    u, v = take(inverse, row + k, 0, live), take(inverse, row + k + 1, 0, live)
                    u, v = (spread(0.0), spread(0.0)) if k == 2 * c else (u, v)
                    put(inverse, row + k, 0, live, u - p * x + q * y)
                    put(inverse, row + k + 1, 0, live, v - p * y - q * x)


@jit(void(int64, int64[::1], MATRIX, MATRIX, MATRIX, MATRIX), allocates=True)
def _by_harmonics(n, dofs, circle, inverse, left, out):
    """``out`` (5 n, lanes), what answers forces ``left`` by each harmonic's dynamic stiffness; ``circle`` : cosines and sines (2, n) of a span."""
    live, d = live_of(0, WIDTH), dofs.size
    cosine, sine = circle[0], circle[1]
    lines = np.empty((2 * dofs.size, WIDTH))
    for row in range(5 * n):
        put(out, row, 0, live, spread(0.0))
    for h in range(n // 2 + 1):
        times = (1.0 if h == 0 or h == n // 2 else 2.0) / n
        for a in range(d):
            re, im = spread(0.0), spread(0.0)
            for j in range(n):
                part = take(left, 5 * j + dofs[a], 0, live)
                re, im = re + cosine[h * j & (n - 1)] * part, im - sine[h * j & (n - 1)] * part
            put(lines, 2 * a, 0, live, times * re)
            put(lines, 2 * a + 1, 0, live, times * im)
        for a in range(d):
            re, im, first = spread(0.0), spread(0.0), 2 * d * (d * h + a)
            for b in range(d):
                p, q = take(inverse, first + 2 * b, 0, live), take(inverse, first + 2 * b + 1, 0, live)
                x, y = take(lines, 2 * b, 0, live), take(lines, 2 * b + 1, 0, live)
                re, im = re + (p * x - q * y), im + (p * y + q * x)
            for j in range(n):
                row = 5 * j + dofs[a]
                part = cosine[h * j & (n - 1)] * re - sine[h * j & (n - 1)] * im
                put(out, row, 0, live, take(out, row, 0, live) + part)


@jit(LANES(int64, LANES, MATRIX, MATRIX), inline=True)
def _product(n, by_arm, a, b):
    """The inner product of two columns of forces (5 n, lanes), couples over the reach of the tilts."""
    live, forces, couples = live_of(0, WIDTH), spread(0.0), spread(0.0)
    for j in range(n):
        for i in range(5):
            part = take(a, 5 * j + i, 0, live) * take(b, 5 * j + i, 0, live)
            if i < 3:
                forces = forces + part
            else:
                couples = couples + part
    return forces + by_arm * by_arm * couples


@jit(void(MATRIX, MATRIX, LANES, int64), inline=True)
def _add(to, column, times, n):
    """Add a multiple of a column (5 n, lanes) to another."""
    live = live_of(0, WIDTH)
    for row in range(5 * n):
        put(to, row, 0, live, take(to, row, 0, live) + times * take(column, row, 0, live))


@jit(void(int64, boolean, int64[::1], VECTOR, MATRIX, MATRIX, CUBE, CUBE, MATRIX), allocates=True)
def _steps(n, viscous, dofs, d1, circle, inverse, rows, basis, shared):
    """Newton's steps of all samples, by generalised conjugate residuals.

    With the mean tangent a system of harmonics is exact: what that leaves of a column is the change of the tangent along the motion times
    its answer. ``basis`` : answers and what they leave, remaining imbalance, step and a slope, (2 m + 3, 5 n, lanes).
    """
    live, stride, most = live_of(0, WIDTH), rows.shape[0] // n, basis.shape[0] // 2 - 1
    left, step, slope, by_arm = basis[2 * most], basis[2 * most + 1], basis[2 * most + 2], 1.0 / take(rows[0], ARM, 0, live)
    for j in range(n):
        for i in range(5):
            put(left, 5 * j + i, 0, live, spread(0.0))
            put(step, 5 * j + i, 0, live, spread(0.0))
        for i in dofs:
            put(left, 5 * j + i, 0, live, -take(rows[j * stride], IMBALANCE + i, 0, live))
    start = _product(n, by_arm, left, left)
    goes_on = start > 0.0
    for m in range(most):
        answer, force = basis[m], basis[most + m]
        _by_harmonics(n, dofs, circle, inverse, left, answer)
        for row in range(5 * n if viscous else 0):
            total = spread(0.0)
            for j in range(n):
                total = total + d1[(row // 5 - j) & (n - 1)] * take(answer, 5 * j + row % 5, 0, live)
            put(slope, row, 0, live, total)
        for j in range(n):
            r = rows[j * stride]
            for i in range(5):
                put(force, 5 * j + i, 0, live, take(left, 5 * j + i, 0, live))
            for i in dofs:
                total = take(left, 5 * j + i, 0, live)
                for k in dofs:
                    change = take(r, TANGENT + 5 * i + k, 0, live) - take(shared, KEPT + 5 * i + k, 0, live)
                    total = total + change * take(answer, 5 * j + k, 0, live)
                    if viscous:
                        change = take(r, VISCOUS + 5 * i + k, 0, live) - take(shared, KEPT + 25 + 5 * i + k, 0, live)
                        total = total + change * take(slope, 5 * j + k, 0, live)
                put(force, 5 * j + i, 0, live, total)
        for k in range(m):
            share = -_product(n, by_arm, force, basis[most + k])
            _add(force, basis[most + k], share, n)
            _add(answer, basis[k], share, n)
        size = _product(n, by_arm, force, force)
        share = where(size > 0.0, 1.0 / root(where(size > 0.0, size, 1.0)), 0.0)
        for row in range(5 * n):
            put(force, row, 0, live, share * take(force, row, 0, live))
            put(answer, row, 0, live, share * take(answer, row, 0, live))
        share = where(goes_on, _product(n, by_arm, left, force), 0.0)
        _add(step, answer, share, n)
        _add(left, force, -share, n)
        goes_on = _product(n, by_arm, left, left) > _LEFT * _LEFT * start
        if not any_of(goes_on):
            break
    for j in range(n):
        for i in range(5):
            put(rows[j * stride], DQ + i, 0, live, take(step, 5 * j + i, 0, live))


@jit(
    types.Tuple((MASK, LANES, LANES))(
        KERNELS, boolean, int64, int64, POINTS, STATES, fourier.TURNING, int64[::1], float64, BLOCK
    ),
    allocates=True,
)
def solve_level(kernels, alone, n, first, points, states, turning, dofs, closeness, block):
    """Converged lanes of n samples, last step over the motion, and change of the radial stiffness over its mean.

    alone : whether a kernel finds the balls in each sample;  closeness : last step over the motion
    """
    live, rows, shared, span, d = live_of(0, WIDTH), block.rows, block.shared, turning.span, dofs.size
    d1, d2, total = np.empty(n), np.empty(n), n * int(np.round(2.0 * np.pi / span))
    circle, inverse = np.empty((2, n)), np.empty((2 * d * d * (n // 2 + 1), WIDTH))
    for j in range(n):
        circle[0, j], circle[1, j] = np.cos(2.0 * np.pi * j / n), np.sin(2.0 * np.pi * j / n)
    fourier.circulants(n, span, d1, d2)
    places = np.empty((WIDTH * n * alone, states.ball.shape[1], states.ball.shape[2]))
    rates, derivative, damped = np.zeros(places.shape), np.empty(2 * total * alone), False
    if alone:
        fourier.circulants(total, 2.0 * np.pi, derivative[:total], np.empty(total))
        for j in range(total):
            derivative[total + j] = derivative[j]
        for lane in range(min(WIDTH, states.status.size - first)):
            for j in range(n):
                copy_matrix(states.ball[first + lane], places[lane * n + j])
            damped |= dampers(points, first + lane)
    before, error, change = spread(np.inf), spread(np.inf), spread(0.0)
    done, lost, moves = ~(take(shared, WANTED, 0, live) > 0.0), ~live, ~live
    for count in range(_NESTED if alone else _ITERATIONS):
        _derivatives(n, turning.sense, d1, d2, rows)
        if alone:
            forces_alone(kernels, n, first, points, turning, derivative, places, rates, block)
        else:
            moves, _ = forces(kernels.law, n, block)
        change = _imbalances(n, rows, shared)
        if count < _INVERSES:
            _invert(n, 2.0 * np.pi / span, dofs, inverse, shared)
        _steps(n, alone, dofs, d1, circle, inverse, rows, block.basis, shared)
        step, size = spread(0.0), spread(1e-300)
        for j in range(n):
            r = rows[j * (rows.shape[0] // n)]
            arm = take(r, ARM, 0, live)
            for i in range(5):
                weight, dq = arm if i > 2 else spread(1.0), where(done, 0.0, take(r, DQ + i, 0, live))
                u = take(r, Q + i, 0, live) + dq
                put(r, DQ + i, 0, live, dq)
                put(r, Q + i, 0, live, u)
                dq, away = dq * weight, (u - take(r, CENTRE + i, 0, live)) * weight
                step = larger(larger(dq, -dq), step) + (dq - dq)  # what is no number stays none
                if i > 0:
                    size = larger(larger(away, -away), size)
        fine = (step <= closeness * size) | ((step <= _ROUNDED * size) & (step > 0.5 * before))
        error, before = where(done, error, step / size), step
        lost = lost | ~(step < 1e-2)
        if count > 2 or not damped:
            done = done | (~moves & fine)
        put(shared, WANTED, 0, live, where(done | lost, 0.0, 1.0))
        if not any_of(~(done | lost)):
            break
    return done & ~lost, error, change


@jit(void(int64, boolean, float64, float64, BLOCK), allocates=True)
def double(n, alone, sense, span, block):
    """Samples between those of a level: the trigonometric polynomial there, balls as they follow the ring from the sample before."""
    work, rows, live = block.work, block.rows, live_of(0, WIDTH)
    weight, stride = np.empty(n), rows.shape[0] // n
    for m in range(n):
        angle = np.pi * (2 * m + 1) / n
        weight[m] = np.sin(0.5 * n * angle) / (n * np.tan(0.5 * angle))
    for j in range(n):
        at, between = j * stride, j * stride + stride // 2
        copy_matrix(rows[at], rows[between])
        for i in range(5):
            u = spread(0.0)
            for m in range(n):
                u = u + weight[(j - m) & (n - 1)] * take(rows[m * stride], Q + i, 0, live)
            put(rows[between], Q + i, 0, live, u)
            put(rows[at], DQ + i, 0, live, spread(0.0))
            put(rows[between], DQ + i, 0, live, spread(0.0))
        if alone:
            continue
        copy_matrix(work[at], work[between])
        turn_directions(sense * span * 0.5 / n, work[at], work[between])
        for k in range(0, work.shape[2] // 2, WIDTH):
            ea, er = centre(seats(k, live, work[at]), rows[at], Q, live)
            fa, fr = centre(seats(k, live, work[between]), rows[between], Q, live)
            t, (pa, pr) = tensors_of(work[at], BY_CENTRE, k, live), pair_of(work[at], PLACE, k, live)
            ea, er = fa - ea, fr - er
            put_pair(work[between], PLACE, k, live, pa + t.aa * ea + t.ar * er, pr + t.ra * ea + t.rr * er)
            put_pair(work[between], STEP, k, live, spread(0.0), spread(0.0))
