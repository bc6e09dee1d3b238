"""Balls that act on each other through elastic rings: groove centres that move as vectors.

Notes
-----
A ball presses on both grooves with the vector F (axial, radial) of its force on the ring, the outer one with the centrifugal
force F_c beyond that.  The inner groove centre then moves against the outer one by

    d = -M F - M_o F_c,    M = M_i + M_o,

M being compliances of the rings between groove centres [m/N], blocks of 2 x 2 (axial, radial) that depend on the distance of two
balls only, the block of a ball on itself included.  Contacts see e + d in the place of e: their angles follow the rings.

With A the tangent of each ball alone, its structural approaches eliminated, Newton's method on d + M F(e + d) + M_o F_c = 0
has (1 + A M) F' = F + A (d_c - d), d_c = -M_o F_c, for the new forces.  Potential: that of the balls at e + d, and F.M F / 2; so
the tangent A J - A M (1 + A M)^-1 A J is symmetric where A is.

``scalars`` holds for each distance: axial by axial, axial by radial and radial by radial force of M, then the axial and the
radial displacement of M_o by a radial force [m/N].
"""

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
    FORCE_BY_SPEED,
    FORCE_BY_TURN,
    MOVED,
    RADIAL_BY_SHIFT,
    STORED,
)
from raceway.core.ring.kernels.layout import (
    APPROACH_BY_CENTRE,
    BALL_CROSS,
    BALL_TANGENT,
    BLOCK,
    BY_Q,
    BY_V,
    CARRIED,
    CENTRIFUGAL,
    CENTRIFUGAL_MOVED,
    CURVE,
    DIRECTION,
    INVERSE,
    INVERSE_2,
    KNOTS,
    LOCAL,
    MATRIX_ROWS,
    MOVED_REST,
    MOVED_STEP,
    OWN,
    RING,
    ROW,
    SLOPE,
    STEP,
    TILT_ARM,
    TURNING,
    VALUES,
    WEIGHT,
    Pair,
    seat_of,
    to_ring,
)
from raceway.core.signatures import MATRIX, VECTOR


