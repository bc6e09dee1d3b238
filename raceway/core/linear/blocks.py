"""Products of sparse matrices of 3 x 3 blocks, the matrices of nodes in space, with vectors."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numba import float32, float64, int32, void

from raceway.core.jit import jit

if TYPE_CHECKING:
    from numba.core.typing.templates import Signature
    from scipy.sparse import csr_matrix

    from raceway.core.jit import Kernel


def _signature(real: Any) -> Signature:
    vector = real[::1]
    return void(int32[::1], int32[::1], vector, vector, vector, real, vector)


def _multiply(starts, columns, blocks, x, base, factor, out):  # type: ignore[no-untyped-def]
    """out = factor base + A x."""
    for row in range(starts.size - 1):
        i = 3 * row
        a, b, c = factor * base[i], factor * base[i + 1], factor * base[i + 2]
        for k in range(starts[row], starts[row + 1]):
            j, at = 3 * columns[k], 9 * k
            p, q, r = x[j], x[j + 1], x[j + 2]
            a += blocks[at] * p + blocks[at + 1] * q + blocks[at + 2] * r
            b += blocks[at + 3] * p + blocks[at + 4] * q + blocks[at + 5] * r
            c += blocks[at + 6] * p + blocks[at + 7] * q + blocks[at + 8] * r
        out[i], out[i + 1], out[i + 2] = a, b, c


_MULTIPLY = {np.float64: jit(_signature(float64))(_multiply), np.float32: jit(_signature(float32))(_multiply)}


class BlockMatrix:
    """A square sparse matrix of 3 x 3 blocks.

    Parameters
    ----------
    matrix : (3 n, 3 n) scipy.sparse
    real : numpy.float64 or numpy.float32, of the blocks and of all vectors
    """

    def __init__(self, matrix: csr_matrix, real: type[np.floating] = np.float64) -> None:
        blocks = matrix.tobsr((3, 3))
        self._starts, self._columns = blocks.indptr.astype(np.int32), blocks.indices.astype(np.int32)
        self._blocks = np.ascontiguousarray(blocks.data.reshape(-1), dtype=real)
        self._kernel: Kernel = _MULTIPLY[real]
        self._real = real
        self._nothing = np.zeros(matrix.shape[0], dtype=real)

    def times(self, x: np.ndarray, base: np.ndarray | None = None, factor: float = 0.0) -> np.ndarray:
        """(3 n,) A x + factor base."""
        out = np.empty_like(self._nothing)
        first = self._nothing if base is None else base
        self._kernel(self._starts, self._columns, self._blocks, x, first, self._real(factor), out)
        return out
