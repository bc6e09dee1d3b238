"""The inner ring's rigid motion seen from each ball's meridian plane.

Notes
-----
A row of balls has a side (+1: a positive axial motion of the inner ring seats it, -1: the mirror image), a lever X (its
axial distance from the reference point) and a shift (axial approach built in by the preload of a set).  With
u = tilt_y sin - tilt_z cos and rho = y cos + z sin, the vector from the outer to the inner groove centre is
e = (e_rest + shift + side (x + R u), e_rest + rho - X u).  What ``scalars`` say of the grooves holds for all rows; a row that
differs has the difference in its own columns of ``table``.
"""

import numpy as np
from numba import float64, int64, types, void

from raceway.core.jit import jit
from raceway.core.ring.kernels import MOVED, MOVED_RATE
from raceway.core.signatures import CONSTANTS, MATRIX, VECTOR

#: Entries of ``scalars``.  CAGE: speed of orbiting balls [rad/s].  The last ones belong to ``rigid_tangential``:
#: friction coefficient, stick stiffness [N/m], shares of the gyroscopic moment (inner + outer = 2), D / d_m,
#: J * spin * cage speed [N m], ball diameter [m].  TIME_CONSTANT: of the contacts' damping [s].
(
    REST_AXIAL, REST_RADIAL, OFFSET_INNER, OFFSET_OUTER, TILT_ARM, DAMPING, CAGE,
    FRICTION, STICK, SHARE_INNER, SHARE_OUTER, BALL_OVER_PITCH, GYROSCOPIC, DIAMETER, TIME_CONSTANT,
) = range(15)  # fmt: skip
SCALARS = 15
#: Columns of ``table``, one row a ball: direction of the azimuth at time zero, centrifugal force [N], share of the
#: approach that the outer race takes under Hertz, Hertz factor of the outer race [N/m^1.5], side, lever [m], shift [m].
COSINE, SINE, CENTRIFUGAL, OUTER_SHARE, OUTER_FACTOR, SIDE, LEVER, SHIFT = range(8)
#: Columns of what a ball's row has beyond the scalars of the same name without OWN: 0 in a set of equal rows.
OWN_REST_AXIAL, OWN_REST_RADIAL, OWN_OFFSET_INNER, OWN_OFFSET_OUTER, OWN_TILT_ARM = range(8, 13)
COLUMNS = 13


@jit(void(float64, VECTOR, VECTOR, CONSTANTS, MATRIX, types.UniTuple(int64, 3)))
def place(t, q, v, constants, work, rows):
    """Of every ball: the azimuth's cos and sin, e (axial, radial) and its velocity, into three ``rows`` of ``work``.

    Notes
    -----
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
        own, reach = table[k, OWN_REST_RADIAL], arm + table[k, OWN_TILT_ARM]
        c, s = cosine * turn_c - sine * turn_s, sine * turn_c + cosine * turn_s
        u, u_rate = tilt_y * s - tilt_z * c, turn_y * s - turn_z * c
        work[direction, k], work[direction, n + k] = c, s
        work[centre, k], work[centre, n + k] = (
            rest_a + shift + side * (x + reach * u),
            rest_r + own + y * c + z * s - lever * u,
        )
        work[velocity, k] = side * (vx + reach * u_rate)
        work[velocity, n + k] = vy * c + vz * s - lever * u_rate


@jit(void(MATRIX, int64, int64))
def move_centres(work, centre, velocity):
    """Add to e and its velocity what the rings' elasticity moves the groove centres of condensed bodies by."""
    for c in range(work.shape[1]):
        work[centre, c] += work[MOVED, c]
        work[velocity, c] += work[MOVED_RATE, c]


@jit(void(float64, VECTOR, MATRIX))
def stop(t, scalars, table):
    """Let orbiting balls stand still where they are at a time: a static state has no rates."""
    c, s = np.cos(scalars[CAGE] * t), np.sin(scalars[CAGE] * t)
    for k in range(table.shape[0]):
        cosine, sine = table[k, COSINE], table[k, SINE]
        table[k, COSINE], table[k, SINE] = cosine * c - sine * s, sine * c + cosine * s
    scalars[CAGE] = 0.0


