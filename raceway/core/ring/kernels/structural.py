"""Elastic rings and balls around any of the rigid kernels: contacts and structural compliances in series.

The bodies add w = C(beta) Q to the gaps: Q (2 Z,) are the contact forces, C the structural compliances [m/N], what
finite elements give beyond the half-spaces that the law knows already: the rings' and balls' own share c(beta), tabulated
over the angle beta of the line of groove centres, with a continuous slope, constant beyond its ends, and a load on the
ball's other race (constant).  Where balls act on each other through the rings, groove centres move as vectors, too, and c
is what is left beyond that: see ``between``.

A rigid kernel finds balls and forces for given w, and their derivatives S = dQ/dw ball by ball; Newton's method on
w - C Q(w) = 0 with I - C S does the rest.  Potential: U(gaps) + Q.C Q / 2, so the change of c with the angle turns the
ring with -Q^2 c'/2 about each ball's groove, and the tangent, by implicit differentiation, is symmetric.

The separation into near and far field: docs/physics.md, condensed bodies.
"""

from functools import cache

import numpy as np
from numba import boolean, float64, int64, types, void
from numba.extending import register_jitable

from raceway.core.jit import Kernel, jit
from raceway.core.ring import kernels as rows
from raceway.core.ring.kernels import layout as ring
from raceway.core.ring.kernels.between import centrifugal_displacement, forces, reduce_tangents, step
from raceway.core.ring.kernels.layout import add_ball, add_products, place, seat_of, slips_end, to_ring
from raceway.core.ring.kernels.tensors import Pair, Tensor, put_tensor, tensor_of, weighted_sum
from raceway.core.signatures import CONSTANTS, MATRIX, SYSTEM, VECTOR

#: Iterations until it is given up, and answers of ``_correct``.
ITERATIONS = 60
GOES_ON, SETTLED, FAILED = range(3)


@jit(types.Tuple((int64, float64, boolean))(float64, VECTOR), inline=True)
def knot_before(x, scalars):
    """Which knot of the table of compliances x lies behind, in distances of knots from the first one, how far, and whether between two."""
    last = scalars[ring.KNOTS] - 1.0
    inside = 0.0 < x < last
    x = x if inside else last if x > 0.0 else 0.0
    i = min(int(x), int(last) - 1)
    return i, x - i, inside


@register_jitable
def spline(u, p, q, m, n):
    """The cubic from p with slope m to q with slope n, its slope and curvature at u of the way."""
    a2, a3 = 3.0 * (q - p) - 2.0 * m - n, 2.0 * (p - q) + m + n
    return p + u * (m + u * (a2 + u * a3)), m + u * (2.0 * a2 + u * 3.0 * a3), 2.0 * a2 + 6.0 * a3 * u


@jit(void(VECTOR, MATRIX))
def _compliances(scalars, work):
    """Angles of the lines of groove centres, with the compliances, their slopes and curvatures there."""
    z = work.shape[1] // 2
    for k in range(z):
        a, r = work[ring.CENTRE, k] + work[rows.MOVED, k], work[ring.CENTRE, z + k] + work[rows.MOVED, z + k]
        inverse = 1.0 / max(a * a + r * r, 1e-300)
        work[ring.TURNING, k], work[ring.TURNING, z + k] = r * inverse, -a * inverse
        distance, knots = scalars[ring.DISTANCE], int(scalars[ring.KNOTS])
        i, u, inside = knot_before((np.arctan2(a, r) - scalars[ring.FIRST]) / distance, scalars)
        for c in (k, z + k):
            first = ring.VALUES + i + (0 if c == k else 2 * knots)
            p, q, m, n = scalars[first], scalars[first + 1], scalars[first + knots], scalars[first + knots + 1]
            work[ring.OWN, c], slope, curve = spline(u, p, q, m, n)
            work[ring.SLOPE, c] = slope / distance if inside else 0.0
            work[ring.CURVE, c] = curve / (distance * distance) if inside else 0.0


@jit(void(float64, VECTOR, VECTOR, CONSTANTS, MATRIX))
def _begin(t, q, v, constants, work):
    """Lines of groove centres and the compliances there."""
    scalars, table = constants
    place(t, q, v, constants, work, (ring.DIRECTION, ring.CENTRE, ring.SPEED))
    work[ring.NORM, 0] = np.inf
    if scalars[ring.COUPLED] == 0.0:
        _compliances(scalars, work)
    else:
        centrifugal_displacement(scalars, table, work)


