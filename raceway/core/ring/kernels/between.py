"""Balls that act on each other through elastic rings: groove centres that move as vectors.

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
from raceway.core.ring import kernels as rows
from raceway.core.ring.kernels import layout as ring
from raceway.core.ring.kernels.layout import add_products, seat_of, to_ring
from raceway.core.ring.kernels.tensors import PAIR, TENSOR, Pair, Tensor, put_tensor, tensor_of, weighted_sum
from raceway.core.signatures import MATRIX, VECTOR


@jit(void(VECTOR, MATRIX, MATRIX))
def centrifugal_displacement(scalars, table, work):
    """d_c = -M_o F_c of every ball."""
    z, balls = table.shape[0], int(scalars[ring.ROW])
    start = ring.VALUES + 4 * int(scalars[ring.KNOTS])
    for k in range(z):
        work[ring.CENTRIFUGAL_MOVED, k] = work[ring.CENTRIFUGAL_MOVED, z + k] = 0.0
        first = (k // balls) * balls
        for j in range(balls):
            push = table[first + j, ring.CENTRIFUGAL]
            if push != 0.0:
                block = start + ring.BLOCK * ((k - j) % balls)
                work[ring.CENTRIFUGAL_MOVED, k] -= scalars[block + 3] * push
                work[ring.CENTRIFUGAL_MOVED, z + k] -= scalars[block + 4] * push


@jit(void(VECTOR, MATRIX, int64, int64))
def _rings_times(scalars, work, source, target):
    """work[target] := M work[source]."""
    z, balls = work.shape[1] // 2, int(scalars[ring.ROW])
    start = ring.VALUES + 4 * int(scalars[ring.KNOTS])
    for k in range(z):
        first = (k // balls) * balls
        axial, radial = 0.0, 0.0
        for j in range(first, first + balls):
            block = start + ring.BLOCK * (k - j if k >= j else k - j + balls)
            a, r = work[source, j], work[source, z + j]
            axial += scalars[block] * a + scalars[block + 1] * r
            radial += scalars[block + 1] * a + scalars[block + 2] * r
        work[target, k], work[target, z + k] = axial, radial


@jit(void(VECTOR, MATRIX, MATRIX))
def forces(scalars, table, work):
    """Forces of the balls on the ring, what is left of d = d_c - M F, and the energy that the rings store."""
    z = table.shape[0]
    for k in range(z):
        turn = -0.5 * (
            work[rows.CONTACT_FORCE, k] ** 2 * work[ring.SLOPE, k]
            + work[rows.CONTACT_FORCE, z + k] ** 2 * work[ring.SLOPE, z + k]
        )
        for c in (k, z + k):
            work[ring.CARRIED, c] = work[rows.FORCE, c] + turn * work[ring.TURNING, c]
    _rings_times(scalars, work, ring.CARRIED, ring.MOVED_REST)
    for c in range(2 * z):
        target = work[ring.CENTRIFUGAL_MOVED, c] - work[rows.MOVED, c]
        work[ring.MOVED_REST, c] = target - work[ring.MOVED_REST, c]
        # Second order in what is left, as of the structural approaches.
        work[rows.STORED, c] += 0.5 * work[ring.CARRIED, c] * (target + work[ring.MOVED_REST, c])


@jit(PAIR(MATRIX, int64))
def _by_angle(work, k):
    """-Q c' of the inner and the outer contact of a ball: change of its structural approaches with the angle of its line [m]."""
    z = work.shape[1] // 2
    return Pair(
        -work[rows.CONTACT_FORCE, k] * work[ring.SLOPE, k], -work[rows.CONTACT_FORCE, z + k] * work[ring.SLOPE, z + k]
    )


@jit(TENSOR(MATRIX, int64))
def _by_shift(work, k):
    """Force of a ball (axial, radial) by its structural approaches (inner, outer) [N/m]."""
    z = work.shape[1] // 2
    ga, gr = work[ring.TURNING, k], work[ring.TURNING, z + k]
    di, do = _by_angle(work, k)
    inner = di * work[rows.BY_OWN, k] + do * work[rows.BY_OTHER, z + k]
    outer = do * work[rows.BY_OWN, z + k] + di * work[rows.BY_OTHER, k]
    w = tensor_of(work, rows.AXIAL_BY_SHIFT, k)
    return Tensor(w.aa + inner * ga, w.ar + outer * ga, w.ra + inner * gr, w.rr + outer * gr)


@jit(PAIR(VECTOR, MATRIX, int64, PAIR))
def _approaches(scalars, work, k, approach):
    """(I - C S)^-1 (inner, outer) of one ball."""
    m = tensor_of(work, ring.INVERSE, k)
    return Pair(m.aa * approach.axial + m.ar * approach.radial, m.ra * approach.axial + m.rr * approach.radial)


