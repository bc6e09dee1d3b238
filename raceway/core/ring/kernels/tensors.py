"""Pairs and two by two matrices in kernels."""

from typing import NamedTuple

from numba import float64, int64, types, void
from numba.extending import register_jitable

from raceway.core.jit import jit
from raceway.core.lanes import LANES, MASK, put, take
from raceway.core.signatures import MATRIX


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


#: Of four balls, in lanes.
LANES_PAIR, LANES_TENSOR = types.NamedUniTuple(LANES, 2, Pair), types.NamedUniTuple(LANES, 4, Tensor)


@jit(LANES_PAIR(MATRIX, int64, int64, MASK), inline=True)
def pair_of(work, row, k, live):
    """Both halves of a row of ``work`` for the balls from k on."""
    return Pair(take(work, row, k, live), take(work, row, work.shape[1] // 2 + k, live))


@jit(void(MATRIX, int64, int64, MASK, LANES, LANES), inline=True)
def put_pair(work, row, k, live, first, second):
    """Lanes into both halves of a row of ``work``, for the balls from k on."""
    put(work, row, k, live, first)
    put(work, row, work.shape[1] // 2 + k, live, second)


@register_jitable
def weighted_sum(a, s, b, t):
    """a S + b T."""
    return Tensor(a * s.aa + b * t.aa, a * s.ar + b * t.ar, a * s.ra + b * t.ra, a * s.rr + b * t.rr)


@register_jitable
def times_adjugate(a, j):
    """A adj J.

    Products leave out the determinant that quotients by a matrix share: A J^-1 = (A adj J) / det J.
    """
    return Tensor(a.aa * j.rr - a.ar * j.ra, a.ar * j.aa - a.aa * j.ar, a.ra * j.rr - a.rr * j.ra, a.rr * j.aa - a.ra * j.ar)


@register_jitable
def row_times_adjugate(n, j):
    """n^T adj J."""
    return Pair(n.axial * j.rr - n.radial * j.ra, n.radial * j.aa - n.axial * j.ar)


@register_jitable
def less(e, t, x):
    """E - T X."""
    return Tensor(
        e.aa - t.aa * x.aa - t.ar * x.ra,
        e.ar - t.aa * x.ar - t.ar * x.rr,
        e.ra - t.ra * x.aa - t.rr * x.ra,
        e.rr - t.ra * x.ar - t.rr * x.rr,
    )


@register_jitable
def less_column(e, t, x):
    """e - T x."""
    return Pair(e.axial - t.aa * x.axial - t.ar * x.radial, e.radial - t.ra * x.axial - t.rr * x.radial)


@register_jitable
def less_row(e, g, x):
    """e - g^T X."""
    return Pair(e.axial - g.axial * x.aa - g.radial * x.ra, e.radial - g.axial * x.ar - g.radial * x.rr)


@jit(void(TENSOR, MATRIX, int64, int64), inline=True)
def put_tensor(tensor, work, row, k):
    """A matrix of ball k into two rows of ``work``, as ``ring_tangent`` reads it."""
    z = work.shape[1] // 2
    work[row, k], work[row, z + k] = tensor.aa, tensor.ar
    work[row + 1, k], work[row + 1, z + k] = tensor.ra, tensor.rr


@jit(TENSOR(MATRIX, int64, int64), inline=True)
def tensor_of(work, row, k):
    """The matrix of ball k that ``put_tensor`` put into two rows of ``work``."""
    z = work.shape[1] // 2
    return Tensor(work[row, k], work[row, z + k], work[row + 1, k], work[row + 1, z + k])


@jit(void(MATRIX, int64, int64, MASK, LANES_TENSOR), inline=True)
def put_tensors(work, row, k, live, tensor):
    """The same of the balls from k on, in lanes."""
    put_pair(work, row, k, live, tensor.aa, tensor.ar)
    put_pair(work, row + 1, k, live, tensor.ra, tensor.rr)


@jit(LANES_TENSOR(MATRIX, int64, int64, MASK), inline=True)
def tensors_of(work, row, k, live):
    """The matrices of the balls from k on that ``put_tensors`` put there."""
    (aa, ar), (ra, rr) = pair_of(work, row, k, live), pair_of(work, row + 1, k, live)
    return Tensor(aa, ar, ra, rr)
