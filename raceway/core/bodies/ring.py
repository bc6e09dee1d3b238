"""The inner ring's rigid motion seen from each ball's meridian plane.

Notes
-----
A row of balls has a side (+1: a positive axial motion of the inner ring seats it, -1: the mirror image), a lever X (its
axial distance from the reference point) and a shift (axial approach built in by the preload of a pair).  The vector
from the outer to the inner groove centre is e = (e_rest + shift + side (x + R (tilt_y sin - tilt_z cos)),
e_rest + (y + X tilt_z) cos + (z - X tilt_y) sin).
"""

import numpy as np
from numba import float64, void

from raceway.core.jit import jit
from raceway.core.signatures import MATRIX, VECTOR

#: Entries of ``scalars``.  CAGE: speed of orbiting balls [rad/s].  The last ones belong to ``rigid_tangential``:
#: friction coefficient, stick stiffness [N/m], shares of the gyroscopic moment (inner + outer = 2), D / d_m,
#: J * spin * cage speed [N m], ball diameter [m].
(
    REST_AXIAL, REST_RADIAL, OFFSET_INNER, OFFSET_OUTER, TILT_ARM, DAMPING, CAGE,
    FRICTION, STICK, SHARE_INNER, SHARE_OUTER, BALL_OVER_PITCH, GYROSCOPIC, DIAMETER,
) = range(14)  # fmt: skip
SCALARS = 14
#: Columns of ``table``, one row a ball: direction of the azimuth at time zero, centrifugal force [N], share of the
#: approach that the outer race takes under Hertz, Hertz factor of the outer race [N/m^1.5], side, lever [m], shift [m].
COSINE, SINE, CENTRIFUGAL, OUTER_SHARE, OUTER_FACTOR, SIDE, LEVER, SHIFT = range(8)
COLUMNS = 8


@jit(void(float64, VECTOR, VECTOR, VECTOR, MATRIX, VECTOR, VECTOR, VECTOR, VECTOR, VECTOR, VECTOR))
def place(t, q, v, scalars, table, ea, er, va, vr, cosine, sine):
    """e (axial ea, radial er), its velocity (va, vr) and the direction of the azimuth of every ball; all (Z,)."""
    arm, cage = scalars[4], scalars[6]
    turn_c, turn_s = 1.0, 0.0
    if cage != 0.0:
        turn_c, turn_s = np.cos(cage * t), np.sin(cage * t)
    for k in range(table.shape[0]):
        c, s = table[k, 0], table[k, 1]
        if cage != 0.0:
            c, s = c * turn_c - s * turn_s, s * turn_c + c * turn_s
        side, lever = table[k, 5], table[k, 6]
        y, z = q[1] + lever * q[4], q[2] - lever * q[3]
        ea[k] = scalars[0] + table[k, 7] + side * (q[0] + arm * (q[3] * s - q[4] * c))
        er[k] = scalars[1] + y * c + z * s
        va[k] = side * (v[0] + arm * (v[3] * s - v[4] * c))
        vr[k] = (v[1] + lever * v[4]) * c + (v[2] - lever * v[3]) * s
        if cage != 0.0:
            va[k] += cage * side * arm * (q[3] * c + q[4] * s)
            vr[k] += cage * (z * c - y * s)
        cosine[k], sine[k] = c, s


@jit(void(float64, VECTOR, MATRIX))
def stop(t, scalars, table):
    """Let orbiting balls stand still where they are at a time: a static state has no rates."""
    c, s = np.cos(scalars[6] * t), np.sin(scalars[6] * t)
    for k in range(table.shape[0]):
        table[k, 0], table[k, 1] = table[k, 0] * c - table[k, 1] * s, table[k, 1] * c + table[k, 0] * s
    scalars[6] = 0.0


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
    for j in range(5):
        row = ma * ja[j] + mr * jr[j] + mm * turn[j]
        for i in range(5):
            K[i, j] += turn[i] * row + (ja[i] * ka + jr[i] * kr) * turn[j]


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
    for j in range(5):
        ga, gr = kaa * ja[j] + kar * jr[j], kra * ja[j] + krr * jr[j]
        for i in range(5):
            K[i, j] += ja[i] * ga + jr[i] * gr
    if caa != 0.0 or crr != 0.0:
        for j in range(5):
            ga, gr = caa * ja[j] + car * jr[j], cra * ja[j] + crr * jr[j]
            for i in range(5):
                C[i, j] += ja[i] * ga + jr[i] * gr
