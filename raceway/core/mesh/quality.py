"""Quality of cells (scaled Jacobian, aspect, skew), and refusal of those that cannot be computed with.

References
----------
Knupp, Ernst, Thompson, Stimpson, Pebay: The Verdict geometric quality library, SAND2007-1751 (2007): scaled Jacobian,
edge ratio, skew of hexahedra.
"""

from __future__ import annotations

import attrs
import numpy as np

from raceway.core.mesh.hex_mesh import BLOCK, EDGES, HexMesh
from raceway.errors import MeshError

#: Neighbours of each corner along the three local axes, in right-handed order.
_AROUND = np.array([[1, 3, 4], [2, 0, 5], [3, 1, 6], [0, 2, 7], [7, 5, 0], [4, 6, 1], [5, 7, 2], [6, 4, 3]])
#: A scaled Jacobian below this is flat to the rounding of coordinates.
DEGENERATE = 1e-6


@attrs.frozen(eq=False)
class Quality:
    """Quality of each cell.

    Attributes
    ----------
    scaled_jacobian : (m,) smallest determinant of the unit edge vectors at the corners: 1 for a cuboid, <= 0 is inverted
    aspect : (m,) longest edge / shortest edge
    skew : (m,) largest |cosine| between the cell's principal axes: 0 for a cuboid
    """

    scaled_jacobian: np.ndarray
    aspect: np.ndarray
    skew: np.ndarray


def quality(mesh: HexMesh) -> Quality:
    """Quality of every cell; flat cells get a scaled Jacobian of 0 and an infinite aspect."""
    count = len(mesh.cells)
    jacobian, aspect, skew = np.empty(count), np.empty(count), np.empty(count)
    for first in range(0, count, BLOCK):
        here = slice(first, first + BLOCK)
        # (3, 8, k): components outermost, so that every product below runs along contiguous memory.
        corner = np.ascontiguousarray(mesh.points[mesh.cells[here]].transpose(2, 1, 0))
        edge = corner[:, EDGES[:, 1]] - corner[:, EDGES[:, 0]]
        length = np.sqrt((edge * edge).sum(axis=0))
        shortest, longest = length.min(axis=0), length.max(axis=0)
        with np.errstate(divide="ignore", invalid="ignore"):
            aspect[here] = np.where(shortest > 0.0, longest / shortest, np.inf)
        worst = np.full(corner.shape[2], np.inf)
        for at, ends in enumerate(_AROUND):
            worst = np.minimum(worst, _unit_determinant(*(corner[:, end] - corner[:, at] for end in ends)))
        jacobian[here] = worst
        axes = [edge[:, 4 * i : 4 * i + 4].sum(axis=1) for i in range(3)]
        skew[here] = np.maximum.reduce([_cosine(axes[i], axes[(i + 1) % 3]) for i in range(3)])
    return Quality(jacobian, aspect, skew)


def refuse_bad_cells(mesh: HexMesh, body: str = "") -> Quality:
    """The quality, unless a cell is inverted or degenerate.

    Raises
    ------
    MeshError
        How many cells, the first of them, its centre and its nodes.
    """
    found = quality(mesh)
    bad = np.flatnonzero(found.scaled_jacobian < DEGENERATE)
    if not len(bad):
        return found
    cell = int(bad[0])
    value = float(found.scaled_jacobian[cell])
    word = "inverted" if value < -DEGENERATE else "degenerate"
    centre = ", ".join(f"{x:.6g}" for x in mesh.points[mesh.cells[cell]].mean(axis=0))
    nodes = ", ".join(str(node) for node in mesh.cells[cell])
    where = f"`{body}`: " if body else ""
    raise MeshError(
        f"{where}{len(bad)} of {len(mesh.cells)} cells are inverted or degenerate; the first is cell {cell}, {word} (scaled "
        f"Jacobian {value:.3g}), centre ({centre}) m, nodes {nodes}. Nodes 0 to 3 of a cell go around its bottom, 4 to 7 "
        "stand above them: check their order, and points that coincide"
    )


def refuse_doubled(mesh: HexMesh, body: str) -> None:
    """Refuse what cannot be one body: cells that stand there twice, points that coincide and are not one, parts that do not hang together.

    Raises
    ------
    MeshError
        How many, and where the first is.
    """
    nodes = np.sort(mesh.cells, axis=1)
    _, first, counts = np.unique(nodes, axis=0, return_index=True, return_counts=True)
    if (counts > 1).any():
        cell = int(first[counts > 1].min())
        raise MeshError(
            f"`{body}`: {int((counts - 1).sum())} cells stand there twice; the first is cell {cell}: remove the copies"
        )
    used = np.unique(mesh.cells)
    points = mesh.points[used]
    grain = 1e-9 * float(np.ptp(points, axis=0).max())
    _, first, counts = np.unique(np.round(points / grain), axis=0, return_index=True, return_counts=True)
    if (counts > 1).any():
        where = ", ".join(f"{x:.6g}" for x in points[first[counts > 1].min()])
        raise MeshError(
            f"`{body}`: {int((counts - 1).sum())} points coincide with others and are not one with them, the first at ({where}) m: "
            "parts that touch there are not joined. Merge the nodes where they lie on each other"
        )
    parts = _parts(mesh.cells)
    if parts > 1:
        raise MeshError(f"`{body}`: its cells form {parts} parts that do not hang together: give one body, in one piece")


def _parts(cells: np.ndarray) -> int:
    """Number of sets of cells that share nodes with no other set."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    count = int(cells.max()) + 1
    rows, columns = np.repeat(np.arange(len(cells)), 8), cells.reshape(-1)
    owns = coo_matrix((np.ones(rows.size, dtype=np.int8), (rows, columns + len(cells))), shape=(len(cells) + count,) * 2)
    _, label = connected_components(owns, directed=False)
    return len(np.unique(label[: len(cells)]))


def _unit_determinant(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """a . (b x c) of vectors (3, k), divided by their lengths; 0 where one has none."""
    value = a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    size = np.sqrt((a * a).sum(axis=0) * (b * b).sum(axis=0) * (c * c).sum(axis=0))
    return np.where(size > 0.0, value / np.where(size > 0.0, size, 1.0), 0.0)


def _cosine(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    size = np.sqrt((a * a).sum(axis=0) * (b * b).sum(axis=0))
    return np.where(size > 0.0, np.abs((a * b).sum(axis=0)) / np.where(size > 0.0, size, 1.0), 1.0)