@jit(void(VECTOR, MATRIX, float64, MATRIX, MATRIX))
def _shift(scalars, ball, ball_gain, ball_history, work):
    """Hand structural approaches and displacements of groove centres, the last columns of ``ball``, to the rigid kernel."""
    z, first = ball.shape[0], slips_end(scalars, ball)
    for k in range(z):
        for side in range(2):
            w = ball[k, first + side]
            work[rows.SHIFT, k + side * z] = w
            work[rows.SHIFT_RATE, k + side * z] = ball_gain * w + ball_history[k, first + side]
    if scalars[ring.COUPLED] == 0.0:
        return
    for k in range(z):
        for c in range(2):
            d = ball[k, first + 2 + c]
            work[rows.MOVED, k + c * z] = d
            work[rows.MOVED_RATE, k + c * z] = ball_gain * d + ball_history[k, first + 2 + c]
    _compliances(scalars, work)


@jit(float64(VECTOR, MATRIX, int64, int64))
def _compliance_times(scalars, work, row, c):
    """Entry c of C x with x = work[row]."""
    z = work.shape[1] // 2
    return work[ring.OWN, c] * work[row, c] + scalars[ring.BALL_CROSS] * work[row, c + z if c < z else c - z]


@jit(boolean(VECTOR, MATRIX))
def _factorise(scalars, work):
    """I - C S as inverses ball by ball; False where the bodies take off more than there is.

    The matrix is similar to a positive definite one, and close to the identity.
    """
    z, cross = work.shape[1] // 2, scalars[ring.BALL_CROSS]
    for k in range(z):
        ci, co = work[ring.OWN, k], work[ring.OWN, z + k]
        sii, sio = work[rows.BY_OWN, k], work[rows.BY_OTHER, k]
        soi, soo = work[rows.BY_OTHER, z + k], work[rows.BY_OWN, z + k]
        mii, mio = 1.0 - ci * sii - cross * soi, -ci * sio - cross * soo
        moi, moo = -cross * sii - co * soi, 1.0 - cross * sio - co * soo
        det = mii * moo - mio * moi
        if not det > 0.0:
            return False
        put_tensor(Tensor(moo / det, -mio / det, -moi / det, mii / det), work, ring.INVERSE, k)
    return True


@jit(void(MATRIX, int64))
def _solve_transposed(work, row):
    """work[row] := work[row] (I - C S)^-1."""
    z = work.shape[1] // 2
    for k in range(z):
        a, b, m = work[row, k], work[row, z + k], tensor_of(work, ring.INVERSE, k)
        work[row, k], work[row, z + k] = a * m.aa + b * m.ra, a * m.ar + b * m.rr


@jit(types.UniTuple(float64, 2)(int64, VECTOR, MATRIX, MATRIX), inline=True)
def _rests(first, scalars, ball, work):
    """What is left of the structural approaches, into STEP, and the energy that bodies store: largest rest, deepest approach [m]."""
    z = ball.shape[0]
    norm, deepest = 0.0, 0.0
    for c in range(2 * z):
        k, side = (c, 0) if c < z else (c - z, 1)
        w = ball[k, first + side]
        residual = _compliance_times(scalars, work, rows.CONTACT_FORCE, c) - w
        work[ring.STEP, c] = residual
        # Second order in what is left: the force times w, less half of what its part C Q would store.
        work[rows.STORED, c] = 0.5 * work[rows.CONTACT_FORCE, c] * (w - residual)
        norm = max(norm, abs(residual))
        deepest = max(deepest, -work[rows.GAP, c])
    return norm, deepest


@jit(boolean(int64, boolean, float64, MATRIX, MATRIX), inline=True)
def _go(first, coupled, deepest, ball, work):
    """Take a step; whether it was so small that what it leaves is of second order."""
    z, at_rest = ball.shape[0], True
    for c in range(2 * z):
        k, side = (c, 0) if c < z else (c - z, 1)
        ball[k, first + side] += work[ring.STEP, c]
        work[ring.LAST, c] = work[ring.STEP, c]
        at_rest = at_rest and abs(work[ring.STEP, c]) <= max(1e-8 * -work[rows.GAP, c], 1e-10 * deepest)
        if coupled:
            ball[k, first + 2 + side] += work[ring.MOVED_STEP, c]
            work[ring.MOVED_LAST, c] = work[ring.MOVED_STEP, c]
            at_rest = at_rest and abs(work[ring.MOVED_STEP, c]) <= 1e-8 * deepest
    return at_rest


