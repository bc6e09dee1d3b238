"""Rows of ``work`` that the elasticity of condensed bodies needs beyond those of ``raceway.core.ring.kernels``."""

from raceway.core.ring.kernels import KERNEL_ROWS, WORK_ROWS

_FIRST = WORK_ROWS + KERNEL_ROWS + 2
#: Of ``structural``: azimuths, e and its velocity, derivative of the angle by e, compliances with slopes and curvatures, steps
#: of the structural approaches, inverses, and the size of what is left.
DIRECTION, CENTRE, SPEED, TURNING, OWN, SLOPE, CURVE, STEP, LAST, INVERSE, INVERSE_2, NORM = range(_FIRST, _FIRST + 12)
# Five rows each: forces by q and by v, the ring's force by w or d, by Q at fixed w, and weights of C Q in it.
BY_Q = NORM + 1
BY_V, RING, TURN, WEIGHT = BY_Q + 5, BY_Q + 10, BY_Q + 15, BY_Q + 20
#: Of ``between``: force of each ball on the ring, displacement by centrifugal forces, what is left of the displacements and
#: their steps, tangents of each ball (two rows), its approaches by e (two rows), and one row of balls in its own order.
CARRIED, CENTRIFUGAL_MOVED, MOVED_REST, MOVED_STEP, MOVED_LAST, BALL_TANGENT = range(WEIGHT + 5, WEIGHT + 11)
APPROACH_BY_CENTRE = BALL_TANGENT + 2
LOCAL = APPROACH_BY_CENTRE + 2
#: Rows of all that, less a matrix of 2 Z rows behind them.
ELASTIC_ROWS = LOCAL + 1 - WORK_ROWS
MATRIX_ROWS = WORK_ROWS + ELASTIC_ROWS
