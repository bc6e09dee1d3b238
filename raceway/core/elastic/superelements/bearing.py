"""The superelements of a bearing: what is equal is factored once, with the nodes that its contacts may touch."""

from __future__ import annotations

import numpy as np

from raceway.core.elastic.assembly import Assembly
from raceway.core.elastic.bed import bed_of_cells
from raceway.core.elastic.contacts.nodal import NodalContact
from raceway.core.elastic.copies import Copies, Group
from raceway.core.elastic.equal_parts import free_nodes
from raceway.core.elastic.superelements.balls import Balls
from raceway.core.elastic.superelements.interface import Interface
from raceway.core.elastic.superelements.kept import OnProgress, kept_ball, kept_ring
from raceway.core.elastic.superelements.rings import Ring
from raceway.errors import MeshError

#: Facets of the rings beyond those under a ball's points: bodies move by tens of micrometres, their facets there are as large.
_FURTHER = 1


def interface_of(assembly: Assembly, wanted: np.ndarray, mass: float, on_progress: OnProgress | None = None) -> Interface:
    """Superelements of c K + d M.

    Parameters
    ----------
    assembly : inner ring, outer ring, balls, with its groups of equal parts
    wanted : (nodes,) bool, those that contacts may touch
    mass : d / c [1/s2]
    on_progress : told of every body that is factored, optional
    """
    rings = [_ring(assembly, group, wanted, mass, on_progress) for group in assembly.groups[:2]]
    balls = [
        (_balls(assembly, group, wanted, mass, on_progress), [ball - 2 for ball in group.members])
        for group in assembly.groups[2:]
    ]
    return Interface(rings, balls, assembly.nodes)


def touchable(contact: NodalContact, nodes: int) -> np.ndarray:
    """(nodes,) bool, which of them contacts may touch: under their points, and so many facets further on the rings."""
    under = np.zeros(nodes, dtype=bool)
    under[contact.nodes.ravel()] = True
    for _ in range(_FURTHER):
        out = under.copy()
        for pair in contact.pairs:
            quads = pair.facets.quads + pair.first_node
            out[quads[under[quads].any(axis=1)].ravel()] = True
        under = out
    return under


def _ring(assembly: Assembly, group: Group, wanted: np.ndarray, mass: float, on_progress: OnProgress | None) -> Ring:
    (index,), copies = group.members, group.copies
    body, rows, first = assembly.bodies[index], assembly.part(index), int(assembly.starts[index])
    free = free_nodes(assembly, index)
    cells = np.asarray(body.operator.cells, dtype=np.int64)
    own = wanted[rows.start // 3 : rows.stop // 3]
    touched = np.unique(np.concatenate([np.flatnonzero(own[part - first]) for part in copies.nodes]))
    cut = np.concatenate([copies.before, copies.behind])
    if np.isin(touched, cut).any():
        copies = Copies.single(body.points, cells, first)
        touched = np.flatnonzero(own)
    local = copies.nodes[0] - first
    touched = touched[free[local[touched]]]
    if not touched.size:
        raise MeshError(
            f"{body.name}: no node of its groove below a contact is free: its seat reaches into the groove. Mesh the ring with free nodes there"
        )
    bed = None if body.foundation is None else _of_part(bed_of_cells(body), cells, local, copies.cells)
    element = kept_ring(body.name, copies, body.operator, touched, free[local], mass, bed, on_progress)
    inertia = mass * np.repeat(body.operator.lumped_mass() * free, 3)
    ride = assembly.carried[rows] if body.frame is not None else np.zeros((rows.stop - rows.start, 0))

    def apply(moved: np.ndarray) -> np.ndarray:
        out = np.zeros_like(moved)
        own = moved[rows]
        force = assembly.body_force(index, moved) + inertia * own
        for foundation, _ in assembly.foundations:
            force += (foundation[rows][:, rows]) @ own
        out[rows] = force * np.repeat(free, 3)
        return out

    return Ring(element, rows, ride, apply, inertia, 3 * assembly.nodes)


def _of_part(
    bed: tuple[np.ndarray, np.ndarray], cells: np.ndarray, local: np.ndarray, part: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The cells of a sector that stand on the bed, numbered in it."""
    key = {tuple(row): k for k, row in enumerate(local[part])}
    found = [(key[row], matrix) for row, matrix in zip(map(tuple, cells[bed[0]]), bed[1], strict=True) if row in key]
    return np.array([k for k, _ in found], dtype=np.int64), np.array([matrix for _, matrix in found])


def _balls(assembly: Assembly, group: Group, wanted: np.ndarray, mass: float, on_progress: OnProgress | None) -> Balls:
    copies, index = group.copies, group.members[0]
    body, rows = assembly.bodies[index], assembly.part(index)
    touched = np.unique(np.concatenate([np.flatnonzero(wanted[nodes]) for nodes in copies.nodes]))
    caged, stiffness = np.zeros((0, rows.stop - rows.start)), np.zeros(0)
    if assembly.cage is not None:
        own = slice(4 * (index - 2), 4 * (index - 2) + 4)
        caged, stiffness = assembly.cage.rows[own, rows].toarray(), assembly.cage.stiffness[own]
    inertia = mass * np.repeat(body.operator.lumped_mass(), 3)[:, None]

    def apply(moved: np.ndarray) -> np.ndarray:
        return assembly.mesh_force(index, moved) + inertia * moved

    forces = np.ascontiguousarray(caged.T)
    loose, response = kept_ball(body.name, copies, body.operator, touched, mass, forces, apply, on_progress)
    return Balls(loose, caged, stiffness, response, mass > 0.0)
