"""Elastic rings and balls around any of the rigid kernels: contacts and structural compliances in series.

Notes
-----
The bodies add w = C(beta) Q to the gaps: Q (2 Z,) are the contact forces, C the structural compliances [m/N], what
finite elements give beyond the half-spaces that the law knows already:

- the rings' and balls' own share c(beta), tabulated over the angle beta of the line of groove centres, with a
  continuous slope, constant beyond its ends;  a load on the ball's other race (constant);
- where rings rest on soft seats, of ball j on ball k, a constant symmetric matrix for each ring of each row of balls.

A rigid kernel finds balls and forces for given w, and their derivatives S = dQ/dw ball by ball; Newton's method on
w - C Q(w) = 0 with I - C S does the rest.  Potential: U(gaps) + Q.C Q / 2, so the change of c with the angle turns the
ring with -Q^2 c'/2 about each ball's groove, and the tangent, by implicit differentiation, is symmetric.

References
----------
The separation into near and far field: docs/physics.md, condensed bodies.
"""

import numpy as np
from numba import boolean, float64, int64, void

from raceway.core.bodies import (
    AXIAL_BY_SHIFT,
    BY_AXIAL,
    BY_AXIAL_SPEED,
    BY_OTHER,
    BY_OWN,
    BY_RADIAL,
    BY_RADIAL_SPEED,
    BY_TURN,
    COUPLE_BY_SHIFT,
    RADIAL_BY_SHIFT,
    SHIFT,
    SHIFT_RATE,
    STORED,
    WORK_ROWS,
)
from raceway.core.bodies.columns import ELASTIC_ROWS
from raceway.core.bodies.ring import COLUMNS, LEVER, SCALARS, SIDE, TILT_ARM, place
from raceway.core.bodies.section import add_ball
from raceway.core.jit import jit
from raceway.core.signatures import MATRIX, VECTOR

#: Entries of ``scalars`` beyond the rigid ones: compliance of a ball by the load on its other race [m/N]; 1 where balls act on each other through the rings; balls of a row; first angle [rad] and
#: distance of the table's angles, their number n; then the table: inner compliance (n,), its slopes by angle over that
#: distance (n,), and both again for the outer race.
BALL_CROSS, COUPLED, ROW, FIRST, DISTANCE, KNOTS, VALUES = range(SCALARS, SCALARS + 7)
#: The matrices (balls of a row x balls of a row) with zero diagonals stand in ``table`` behind its columns: inner, outer.
MATRICES = COLUMNS
#: Iterations until it is given up, and answers of ``correct``.
ITERATIONS = 60
GOES_ON, SETTLED, FAILED = range(3)

_FIRST_ROW = WORK_ROWS + 10
DIRECTION, CENTRE, SPEED, TURNING, OWN, SLOPE, CURVE, STEP, LAST, INVERSE, INVERSE_2, LOCAL, NORM = range(
    _FIRST_ROW, _FIRST_ROW + 13
)
# Five rows each: contact forces by q and by v, the ring's force by w, by Q at fixed w, and weights of C Q in it.
_BY_Q = NORM + 1
_BY_V, _RING, _TURN, _WEIGHT = _BY_Q + 5, _BY_Q + 10, _BY_Q + 15, _BY_Q + 20
_FACTOR = WORK_ROWS + ELASTIC_ROWS


@jit(void(float64, VECTOR, VECTOR, VECTOR, MATRIX, MATRIX))
def begin(t, q, v, scalars, table, work):
    """Angles of the lines of groove centres and the compliances there."""
    z = table.shape[0]
    place(t, q, v, scalars, table, work, DIRECTION, CENTRE, SPEED)
    work[NORM, 0] = np.inf
    knots = int(scalars[KNOTS])
    for k in range(z):
        a, r = work[CENTRE, k], work[CENTRE, z + k]
        inverse = 1.0 / max(a * a + r * r, 1e-300)
        work[TURNING, k], work[TURNING, z + k] = r * inverse, -a * inverse
        x = (np.arctan2(a, r) - scalars[FIRST]) / scalars[DISTANCE]
        inside = 0.0 < x < knots - 1.0
        x = min(max(x, 0.0), knots - 1.0)
        i = min(int(x), knots - 2)
        u = x - i
        for c in (k, z + k):
            first = VALUES + i + (0 if c == k else 2 * knots)
            p, q1, m, n = scalars[first], scalars[first + 1], scalars[first + knots], scalars[first + knots + 1]
            a2, a3 = 3.0 * (q1 - p) - 2.0 * m - n, 2.0 * (p - q1) + m + n
            work[OWN, c] = p + u * (m + u * (a2 + u * a3))
            work[SLOPE, c] = (m + u * (2.0 * a2 + u * 3.0 * a3)) / scalars[DISTANCE] if inside else 0.0
            work[CURVE, c] = (2.0 * a2 + 6.0 * a3 * u) / (scalars[DISTANCE] * scalars[DISTANCE]) if inside else 0.0