@jit(void(VECTOR, MATRIX, MATRIX))
def centrifugal_displacement(scalars, table, work):
    """d_c = -M_o F_c of every ball."""
    z, balls = table.shape[0], int(scalars[ROW])
    start = VALUES + 4 * int(scalars[KNOTS])
    for k in range(z):
        work[CENTRIFUGAL_MOVED, k] = work[CENTRIFUGAL_MOVED, z + k] = 0.0
        first = (k // balls) * balls
        for j in range(balls):
            push = table[first + j, CENTRIFUGAL]
            if push != 0.0:
                block = start + BLOCK * ((k - j) % balls)
                work[CENTRIFUGAL_MOVED, k] -= scalars[block + 3] * push
                work[CENTRIFUGAL_MOVED, z + k] -= scalars[block + 4] * push


@jit(void(VECTOR, MATRIX, int64, int64))
def _rings_times(scalars, work, source, target):
    """work[target] := M work[source]."""
    z, balls = work.shape[1] // 2, int(scalars[ROW])
    start = VALUES + 4 * int(scalars[KNOTS])
    for k in range(z):
        first = (k // balls) * balls
        axial, radial = 0.0, 0.0
        for j in range(first, first + balls):
            block = start + BLOCK * (k - j if k >= j else k - j + balls)
            a, r = work[source, j], work[source, z + j]
            axial += scalars[block] * a + scalars[block + 1] * r
            radial += scalars[block + 1] * a + scalars[block + 2] * r
        work[target, k], work[target, z + k] = axial, radial


@jit(void(VECTOR, MATRIX, MATRIX))
def forces(scalars, table, work):
    """Forces of the balls on the ring, what is left of d = d_c - M F, and the energy that the rings store."""
    z = table.shape[0]
    for k in range(z):
        turn = -0.5 * (work[CONTACT_FORCE, k] ** 2 * work[SLOPE, k] + work[CONTACT_FORCE, z + k] ** 2 * work[SLOPE, z + k])
        for c in (k, z + k):
            work[CARRIED, c] = work[FORCE, c] + turn * work[TURNING, c]
    _rings_times(scalars, work, CARRIED, MOVED_REST)
    for c in range(2 * z):
        meant = work[CENTRIFUGAL_MOVED, c] - work[MOVED, c]
        work[MOVED_REST, c] = meant - work[MOVED_REST, c]
        # Second order in what is left, as of the structural approaches.
        work[STORED, c] += 0.5 * work[CARRIED, c] * (meant + work[MOVED_REST, c])


@jit(types.UniTuple(float64, 4)(MATRIX, int64))
def _by_shift(work, k):
    """Force of a ball by its structural approaches: axial, radial by the inner one, axial, radial by the outer one [N/m]."""
    z = work.shape[1] // 2
    ga, gr = work[TURNING, k], work[TURNING, z + k]
    di, do = -work[CONTACT_FORCE, k] * work[SLOPE, k], -work[CONTACT_FORCE, z + k] * work[SLOPE, z + k]
    inner = di * work[BY_OWN, k] + do * work[BY_OTHER, z + k]
    outer = do * work[BY_OWN, z + k] + di * work[BY_OTHER, k]
    return (
        work[AXIAL_BY_SHIFT, k] + inner * ga,
        work[RADIAL_BY_SHIFT, k] + inner * gr,
        work[AXIAL_BY_SHIFT, z + k] + outer * ga,
        work[RADIAL_BY_SHIFT, z + k] + outer * gr,
    )


@jit(types.UniTuple(float64, 2)(VECTOR, MATRIX, int64, float64, float64))
def _approaches(scalars, work, k, inner, outer):
    """(I - C S)^-1 (inner, outer) of one ball."""
    z = work.shape[1] // 2
    return (
        work[INVERSE, k] * inner + work[INVERSE, z + k] * outer,
        work[INVERSE_2, k] * inner + work[INVERSE_2, z + k] * outer,
    )


@jit(types.UniTuple(float64, 8)(VECTOR, MATRIX, int64, float64, float64))
def _by_centre(scalars, work, k, position, speed):
    """Of one ball, structural approaches eliminated, by e times ``position`` and its velocity times ``speed``.

    Returns
    -------
    aa, ar, ra, rr : tangent of its force;  ia, ir, oa, or : derivatives of the inner and outer structural approaches
    """
    z = work.shape[1] // 2
    ga, gr, cross = work[TURNING, k], work[TURNING, z + k], scalars[BALL_CROSS]
    di, do = -work[CONTACT_FORCE, k] * work[SLOPE, k], -work[CONTACT_FORCE, z + k] * work[SLOPE, z + k]
    qia = position * work[BY_AXIAL, k] + speed * work[BY_AXIAL_SPEED, k]
    qir = position * work[BY_RADIAL, k] + speed * work[BY_RADIAL_SPEED, k]
    qoa = position * work[BY_AXIAL, z + k] + speed * work[BY_AXIAL_SPEED, z + k]
    qor = position * work[BY_RADIAL, z + k] + speed * work[BY_RADIAL_SPEED, z + k]
    ci, co = work[OWN, k], work[OWN, z + k]
    ia, oa = _approaches(
        scalars, work, k, ci * qia + cross * qoa - position * di * ga, cross * qia + co * qoa - position * do * ga
    )
    ir, orr = _approaches(
        scalars, work, k, ci * qir + cross * qor - position * di * gr, cross * qir + co * qor - position * do * gr
    )
    wai, wri, wao, wro = _by_shift(work, k)
    half_i, half_o = -0.5 * work[CONTACT_FORCE, k] ** 2, -0.5 * work[CONTACT_FORCE, z + k] ** 2
    slope = position * (half_i * work[SLOPE, k] + half_o * work[SLOPE, z + k])
    curve = position * (half_i * work[CURVE, k] + half_o * work[CURVE, z + k])
    haa, har = 2.0 * ga * gr, gr * gr - ga * ga
    ta, tr = di * qia + do * qoa, di * qir + do * qor
    aa = position * work[FORCE_BY_CENTRE, k] + speed * work[FORCE_BY_SPEED, k]
    ar = position * work[FORCE_BY_CENTRE, z + k] + speed * work[FORCE_BY_SPEED, z + k]
    ra = position * work[FORCE_BY_CENTRE + 1, k] + speed * work[FORCE_BY_SPEED + 1, k]
    rr = position * work[FORCE_BY_CENTRE + 1, z + k] + speed * work[FORCE_BY_SPEED + 1, z + k]
    return (
        aa + curve * ga * ga + slope * haa + ga * ta + wai * ia + wao * oa,
        ar + curve * ga * gr + slope * har + ga * tr + wai * ir + wao * orr,
        ra + curve * ga * gr + slope * har + gr * ta + wri * ia + wro * oa,
        rr + curve * gr * gr - slope * haa + gr * tr + wri * ir + wro * orr,
        ia,
        ir,
        oa,
        orr,
    )


@jit(boolean(VECTOR, MATRIX, int64, int64))
def _factorise(scalars, work, first, balls):
    """1 + A M of one row of balls as L U, unknowns ball by ball; False where a pivot is not positive.

    Notes
    -----
    The matrix is similar to a positive definite one: no pivots are needed.
    """
    z, n, base = work.shape[1] // 2, 2 * balls, MATRIX_ROWS + 2 * first
    start = VALUES + 4 * int(scalars[KNOTS])
    for i in range(balls):
        k = first + i
        aa, ar = work[BALL_TANGENT, k], work[BALL_TANGENT, z + k]
        ra, rr = work[BALL_TANGENT + 1, k], work[BALL_TANGENT + 1, z + k]
        row = base + 2 * i
        for j in range(balls):
            block = start + BLOCK * (i - j if i >= j else i - j + balls)
            maa, mar, mrr = scalars[block], scalars[block + 1], scalars[block + 2]
            work[row, 2 * j], work[row, 2 * j + 1] = aa * maa + ar * mar, aa * mar + ar * mrr
            work[row + 1, 2 * j], work[row + 1, 2 * j + 1] = ra * maa + rr * mar, ra * mar + rr * mrr
        work[row, 2 * i] += 1.0
        work[row + 1, 2 * i + 1] += 1.0
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
    """The entries of one row of balls, ball by ball, into LOCAL."""
    z = work.shape[1] // 2
    for j in range(balls):
        work[LOCAL, 2 * j], work[LOCAL, 2 * j + 1] = work[row, first + j], work[row, z + first + j]


@jit(void(MATRIX, int64, int64, int64))
def _scatter(work, row, first, balls):
    """The same back."""
    z = work.shape[1] // 2
    for j in range(balls):
        work[row, first + j], work[row, z + first + j] = work[LOCAL, 2 * j], work[LOCAL, 2 * j + 1]


@jit(void(VECTOR, MATRIX, int64))
def _solve(scalars, work, row):
    """work[row] := (1 + A M)^-1 work[row]."""
    balls = int(scalars[ROW])
    n = 2 * balls
    for first in range(0, work.shape[1] // 2, balls):
        base = MATRIX_ROWS + 2 * first
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
    """work[row] := work[row] (1 + A M)^-1."""
    balls = int(scalars[ROW])
    n = 2 * balls
    for first in range(0, work.shape[1] // 2, balls):
        base = MATRIX_ROWS + 2 * first
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


@jit(boolean(VECTOR, MATRIX, float64, MATRIX))
def step(scalars, table, ball_gain, work):
    """Newton steps of d, and of the structural approaches with them; False where the bodies take off more than there is.

    Notes
    -----
    ``STEP`` holds the steps of the structural approaches at fixed d before.
    """
    z, balls = table.shape[0], int(scalars[ROW])
    for k in range(z):
        aa, ar, ra, rr, ia, ir, oa, orr = _by_centre(scalars, work, k, 1.0, ball_gain)
        work[BALL_TANGENT, k], work[BALL_TANGENT, z + k] = aa, ar
        work[BALL_TANGENT + 1, k], work[BALL_TANGENT + 1, z + k] = ra, rr
        work[APPROACH_BY_CENTRE, k], work[APPROACH_BY_CENTRE, z + k] = ia, ir
        work[APPROACH_BY_CENTRE + 1, k], work[APPROACH_BY_CENTRE + 1, z + k] = oa, orr
        wai, wri, wao, wro = _by_shift(work, k)
        da, dr = work[CENTRIFUGAL_MOVED, k] - work[MOVED, k], work[CENTRIFUGAL_MOVED, z + k] - work[MOVED, z + k]
        work[CARRIED, k] += wai * work[STEP, k] + wao * work[STEP, z + k] + aa * da + ar * dr
        work[CARRIED, z + k] += wri * work[STEP, k] + wro * work[STEP, z + k] + ra * da + rr * dr
    for first in range(0, z, balls):
        if not _factorise(scalars, work, first, balls):
            return False
    _solve(scalars, work, CARRIED)
    _rings_times(scalars, work, CARRIED, MOVED_STEP)
    for c in range(2 * z):
        work[MOVED_STEP, c] = work[CENTRIFUGAL_MOVED, c] - work[MOVED_STEP, c] - work[MOVED, c]
    for k in range(z):
        da, dr = work[MOVED_STEP, k], work[MOVED_STEP, z + k]
        work[STEP, k] += work[APPROACH_BY_CENTRE, k] * da + work[APPROACH_BY_CENTRE, z + k] * dr
        work[STEP, z + k] += work[APPROACH_BY_CENTRE + 1, k] * da + work[APPROACH_BY_CENTRE + 1, z + k] * dr
    return True


@jit(void(VECTOR, MATRIX, float64, MATRIX, MATRIX, MATRIX))
def reduce_tangents(scalars, table, ball_gain, work, K, C):
    """K and C (5, 5) of balls at fixed d, with d eliminated: A J - A M (1 + A M)^-1 A J."""
    z, arm, cross = table.shape[0], scalars[TILT_ARM], scalars[BALL_CROSS]
    rates = 0.0
    for k in range(z):
        seat = seat_of(k, arm, table, work, DIRECTION)
        wai, wri, wao, wro = _by_shift(work, k)
        # By the turn of the section, and of the couple by d.
        qi, qo = work[BY_TURN, k], work[BY_TURN, z + k]
        wi, wo = _approaches(scalars, work, k, work[OWN, k] * qi + cross * qo, cross * qi + work[OWN, z + k] * qo)
        turned = -work[CONTACT_FORCE, k] * work[SLOPE, k] * qi - work[CONTACT_FORCE, z + k] * work[SLOPE, z + k] * qo
        axial = work[FORCE_BY_TURN, k] + turned * work[TURNING, k] + wai * wi + wao * wo
        radial = work[FORCE_BY_TURN, z + k] + turned * work[TURNING, z + k] + wri * wi + wro * wo
        aa, ar, ra, rr, _, _, _, _ = _by_centre(scalars, work, k, 1.0, 0.0)
        to_ring(seat, Pair(aa, ar), axial, work, BY_Q, k)
        to_ring(seat, Pair(ra, rr), radial, work, BY_Q, z + k)
        aa, ar, ra, rr, _, _, _, _ = _by_centre(scalars, work, k, 0.0, 1.0)
        rates += abs(aa) + abs(rr)
        to_ring(seat, Pair(aa, ar), 0.0, work, BY_V, k)
        to_ring(seat, Pair(ra, rr), 0.0, work, BY_V, z + k)
        for side in range(2):
            d = k + side * z
            turn = work[COUPLE_BY_CENTRE, d]
            turn += work[COUPLE_BY_SHIFT, k] * work[APPROACH_BY_CENTRE, d]
            turn += work[COUPLE_BY_SHIFT, z + k] * work[APPROACH_BY_CENTRE + 1, d]
            to_ring(seat, Pair(work[BALL_TANGENT, d], work[BALL_TANGENT + 1, d]), turn, work, RING, d)
    for i in range(5):
        _rings_times(scalars, work, RING + i, WEIGHT + i)
        _solve_transposed(scalars, work, WEIGHT + i)
    for i in range(5):
        for j in range(5):
            total = 0.0
            for c in range(2 * z):
                total += work[WEIGHT + i, c] * work[BY_Q + j, c]
            K[i, j] -= total
            if rates != 0.0:
                total = 0.0
                for c in range(2 * z):
                    total += work[WEIGHT + i, c] * work[BY_V + j, c]
                C[i, j] -= total
