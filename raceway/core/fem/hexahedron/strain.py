"""Strain-displacement matrices of the four formulations, one element at a time.

``one_point``        the exact mean gradient, one point (hourglass control is added by its users)
``full``             2 x 2 x 2 Gauss points
``incompatible``     full, with the gradients of 1 - xi^2, 1 - eta^2, 1 - zeta^2 as nine more columns, mapped by the centre's
                     Jacobian and scaled by det J(0) / det J: their mean vanishes on every element, which is the patch test
``mean_dilatation``  full, with the volume change of every point replaced by the element's mean

Strains are in Voigt's order xx yy zz xy yz zx, shears being angles.

Taylor, Beresford, Wilson, A non-conforming element for stress analysis, Int. J. Numer. Meth. Engng 10 (1976) 1211-1219.
Simo, Rifai, A class of mixed assumed strain methods, Int. J. Numer. Meth. Engng 29 (1990) 1595-1638.
Hughes, Generalization of selective integration procedures, Int. J. Numer. Meth. Engng 15 (1980) 1413-1418.
"""

from typing import NamedTuple

import numpy as np
from numba import float64, int64, types, void

from raceway.core.fem.mesh.hex_mesh import gauss, shape_slopes
from raceway.core.jit import jit
from raceway.core.signatures import CUBE, MATRIX, VECTOR, record

#: Numbers of the formulations, as the kernels know them.
KINDS = {"one_point": 0, "full": 1, "incompatible": 2, "mean_dilatation": 3}
#: Columns: 24 displacements and 9 incompatible modes.
COLUMNS = 33

_AT = gauss(2)[0]
#: (9, 8, 3) Slopes of the shape functions at the eight Gauss points and at the centre.
_SLOPES = shape_slopes(np.concatenate([_AT, np.zeros((1, 3))]))


@jit(float64(MATRIX, int64, MATRIX))
def _invert_jacobian(x, point, inverse):
    """d(xi_i) / d(x_j) at a point; returns the determinant of the Jacobian."""
    for i in range(3):  # the Jacobian's transpose first: inverse[a, b] = d(x_b) / d(xi_a)
        for j in range(3):
            total = 0.0
            for n in range(8):
                total += _SLOPES[point, n, i] * x[n, j]
            inverse[i, j] = total
    a, b, c = inverse[0, 0], inverse[0, 1], inverse[0, 2]
    d, e, f = inverse[1, 0], inverse[1, 1], inverse[1, 2]
    g, h, k = inverse[2, 0], inverse[2, 1], inverse[2, 2]
    determinant = a * (e * k - f * h) - b * (d * k - f * g) + c * (d * h - e * g)
    over = 1.0 / determinant
    inverse[0, 0], inverse[1, 0], inverse[2, 0] = (e * k - f * h) * over, (c * h - b * k) * over, (b * f - c * e) * over
    inverse[0, 1], inverse[1, 1], inverse[2, 1] = (f * g - d * k) * over, (a * k - c * g) * over, (c * d - a * f) * over
    inverse[0, 2], inverse[1, 2], inverse[2, 2] = (d * h - e * g) * over, (b * g - a * h) * over, (a * e - b * d) * over
    return determinant


@jit(void(CUBE, int64, int64, float64, float64, float64))
def _set_columns(B, point, column, gx, gy, gz):
    """The strains of a displacement (x, y, z) with this gradient: three columns."""
    for row in range(6):
        for k in range(3):
            B[point, row, column + k] = 0.0
    B[point, 0, column], B[point, 1, column + 1], B[point, 2, column + 2] = gx, gy, gz
    B[point, 3, column], B[point, 3, column + 1] = gy, gx
    B[point, 4, column + 1], B[point, 4, column + 2] = gz, gy
    B[point, 5, column + 2], B[point, 5, column] = gx, gz


class Element(NamedTuple):
    """One element: corners x (8, 3) [m], mean gradients of its shape functions (8, 3) [1/m], strains of unit displacements at its
    points B (8, 6, 33) [1/m], the points' volumes (8,) [m3]; scratch: inverse (3, 3), rows (6, 33).
    """

    x: np.ndarray
    mean: np.ndarray
    B: np.ndarray
    weight: np.ndarray
    inverse: np.ndarray
    rows: np.ndarray


ELEMENT = record(Element, MATRIX, MATRIX, CUBE, VECTOR, MATRIX, MATRIX)


@jit(ELEMENT(), allocates=True)
def new_element():
    """Room for one."""
    return Element(
        np.empty((8, 3)), np.empty((8, 3)), np.zeros((8, 6, COLUMNS)), np.empty(8), np.empty((3, 3)), np.zeros((6, COLUMNS))
    )


