"""Records of many operating points for compiled loops: numbers in, states out."""

from typing import Any, NamedTuple

import numpy as np
from numba import boolean, int64

from raceway.core.signatures import CUBE, LAW_POINTER, MATRIX, SYSTEM_POINTER, VECTOR, record

#: Relative residual of the equilibria.
TOLERANCE = 1e-12
#: Status beside those of ``raceway.core.ring.equilibrium``: some motion is held by less than this part of the stiffest one.
LOOSE, LEAST = 5, 1e-9


class Points(NamedTuple):
    """Numbers of n points: ``scalars`` (n, s), ``table`` (n, Z, c), law's ``params`` (n, 2 Z, k), ``load`` (n, 5), ``shaft`` (n,)
    [N m/rad] against tilts, and ``guess`` (n, 5) to begin with."""

    scalars: np.ndarray
    table: np.ndarray
    params: np.ndarray
    load: np.ndarray
    shaft: np.ndarray
    guess: np.ndarray


class States(NamedTuple):
    """What is computed of n points: displacement (n, 5), positions of balls (n, Z, b), tangent of the contacts and their
    damping (n, 5, 5), or (0, 5, 5) where that is not asked for, contact forces (n, 2 Z), status (n,)."""

    q: np.ndarray
    ball: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    force: np.ndarray
    status: np.ndarray


class Kernels(NamedTuple):
    """``system`` (a ``SYSTEM``), ``base`` (the one whose forces have a potential, ``columns`` of ``ball``) and ``law`` (a ``LAW``);
    ``lanes`` : whether the balls are those of ``raceway.core.ring.lockstep``, rigid or condensed, none acting on another."""

    system: Any
    base: Any
    columns: int
    law: Any
    lanes: bool


POINTS = record(Points, MATRIX, CUBE, CUBE, MATRIX, VECTOR, MATRIX)
STATES = record(States, MATRIX, CUBE, CUBE, CUBE, MATRIX, int64[::1])
KERNELS = record(Kernels, SYSTEM_POINTER, SYSTEM_POINTER, int64, LAW_POINTER, boolean)
