"""Mean motions of bodies, L u, and the forces that act on them, L^T s: one block of rows a body, each a job of its own."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numba import int64, void

from raceway.core.jit import jit
from raceway.core.signatures import MATRIX, VECTOR

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


@jit(void(MATRIX, int64, VECTOR, VECTOR), releases=True)
def sums(rows, begin, u, out):  # type: ignore[no-untyped-def]
    """out (k,) = rows (k, n) times u[begin : begin + n], entry after entry: the digits of a sparse product.

    Notes
    -----
    Four rows at a time, which do not wait for each other's sums; where fewer are left, the last one is computed again.
    """
    last = rows.shape[0] - 1
    for g in range(0, last + 1, 4):
        p, q, r = min(g + 1, last), min(g + 2, last), min(g + 3, last)
        a, b, c, d = 0.0, 0.0, 0.0, 0.0
        for i in range(rows.shape[1]):
            value = u[begin + i]
            a += rows[g, i] * value
            b += rows[p, i] * value
            c += rows[q, i] * value
            d += rows[r, i] * value
        out[g], out[p], out[q], out[r] = a, b, c, d


@jit(void(int64, int64, MATRIX, int64, VECTOR, VECTOR), releases=True)
def add_transposed(first, last, rows, begin, amounts, f):  # type: ignore[no-untyped-def]
    """Add rows^T times amounts (k,) to the entries ``first`` to ``last - 1`` of f; row j begins at entry ``begin``."""
    low, high, top = max(first, begin), min(last, begin + rows.shape[1]), rows.shape[0] - 1
    for g in range(0, top + 1, 4):
        p, q, r = min(g + 1, top), min(g + 2, top), min(g + 3, top)
        a = amounts[g]
        b = amounts[p] if g + 1 <= top else 0.0
        c = amounts[q] if g + 2 <= top else 0.0
        d = amounts[r] if g + 3 <= top else 0.0
        for i in range(low, high):
            j = i - begin
            f[i] += rows[g, j] * a + rows[p, j] * b + rows[q, j] * c + rows[r, j] * d


class MeanMotions:
    """The rows of L in blocks.

    Parameters
    ----------
    rows : (m, n) sparse L; each row without gaps from its first column to its last, as means over a body are

    Raises
    ------
    ValueError
        A row with a gap.
    """

    def __init__(self, rows: csr_matrix) -> None:
        found, starts = rows.tocsr(), rows.tocsr().indptr
        found.sort_indices()
        self.count = int(rows.shape[0])
        #: First row, first column, and the rows (k, n) themselves, views of L's numbers.
        self.blocks: list[tuple[int, int, np.ndarray]] = []
        spans: list[tuple[int, int]] = []
        for row in range(self.count):
            columns = found.indices[starts[row] : starts[row + 1]]
            span = (int(columns[0]), int(columns[-1]) + 1) if len(columns) else (0, 0)
            if span[1] - span[0] != len(columns):
                raise ValueError(f"row {row} of the mean motions has gaps between its columns {span[0]} and {span[1] - 1}")
            spans.append(span)
        begin = 0
        for row in range(1, self.count + 1):
            if row < self.count and spans[row] == spans[begin]:
                continue
            values = found.data[starts[begin] : starts[row]].reshape(row - begin, -1)
            self.blocks.append((begin, spans[begin][0], np.ascontiguousarray(values, dtype=float)))
            begin = row

    def jobs(self, u: np.ndarray, out: np.ndarray) -> list[Callable[[], None]]:
        """Jobs that set out (m,) to L u; they may run at the same time."""
        return [partial(self._sum, one, u, out) for one in self.blocks]

    def add(self, first: int, last: int, amounts: np.ndarray, force: np.ndarray) -> None:
        """Add L^T amounts (m,) to the entries ``first`` to ``last - 1`` of force (n,)."""
        for row, begin, values in self.blocks:
            if begin < last and first < begin + values.shape[1]:
                add_transposed(first, last, values, begin, amounts[row : row + len(values)], force)

    @staticmethod
    def _sum(block: tuple[int, int, np.ndarray], u: np.ndarray, out: np.ndarray) -> None:
        row, begin, values = block
        sums(values, begin, u, out[row : row + len(values)])
