"""One ball's contribution to the ring, added to arrays: for kernels whose balls need more than a 2x2 tangent."""

from typing import NamedTuple

from numba import float64, int64, types, void

from raceway.core.jit import jit
from raceway.core.ring.kernels.layout import LEVER, SIDE
from raceway.core.ring.kernels.planar import PAIR, TENSOR
from raceway.core.signatures import MATRIX, VECTOR


class Seat(NamedTuple):
    """How a ball's meridian plane meets the ring: azimuth, radius of the tilts' lever [m], side (+1, -1), lever X [m]."""

    cosine: float
    sine: float
    arm: float
    side: float
    lever: float


SEAT = types.NamedUniTuple(float64, 5, Seat)


@jit(SEAT(int64, float64, MATRIX, MATRIX, int64), inline=True)
def seat_of(k, arm, table, work, direction):
    """The seat of ball k, whose azimuth is in the row ``direction`` of ``work``."""
    return Seat(work[direction, k], work[direction, table.shape[0] + k], arm, table[k, SIDE], table[k, LEVER])


@jit(void(SEAT, PAIR, TENSOR, TENSOR, VECTOR, MATRIX, MATRIX))
def add_ball(seat, force, stiffness, damping, f, K, C):
    """Add one ball's force [N] and its derivatives by e and by its velocity to the ring's f (5,), K and C (5, 5).

    Notes
    -----
    e = J q with the rows J_a = side (1, 0, 0, R s, -R c) and J_r = (0, c, s, -X s, X c).
    """
    c, s, arm, side, lever = seat
    ja = (side, 0.0, 0.0, side * arm * s, -side * arm * c)
    jr = (0.0, c, s, -lever * s, lever * c)
    for i in range(5):
        f[i] += ja[i] * force.axial + jr[i] * force.radial
    if K.size == 0:
        return
    for j in range(5):
        ga, gr = stiffness.aa * ja[j] + stiffness.ar * jr[j], stiffness.ra * ja[j] + stiffness.rr * jr[j]
        for i in range(5):
            K[i, j] += ja[i] * ga + jr[i] * gr
    if damping.aa != 0.0 or damping.rr != 0.0:
        for j in range(5):
            ga, gr = damping.aa * ja[j] + damping.ar * jr[j], damping.ra * ja[j] + damping.rr * jr[j]
            for i in range(5):
                C[i, j] += ja[i] * ga + jr[i] * gr


@jit(void(SEAT, PAIR, float64, MATRIX, int64, int64))
def to_ring(seat, force, turn, work, row, column):
    """J^T force and the turn of the ball's section, into a column of the five rows of ``work`` from ``row`` on."""
    axial = force.axial * seat.side
    couple = seat.arm * axial - seat.lever * force.radial + seat.side * turn
    work[row, column] = axial
    work[row + 1, column], work[row + 2, column] = force.radial * seat.cosine, force.radial * seat.sine
    work[row + 3, column], work[row + 4, column] = couple * seat.sine, -couple * seat.cosine


@jit(void(SEAT, float64, PAIR, PAIR, float64, VECTOR, MATRIX))
def add_couple(seat, couple, force_by_turn, by_centre, by_turn, f, K):
    """Add the couple [N m] that tangential forces put on a ball's section of the ring, with its derivatives.

    Parameters
    ----------
    force_by_turn : derivative of the ball's force by the turn of its section, side (tilt_y s - tilt_z c)
    by_centre, by_turn : of the couple by e and by that turn
    """
    c, s, arm, side, lever = seat
    turn = (0.0, 0.0, 0.0, side * s, -side * c)
    ja = (side, 0.0, 0.0, side * arm * s, -side * arm * c)
    jr = (0.0, c, s, -lever * s, lever * c)
    for i in range(5):
        f[i] += turn[i] * couple
    if K.size == 0:
        return
    for j in range(5):
        moment = by_centre.axial * ja[j] + by_centre.radial * jr[j] + by_turn * turn[j]
        for i in range(5):
            K[i, j] += turn[i] * moment + (ja[i] * force_by_turn.axial + jr[i] * force_by_turn.radial) * turn[j]
