"""Unknowns and nodal vectors: copies between them by shares of the nodes, and at a few nodes alone."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

import attrs
import numpy as np
from numba import int64, void

from raceway.core.jit import jit
from raceway.core.signatures import MATRIX, VECTOR

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

_PLACES = int64[::1]


def of_nodes(nodes: np.ndarray) -> np.ndarray:
    """(3 n,) numbers of the displacements of nodes (n,)."""
    return np.asarray((3 * nodes[:, None] + np.arange(3)).ravel())


@jit(void(int64, int64, _PLACES, VECTOR, VECTOR), releases=True)
def spread(first, last, free, values, out):  # type: ignore[no-untyped-def]
    """``out[free[i]] = values[i]`` for i from ``first`` to ``last - 1``."""
    if first >= last:
        return
    shift = free[first] - first
    if free[last - 1] - (last - 1) == shift:  # they are sorted: all lie one behind the other
        for i in range(first, last):
            out[i + shift] = values[i]
        return
    for i in range(first, last):
        out[free[i]] = values[i]


@jit(void(int64, int64, _PLACES, VECTOR, VECTOR), releases=True)
def gather(first, last, free, values, out):  # type: ignore[no-untyped-def]
    """``out[i] = values[free[i]]`` for i from ``first`` to ``last - 1``."""
    if first >= last:
        return
    shift = free[first] - first
    if free[last - 1] - (last - 1) == shift:
        for i in range(first, last):
            out[i] = values[i + shift]
        return
    for i in range(first, last):
        out[i] = values[free[i]]


@attrs.frozen(eq=False)
class Selection:
    """Some entries of nodal vectors, seen from the unknowns y = (frames, free nodes).

    entries : (k,) int, of the nodal vectors, sorted
    free, unknown : those that are unknowns: numbers among the k, and in y
    tied, ride : those that follow a frame: numbers among the k, and (t, frame_size) their displacement with it
    """

    entries: np.ndarray
    free: np.ndarray
    unknown: np.ndarray
    tied: np.ndarray
    ride: np.ndarray

    @classmethod
    def of(cls, entries: np.ndarray, free: np.ndarray, tied: np.ndarray, ride: np.ndarray) -> Selection:
        """``free`` (size - frame_size,), ``tied`` (t,): sorted entries; ``ride`` (t, frame_size) of the tied ones."""
        mine, number = _among(entries, free)
        ours, row = _among(entries, tied)
        return cls(entries, mine, number + ride.shape[1], ours, ride[row])

    def nodal(self, y: np.ndarray) -> np.ndarray:
        """(k,) of G y."""
        out = np.zeros(len(self.entries))
        out[self.free] = y[self.unknown]
        if len(self.tied):
            out[self.tied] = self.ride @ y[: self.ride.shape[1]]
        return out

    def add(self, force: np.ndarray, out: np.ndarray) -> None:
        """Add G^T F of forces (k,) at the entries to out (size,)."""
        out[self.unknown] += force[self.free]
        if len(self.tied):
            out[: self.ride.shape[1]] += self.ride.T @ force[self.tied]


@attrs.frozen(eq=False)
class Near:
    """The columns of a contact's B that are not empty: a few of all nodes."""

    entries: np.ndarray  # (k,) int, of the nodal displacements, sorted
    move: csr_matrix  # (3 n, k) sparse, B at these entries

    @classmethod
    def of(cls, move: csr_matrix) -> Near:
        """Of B (3 n, 3 nodes)."""
        from scipy.sparse import csr_array

        reach = np.zeros(move.shape[1], dtype=bool)
        reach[move.indices] = True
        entries = np.flatnonzero(reach)
        number = np.cumsum(reach) - 1
        short = csr_array((move.data, number[move.indices], move.indptr), shape=(move.shape[0], len(entries)))
        return cls(entries, short)


def _among(entries: np.ndarray, sorted_ones: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of the entries that are among the sorted ones, and where there."""
    at = np.searchsorted(sorted_ones, entries)
    at[at == len(sorted_ones)] = 0
    members = np.flatnonzero(sorted_ones[at] == entries) if len(sorted_ones) else np.zeros(0, dtype=np.int64)
    return members, at[members]


@jit(void(MATRIX, int64, VECTOR, VECTOR), releases=True)
def _sums(rows, begin, u, out):  # type: ignore[no-untyped-def]
    """out (k,) = rows (k, n) times u[begin : begin + n], entry after entry: the digits of a sparse product.

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
def _add_transposed(first, last, rows, begin, amounts, f):  # type: ignore[no-untyped-def]
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

    rows : (m, n) sparse L; each row without gaps from its first column to its last, as means over a body are

    ValueError: A row with a gap.
    """

    def __init__(self, rows: csr_matrix) -> None:
        matrix, starts = rows.tocsr(), rows.tocsr().indptr
        matrix.sort_indices()
        self.count = int(rows.shape[0])
        #: First row, first column, and the rows (k, n) themselves, views of L's numbers.
        self.blocks: list[tuple[int, int, np.ndarray]] = []
        spans: list[tuple[int, int]] = []
        for row in range(self.count):
            columns = matrix.indices[starts[row] : starts[row + 1]]
            span = (int(columns[0]), int(columns[-1]) + 1) if len(columns) else (0, 0)
            if span[1] - span[0] != len(columns):
                raise ValueError(f"row {row} of the mean motions has gaps between its columns {span[0]} and {span[1] - 1}")
            spans.append(span)
        begin = 0
        for row in range(1, self.count + 1):
            if row < self.count and spans[row] == spans[begin]:
                continue
            values = matrix.data[starts[begin] : starts[row]].reshape(row - begin, -1)
            self.blocks.append((begin, spans[begin][0], np.ascontiguousarray(values, dtype=float)))
            begin = row

    def jobs(self, u: np.ndarray, out: np.ndarray) -> list[Callable[[], None]]:
        """Jobs that set out (m,) to L u; they may run at the same time."""
        return [partial(_sums, values, begin, u, out[row : row + len(values)]) for row, begin, values in self.blocks]  # type: ignore[misc]

    def add(self, first: int, last: int, amounts: np.ndarray, force: np.ndarray) -> None:
        """Add L^T amounts (m,) to the entries ``first`` to ``last - 1`` of force (n,)."""
        for row, begin, values in self.blocks:
            if begin < last and first < begin + values.shape[1]:
                _add_transposed(first, last, values, begin, amounts[row : row + len(values)], force)
