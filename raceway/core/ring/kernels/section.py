"""One ball's contribution to the ring, added to arrays: for kernels whose balls need more than a 2x2 tangent."""

from numba import float64, int64, void

from raceway.core.jit import jit
from raceway.core.ring.kernels.layout import LEVER, SIDE
from raceway.core.signatures import MATRIX, VECTOR


@jit(void(float64, float64, float64, float64, float64, float64, float64, float64, float64, float64, float64, float64, float64, float64, float64, VECTOR, MATRIX, MATRIX))  # fmt: skip
def add_ball(c, s, arm, side, lever, fa, fr, kaa, kar, kra, krr, caa, car, cra, crr, f, K, C):
    """Add one ball's force (axial fa, radial fr) and 2x2 tangents to the ring's f (5,), K and C (5, 5).

    Notes
    -----
    e = J q with the rows J_a = side (1, 0, 0, R s, -R c) and J_r = (0, c, s, -X s, X c).
    """
    ja = (side, 0.0, 0.0, side * arm * s, -side * arm * c)
    jr = (0.0, c, s, -lever * s, lever * c)
    for i in range(5):
        f[i] += ja[i] * fa + jr[i] * fr
    if K.size == 0:
        return
    for j in range(5):
        ga, gr = kaa * ja[j] + kar * jr[j], kra * ja[j] + krr * jr[j]
        for i in range(5):
            K[i, j] += ja[i] * ga + jr[i] * gr
    if caa != 0.0 or crr != 0.0:
        for j in range(5):
            ga, gr = caa * ja[j] + car * jr[j], cra * ja[j] + crr * jr[j]
            for i in range(5):
                C[i, j] += ja[i] * ga + jr[i] * gr


@jit(void(float64, float64, MATRIX, MATRIX, int64, float64, float64, float64, float64, int64, int64))
def to_ring(c, s, table, work, k, arm, axial, radial, turn, row, column):
    """J^T (axial, radial) and the turn of ball k's section, into a column of the five rows of ``work`` from ``row`` on."""
    axial *= table[k, SIDE]
    couple = arm * axial - table[k, LEVER] * radial + table[k, SIDE] * turn
    work[row, column] = axial
    work[row + 1, column], work[row + 2, column] = radial * c, radial * s
    work[row + 3, column], work[row + 4, column] = couple * s, -couple * c


@jit(void(float64, float64, float64, float64, float64, float64, float64, float64, float64, float64, float64, VECTOR, MATRIX))  # fmt: skip
def add_couple(c, s, arm, side, lever, couple, ka, kr, ma, mr, mm, f, K):
    """Add the couple [N m] that tangential forces put on a ball's section of the ring, with its derivatives.

    Notes
    -----
    The section turns by side (tilt_y s - tilt_z c).  (ka, kr): derivative of the ball's force by that turn, (ma, mr) of
    the couple by e, mm of the couple by the turn.
    """
    turn = (0.0, 0.0, 0.0, side * s, -side * c)
    ja = (side, 0.0, 0.0, side * arm * s, -side * arm * c)
    jr = (0.0, c, s, -lever * s, lever * c)
    for i in range(5):
        f[i] += turn[i] * couple
    if K.size == 0:
        return
    for j in range(5):
        row = ma * ja[j] + mr * jr[j] + mm * turn[j]
        for i in range(5):
            K[i, j] += turn[i] * row + (ja[i] * ka + jr[i] * kr) * turn[j]