@jit(void(int64, VECTOR, MATRIX, float64, MATRIX, VECTOR), inline=True)
def _follow_linearly(k, scalars, table, ball_gain, work, f):
    """Forces of ball k and f (5,) after the last step."""
    z = table.shape[0]
    a, b = work[ring.STEP, k], work[ring.STEP, z + k]
    inner = work[rows.CONTACT_FORCE, k] + work[rows.BY_OWN, k] * a + work[rows.BY_OTHER, k] * b
    outer = work[rows.CONTACT_FORCE, z + k] + work[rows.BY_OTHER, z + k] * a + work[rows.BY_OWN, z + k] * b
    w = tensor_of(work, rows.AXIAL_BY_SHIFT, k)
    axial, radial = w.aa * a + w.ar * b, w.ra * a + w.rr * b
    turn = work[rows.COUPLE_BY_SHIFT, k] * a + work[rows.COUPLE_BY_SHIFT, z + k] * b
    if scalars[ring.COUPLED] != 0.0:
        da, dr = work[ring.MOVED_STEP, k], work[ring.MOVED_STEP, z + k]
        q, f_d = tensor_of(work, rows.BY_AXIAL, k), tensor_of(work, rows.FORCE_BY_CENTRE, k)
        q = weighted_sum(1.0, q, ball_gain, tensor_of(work, rows.BY_AXIAL_SPEED, k))
        f_d = weighted_sum(1.0, f_d, ball_gain, tensor_of(work, rows.FORCE_BY_SPEED, k))
        inner, outer = inner + q.aa * da + q.ra * dr, outer + q.ar * da + q.rr * dr
        axial, radial = axial + f_d.aa * da + f_d.ar * dr, radial + f_d.ra * da + f_d.rr * dr
        turn += work[rows.COUPLE_BY_CENTRE, k] * da + work[rows.COUPLE_BY_CENTRE, z + k] * dr
    work[rows.CONTACT_FORCE, k], work[rows.CONTACT_FORCE, z + k] = max(inner, 0.0), max(outer, 0.0)
    axial *= table[k, ring.SIDE]
    couple = (
        (scalars[ring.TILT_ARM] + table[k, ring.OWN_TILT_ARM]) * axial
        - table[k, ring.LEVER] * radial
        + table[k, ring.SIDE] * turn
    )
    cosine, sine = work[ring.DIRECTION, k], work[ring.DIRECTION, z + k]
    f[0] += axial
    f[1] += radial * cosine
    f[2] += radial * sine
    f[3] += couple * sine
    f[4] -= couple * cosine


@jit(int64(VECTOR, MATRIX, MATRIX, float64, MATRIX, VECTOR))
def _correct(scalars, table, ball, ball_gain, work, f):
    """One Newton step on structural approaches and displacements after a rigid kernel; the last one is a linear correction.

    Returns int: ``GOES_ON``, ``SETTLED`` (forces and f are corrected; ``_tangents`` may follow) or ``FAILED``.
    """
    z, first = table.shape[0], slips_end(scalars, ball)
    coupled = scalars[ring.COUPLED] != 0.0
    norm, deepest = _rests(first, scalars, ball, work)
    if coupled:
        forces(scalars, table, work)
        for c in range(2 * z):
            norm = max(norm, abs(work[ring.MOVED_REST, c]))
    if not np.isfinite(norm):
        return FAILED
    if norm > work[ring.NORM, 0] and norm > 1e-9 * deepest:
        # Worse than before the last step, half of which is taken back.
        for c in range(2 * z):
            k, side = (c, 0) if c < z else (c - z, 1)
            work[ring.LAST, c] *= 0.5
            ball[k, first + side] -= work[ring.LAST, c]
            if coupled:
                work[ring.MOVED_LAST, c] *= 0.5
                ball[k, first + 2 + side] -= work[ring.MOVED_LAST, c]
        return GOES_ON
    work[ring.NORM, 0] = norm
    if not _factorise(scalars, work):
        return FAILED
    for k in range(z):
        a, b, m = work[ring.STEP, k], work[ring.STEP, z + k], tensor_of(work, ring.INVERSE, k)
        work[ring.STEP, k], work[ring.STEP, z + k] = m.aa * a + m.ar * b, m.ra * a + m.rr * b
    if coupled and not step(scalars, table, ball_gain, work):
        return FAILED
    if not _go(first, coupled, deepest, ball, work):
        return GOES_ON
    for k in range(z):
        _follow_linearly(k, scalars, table, ball_gain, work, f)
    return SETTLED


@jit(void(int64, float64, MATRIX, MATRIX, VECTOR, MATRIX))
def _add_turning(k, arm, table, work, f, K):
    """Add what ball k's compliances, which change with the angle, do to the ring: force and tangent."""
    z = table.shape[0]
    ga, gr = work[ring.TURNING, k], work[ring.TURNING, z + k]
    by_angle, twice = 0.0, 0.0
    for c in (k, z + k):
        half = -0.5 * work[rows.CONTACT_FORCE, c] * work[rows.CONTACT_FORCE, c]
        by_angle += half * work[ring.SLOPE, c]
        twice += half * work[ring.CURVE, c]
    if by_angle == 0.0 and twice == 0.0:
        return
    haa, har = 2.0 * ga * gr, gr * gr - ga * ga
    cross = twice * ga * gr + by_angle * har
    stiffness = Tensor(twice * ga * ga + by_angle * haa, cross, cross, twice * gr * gr - by_angle * haa)
    seat = seat_of(k, arm, table, work, ring.DIRECTION)
    add_ball(seat, Pair(by_angle * ga, by_angle * gr), stiffness, f, K)


