"""The eight-node hexahedron in its modes: what the vectorised kernel computes in registers.

A trilinear field is the sum over k of a_k h_k, with h = (1, xi, eta, zeta, eta zeta, xi zeta, xi eta, xi eta zeta)
numbered 0 to 7.  The values of h_k at the nodes are the columns of a Hadamard matrix, so nodal values become modes, and
back, by additions alone.  Here a mode is the plain sum A_k = sum_I h_k(I) a_I = 8 a_k; mode 0, the mean, is never needed.

The functions take and return tuples and are written into their callers, where the tuples become registers and LLVM can
vectorise the loop around them.
"""

from numba import float64, types

from raceway.core.jit import jit

_SIX, _SEVEN, _EIGHT = (types.UniTuple(float64, count) for count in (6, 7, 8))


@jit(_SEVEN(_EIGHT), inline=True)
def modes(a):
    """Modes 1 to 7 of eight nodal values in VTK's order: butterflies along xi, then eta, then zeta."""
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

    Parameters
    ----------
    y, z : modes 1 to 7 of the two other coordinates [m]

    Returns
    -------
    b : 6 floats [m2]
        64 times the integral of the gradient of shape function I along x is sum_k b_k h_k(I).

    Notes
    -----
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
