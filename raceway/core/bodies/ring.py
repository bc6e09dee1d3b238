"""The inner ring's rigid motion seen from one ball's meridian plane."""

from numba import float64, void

from raceway.core.jit import jit
from raceway.core.signatures import MATRIX, VECTOR

#: Entries of ``scalars`` that both rigid kernels read.
REST_AXIAL, REST_RADIAL, OFFSET_INNER, OFFSET_OUTER, TILT_ARM, DAMPING = range(6)
SCALARS = 8
#: Columns of ``table``, one row a ball: direction of the azimuth, centrifugal force [N], share of the approach that
#: the outer race takes under Hertz, Hertz factor of the outer race [N/m^1.5].
COSINE, SINE, CENTRIFUGAL, OUTER_SHARE, OUTER_FACTOR = range(5)
COLUMNS = 5


@jit(void(float64, float64, float64, float64, float64, float64, float64, float64, float64, float64, float64, float64, float64, VECTOR, MATRIX, MATRIX))  # fmt: skip
def add_ball(cosine, sine, arm, fa, fr, kaa, kar, kra, krr, caa, car, cra, crr, f, K, C):
    """Add one ball's force (axial fa, radial fr) and 2x2 tangents to the ring's f (5,), K and C (5, 5).

    Notes
    -----
    The inner groove centre moves by e = J q with J = [[1, 0, 0, R sin, -R cos], [0, cos, sin, 0, 0]].
    """
    a3, a4 = arm * sine, -arm * cosine
    f[0] += fa
    f[1] += cosine * fr
    f[2] += sine * fr
    f[3] += a3 * fa
    f[4] += a4 * fa
    for part in range(2):
        target = K if part == 0 else C
        if part == 0:
            aa, ar, ra, rr = kaa, kar, kra, krr
        else:
            aa, ar, ra, rr = caa, car, cra, crr
        if aa == 0.0 and rr == 0.0:
            continue
        target[0, 0] += aa
        target[0, 1] += ar * cosine
        target[0, 2] += ar * sine
        target[0, 3] += aa * a3
        target[0, 4] += aa * a4
        target[1, 0] += ra * cosine
        target[2, 0] += ra * sine
        target[3, 0] += aa * a3
        target[4, 0] += aa * a4
        target[1, 1] += rr * cosine * cosine
        target[1, 2] += rr * cosine * sine
        target[2, 1] += rr * cosine * sine
        target[2, 2] += rr * sine * sine
        target[1, 3] += ra * cosine * a3
        target[1, 4] += ra * cosine * a4
        target[2, 3] += ra * sine * a3
        target[2, 4] += ra * sine * a4
        target[3, 1] += ar * cosine * a3
        target[4, 1] += ar * cosine * a4
        target[3, 2] += ar * sine * a3
        target[4, 2] += ar * sine * a4
        target[3, 3] += aa * a3 * a3
        target[3, 4] += aa * a3 * a4
        target[4, 3] += aa * a3 * a4
        target[4, 4] += aa * a4 * a4