@jit(void(MATRIX, float64, MATRIX, MATRIX))
def shift(ball, ball_gain, ball_known, work):
    """Hand the structural approaches in the last two columns of ``ball`` to the rigid kernel."""
    z, last = ball.shape[0], ball.shape[1] - 2
    for k in range(z):
        for side in range(2):
            w = ball[k, last + side]
            work[SHIFT, k + side * z] = w
            work[SHIFT_RATE, k + side * z] = ball_gain * w + ball_known[k, last + side]


@jit(float64(VECTOR, MATRIX, MATRIX, int64, int64))
def _compliance_times(scalars, table, work, row, c):
    """Entry c of C x with x = work[row]."""
    z = table.shape[0]
    k, other = (c, c + z) if c < z else (c - z, c - z)
    total = work[OWN, c] * work[row, c] + scalars[BALL_CROSS] * work[row, other]
    if scalars[COUPLED] != 0.0:
        balls = int(scalars[ROW])
        first = (k // balls) * balls
        column, start = MATRICES + (0 if c < z else balls), first + (c - k)
        for j in range(balls):
            total += table[k, column + j] * work[row, start + j]
    return total


@jit(boolean(VECTOR, MATRIX, MATRIX))
def _factorise(scalars, table, work):
    """I - C S, as inverses ball by ball or as L U of each row of balls; False where the bodies take off more than there is.

    Notes
    -----
    The matrix is similar to a positive definite one, and close to the identity: no pivots are needed.
    """
    z, cross = table.shape[0], scalars[BALL_CROSS]
    if scalars[COUPLED] == 0.0:
        for k in range(z):
            ci, co = work[OWN, k], work[OWN, z + k]
            sii, sio, soi, soo = work[BY_OWN, k], work[BY_OTHER, k], work[BY_OTHER, z + k], work[BY_OWN, z + k]
            mii, mio = 1.0 - ci * sii - cross * soi, -ci * sio - cross * soo
            moi, moo = -cross * sii - co * soi, 1.0 - cross * sio - co * soo
            det = mii * moo - mio * moi
            if not det > 0.0:
                return False
            work[INVERSE, k], work[INVERSE, z + k] = moo / det, -mio / det
            work[INVERSE_2, k], work[INVERSE_2, z + k] = -moi / det, mii / det
        return True
    balls = int(scalars[ROW])
    n = 2 * balls
    for first in range(0, z, balls):
        base = _FACTOR + 2 * first
        for i in range(n):
            side, k = i // balls, first + i % balls
            column = MATRICES + side * balls
            for j in range(balls):
                m, o = first + j + side * z, first + j + (1 - side) * z
                c = table[k, column + j]
                x = 0.0
                if k == first + j:
                    c, x = work[OWN, m], cross
                same, opposite = side * balls + j, (1 - side) * balls + j
                work[base + i, same] = -c * work[BY_OWN, m] - x * work[BY_OTHER, o]
                work[base + i, opposite] = -x * work[BY_OWN, o] - c * work[BY_OTHER, m]
            work[base + i, i] += 1.0
        for p in range(n):
            pivot = work[base + p, p]
            if not pivot > 1e-12:
                return False
            inverse = 1.0 / pivot
            for i in range(p + 1, n):
                factor = work[base + i, p] * inverse
                work[base + i, p] = factor
                for j in range(p + 1, n):
                    work[base + i, j] -= factor * work[base + p, j]
    return True


@jit(void(MATRIX, int64, int64, int64))
def _gather(work, row, first, balls):
    """The entries of one row of balls, inner contacts first, into LOCAL."""
    z = work.shape[1] // 2
    for j in range(balls):
        work[LOCAL, j], work[LOCAL, balls + j] = work[row, first + j], work[row, z + first + j]


@jit(void(MATRIX, int64, int64, int64))
def _scatter(work, row, first, balls):
    """The same back."""
    z = work.shape[1] // 2
    for j in range(balls):
        work[row, first + j], work[row, z + first + j] = work[LOCAL, j], work[LOCAL, balls + j]


@jit(void(VECTOR, MATRIX, int64))
def _solve(scalars, work, row):
    """work[row] := (I - C S)^-1 work[row]."""
    z = work.shape[1] // 2
    if scalars[COUPLED] == 0.0:
        for k in range(z):
            a, b = work[row, k], work[row, z + k]
            work[row, k] = work[INVERSE, k] * a + work[INVERSE, z + k] * b
            work[row, z + k] = work[INVERSE_2, k] * a + work[INVERSE_2, z + k] * b
        return
    balls = int(scalars[ROW])
    n = 2 * balls
    for first in range(0, z, balls):
        base = _FACTOR + 2 * first
        _gather(work, row, first, balls)
        for i in range(n):
            total = work[LOCAL, i]
            for j in range(i):
                total -= work[base + i, j] * work[LOCAL, j]
            work[LOCAL, i] = total
        for i in range(n - 1, -1, -1):
            total = work[LOCAL, i]
            for j in range(i + 1, n):
                total -= work[base + i, j] * work[LOCAL, j]
            work[LOCAL, i] = total / work[base + i, i]
        _scatter(work, row, first, balls)


@jit(void(VECTOR, MATRIX, int64))
def _solve_transposed(scalars, work, row):
    """work[row] := work[row] (I - C S)^-1."""
    z = work.shape[1] // 2
    if scalars[COUPLED] == 0.0:
        for k in range(z):
            a, b = work[row, k], work[row, z + k]
            work[row, k] = a * work[INVERSE, k] + b * work[INVERSE_2, k]
            work[row, z + k] = a * work[INVERSE, z + k] + b * work[INVERSE_2, z + k]
        return
    balls = int(scalars[ROW])
    n = 2 * balls
    for first in range(0, z, balls):
        base = _FACTOR + 2 * first
        _gather(work, row, first, balls)
        for i in range(n):
            value = work[LOCAL, i] / work[base + i, i]
            work[LOCAL, i] = value
            for j in range(i + 1, n):
                work[LOCAL, j] -= value * work[base + i, j]
        for i in range(n - 1, 0, -1):
            value = work[LOCAL, i]
            for j in range(i):
                work[LOCAL, j] -= value * work[base + i, j]
        _scatter(work, row, first, balls)


@jit(int64(VECTOR, MATRIX, MATRIX, MATRIX, VECTOR))
def correct(scalars, table, ball, work, f):
    """One Newton step on the structural approaches after a rigid kernel; the last one is a linear correction.

    Returns
    -------
    int
        ``GOES_ON``, ``SETTLED`` (forces and f are corrected; ``tangents`` may follow) or ``FAILED``.
    """
    z, last = table.shape[0], ball.shape[1] - 2
    norm, deepest = 0.0, 0.0
    for c in range(2 * z):
        k, side = (c, 0) if c < z else (c - z, 1)
        w = ball[k, last + side]
        rest = _compliance_times(scalars, table, work, 2, c) - w
        work[STEP, c] = rest
        # Second order in what is left: the force times w, less half of what its part C Q would store.
        work[STORED, c] = 0.5 * work[2, c] * (w - rest)
        norm = max(norm, abs(rest))
        deepest = max(deepest, -work[0, c])
    if not np.isfinite(norm):
        return FAILED
    if norm > work[NORM, 0] and norm > 1e-9 * deepest:
        # Worse than before the last step: go half-way back.
        for c in range(2 * z):
            k, side = (c, 0) if c < z else (c - z, 1)
            work[LAST, c] *= 0.5
            ball[k, last + side] -= work[LAST, c]
        return GOES_ON
    work[NORM, 0] = norm
    if not _factorise(scalars, table, work):
        return FAILED
    _solve(scalars, work, STEP)
    settled = True
    for c in range(2 * z):
        step = work[STEP, c]
        k, side = (c, 0) if c < z else (c - z, 1)
        ball[k, last + side] += step
        work[LAST, c] = step
        settled = settled and abs(step) <= max(1e-8 * -work[0, c], 1e-10 * deepest)
    if not settled:
        return GOES_ON
    for k in range(z):
        a, b = work[STEP, k], work[STEP, z + k]
        work[2, k] = max(work[2, k] + work[BY_OWN, k] * a + work[BY_OTHER, k] * b, 0.0)
        work[2, z + k] = max(work[2, z + k] + work[BY_OTHER, z + k] * a + work[BY_OWN, z + k] * b, 0.0)
        axial = table[k, SIDE] * (work[AXIAL_BY_SHIFT, k] * a + work[AXIAL_BY_SHIFT, z + k] * b)
        radial = work[RADIAL_BY_SHIFT, k] * a + work[RADIAL_BY_SHIFT, z + k] * b
        couple = scalars[TILT_ARM] * axial - table[k, LEVER] * radial
        couple += table[k, SIDE] * (work[COUPLE_BY_SHIFT, k] * a + work[COUPLE_BY_SHIFT, z + k] * b)
        cosine, sine = work[DIRECTION, k], work[DIRECTION, z + k]
        f[0] += axial
        f[1] += radial * cosine
        f[2] += radial * sine
        f[3] += couple * sine
        f[4] -= couple * cosine
    return SETTLED


@jit(void(MATRIX, MATRIX, int64, float64, float64, float64, float64, int64, int64))
def _to_ring(table, work, k, arm, axial, radial, turn, row, c):
    """Five rows of ``work`` from ``row`` on, entry c: J^T (axial, radial) and the turn of ball k's section."""
    cosine, sine = work[DIRECTION, k], work[DIRECTION, table.shape[0] + k]
    axial *= table[k, SIDE]
    couple = arm * axial - table[k, LEVER] * radial + table[k, SIDE] * turn
    work[row, c] = axial
    work[row + 1, c], work[row + 2, c] = radial * cosine, radial * sine
    work[row + 3, c], work[row + 4, c] = couple * sine, -couple * cosine


@jit(void(VECTOR, MATRIX, MATRIX, VECTOR, MATRIX, MATRIX))
def tangents(scalars, table, work, f, K, C):
    """Complete f (5,), and K and C (5, 5) where they are asked for, with what the bodies' elasticity adds.

    Notes
    -----
    df = K dq + B dw + D^T dQ and dQ = A dq + S dw, w = C Q: dw = (I - C S)^-1 (C A - D) dq, where D holds -Q c' dbeta/dq.
    """
    z, arm = table.shape[0], scalars[TILT_ARM]
    empty = K.size == 0
    for k in range(z):
        ga, gr = work[TURNING, k], work[TURNING, z + k]
        by_angle, twice = 0.0, 0.0
        for c in (k, z + k):
            half = -0.5 * work[2, c] * work[2, c]
            by_angle += half * work[SLOPE, c]
            twice += half * work[CURVE, c]
        if by_angle == 0.0 and twice == 0.0:
            continue
        haa, har = 2.0 * ga * gr, gr * gr - ga * ga
        add_ball(
            work[DIRECTION, k], work[DIRECTION, z + k], arm, table[k, SIDE], table[k, LEVER], by_angle * ga, by_angle * gr,
            twice * ga * ga + by_angle * haa, twice * ga * gr + by_angle * har,
            twice * ga * gr + by_angle * har, twice * gr * gr - by_angle * haa, 0.0, 0.0, 0.0, 0.0, f, K, C,
        )  # fmt: skip
    if empty:
        return
    rates = 0.0
    for k in range(z):
        ga, gr = work[TURNING, k], work[TURNING, z + k]
        for c in (k, z + k):
            other = z + k if c == k else k
            _to_ring(table, work, k, arm, work[BY_AXIAL, c], work[BY_RADIAL, c], work[BY_TURN, c], _BY_Q, c)
            _to_ring(table, work, k, arm, work[BY_AXIAL_SPEED, c], work[BY_RADIAL_SPEED, c], 0.0, _BY_V, c)
            rates += abs(work[BY_AXIAL_SPEED, c]) + abs(work[BY_RADIAL_SPEED, c])
            d = -work[2, c] * work[SLOPE, c]
            _to_ring(table, work, k, arm, d * ga, d * gr, 0.0, _TURN, c)
            # B + D^T S: a shift changes the forces that turn the ring, too.
            d = d * work[BY_OWN, c] - work[2, other] * work[SLOPE, other] * work[BY_OTHER, other]
            _to_ring(
                table, work, k, arm, work[AXIAL_BY_SHIFT, c] + d * ga, work[RADIAL_BY_SHIFT, c] + d * gr,
                work[COUPLE_BY_SHIFT, c], _RING, c,
            )  # fmt: skip
    for i in range(5):
        _solve_transposed(scalars, work, _RING + i)
        for c in range(2 * z):
            # C is symmetric.
            work[_WEIGHT + i, c] = _compliance_times(scalars, table, work, _RING + i, c) + work[_TURN + i, c]
    for i in range(5):
        for j in range(5):
            total = 0.0
            for c in range(2 * z):
                total += work[_WEIGHT + i, c] * work[_BY_Q + j, c] - work[_RING + i, c] * work[_TURN + j, c]
            K[i, j] += total
            if rates != 0.0:
                total = 0.0
                for c in range(2 * z):
                    total += work[_WEIGHT + i, c] * work[_BY_V + j, c]
                C[i, j] += total
