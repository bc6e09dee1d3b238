"""The arrays of a collocated motion, as compiled parts take them.

Notes
-----
The angle theta = w t is the independent variable, so that displacements and their derivatives by the angle are of one
size: w^2 M q'' + w C q' + K q + f(t, q, w q') = push.  Unknown are q and q' at the start of each interval and the
accelerations A at its Gauss points.  Linearised, an interval's own unknowns are eliminated,
dA = S_y (dq, dq') + S_r + S_p dp, which leaves the transfer (dq, dq')_next = T_y (dq, dq') + T_r + T_p dp; p is a parameter.

n unknown coordinates, m intervals, s points an interval, k the number of an interval.
"""

from typing import NamedTuple

import numpy as np
from numba import float64, int64

from raceway.core.signatures import CUBE, FORCES, LINEAR, MATRIX, VECTOR, Forces, Linear, record

INDICES = int64[::1]


class Equations(NamedTuple):
    """Compiled forces, linear parts, the law's memory (2 Z, m), numbers of unknown coordinates (n,), weight (5,), w [rad/s].

    The weight makes moments forces.
    """

    forces: Forces
    linear: Linear
    memory: np.ndarray
    free: np.ndarray
    weight: np.ndarray
    speed: float


class Mesh(NamedTuple):
    """Angles of the nodes (m + 1,), and ``Rule.packed`` (2 p + 3, s) or ``Rule.try_packed`` (2 p + 3, s + p) of p points."""

    nodes: np.ndarray
    rule: np.ndarray


class Samples(NamedTuple):
    """q, v (m + 1, 5) at nodes, a (m s, 5) at Gauss points; there also columns of the balls and their rates (m s, Z, c),
    the outer forces ``push`` (m s, 5), and the derivative of the balance of forces by the parameter, ``slope`` (m s, 5).
    """

    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    ball: np.ndarray
    rate: np.ndarray
    push: np.ndarray
    slope: np.ndarray


class Eliminated(NamedTuple):
    """stages (m s n, 2 n + 2): S_y, S_r, S_p; transfer (m 2 n, 2 n + 2): T_y, T_r, T_p; whole (2 n, 2 n + 2): all intervals'."""

    stages: np.ndarray
    transfer: np.ndarray
    whole: np.ndarray


class Change(NamedTuple):
    """Corrections of q, v (m + 1, 5) and a (m s, 5)."""

    q: np.ndarray
    v: np.ndarray
    a: np.ndarray


EQUATIONS = record(Equations, FORCES, LINEAR, MATRIX, INDICES, VECTOR, float64)
MESH = record(Mesh, VECTOR, MATRIX)
SAMPLES = record(Samples, MATRIX, MATRIX, MATRIX, CUBE, CUBE, MATRIX, MATRIX)
ELIMINATED = record(Eliminated, MATRIX, MATRIX, MATRIX)
CHANGE = record(Change, MATRIX, MATRIX, MATRIX)
