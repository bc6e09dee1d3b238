"""The inner ring's rigid motion seen from one ball's meridian plane."""

from numba import float64, int64, void

from raceway.core.jit import jit
from raceway.core.signatures import MATRIX, VECTOR

#: Entries of ``scalars`` that both rigid kernels read.
REST_AXIAL, REST_RADIAL, OFFSET_INNER, OFFSET_OUTER, TILT_ARM, DAMPING = range(6)
SCALARS = 8
#: Columns of ``table``, one row a ball: direction of the azimuth, centrifugal force [N], share of the approach that
#: the outer race takes under Hertz, Hertz factor of the outer race [N/m^1.5].
COSINE, SINE, CENTRIFUGAL, OUTER_SHARE, OUTER_FACTOR = range(5)
COLUMNS = 5


# Kernels below take rows of ``work`` by their number: a view of an array costs two atomic operations, and a kernel's
# views together cost as much as its arithmetic.


@jit(void(MATRIX, float64, MATRIX, int64, VECTOR))
def ring_force(table, arm, work, row, f):
    """f (5,): the balls' forces on the ring [N], from work[row] = axial (Z,), radial (Z,).

    Notes
    -----
    The inner groove centre moves by e = J q with J = [[1, 0, 0, R sin, -R cos], [0, cos, sin, 0, 0]]; f = sum J^T (axial,
    radial).
    """
    n = table.shape[0]
    x, y, z, tilt_y, tilt_z = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(n):
        c, s = table[k, 0], table[k, 1]
        axial, radial = work[row, k], work[row, n + k]
        x += axial
        y += radial * c
        z += radial * s
        tilt_y += axial * s
        tilt_z += axial * c
    f[0], f[1], f[2], f[3], f[4] = x, y, z, arm * tilt_y, -arm * tilt_z


@jit(void(MATRIX, float64, MATRIX, int64, MATRIX))
def ring_tangent(table, arm, work, row, K):
    """K (5, 5): sum of J^T [[aa, ar], [ra, rr]] J over the balls; J as in ``ring_force``.

    Parameters
    ----------
    work : work[row] = aa (Z,), ar (Z,);  work[row + 1] = ra (Z,), rr (Z,)

    Notes
    -----
    All entries are sums of the balls' numbers times 1, cos, sin and their products, kept in registers: three times as
    fast as adding each ball to K in memory.
    """
    a, a_s, a_c, a_ss, a_cs, a_cc = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    u_c, u_s, u_cc, u_cs, u_ss = 0.0, 0.0, 0.0, 0.0, 0.0
    v_c, v_s, v_cc, v_cs, v_ss = 0.0, 0.0, 0.0, 0.0, 0.0
    r_cc, r_cs, r_ss = 0.0, 0.0, 0.0
    z = table.shape[0]
    for k in range(z):
        c, s = table[k, 0], table[k, 1]
        aa, ar, ra, rr = work[row, k], work[row, z + k], work[row + 1, k], work[row + 1, z + k]
        cc, cs, ss = c * c, c * s, s * s
        a += aa
        a_s += aa * s
        a_c += aa * c
        a_ss += aa * ss
        a_cs += aa * cs
        a_cc += aa * cc
        u_c += ar * c
        u_s += ar * s
        u_cc += ar * cc
        u_cs += ar * cs
        u_ss += ar * ss
        v_c += ra * c
        v_s += ra * s
        v_cc += ra * cc
        v_cs += ra * cs
        v_ss += ra * ss
        r_cc += rr * cc
        r_cs += rr * cs
        r_ss += rr * ss
    K[0, 0], K[0, 1], K[0, 2], K[0, 3], K[0, 4] = a, u_c, u_s, arm * a_s, -arm * a_c
    K[1, 0], K[1, 1], K[1, 2], K[1, 3], K[1, 4] = v_c, r_cc, r_cs, arm * v_cs, -arm * v_cc
    K[2, 0], K[2, 1], K[2, 2], K[2, 3], K[2, 4] = v_s, r_cs, r_ss, arm * v_ss, -arm * v_cs
    K[3, 0], K[3, 1], K[3, 2], K[3, 3], K[3, 4] = arm * a_s, arm * u_cs, arm * u_ss, arm * arm * a_ss, -arm * arm * a_cs
    K[4, 0], K[4, 1], K[4, 2], K[4, 3], K[4, 4] = -arm * a_c, -arm * u_cc, -arm * u_cs, -arm * arm * a_cs, arm * arm * a_cc
