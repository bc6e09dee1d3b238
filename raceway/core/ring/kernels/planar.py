"""Vectors and 2x2 matrices in a ball's meridian plane, as values in registers.

Notes
-----
Products leave out the determinant that quotients by a matrix share: A J^-1 = (A adj J) / det J.
"""

from typing import NamedTuple

from numba import float64, types

from raceway.core.jit import jit


class Pair(NamedTuple):
    """A vector or a row: axial, radial."""

    axial: float
    radial: float


class Tensor(NamedTuple):
    """A 2x2 matrix: first index the row."""

    aa: float
    ar: float
    ra: float
    rr: float


PAIR = types.NamedUniTuple(float64, 2, Pair)
TENSOR = types.NamedUniTuple(float64, 4, Tensor)
NOTHING = Pair(0.0, 0.0)


@jit(TENSOR(TENSOR, TENSOR), inline=True)
def times_adjugate(a, j):
    """A adj J."""
    return Tensor(a.aa * j.rr - a.ar * j.ra, a.ar * j.aa - a.aa * j.ar, a.ra * j.rr - a.rr * j.ra, a.rr * j.aa - a.ra * j.ar)


@jit(PAIR(PAIR, TENSOR), inline=True)
def row_times_adjugate(n, j):
    """n^T adj J."""
    return Pair(n.axial * j.rr - n.radial * j.ra, n.radial * j.aa - n.axial * j.ar)


@jit(TENSOR(TENSOR, TENSOR, TENSOR), inline=True)
def less(e, t, x):
    """E - T X."""
    return Tensor(
        e.aa - t.aa * x.aa - t.ar * x.ra,
        e.ar - t.aa * x.ar - t.ar * x.rr,
        e.ra - t.ra * x.aa - t.rr * x.ra,
        e.rr - t.ra * x.ar - t.rr * x.rr,
    )


@jit(PAIR(PAIR, TENSOR, PAIR), inline=True)
def less_column(e, t, x):
    """e - T x."""
    return Pair(e.axial - t.aa * x.axial - t.ar * x.radial, e.radial - t.ra * x.axial - t.rr * x.radial)


@jit(PAIR(PAIR, PAIR, TENSOR), inline=True)
def less_row(e, g, x):
    """e - g^T X."""
    return Pair(e.axial - g.axial * x.aa - g.radial * x.ra, e.radial - g.axial * x.ar - g.radial * x.rr)
