"""Nested dissection of a mesh: the order in which its nodes are eliminated.

Reference
---------
George, A.: Nested dissection of a regular finite element mesh, SIAM Journal on Numerical Analysis 10 (1973) 345.
"""

from __future__ import annotations

import attrs
import numpy as np
from numpy.typing import NDArray

Nodes = NDArray[np.int64]

#: Cells that are no longer divided: 64 to 200 cost the same flops, and fewer matrices are quicker.
LEAF = 128
#: Smallest share of the cells on one side of a cut, and what an unbalanced cut costs over a balanced one.
_SMALLEST, _UNBALANCED = 0.3, 0.5
#: Directions of the cuts: axes, and planes through edges of a cube.
_DIRECTIONS = np.array(
    [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [1, -1, 0], [1, 0, 1], [1, 0, -1], [0, 1, 1], [0, 1, -1]], dtype=float
)


@attrs.frozen(eq=False)
class Domain:
    """Cells that are eliminated together.

    Attributes
    ----------
    inner : (k,) sorted nodes that belong to these cells alone and to no child's inner ones: eliminated here
    border : (b,) sorted nodes that other cells share, or that are kept
    children : numbers of the two halves, lower than the own one; none of a leaf
    cells : (first, last + 1) of a leaf in ``Dissection.order``
    """

    inner: Nodes
    border: Nodes
    children: tuple[int, ...]
    cells: tuple[int, int] | None


@attrs.frozen(eq=False)
class Dissection:
    """Domains, children before parents, the whole mesh last, and the order of the cells in which leaves are contiguous."""

    domains: list[Domain]
    order: Nodes


def dissect(points: np.ndarray, cells: np.ndarray, kept: np.ndarray) -> Dissection:
    """Halves of halves of a mesh, cut where few nodes lie.

    Parameters
    ----------
    points : (n, 3) float;  cells : (m, 8) int
    kept : (k,) int
        Nodes that are not eliminated.
    """
    numbers = np.asarray(cells, dtype=np.int64)
    centre = points[numbers].mean(axis=1)
    centre -= centre.mean(axis=0)
    size = float(np.ptp(points, axis=0).max())
    radius = np.linalg.norm(centre, axis=1)
    # Rounded: layers of cells stay together.
    measures = [np.round(x / size, 7) for x in (*(centre @ _DIRECTIONS.T).T, radius, np.abs(centre).max(axis=1))]
    uses = np.bincount(numbers.ravel(), minlength=len(points))
    uses[kept] = len(numbers) + 1
    domains: list[Domain] = []
    leaves: list[Nodes] = []
    placed = 0

    def visit(part: Nodes) -> int:
        nonlocal placed
        nodes, local = np.unique(numbers[part], return_inverse=True)
        local = local.reshape(-1, 8)
        inside = np.bincount(local.ravel()) >= uses[nodes]
        border = nodes[~inside]
        if len(part) <= LEAF:
            leaves.append(part)
            domains.append(Domain(nodes[inside], border, (), (placed, placed + len(part))))
            placed += len(part)
            return len(domains) - 1
        _, first, second = min((_cut(x[part], local, len(nodes)) for x in measures), key=lambda cut: cut[0])
        children = visit(part[first]), visit(part[second])
        both = np.union1d(domains[children[0]].border, domains[children[1]].border)
        domains.append(Domain(np.setdiff1d(both, border, assume_unique=True), border, children, None))
        return len(domains) - 1

    visit(np.arange(len(numbers)))
    return Dissection(domains, np.concatenate(leaves))


def _cut(along: np.ndarray, local: np.ndarray, nodes: int) -> tuple[float, Nodes, Nodes]:
    """Cost of the best cut across a measure of the cells (m,), and the cells of both sides; ``local`` (m, 8) nodes from 0."""
    count = len(along)
    order = np.argsort(along, kind="stable")
    rank = np.empty(count, dtype=np.int64)
    rank[order] = np.arange(count)
    first, last = np.full(nodes, count), np.zeros(nodes, dtype=np.int64)
    ranks = np.repeat(rank, 8)
    np.minimum.at(first, local.ravel(), ranks)
    np.maximum.at(last, local.ravel(), ranks)
    # A node lies in the cut after k cells where first < k <= last.
    change = np.bincount(first + 1, minlength=count + 2) - np.bincount(last + 1, minlength=count + 2)
    shared = np.cumsum(change)
    low = max(1, int(_SMALLEST * count))
    places = np.arange(low, count - low + 1)
    larger = np.maximum(places, count - places) / count
    cost = shared[places] * (1.0 + _UNBALANCED * (2.0 * larger - 1.0))
    best = int(np.argmin(cost))
    return float(cost[best]), order[: places[best]], order[places[best] :]
