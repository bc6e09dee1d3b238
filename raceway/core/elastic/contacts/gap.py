"""Gap of points from exact surfaces: planes and the grooves of rings."""

from __future__ import annotations

import numpy as np
from numba import boolean, int64, void

from raceway.core.jit import jit
from raceway.core.signatures import CUBE, MATRIX, VECTOR

#: Numbers that describe a surface: kind, then seven more.
NUMBERS = 8
#: Of a groove: the radius of its centre circle [m].
CIRCLE = 4


def plane(point: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """(8,) a plane through a point [m]; the normal points away from the body."""
    n = np.asarray(normal, dtype=float)
    return np.concatenate([[0.0], point, n / np.linalg.norm(n), [0.0]])


def groove(centre: np.ndarray, circle: float, radius: float) -> np.ndarray:
    """(8,) the inside of a torus about an axis along x: middle [m], radius of its centre circle and of its tube [m]."""
    return np.array([1.0, *centre, circle, radius, 0.0, 0.0])


@jit(void(MATRIX, int64[::1], MATRIX, VECTOR, MATRIX, CUBE), releases=True)
def gaps(where, pair, surfaces, gap, normal, bend):  # type: ignore[no-untyped-def]
    """Signed distance from a surface, its gradient and its second derivative.

    Parameters
    ----------
    where : (n, 3) float [m];  pair : (n,) int, row of ``surfaces`` (m, 8)
    gap : (n,) out [m], negative inside the body;  normal : (n, 3) out, away from the body
    bend : (n, 3, 3) out: second derivative of the gap [1/m]

    Notes
    -----
    A groove: with the radius r about the axis and m the unit vector from the centre circle (x0, R) to the point, at the
    distance d, gap = tube - d, normal = -m, and the second derivative is minus that of d: 1/d across m in the meridian
    plane, (m . e_r)/r around the axis.
    """
    for i in range(where.shape[0]):
        p = pair[i]
        if surfaces[p, 0] == 0.0:
            gap[i] = 0.0
            for a in range(3):
                gap[i] += (where[i, a] - surfaces[p, 1 + a]) * surfaces[p, 4 + a]
                normal[i, a] = surfaces[p, 4 + a]
                for b in range(3):
                    bend[i, a, b] = 0.0
            continue
        x, y, z = where[i, 0] - surfaces[p, 1], where[i, 1] - surfaces[p, 2], where[i, 2] - surfaces[p, 3]
        r = np.sqrt(y * y + z * z)
        c, s = y / r, z / r
        away = r - surfaces[p, 4]
        d = np.sqrt(x * x + away * away)
        mx, mr = x / d, away / d
        gap[i] = surfaces[p, 5] - d
        m = (mx, mr * c, mr * s)
        along = (-mr, mx * c, mx * s)
        around = (0.0, -s, c)
        for a in range(3):
            normal[i, a] = -m[a]
            for b in range(3):
                bend[i, a, b] = -(along[a] * along[b] / d + mr / r * around[a] * around[b])


@jit(void(VECTOR, VECTOR, VECTOR, VECTOR, MATRIX, CUBE, MATRIX, CUBE, CUBE), releases=True)
def forces_and_tangents(area, pressure, d_gap, d_rate, normal, bend, force, stiffness, damping):  # type: ignore[no-untyped-def]
    """Forces (n, 3) [N] on the points and minus their derivatives by place and velocity (n, 3, 3) [N/m, N s/m].

    Notes
    -----
    F = A p n, so -dF/dy = -A (dp/dg n n^T + p d2g/dy2): symmetric.
    """
    for i in range(area.size):
        w = area[i]
        for a in range(3):
            force[i, a] = w * pressure[i] * normal[i, a]
            for b in range(3):
                nn = normal[i, a] * normal[i, b]
                stiffness[i, a, b] = -w * (d_gap[i] * nn + pressure[i] * bend[i, a, b])
                damping[i, a, b] = -w * d_rate[i] * nn


@jit(void(CUBE, VECTOR), releases=True)
def row_sums(stiffness, out):  # type: ignore[no-untyped-def]
    """Largest row sum (n,) of the sizes of matrices (n, 3, 3)."""
    for i in range(stiffness.shape[0]):
        out[i] = 0.0
        for a in range(3):
            total = abs(stiffness[i, a, 0]) + abs(stiffness[i, a, 1]) + abs(stiffness[i, a, 2])
            if not total <= out[i]:  # what is no number is kept
                out[i] = total


@jit(boolean(MATRIX, MATRIX, VECTOR), releases=True)
def has_moved(where, before, far):  # type: ignore[no-untyped-def]
    """Whether a point (n, 3) has moved along an axis by more than ``far`` (n,)."""
    for i in range(where.shape[0]):
        for a in range(3):
            if abs(where[i, a] - before[i, a]) > far[i]:
                return True
    return False
