"""Springs under a surface: their matrix, node by node and cell by cell."""

from __future__ import annotations

import numpy as np

from raceway.core.elastic.body import Body
from raceway.core.elastic.contacts.surface import surface_points


def bed_blocks(body: Body) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (4 k, 4) of the points of a bed's facets, and the stiffness (4 k, 4, 4) between them in each direction [N/m]."""
    assert body.foundation is not None
    quads, stiffness = body.foundation
    p = surface_points(body.points, quads)
    return p.nodes, stiffness * p.area[:, None, None] * p.weights[:, :, None] * p.weights[:, None, :]


def bed_of_cells(body: Body) -> tuple[np.ndarray, np.ndarray]:
    """Cells (b,) that a bed's facets belong to, and what it adds to their matrices (b, 24, 24)."""
    nodes, blocks = bed_blocks(body)
    quads, blocks = nodes[::4], blocks.reshape(-1, 4, 4, 4).sum(axis=1)
    cells = np.asarray(body.operator.cells, dtype=np.int64)
    on_bed = np.zeros(len(body.points), dtype=bool)
    on_bed[quads.ravel()] = True
    near = np.flatnonzero(on_bed[cells].sum(axis=1) >= 4)
    owner: dict[int, list[int]] = {}
    for cell in near:
        for node in cells[cell][on_bed[cells[cell]]]:
            owner.setdefault(int(node), []).append(int(cell))
    chosen, matrices = np.empty(len(quads), dtype=np.int64), np.zeros((len(quads), 24, 24))
    for k, (quad, block) in enumerate(zip(quads, blocks, strict=True)):
        (chosen[k],) = set.intersection(*(set(owner[int(node)]) for node in quad))
        place = np.array([int(np.flatnonzero(cells[chosen[k]] == node)[0]) for node in quad])
        for axis in range(3):
            matrices[k][np.ix_(3 * place + axis, 3 * place + axis)] = block
    return chosen, matrices
