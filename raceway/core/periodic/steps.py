"""Arrays of four points' samples, which their steady orbits are solved in, and Newton's steps there, by generalised conjugate residuals.

With the mean tangent of the samples the linear system falls into harmonics, whose inverses answer each column.

Eisenstat, Elman, Schultz, SIAM J. Numer. Anal. 20 (1983) 345.
"""

from typing import NamedTuple

import numpy as np
from numba import boolean, float64, int64, void

from raceway.core.jit import jit
from raceway.core.lanes import LANES, WIDTH, any_of, live_of, put, root, spread, take, where
from raceway.core.ring.compliances import SHIFT, SHIFT_BY_E, SHIFT_STEP
from raceway.core.ring.elimination import copy_matrix
from raceway.core.ring.kernels import GAP_RATE
from raceway.core.ring.kernels.tensors import pair_of, put_pair, tensors_of
from raceway.core.ring.lockstep import ARM, BY_CENTRE, DIRECTION, DQ, INNER, PLACE, SHAFT, STEP, TANGENT, Q, centre, seats
from raceway.core.signatures import CUBE, MATRIX, VECTOR, record

#: Rows of a sample behind its tangent: that by the velocity, w C; imbalance; u' + G u, u'' + 2 G u' + G^2 u; the equilibrium from the frame.
VISCOUS = TANGENT + 25
IMBALANCE, RATE, BEND, CENTRE = (VISCOUS + 25 + 5 * i for i in range(4))
ROWS = CENTRE + 5
#: Rows of ``shared``, numbers of each point: w^2 mass, w damping; derivatives of the imbalance by u beside the tangent and by u'; means of
#: the tangents by u and u', and those of the harmonics' inverses; which lanes are asked for, and answers of a level; dashpot [N s/m] and
#: time constant [s] of the contacts, speed [rad/s].
MASS, DAMPED, FIXED, BY_RATE, MEAN, KEPT, WANTED, ANSWER = 0, 5, 30, 55, 80, 130, 180, 181
DASHPOT, TIME, SPEED = range(ANSWER + 2, ANSWER + 5)
SHARED_ROWS = SPEED + 1


class Block(NamedTuple):
    """Arrays of four points: their law's ``params`` (W 2 Z, k) and none of its ``memory``; scalars of condensed ``bodies`` (W, s), or (0, s); of each sample ``work`` (N, ..., W 2 Z) and
    ``rows`` (N, ``ROWS``, W), of level n each (N / n)th; ``basis`` (2 m + 3, 5 N, W) of a step; ``shared`` (``SHARED_ROWS``, W); ``own`` for the balls of a kernel."""

    params: np.ndarray
    memory: np.ndarray
    bodies: np.ndarray
    work: np.ndarray
    rows: np.ndarray
    basis: np.ndarray
    shared: np.ndarray
    own: np.ndarray


BLOCK = record(Block, MATRIX, MATRIX, MATRIX, CUBE, CUBE, CUBE, MATRIX, MATRIX)


@jit(void(float64, MATRIX, MATRIX))
def copy_balls(angle, before, after):
    """What an iteration begins with, seen from a frame that has turned by an angle."""
    c, s, live = np.cos(angle), np.sin(angle), live_of(0, WIDTH)
    for k in range(0, before.shape[1], WIDTH):
        put(after, GAP_RATE, k, live, take(before, GAP_RATE, k, live))
        put(after, SHIFT, k, live, take(before, SHIFT, k, live))
        for row in range(DIRECTION + 1, INNER):
            put(after, row, k, live, take(before, row, k, live))
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
        copy_balls(sense * span * 0.5 / n, work[at], work[between])
        for k in range(0, work.shape[2] // 2, WIDTH):
            ea, er = centre(seats(k, live, work[at]), rows[at], Q, live)
            fa, fr = centre(seats(k, live, work[between]), rows[between], Q, live)
            ea, er = fa - ea, fr - er
            for place, step, by_centre in ((PLACE, STEP, BY_CENTRE), (SHIFT, SHIFT_STEP, SHIFT_BY_E)):
                t, (a, r) = tensors_of(work[at], by_centre, k, live), pair_of(work[at], place, k, live)
                put_pair(work[between], place, k, live, a + t.aa * ea + t.ar * er, r + t.ra * ea + t.rr * er)
                put_pair(work[between], step, k, live, spread(0.0), spread(0.0))


#: Columns of a step, and what they may leave of the imbalance.
COLUMNS, _LEFT = 12, 1e-5


@jit(void(int64, float64, int64[::1], MATRIX, MATRIX))
def invert(n, wave, dofs, inverse, shared):
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


@jit(void(int64, int64[::1], VECTOR, MATRIX, MATRIX, MATRIX), allocates=True)
def _by_harmonics(n, dofs, circle, inverse, left, out):
    """``out`` (5 n, lanes), what answers forces ``left`` by each harmonic's dynamic stiffness; ``circle`` : cosines and sines (2 n,) of a span."""
    live, d = live_of(0, WIDTH), dofs.size
    cosine, sine, lines = circle[:n], circle[n:], np.empty((2 * d, WIDTH))
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


@jit(void(int64, boolean, int64[::1], VECTOR, VECTOR, MATRIX, CUBE, CUBE, MATRIX), allocates=True)
def newton_steps(n, viscous, dofs, d1, circle, inverse, rows, basis, shared):
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