@jit(void(MATRIX, float64, MATRIX, int64, int64, VECTOR), inline=True)
def ring_force(table, arm, work, direction, row, f):
    """f (5,): the balls' forces on the ring [N], from work[row] = axial (Z,), radial (Z,); f = sum J^T (axial, radial).

    ``direction`` is the row that ``place`` put the azimuths in.
    """
    n = table.shape[0]
    x, y, z, tilt_y, tilt_z = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(n):
        c, s = work[direction, k], work[direction, n + k]
        axial, radial = table[k, SIDE] * work[row, k], work[row, n + k]
        couple = (arm + table[k, OWN_TILT_ARM]) * axial - table[k, LEVER] * radial
        x += axial
        y += radial * c
        z += radial * s
        tilt_y += couple * s
        tilt_z += couple * c
    f[0], f[1], f[2], f[3], f[4] = x, y, z, tilt_y, -tilt_z


@jit(void(MATRIX, float64, MATRIX, int64, int64, MATRIX))
def ring_tangent(table, arm, work, direction, row, K):
    """K (5, 5): sum of J^T [[aa, ar], [ra, rr]] J over the balls.

    Parameters
    ----------
    work : work[row] = aa (Z,), ar (Z,);  work[row + 1] = ra (Z,), rr (Z,)

    Notes
    -----
    Each ball's tangent is taken to the three coordinates x, rho and u first; all entries are then sums times 1, cos, sin
    and their products, kept in registers: three times as fast as adding each ball to K in memory.
    """
    xx, xr_c, xr_s, rx_c, rx_s = 0.0, 0.0, 0.0, 0.0, 0.0
    xu_c, xu_s, ux_c, ux_s = 0.0, 0.0, 0.0, 0.0
    rr_cc, rr_cs, rr_ss = 0.0, 0.0, 0.0
    ru_cc, ru_cs, ru_ss, ur_cc, ur_cs, ur_ss = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    uu_cc, uu_cs, uu_ss = 0.0, 0.0, 0.0
    z = table.shape[0]
    for k in range(z):
        c, s, lever, reach = work[direction, k], work[direction, z + k], table[k, LEVER], arm + table[k, OWN_TILT_ARM]
        aa, ar = work[row, k], table[k, SIDE] * work[row, z + k]
        ra, rr = table[k, SIDE] * work[row + 1, k], work[row + 1, z + k]
        cc, cs, ss = c * c, c * s, s * s
        xu, ux = reach * aa - lever * ar, reach * aa - lever * ra
        ru, ur = reach * ra - lever * rr, reach * ar - lever * rr
        uu = reach * xu - lever * ru
        xx += aa
        xr_c += ar * c
        xr_s += ar * s
        rx_c += ra * c
        rx_s += ra * s
        xu_c += xu * c
        xu_s += xu * s
        ux_c += ux * c
        ux_s += ux * s
        rr_cc += rr * cc
        rr_cs += rr * cs
        rr_ss += rr * ss
        ru_cc += ru * cc
        ru_cs += ru * cs
        ru_ss += ru * ss
        ur_cc += ur * cc
        ur_cs += ur * cs
        ur_ss += ur * ss
        uu_cc += uu * cc
        uu_cs += uu * cs
        uu_ss += uu * ss
    K[0, 0], K[0, 1], K[0, 2], K[0, 3], K[0, 4] = xx, xr_c, xr_s, xu_s, -xu_c
    K[1, 0], K[1, 1], K[1, 2], K[1, 3], K[1, 4] = rx_c, rr_cc, rr_cs, ru_cs, -ru_cc
    K[2, 0], K[2, 1], K[2, 2], K[2, 3], K[2, 4] = rx_s, rr_cs, rr_ss, ru_ss, -ru_cs
    K[3, 0], K[3, 1], K[3, 2], K[3, 3], K[3, 4] = ux_s, ur_cs, ur_ss, uu_ss, -uu_cs
    K[4, 0], K[4, 1], K[4, 2], K[4, 3], K[4, 4] = -ux_c, -ur_cc, -ur_cs, -uu_cs, uu_cc
