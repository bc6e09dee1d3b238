"""Exact gap of points of a sphere to the torus of a groove, with its derivatives by the place of the sphere.

With D = (axial, radial) the place of the ball's centre seen from the groove's centre in the ball's meridian plane, a
point at angle phi and latitude l lies at

    radial  R = R_c + D_r + s R_b cos(l) cos(phi),   rolling  y = R_b sin(l),   axial  z = D_a + s R_b cos(l) sin(phi)

and its gap is g = R_g - rho with rho = hypot(hypot(R, y) - R_c, z); s = -1 on the inner race, 1 on the outer one.
"""

from typing import NamedTuple

import numpy as np
from numba import float64, int64, void

from raceway.core.jit import jit
from raceway.core.signatures import CUBE, MATRIX, VECTOR, record

INDEX = int64[::1]


class Points(NamedTuple):
    """Of a sphere in a groove: geometry (4,) s, R_g, R_c, R_b, meridian (2, m) cosine and sine of phi, parallel (2, n) of l."""

    geometry: np.ndarray
    meridian: np.ndarray
    parallel: np.ndarray


_POINTS = record(Points, VECTOR, MATRIX, MATRIX)


@jit(void(float64, float64, _POINTS, MATRIX))
def sphere_in_torus(axial, radial, points, gap):
    """gap (m, n) [m] of every point."""
    geometry, meridian, parallel = points
    sense, groove, circle, ball = geometry[0], geometry[1], geometry[2], geometry[3]
    for i in range(parallel.shape[1]):
        size = sense * ball * parallel[0, i]
        y = ball * parallel[1, i]
        for k in range(meridian.shape[1]):
            away = circle + radial + size * meridian[0, k]
            z = axial + size * meridian[1, k]
            u = np.sqrt(away * away + y * y) - circle
            gap[k, i] = groove - np.sqrt(u * u + z * z)


@jit(void(float64, float64, _POINTS, INDEX, VECTOR, MATRIX, VECTOR))
def derivatives(axial, radial, points, nodes, load, slope, curvature):
    """slope (n, 2): derivatives of chosen points' gaps by D; curvature (3,): aa, ar, rr of sum(load * second derivatives).

    nodes : (n,) numbers k * columns + i;  load : (n,)
    """
    geometry, meridian, parallel = points
    sense, circle, ball = geometry[0], geometry[2], geometry[3]
    columns = parallel.shape[1]
    curvature[0], curvature[1], curvature[2] = 0.0, 0.0, 0.0
    for n in range(nodes.size):
        k, i = nodes[n] // columns, nodes[n] % columns
        size = sense * ball * parallel[0, i]
        y = ball * parallel[1, i]
        away = circle + radial + size * meridian[0, k]
        z = axial + size * meridian[1, k]
        reach = np.sqrt(away * away + y * y)
        u = reach - circle
        rho = np.sqrt(u * u + z * z)
        lean = away / reach
        slope[n, 0] = -z / rho
        slope[n, 1] = -u / rho * lean
        w = load[n] / rho
        curvature[0] -= w * (1.0 - z * z / (rho * rho))
        curvature[1] += w * z * u / (rho * rho) * lean
        curvature[2] -= w * ((1.0 - u * u / (rho * rho)) * lean * lean + u * y * y / (reach * reach * reach))


@jit(void(CUBE, CUBE, INDEX, INDEX, MATRIX))
def between(ball, race, to, of, out):
    """out (len(to), len(of)) [m/N]: displacement of points ``to`` by forces on points ``of``.

    ball : (rows, n, n) by distance in rows;  race : (n, m, m) by distance in columns
    to, of : numbers k * n + i
    """
    n = ball.shape[1]
    for a in range(to.size):
        k, i = to[a] // n, to[a] % n
        for b in range(of.size):
            q, j = of[b] // n, of[b] % n
            out[a, b] = ball[abs(k - q), i, j] + race[abs(i - j), k, q]


@jit(void(CUBE, CUBE, INDEX, INDEX, VECTOR, VECTOR))
def displaced(ball, race, to, of, load, out):
    """out (len(to),) [m]: displacement of points ``to`` by loads [N] on points ``of``."""
    n = ball.shape[1]
    for a in range(to.size):
        k, i = to[a] // n, to[a] % n
        total = 0.0
        for b in range(of.size):
            q, j = of[b] // n, of[b] % n
            total += (ball[abs(k - q), i, j] + race[abs(i - j), k, q]) * load[b]
        out[a] = total