@jit(int64(int64, ELEMENT))
def strain_matrices(kind, element):
    """Fill the strain matrices of an element from its corners; kind : of ``KINDS``.  The number of its points, 1 or 8."""
    x, mean, B, weight, inverse, _ = element
    volume = 0.0
    mean[:, :] = 0.0
    for g in range(8):
        weight[g] = _invert_jacobian(x, g, inverse)
        volume += weight[g]
        for n in range(8):
            s, t, r = _SLOPES[g, n, 0], _SLOPES[g, n, 1], _SLOPES[g, n, 2]
            gx = s * inverse[0, 0] + t * inverse[1, 0] + r * inverse[2, 0]
            gy = s * inverse[0, 1] + t * inverse[1, 1] + r * inverse[2, 1]
            gz = s * inverse[0, 2] + t * inverse[1, 2] + r * inverse[2, 2]
            mean[n, 0] += weight[g] * gx
            mean[n, 1] += weight[g] * gy
            mean[n, 2] += weight[g] * gz
            if kind != 0:
                _set_columns(B, g, 3 * n, gx, gy, gz)
    for n in range(8):
        for k in range(3):
            mean[n, k] /= volume
    if kind == 0:
        weight[0] = volume
        for n in range(8):
            _set_columns(B, 0, 3 * n, mean[n, 0], mean[n, 1], mean[n, 2])
        return 1
    if kind == 2:
        centre = _invert_jacobian(x, 8, inverse)
        for g in range(8):
            for mode in range(3):
                slope = -2.0 * _AT[g, mode] * centre / weight[g]
                _set_columns(
                    B, g, 24 + 3 * mode, slope * inverse[mode, 0], slope * inverse[mode, 1], slope * inverse[mode, 2]
                )
    if kind == 3:
        for g in range(8):
            for n in range(8):
                for k in range(3):
                    shift = (mean[n, k] - B[g, k, 3 * n + k]) / 3.0
                    for row in range(3):
                        B[g, row, 3 * n + k] += shift
    return 8


_SIX, _SEVEN, _EIGHT = (types.UniTuple(float64, count) for count in (6, 7, 8))


@jit(_SEVEN(_EIGHT), inline=True)
def modes(a):
    """Modes 1 to 7 of eight nodal values in VTK's order: butterflies along xi, then eta, then zeta.

    A trilinear field is the sum over k of a_k h_k, with h = (1, xi, eta, zeta, eta zeta, xi zeta, xi eta, xi eta zeta)
    numbered 0 to 7. The values of h_k at the nodes are the columns of a Hadamard matrix, so nodal values become modes, and
    back, by additions alone. Here a mode is the plain sum A_k = sum_I h_k(I) a_I = 8 a_k; mode 0, the mean, is never needed.

    The functions take and return tuples and are written into their callers, where the tuples become registers and LLVM can
    vectorise the loop around them.
    """
    a0, a1, a2, a3, a4, a5, a6, a7 = a
    s0, s1, s2, s3 = a1 + a0, a2 + a3, a5 + a4, a6 + a7
    d0, d1, d2, d3 = a1 - a0, a2 - a3, a5 - a4, a6 - a7
    below, above = s1 - s0, s3 - s2
    near, far = d1 + d0, d3 + d2
    twist_near, twist_far = d1 - d0, d3 - d2
    return (
        far + near, above + below, (s3 + s2) - (s1 + s0),
        above - below, far - near, twist_far + twist_near, twist_far - twist_near,
    )  # fmt: skip


@jit(_EIGHT(_SEVEN), inline=True)
def nodal(m):
    """Nodal values sum_k m_k h_k(I), I = 0 to 7, of modes 1 to 7: the transpose of ``modes``."""
    m1, m2, m3, m4, m5, m6, m7 = m
    e0, e1 = m2 - m4, m2 + m4
    c0, c1 = m1 - m5, m1 + m5
    t0, t1 = m6 - m7, m6 + m7
    s0, s1, s2, s3 = -m3 - e0, e0 - m3, m3 - e1, m3 + e1
    d0, d1, d2, d3 = c0 - t0, c0 + t0, c1 - t1, c1 + t1
    return s0 - d0, s0 + d0, s1 + d1, s1 - d1, s2 - d2, s2 + d2, s3 + d3, s3 - d3


@jit(_SIX(_SEVEN, _SEVEN), inline=True)
def gradient_modes(y, z):
    """Modes 1 to 6 of the exact mean gradient along x; call with (z, x) for y and with (x, y) for z.

    y, z : modes 1 to 7 of the two other coordinates [m]
    returns : b (6,) [m2]; 64 times the integral of the gradient of shape function I along x is sum_k b_k h_k(I)

    The integral over the element of dN_I/dx is that of the determinant |d(N_I, y, z) / d(xi, eta, zeta)| over the
    cube, a polynomial; <xi^2> = 1/3 is all that is left of it.  Mode 7 vanishes, and so do all products with y7 and z7.
    """
    third = 1.0 / 3.0
    y1, y2, y3, y4, y5, y6, _ = y
    z1, z2, z3, z4, z5, z6, _ = z
    return (
        y2 * z3 - y3 * z2 + third * (y6 * z5 - y5 * z6),
        y3 * z1 - y1 * z3 + third * (y4 * z6 - y6 * z4),
        y1 * z2 - y2 * z1 + third * (y5 * z4 - y4 * z5),
        third * (y3 * z5 - y5 * z3 + y6 * z2 - y2 * z6),
        third * (y1 * z6 - y6 * z1 + y4 * z3 - y3 * z4),
        third * (y2 * z4 - y4 * z2 + y5 * z1 - y1 * z5),
    )  # fmt: skip


@jit(float64(_SIX, _SEVEN), inline=True)
def mean_gradient(b, u):
    """Inner product of a gradient's modes with those of a field, of which mode 7 has no part in it."""
    return b[0] * u[0] + b[1] * u[1] + b[2] * u[2] + b[3] * u[3] + b[4] * u[4] + b[5] * u[5]


@jit(float64(_SIX), inline=True)
def square(b):
    """Inner product of a gradient's modes with themselves."""
    return b[0] * b[0] + b[1] * b[1] + b[2] * b[2] + b[3] * b[3] + b[4] * b[4] + b[5] * b[5]
