"""Sparse matrices of a mesh: the pattern once, then element matrices added batch by batch."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numba import int32, int64, void
from numpy.typing import NDArray

from raceway.core.hexahedron.mass import batches
from raceway.core.hexahedron.shape import Floats
from raceway.core.hexahedron.stiffness import add_to_sparse
from raceway.core.jit import jit

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


@jit(void(int64, int64[::1], int32[::1], int64[::1], int32[::1]))
def _spread(components, starts, neighbours, row_starts, columns):  # type: ignore[no-untyped-def]
    """Rows and columns of a node-by-node pattern with ``components`` unknowns a node."""
    at = 0
    row_starts[0] = 0
    for node in range(starts.size - 1):
        for a in range(components):
            for p in range(starts[node], starts[node + 1]):
                for b in range(components):
                    columns[at] = components * neighbours[p] + b
                    at += 1
            row_starts[components * node + a + 1] = at


def node_pattern(cells: NDArray[np.uint32], count: int) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """For each of ``count`` nodes the sorted nodes that share an element with it: starts (count + 1,), neighbours."""
    from scipy.sparse import csr_array

    size = 8 * len(cells)
    rows = np.arange(0, size + 1, 8, dtype=np.int32 if size < 2**31 else np.int64)
    incidence = csr_array((np.ones(size, dtype=np.int8), cells.ravel().astype(rows.dtype), rows), shape=(len(cells), count))
    pattern = (incidence.T.tocsr() @ incidence).tocsr()
    pattern.sort_indices()
    return pattern.indptr.astype(np.int64), pattern.indices.astype(np.int32)


def assemble_blocks(
    cells: NDArray[np.uint32], count: int, components: int, element_matrices: Callable[[slice], Floats]
) -> tuple[NDArray[np.int64], NDArray[np.int32], Floats]:
    """``node_pattern``, and the numbers: the rows of a node after each other.  Parameters: see ``assemble``."""
    starts, neighbours = node_pattern(cells, count)
    data = np.zeros(components**2 * len(neighbours))
    for part in batches(len(cells), 2048):
        add_to_sparse(part.start, components, element_matrices(part), cells, starts, neighbours, data)
    return starts, neighbours, data


def assemble(
    cells: NDArray[np.uint32],
    count: int,
    components: int,
    element_matrices: Callable[[slice], Floats],
) -> csr_matrix:
    """Sum of element matrices.

    Parameters
    ----------
    cells : (m, 8) uint32
    count : int
        Nodes.
    components : int
        Unknowns a node: 3 for a stiffness, 1 for the mass of one direction.
    element_matrices : function
        Of a slice of elements: their matrices (k, 8 components, 8 components).

    Returns
    -------
    matrix : scipy.sparse.csr_array (components count, components count)
    """
    from scipy.sparse import csr_array

    starts, neighbours, data = assemble_blocks(cells, count, components, element_matrices)
    row_starts = np.empty(components * count + 1, dtype=np.int64)
    columns = np.empty(len(data), dtype=np.int32)
    _spread(components, starts, neighbours, row_starts, columns)
    if len(data) < 2**31:  # scipy's kernels are faster with short indices
        row_starts = row_starts.astype(np.int32)
    return csr_array((data, columns, row_starts), shape=(components * count, components * count))