@jit(types.UniTuple(TENSOR, 2)(VECTOR, MATRIX, int64, float64, float64))
def _by_centre(scalars, work, k, position, speed):
    """Of one ball, structural approaches eliminated, by e times ``position`` and its velocity times ``speed``.

    Returns the tangent of its force; derivatives (inner, outer) x (axial, radial) of its structural approaches.
    """
    z = work.shape[1] // 2
    ga, gr, cross = work[ring.TURNING, k], work[ring.TURNING, z + k], scalars[ring.BALL_CROSS]
    ci, co, (di, do) = work[ring.OWN, k], work[ring.OWN, z + k], _by_angle(work, k)
    # Contact forces: (axial, radial) x (inner, outer).
    q = weighted_sum(position, tensor_of(work, rows.BY_AXIAL, k), speed, tensor_of(work, rows.BY_AXIAL_SPEED, k))
    axial = Pair(ci * q.aa + cross * q.ar - position * di * ga, cross * q.aa + co * q.ar - position * do * ga)
    radial = Pair(ci * q.ra + cross * q.rr - position * di * gr, cross * q.ra + co * q.rr - position * do * gr)
    (ia, oa), (ir, orr) = _approaches(scalars, work, k, axial), _approaches(scalars, work, k, radial)
    half_i, half_o = -0.5 * work[rows.CONTACT_FORCE, k] ** 2, -0.5 * work[rows.CONTACT_FORCE, z + k] ** 2
    slope = position * (half_i * work[ring.SLOPE, k] + half_o * work[ring.SLOPE, z + k])
    curve = position * (half_i * work[ring.CURVE, k] + half_o * work[ring.CURVE, z + k])
    haa, har = 2.0 * ga * gr, gr * gr - ga * ga
    ta, tr = di * q.aa + do * q.ar, di * q.ra + do * q.rr
    w, f = _by_shift(work, k), tensor_of(work, rows.FORCE_BY_CENTRE, k)
    f = weighted_sum(position, f, speed, tensor_of(work, rows.FORCE_BY_SPEED, k))
    tangent = Tensor(
        f.aa + curve * ga * ga + slope * haa + ga * ta + w.aa * ia + w.ar * oa,
        f.ar + curve * ga * gr + slope * har + ga * tr + w.aa * ir + w.ar * orr,
        f.ra + curve * ga * gr + slope * har + gr * ta + w.ra * ia + w.rr * oa,
        f.rr + curve * gr * gr - slope * haa + gr * tr + w.ra * ir + w.rr * orr,
    )
    return tangent, Tensor(ia, ir, oa, orr)


@jit(boolean(VECTOR, MATRIX, int64, int64))
def _factorise(scalars, work, first, balls):
    """1 + A M of one row of balls as L U, unknowns ball by ball; False where a pivot is not positive.

    The matrix is similar to a positive definite one: no pivots are needed.
    """
    n, base = 2 * balls, ring.MATRIX_ROWS + 2 * first
    start = ring.VALUES + 4 * int(scalars[ring.KNOTS])
    for i in range(balls):
        k = first + i
        aa, ar, ra, rr = tensor_of(work, ring.BALL_TANGENT, k)
        row = base + 2 * i
        for j in range(balls):
            block = start + ring.BLOCK * (i - j if i >= j else i - j + balls)
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
        work[ring.LOCAL, 2 * j], work[ring.LOCAL, 2 * j + 1] = work[row, first + j], work[row, z + first + j]


@jit(void(MATRIX, int64, int64, int64))
def _scatter(work, row, first, balls):
    z = work.shape[1] // 2
    for j in range(balls):
        work[row, first + j], work[row, z + first + j] = work[ring.LOCAL, 2 * j], work[ring.LOCAL, 2 * j + 1]


