"""The stiffness of a mesh as rows of 3 x 3 blocks, and its product with the displacements of many copies at once.

A matrix is read from memory once for all copies: on 60 000 elements with incompatible modes the forces of twelve copies take a
hundredth of what the same elements take one by one.
"""

from __future__ import annotations

from collections.abc import Callable

import attrs
import numpy as np
from numba import int32, int64, void
from numpy.typing import NDArray

from raceway.core.hexahedron.shape import Floats
from raceway.core.hexahedron.sparse import assemble_blocks
from raceway.core.jit import jit
from raceway.core.signatures import CUBE, VECTOR


@jit(void(int64, int64, int64[::1], int64[::1], int32[::1], VECTOR, CUBE, CUBE), releases=True)
def add_rows(first, last, nodes, starts, neighbours, data, moved, force):  # type: ignore[no-untyped-def]
    """Forces on nodes[first:last], one after the other in ``force`` (m, 3, c), of displacements (n, 3, c) of c copies."""
    copies = moved.shape[2]
    for row in range(first, last):
        for a in range(3):
            for c in range(copies):
                force[row, a, c] = 0.0
        begin = starts[nodes[row]]
        count = starts[nodes[row] + 1] - begin
        for p in range(count):
            column = neighbours[begin + p]
            for a in range(3):
                at = 9 * begin + 3 * (a * count + p)
                x, y, z = data[at], data[at + 1], data[at + 2]
                for c in range(copies):
                    force[row, a, c] += x * moved[column, 0, c] + y * moved[column, 1, c] + z * moved[column, 2, c]


@attrs.frozen(eq=False)
class BlockRows:
    """A stiffness matrix.

    Attributes
    ----------
    starts : (n + 1,) int64;  neighbours : (k,) int32
        Nodes that share an element with node i, sorted: neighbours[starts[i] : starts[i + 1]].
    data : (9 k,)
        The three rows of a node after each other [N/m].
    """

    starts: NDArray[np.int64]
    neighbours: NDArray[np.int32]
    data: Floats

    @classmethod
    def assemble(cls, cells: NDArray[np.uint32], nodes: int, element_matrices: Callable[[slice], Floats]) -> BlockRows:
        """Sum of element matrices (k, 24, 24), which ``element_matrices`` gives for a slice of cells (m, 8)."""
        return cls(*assemble_blocks(cells, nodes, 3, element_matrices))

    def times(self, nodes: NDArray[np.int64], moved: Floats) -> Floats:
        """(m, 3, c) forces [N] on ``nodes`` (m,) of displacements (n, 3, c) [m]."""
        force = np.empty((len(nodes), 3, moved.shape[2]))
        add_rows(0, len(nodes), nodes, self.starts, self.neighbours, self.data, moved, force)
        return force
