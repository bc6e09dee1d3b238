"""Aggregates of nodes for multigrid: neighbours along short edges first.

Cells that are long or flat are stiff along their short edges.  Smoothing there only works along them, so that coarsening has
to follow: an aggregate takes the neighbours that are hardly farther than the nearest one.  Distances tell that more surely
than entries of the stiffness, whose couplings along and across a long trilinear cell are of one size.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import attrs
import numpy as np

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

#: Neighbours up to this many times the distance of the nearest one are strong: all corners of a cube (1.73) and somewhat more,
#: for every direction that is left out makes the next level larger.
REACH = 2.2
#: Coarse nodes, of six unknowns each, at which a factorisation is cheap.
COARSEST = 80


@attrs.frozen(eq=False)
class Levels:
    """Aggregates from fine to coarse.

    Attributes
    ----------
    strong : for each level (n, n), which nodes are strongly coupled
    aggregates : for each level (n, k), 1 where a node belongs to an aggregate; the k nodes of the next level
    """

    strong: list[csr_matrix]
    aggregates: list[csr_matrix]


def aggregated(graph: csr_matrix, points: np.ndarray, fewest: float = 1.0) -> Levels:
    """Aggregates of nodes, of these aggregates, and so on.

    Parameters
    ----------
    graph : (n, n) CSR, not zero where two nodes share a cell
    points : (n, 3) float [m]
    fewest : nodes that an aggregate holds on average at least; aggregates of aggregates are taken until they do

    Notes
    -----
    An aggregate stands at the mean of its nodes, and neighbours those that share a cell with one of its nodes.
    """
    from pyamg.aggregation.aggregate import standard_aggregation

    levels = Levels([], [])
    strong, whole = graph, None  # of the last level kept: its strong pairs, and what its nodes belong to
    while graph.shape[0] > COARSEST:
        near = _strong(graph, points)
        found = standard_aggregation(near)[0].tocsr().astype(float)
        if found.shape[1] > 0.9 * found.shape[0]:  # nothing left to put together
            break
        if whole is None:
            strong, whole = near, found
        else:
            whole = (whole @ found).tocsr()
        points = (found.T @ points) / np.maximum(np.asarray(found.sum(axis=0)).reshape(-1, 1), 1.0)
        graph = (found.T @ graph @ found).tocsr()
        if whole.shape[0] >= fewest * whole.shape[1]:
            levels.strong.append(strong)
            levels.aggregates.append(whole)
            whole = None
    if whole is not None:
        levels.strong.append(strong)
        levels.aggregates.append(whole)
    return levels


def _strong(graph: csr_matrix, points: np.ndarray) -> csr_matrix:
    """(n, n) CSR of ones: pairs that one of the two counts among its nearest, and the diagonal."""
    import scipy.sparse as sp

    pairs = graph.tocoo()
    apart = pairs.row != pairs.col
    row, column = pairs.row[apart], pairs.col[apart]
    distance = np.linalg.norm(points[row] - points[column], axis=1)
    nearest = np.full(len(points), np.inf)
    np.minimum.at(nearest, row, distance)
    near = distance <= REACH * nearest[row]
    chosen = sp.csr_matrix((np.ones(near.sum()), (row[near], column[near])), shape=graph.shape)
    strong = (chosen + chosen.T + sp.eye(len(points), format="csr")).tocsr()
    strong.data[:] = 1.0
    return strong
