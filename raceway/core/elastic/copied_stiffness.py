"""Internal forces of bodies that are copies of one mesh: one matrix for all of them."""

from __future__ import annotations

import numpy as np
from numba import int64, void

from raceway.core.elastic.copies import Copies
from raceway.core.hexahedron.block_rows import BlockRows, add_rows
from raceway.core.hexahedron.operator import HexOperator
from raceway.core.jit import jit
from raceway.core.signatures import CUBE, VECTOR

#: Nodes of a mesh whose forces are computed together: enough work for a thread.
_ROWS = 4096
_NUMBERS = int64[:, ::1]


@jit(void(int64, int64, _NUMBERS, CUBE, VECTOR, CUBE), releases=True)
def gather_copies(first, last, numbers, turns, u, moved):  # type: ignore[no-untyped-def]
    """Displacements of nodes ``first`` to ``last - 1`` of every copy, turned back to the first: moved (n, 3, c)."""
    for i in range(first, last):
        for c in range(turns.shape[0]):
            at = 3 * numbers[c, i]
            for a in range(3):
                moved[i, a, c] = turns[c, 0, a] * u[at] + turns[c, 1, a] * u[at + 1] + turns[c, 2, a] * u[at + 2]


@jit(void(int64, int64, int64[::1], _NUMBERS, CUBE, CUBE, VECTOR), releases=True)
def spread_copies(first, last, nodes, numbers, turns, force, out):  # type: ignore[no-untyped-def]
    """The way back of forces (m, 3, c) on nodes[first:last], written to ``out`` (3 nodes of all copies,)."""
    for row in range(first, last):
        for c in range(turns.shape[0]):
            at = 3 * numbers[c, nodes[row]]
            for a in range(3):
                out[at + a] = (
                    turns[c, a, 0] * force[row, 0, c] + turns[c, a, 1] * force[row, 1, c] + turns[c, a, 2] * force[row, 2, c]
                )


class CopiedStiffness:
    """K u of all copies of a mesh.

    Parameters
    ----------
    copies : Copies;  operator : HexOperator, whose material and formulation it has

    Notes
    -----
    A node on a cut plane belongs to the sector behind it, and the cells of the sector before it that share its cut plane are
    part of the matrix: every row is whole, every force is written once.
    """

    def __init__(self, copies: Copies, operator: HexOperator) -> None:
        points, cells, numbers = copies.points, copies.cells, copies.nodes
        own = np.ones(len(points), dtype=bool)
        own[copies.behind] = False
        if len(copies.behind):
            beyond = cells[np.isin(cells, copies.behind).any(axis=1)]  # of the sector before, at the first cut plane
            more = np.setdiff1d(beyond, copies.behind)
            place = np.empty(len(points), dtype=np.int64)
            place[copies.behind], place[more] = copies.before, len(points) + np.arange(len(more))
            points = np.concatenate([points, copies.points[more] @ copies.turns[-1].T])
            cells = np.concatenate([cells, place[beyond]])
            numbers = np.concatenate([numbers, np.roll(copies.nodes, 1, axis=0)[:, more]], axis=1)
        mesh = operator.of_mesh(points, cells)
        self.rows = BlockRows.assemble(mesh.cells, len(points), mesh.element_stiffness)
        self._own = np.flatnonzero(own)
        self._numbers, self._turns = np.ascontiguousarray(numbers), np.ascontiguousarray(copies.turns)
        self._moved = np.empty((len(points), 3, len(copies.turns)))
        self._force = np.empty((len(self._own), 3, len(copies.turns)))

    @property
    def parts(self) -> int:
        """How many jobs a product is made of."""
        return -(-len(self._moved) // _ROWS)

    def gather(self, part: int, u: np.ndarray) -> None:
        """First round of jobs: displacements (3 nodes,) into the frame of the first copy."""
        last = min((part + 1) * _ROWS, len(self._moved))
        gather_copies(part * _ROWS, last, self._numbers, self._turns, u, self._moved)

    def multiply(self, part: int, out: np.ndarray) -> None:
        """Second round: forces into ``out`` (3 nodes,)."""
        first, last = part * _ROWS, min((part + 1) * _ROWS, len(self._own))
        r = self.rows
        add_rows(first, last, self._own, r.starts, r.neighbours, r.data, self._moved, self._force)
        spread_copies(first, last, self._own, self._numbers, self._turns, self._force, out)

    def apply(self, u: np.ndarray) -> np.ndarray:
        """(3 nodes,) forces of all copies at u (3 nodes,), zero elsewhere."""
        out = np.zeros_like(u)
        for part in range(self.parts):
            self.gather(part, u)
        for part in range(self.parts):
            self.multiply(part, out)
        return out

    def times(self, moved: np.ndarray) -> np.ndarray:
        """(3 n, m) forces on the first copy of displacements (3 n, m), of a body that is one copy."""
        columns = np.ascontiguousarray(moved.reshape(len(self._moved), 3, -1))
        return self.rows.times(self._own, columns).reshape(moved.shape)
