"""Newton's steps of four points' steady orbits, by generalised conjugate residuals.

With the mean tangent of the samples the linear system falls into harmonics, whose inverses answer each column.

References
----------
Eisenstat, Elman, Schultz, SIAM J. Numer. Anal. 20 (1983) 345.
"""

import numpy as np
from numba import boolean, float64, int64, void

from raceway.core.jit import jit
from raceway.core.lanes import LANES, WIDTH, any_of, live_of, put, root, spread, take, where
from raceway.core.periodic.block import BY_RATE, FIXED, IMBALANCE, KEPT, MASS, MEAN, VISCOUS
from raceway.core.ring.lockstep import ARM, DQ, TANGENT
from raceway.core.signatures import CUBE, MATRIX, VECTOR

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