@jit(void(VECTOR, MATRIX, int64))
def _solve_moves(scalars, work, row):
    """work[row] := (1 + A M)^-1 work[row]."""
    balls = int(scalars[ring.ROW])
    n = 2 * balls
    for first in range(0, work.shape[1] // 2, balls):
        base = ring.MATRIX_ROWS + 2 * first
        _gather(work, row, first, balls)
        for i in range(n):
            total = work[ring.LOCAL, i]
            for j in range(i):
                total -= work[base + i, j] * work[ring.LOCAL, j]
            work[ring.LOCAL, i] = total
        for i in range(n - 1, -1, -1):
            total = work[ring.LOCAL, i]
            for j in range(i + 1, n):
                total -= work[base + i, j] * work[ring.LOCAL, j]
            work[ring.LOCAL, i] = total / work[base + i, i]
        _scatter(work, row, first, balls)


@jit(void(VECTOR, MATRIX, int64))
def _solve_transposed(scalars, work, row):
    """work[row] := work[row] (1 + A M)^-1."""
    balls = int(scalars[ring.ROW])
    n = 2 * balls
    for first in range(0, work.shape[1] // 2, balls):
        base = ring.MATRIX_ROWS + 2 * first
        _gather(work, row, first, balls)
        for i in range(n):
            value = work[ring.LOCAL, i] / work[base + i, i]
            work[ring.LOCAL, i] = value
            for j in range(i + 1, n):
                work[ring.LOCAL, j] -= value * work[base + i, j]
        for i in range(n - 1, 0, -1):
            value = work[ring.LOCAL, i]
            for j in range(i):
                work[ring.LOCAL, j] -= value * work[base + i, j]
        _scatter(work, row, first, balls)


@jit(boolean(VECTOR, MATRIX, float64, MATRIX))
def step(scalars, table, ball_gain, work):
    """Newton steps of d, and of the structural approaches with them; False where the bodies take off more than there is.

    ``STEP`` holds the steps of the structural approaches at fixed d before.
    """
    z, balls = table.shape[0], int(scalars[ring.ROW])
    for k in range(z):
        tangent, approach = _by_centre(scalars, work, k, 1.0, ball_gain)
        put_tensor(tangent, work, ring.BALL_TANGENT, k)
        put_tensor(approach, work, ring.APPROACH_BY_CENTRE, k)
        w, step_i, step_o = _by_shift(work, k), work[ring.STEP, k], work[ring.STEP, z + k]
        da = work[ring.CENTRIFUGAL_MOVED, k] - work[rows.MOVED, k]
        dr = work[ring.CENTRIFUGAL_MOVED, z + k] - work[rows.MOVED, z + k]
        work[ring.CARRIED, k] += w.aa * step_i + w.ar * step_o + tangent.aa * da + tangent.ar * dr
        work[ring.CARRIED, z + k] += w.ra * step_i + w.rr * step_o + tangent.ra * da + tangent.rr * dr
    for first in range(0, z, balls):
        if not _factorise(scalars, work, first, balls):
            return False
    _solve_moves(scalars, work, ring.CARRIED)
    _rings_times(scalars, work, ring.CARRIED, ring.MOVED_STEP)
    for c in range(2 * z):
        work[ring.MOVED_STEP, c] = work[ring.CENTRIFUGAL_MOVED, c] - work[ring.MOVED_STEP, c] - work[rows.MOVED, c]
    for k in range(z):
        da, dr = work[ring.MOVED_STEP, k], work[ring.MOVED_STEP, z + k]
        approach = tensor_of(work, ring.APPROACH_BY_CENTRE, k)
        work[ring.STEP, k] += approach.aa * da + approach.ar * dr
        work[ring.STEP, z + k] += approach.ra * da + approach.rr * dr
    return True


@jit(void(VECTOR, MATRIX, float64, MATRIX, MATRIX, MATRIX))
def reduce_tangents(scalars, table, ball_gain, work, K, C):
    """K and C (5, 5) of balls at fixed d, with d eliminated: A J - A M (1 + A M)^-1 A J."""
    z, arm, cross = table.shape[0], scalars[ring.TILT_ARM], scalars[ring.BALL_CROSS]
    rates = 0.0
    for k in range(z):
        seat = seat_of(k, arm, table, work, ring.DIRECTION)
        w, (di, do) = _by_shift(work, k), _by_angle(work, k)
        # By the turn of the section, and of the couple by d.
        qi, qo = work[rows.BY_TURN, k], work[rows.BY_TURN, z + k]
        by_turn = di * qi + do * qo
        approach = Pair(work[ring.OWN, k] * qi + cross * qo, cross * qi + work[ring.OWN, z + k] * qo)
        wi, wo = _approaches(scalars, work, k, approach)
        axial = work[rows.FORCE_BY_TURN, k] + by_turn * work[ring.TURNING, k] + w.aa * wi + w.ar * wo
        radial = work[rows.FORCE_BY_TURN, z + k] + by_turn * work[ring.TURNING, z + k] + w.ra * wi + w.rr * wo
        f, _ = _by_centre(scalars, work, k, 1.0, 0.0)
        to_ring(seat, Pair(f.aa, f.ar), axial, work, ring.BY_Q, k)
        to_ring(seat, Pair(f.ra, f.rr), radial, work, ring.BY_Q, z + k)
        f, _ = _by_centre(scalars, work, k, 0.0, 1.0)
        rates += abs(f.aa) + abs(f.rr)
        to_ring(seat, Pair(f.aa, f.ar), 0.0, work, ring.BY_V, k)
        to_ring(seat, Pair(f.ra, f.rr), 0.0, work, ring.BY_V, z + k)
        for side in range(2):
            d = k + side * z
            turn = work[rows.COUPLE_BY_CENTRE, d]
            turn += work[rows.COUPLE_BY_SHIFT, k] * work[ring.APPROACH_BY_CENTRE, d]
            turn += work[rows.COUPLE_BY_SHIFT, z + k] * work[ring.APPROACH_BY_CENTRE + 1, d]
            to_ring(seat, Pair(work[ring.BALL_TANGENT, d], work[ring.BALL_TANGENT + 1, d]), turn, work, ring.RING, d)
    for i in range(5):
        _rings_times(scalars, work, ring.RING + i, ring.WEIGHT + i)
        _solve_transposed(scalars, work, ring.WEIGHT + i)
    add_products(work, ring.BY_Q, -1.0, K)
    if rates != 0.0:
        add_products(work, ring.BY_V, -1.0, C)