@jit(float64(int64, float64, MATRIX, MATRIX))
def _rows_of_ball(k, arm, table, work):
    """Fill the columns of both contacts of ball k in BY_Q, BY_V, TURN and RING; the size of their derivatives by velocity."""
    z, rates = table.shape[0], 0.0
    ga, gr = work[ring.TURNING, k], work[ring.TURNING, z + k]
    seat = seat_of(k, arm, table, work, ring.DIRECTION)
    for c in (k, z + k):
        opposite = z + k if c == k else k
        to_ring(seat, Pair(work[rows.BY_AXIAL, c], work[rows.BY_RADIAL, c]), work[rows.BY_TURN, c], work, ring.BY_Q, c)
        to_ring(seat, Pair(work[rows.BY_AXIAL_SPEED, c], work[rows.BY_RADIAL_SPEED, c]), 0.0, work, ring.BY_V, c)
        rates += abs(work[rows.BY_AXIAL_SPEED, c]) + abs(work[rows.BY_RADIAL_SPEED, c])
        d = -work[rows.CONTACT_FORCE, c] * work[ring.SLOPE, c]
        to_ring(seat, Pair(d * ga, d * gr), 0.0, work, ring.TURN, c)
        # B + D^T S: a shift changes the forces that turn the ring, too.
        d = (
            d * work[rows.BY_OWN, c]
            - work[rows.CONTACT_FORCE, opposite] * work[ring.SLOPE, opposite] * work[rows.BY_OTHER, opposite]
        )
        by_shift = Pair(work[rows.AXIAL_BY_SHIFT, c] + d * ga, work[rows.RADIAL_BY_SHIFT, c] + d * gr)
        to_ring(seat, by_shift, work[rows.COUPLE_BY_SHIFT, c], work, ring.RING, c)
    return rates


@jit(void(VECTOR, MATRIX, float64, MATRIX, VECTOR, MATRIX, MATRIX))
def _tangents(scalars, table, ball_gain, work, f, K, C):
    """Complete f (5,), and K and C (5, 5) where they are asked for, with what the bodies' elasticity adds.

    df = K dq + B dw + D^T dQ and dQ = A dq + S dw, w = C Q: dw = (I - C S)^-1 (C A - D) dq, where D holds -Q c' dbeta/dq.
    """
    z, arm, rates = table.shape[0], scalars[ring.TILT_ARM], 0.0
    for k in range(z):
        _add_turning(k, arm, table, work, f, K)
    if K.size == 0:
        return
    for k in range(z):
        rates += _rows_of_ball(k, arm, table, work)
    for i in range(5):
        _solve_transposed(work, ring.RING + i)
        for c in range(2 * z):
            # C is symmetric.
            work[ring.WEIGHT + i, c] = _compliance_times(scalars, work, ring.RING + i, c) + work[ring.TURN + i, c]
    for i in range(5):
        for j in range(5):
            total = 0.0
            for c in range(2 * z):
                total += work[ring.WEIGHT + i, c] * work[ring.BY_Q + j, c] - work[ring.RING + i, c] * work[ring.TURN + j, c]
            K[i, j] += total
    if rates != 0.0:
        add_products(work, ring.BY_V, 1.0, C)
    if scalars[ring.COUPLED] != 0.0:
        reduce_tangents(scalars, table, ball_gain, work, K, C)


@cache
def condensed(rigid: Kernel) -> Kernel:
    """The kernel of elastic rings and balls whose contacts, inertia and friction are those of a rigid kernel."""

    @jit(SYSTEM)
    def elastic(t, q, v, balls, contacts, constants, response):
        # See ``raceway.core.ring.kernels``; the last columns of ball belong to the elasticity of the bodies [m].
        ball, ball_gain, ball_history = balls
        scalars, table = constants
        f, K, C, work = response
        _begin(t, q, v, constants, work)
        for _ in range(ITERATIONS):
            _shift(scalars, ball, ball_gain, ball_history, work)
            status = rigid(t, q, v, balls, contacts, constants, response)
            if status != 0:
                return status
            answer = _correct(scalars, table, ball, ball_gain, work, f)
            if answer == SETTLED:
                _tangents(scalars, table, ball_gain, work, f, K, C)
                return 0
            if answer != GOES_ON:
                return 1
        return 1

    return elastic
