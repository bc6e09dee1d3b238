"""The superelements of a bearing: what is equal is factored once, with the nodes that its contacts may touch."""

from collections.abc import Callable
from functools import partial
from typing import Any

import attrs
import numpy as np

from raceway.core.fem.elastic.assembly import Assembly, bed_of_cells
from raceway.core.fem.elastic.contact import NodalContact
from raceway.core.fem.elastic.copies import Copies, Group
from raceway.core.fem.elastic.superelement import REFINED, Closed, Loose, Part, gather_turned
from raceway.core.fem.elastic.unknowns import of_nodes
from raceway.core.fem.hexahedron.operator import HexOperator
from raceway.errors import MeshError
from raceway.storage.array_cache import kept


class _Ring:
    """One ring, its displacement u = R q + w of the frame's motions q and of w, which is zero on the seat.

    element : Loose | Closed;  part : rows of the ring among all nodes' (3 nodes,)
    ride : (3 n, m) R at all nodes; m = 0 without a frame
    apply : function of w (3 nodes,) -> c K w + d M w;  inertia : (3 n,) d / c times the nodes' masses
    size : 3 nodes
    follow : (3 n, m) R - W, W the displacement by which the ring falls behind its frame for its inertia
    carried : (3 k, m) ``follow`` at the contacts' nodes
    """

    def __init__(
        self, element: Loose | Closed, part: slice, ride: np.ndarray, apply: Callable[[np.ndarray], np.ndarray],
        inertia: np.ndarray, size: int,
    ) -> None:  # fmt: skip
        self.element, self.part = element, part
        behind = np.zeros_like(ride)
        if inertia.any():
            for k in range(ride.shape[1]):
                force, solution = np.zeros((2, size))
                force[part] = inertia * ride[:, k]
                for _ in range(REFINED):
                    loads, interior = element.forward(force - apply(solution))
                    back: Any = interior
                    step = np.zeros(size)
                    element.backward(back, element.respond(loads), step)
                    solution += step
                behind[:, k] = solution[part]
        self.follow = ride - behind
        self.carried = self.follow[of_nodes(element.nodes.ravel()) - part.start]
        #: (m, m) what the ring's free nodes add to the frame's matrix: R^T M (R - W) d / c.
        self.added = ride.T @ (inertia[:, None] * self.follow)

    @property
    def nodes(self) -> np.ndarray:
        """(contacts' nodes,) their numbers."""
        return np.asarray(self.element.nodes.ravel())

    def respond(self, force: np.ndarray) -> np.ndarray:
        """w (k, 3) at the contacts' nodes under forces (k, 3) there."""
        return self.element.respond(force.reshape(len(self.element.nodes), -1)).reshape(-1, 3)

    def forward(self, force: np.ndarray) -> tuple[np.ndarray, np.ndarray, Any]:
        """Displacements (3 k,) under nodal forces (3 nodes,) with the frame held, forces (m,) on it, and what ``backward`` needs."""
        loads, interior = self.element.forward(force)
        return self.element.respond(loads).ravel(), self.follow.T @ force[self.part], interior

    def backward(self, interior: Any, displacement: np.ndarray, frame: np.ndarray, out: np.ndarray) -> None:
        """Displacements of all nodes, into ``out`` (3 nodes,), of those of the contacts (3 k,) and of the frame (m,)."""
        deformation = displacement - self.carried @ frame
        self.element.backward(interior, deformation.reshape(len(self.element.nodes), -1), out)
        out[self.part] += self.follow @ frame


def free_nodes(assembly: Assembly, index: int) -> np.ndarray:
    """(n,) bool, nodes of a body that are neither held nor tied to a frame."""
    free = np.zeros(3 * assembly.nodes, dtype=bool)
    free[assembly.free] = True
    return np.asarray(free[assembly.part(index)].reshape(-1, 3).all(axis=1))


class _Balls:
    """Copies of one ball.

    loose : Loose
    rows : (c, 3 n) mean motions of the first copy that the cage holds;  stiffness : (c,) [N/m, N m/rad]
    response : (3 n, c) displacements of the first copy under forces on them
    inert : whether a mass holds a ball that touches nothing
    flexibility : (3 k + e, 3 k + e) of the first copy: contacts' nodes, then mean motions of the contacts' nodes and of the cage
    springs : (e,) stiffness of what acts on these motions: minus the springs of ``loose``, and the cage's
    alone : (e,) of a ball that touches nothing: without a mass the springs of ``loose`` stay, or nothing would hold it
    """

    def __init__(self, loose: Loose, rows: np.ndarray, stiffness: np.ndarray, response: np.ndarray, inert: bool) -> None:
        self.loose, self.response = loose, response
        places = loose.unknowns
        size, rigid_count, cage_count = len(places), loose.motions.shape[1], len(rows)
        outputs = np.zeros((size, rigid_count + cage_count))
        outputs[:, :rigid_count] = loose.flexibility @ loose.motions
        outputs[:, rigid_count:] = self.response[places]
        corner = np.zeros((rigid_count + cage_count, rigid_count + cage_count))
        corner[:rigid_count] = loose.motions.T @ outputs
        corner[rigid_count:, :rigid_count] = corner[:rigid_count, rigid_count:].T
        corner[rigid_count:, rigid_count:] = rows @ self.response
        self.flexibility = np.block([[loose.flexibility, outputs], [outputs.T, corner]])
        self.springs = np.concatenate([np.full(rigid_count, -loose.hold), stiffness])
        self.alone = self.springs if inert else np.maximum(self.springs, 0.0)
        self.size = size

    @property
    def count(self) -> int:
        return len(self.loose.nodes)

    def forward(self, force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Motions (copies, 3 k + e) under nodal forces (3 nodes,) alone, and what ``backward`` needs."""
        loads, interior = self.loose.forward(force)
        out = np.empty((self.count, len(self.flexibility)))
        local = self.loose.to_first(loads)
        displacement = local @ self.flexibility[: self.size, : self.size]
        out[:, : self.size] = self.loose.to_copies(displacement)
        rigid_count = self.loose.motions.shape[1]
        out[:, self.size : self.size + rigid_count] = displacement @ self.loose.motions
        out[:, self.size + rigid_count :] = self.loose.part.gathered(force, float).T @ self.response
        return out, interior

    def backward(self, interior: np.ndarray, displacement: np.ndarray, forces: np.ndarray, out: np.ndarray) -> None:
        """Displacements of all nodes, into ``out`` (3 nodes,).

        displacement : (copies, 3 k) of the contacts' nodes;  forces : (copies, e) on the other motions
        """
        rigid_count = self.loose.motions.shape[1]
        cage = forces[:, rigid_count:] @ self.response.T  # (copies, 3 n)
        places = self.loose.unknowns
        local = self.loose.to_first(displacement) + cage[:, places]
        self.loose.part.spread(self.loose.inner(interior, local) - cage.T, out)


#: Cells of a part from which factors take seconds, and reading them pays.
LEAST_CELLS = 8000
_ELASTIC = ("copies", "fronts", "linear_statics", "superelement", "interface", "unknowns")
#: The code that the numbers depend on.
SOURCES = ("core/fem/hexahedron", *(f"core/fem/elastic/{name}.py" for name in _ELASTIC))

Arrays = dict[str, np.ndarray]
#: Called with what is done, how much of it, and how much there is.
OnProgress = Callable[[str, int, int], None]


@attrs.frozen(eq=False)
class _Substructure:
    name: str  # of its body
    #: copies, operator, contact, free, mass, bed : see ``Part.of``
    copies: Copies
    operator: HexOperator
    contact: np.ndarray
    free: np.ndarray
    mass: float
    bed: tuple[np.ndarray, np.ndarray] | None
    on_progress: OnProgress | None

    def ring(self) -> Loose | Closed:
        """A ring, or its sectors."""
        copies = self.copies
        kind: type[Loose] | type[Closed] = Closed if len(copies.turns) > 1 else Loose
        planes = [copies.before, copies.behind]
        inputs = {"free": self.free, "bed": list(self.bed or ()), "turns": copies.turns, "planes": planes}
        return kind.of_arrays(copies, self.contact, self._from_store(inputs, lambda: kind.of(self._part()).arrays()))

    def ball(self, cage_rows: np.ndarray, apply: Callable[[np.ndarray], np.ndarray]) -> tuple[Loose, np.ndarray]:
        """A ball, held by springs on its mean motions, which the caller takes off again, and its answers (3 n, c) to its cage.

        cage_rows : (3 n, c) forces of the cage;  apply : function of displacements (3 n, m) -> forces, those springs left out
        """

        def make() -> Arrays:
            loose = Loose.of(self._part(), held=True)
            return loose.arrays() | {"response": loose.solved(cage_rows, apply)}

        arrays = self._from_store({"held": True, "caged": cage_rows}, make)
        return Loose.of_arrays(self.copies, self.contact, arrays), arrays["response"]

    @property
    def _title(self) -> str:
        return self.name.rstrip("_0123456789").replace("_", " ")

    def _part(self) -> Part:
        on_front = None
        if self.on_progress is not None:
            sector = "a sector of the " if len(self.copies.before) else ""
            on_front = partial(self.on_progress, f"factoring {sector}{self._title}, {len(self.copies.cells)} elements")
        return Part.of(self.copies, self.operator, self.contact, self.free, self.mass, self.bed, on_front)

    def _from_store(self, inputs: dict[str, object], make: Callable[[], Arrays]) -> Arrays:
        cells, operator, mass = len(self.copies.cells), self.operator, self.mass
        if cells < LEAST_CELLS:
            return make()
        inputs |= {
            "points": self.copies.points,
            "cells": self.copies.cells,
            "contact": self.contact,
            "mass": float(mass),
            "moduli": operator.moduli,
            "density": operator.density if mass else None,
            "formulation": operator.formulation,
        }
        title = f"{self._title}, {cells} elements, {operator.formulation}" + (f", mass {mass:.6g}/s2" if mass else "")
        return kept("superelement", title, inputs, SOURCES, make)


@attrs.frozen(eq=False)
class _RingFlexibility:
    """A matrix with one dense block for each ring."""

    nodes: np.ndarray  # (k,) sorted numbers of nodes
    blocks: list[tuple[slice, np.ndarray]]  # rows of each ring among the unknowns (3 k,), and its flexibility [m/N]
    carried: np.ndarray  # (3 k, m) motion with the frame

    def times(self, forces: np.ndarray) -> np.ndarray:
        """(3 k,) displacements under forces (3 k,)."""
        out = np.empty_like(forces)
        for rows, block in self.blocks:
            out[rows] = block @ forces[rows]
        return out

    def under(self, places: np.ndarray, forces: np.ndarray) -> np.ndarray:
        """(3 k, n) displacements under forces (p, n) at sorted places (p,)."""
        out = np.empty((3 * len(self.nodes), forces.shape[1]))
        for (rows, block), of_ring in zip(self.blocks, self._split(places), strict=True):
            out[rows] = block[:, places[of_ring] - rows.start] @ forces[of_ring]
        return out

    def among(self, places: np.ndarray, forces: np.ndarray) -> np.ndarray:
        """(p, n) of these displacements those at ``places`` themselves."""
        out = np.empty_like(forces)
        for (rows, block), of_ring in zip(self.blocks, self._split(places), strict=True):
            here = places[of_ring] - rows.start
            out[of_ring] = block[np.ix_(here, here)] @ forces[of_ring]
        return out

    def _split(self, places: np.ndarray) -> list[slice]:
        ends = [np.searchsorted(places, (rows.start, rows.stop)) for rows, _ in self.blocks]
        return [slice(int(first), int(last)) for first, last in ends]


@attrs.frozen(eq=False)
class Motions:
    """Displacements, or forces, at what bodies are seen from."""

    nodes: np.ndarray  # (n, 3) the contacts' nodes of all bodies
    balls: np.ndarray  # (Z, e) mean motions of the balls
    frame: np.ndarray  # (m,) motions of the frame

    def plus(self, part: float, change: "Motions") -> "Motions":
        """Self + part * other."""
        return Motions(self.nodes + part * change.nodes, self.balls + part * change.balls, self.frame + part * change.frame)


class Interface:
    """Superelements of all bodies of a bearing.

    rings : the inner ring, with the frame, and the outer one
    balls : groups of equal balls, each with the numbers of its balls;  nodes : of the assembly

    numbers : (n,) of the contacts' nodes in the assembly;  place : (nodes,) the way back, -1 elsewhere

    A ball answers for itself: its contacts' nodes, and the mean motions that its cage and the springs of its superelement
    act on. The rings answer for all contacts at once.
    """

    def __init__(self, rings: list[_Ring], balls: list[tuple[_Balls, list[int]]], nodes: int) -> None:
        self.rings, self.groups = rings, balls
        self.numbers = np.concatenate([ring.nodes for ring in rings] + [group.loose.nodes.ravel() for group, _ in balls])
        self.place = np.full(nodes, -1, dtype=np.int64)
        self.place[self.numbers] = np.arange(len(self.numbers))
        self.frame_size = max(ring.carried.shape[1] for ring in rings)
        self.extra = len(balls[0][0].springs)
        self._first = np.cumsum([0, *(len(ring.nodes) for ring in rings)])
        self._balls: dict[int, tuple[_Balls, int, int]] = {}
        self._flexibility: _RingFlexibility | None = None
        begin = int(self._first[-1])
        for group, members in balls:
            for copy, ball in enumerate(members):
                self._balls[ball] = group, copy, begin
                begin += group.size // 3

    @property
    def ball_count(self) -> int:
        return len(self._balls)

    def moved(self, forces: Motions, frame: np.ndarray) -> Motions:
        """Motions under forces on contacts' nodes and balls, and motions (m,) of the frame."""
        out, balls = np.empty_like(forces.nodes), np.empty_like(forces.balls)
        for k, ring in enumerate(self.rings):
            rows = slice(self._first[k], self._first[k + 1])
            along = ring.carried @ frame[: ring.carried.shape[1]]
            out[rows] = ring.respond(forces.nodes[rows]) + along.reshape(-1, 3)
        begin = int(self._first[-1])
        for group, members in self.groups:
            rows = slice(begin, begin + len(members) * group.size // 3)
            begin = rows.stop
            loads = group.loose.to_first(forces.nodes[rows].reshape(len(members), -1))
            motions = np.concatenate([loads, forces.balls[members]], axis=1) @ group.flexibility
            out[rows] = group.loose.to_copies(motions[:, : group.size]).reshape(-1, 3)
            balls[members] = motions[:, group.size :]
        return Motions(out, balls, frame)

    def on_frame(self, force: np.ndarray) -> np.ndarray:
        """(m,) what forces (n, 3) on contacts' nodes are on the frame."""
        out = np.zeros(self.frame_size)
        for k, ring in enumerate(self.rings):
            out[: ring.carried.shape[1]] += ring.carried.T @ force[self._first[k] : self._first[k + 1]].ravel()
        return out

    def springs(self, ball: int, touching: bool) -> np.ndarray:
        """(e,) on a ball's mean motions."""
        group = self._balls[ball][0]
        return group.springs if touching else group.alone

    def of_ball(self, ball: int, nodes: np.ndarray) -> np.ndarray:
        """(3 m + e, 3 m + e) flexibility of some nodes (m,) and the mean motions of a ball where it lies."""
        group, copy, begin = self._balls[ball]
        places, turn = of_nodes(nodes - begin), group.loose.part.copies.turns[copy]
        size, none = len(places), np.zeros(len(nodes), dtype=np.int64)
        inner = np.empty((size, size))
        gather_turned(group.flexibility[None], turn[None], none, nodes - begin, inner)
        beside = (turn @ group.flexibility[places, group.size :].reshape(-1, 3, self.extra)).reshape(size, self.extra)
        return np.block([[inner, beside], [beside.T, group.flexibility[group.size :, group.size :]]])

    def of_rings(self, nodes: np.ndarray) -> _RingFlexibility:
        """Of some of the rings' nodes (k,), ``nodes`` (m,) among them.

        Contacts move little from iteration to iteration: what was asked for before stays, up to twice of what is asked.
        """
        reach = np.union1d(self._flexibility.nodes, nodes) if self._flexibility else nodes
        if len(reach) > 2 * len(nodes):
            reach = nodes
        if self._flexibility is not None and np.array_equal(reach, self._flexibility.nodes):
            return self._flexibility
        frame_motion = np.zeros((3 * len(reach), self.frame_size))
        blocks, ends = [], 3 * np.searchsorted(reach, self._first)
        for k, ring in enumerate(self.rings):
            rows = slice(int(ends[k]), int(ends[k + 1]))
            local = reach[rows.start // 3 : rows.stop // 3] - self._first[k]
            blocks.append((rows, ring.element.among(local)))
            frame_motion[rows, : ring.carried.shape[1]] = ring.carried[of_nodes(local)]
        self._flexibility = _RingFlexibility(reach, blocks, frame_motion)
        return self._flexibility


#: Facets of the rings beyond those under a ball's points: bodies move by tens of micrometres, their facets there are as large.
_FURTHER = 1


def interface_of(assembly: Assembly, contacts: np.ndarray, mass: float, on_progress: OnProgress | None = None) -> Interface:
    """Superelements of c K + d M.

    assembly : inner ring, outer ring, balls, with its groups of equal parts
    contacts : (nodes,) bool, those that contacts may touch;  mass : d / c [1/s2]
    on_progress : told of every body that is factored, optional
    """
    rings = [_ring(assembly, group, contacts, mass, on_progress) for group in assembly.groups[:2]]
    balls = [
        (_balls(assembly, group, contacts, mass, on_progress), [ball - 2 for ball in group.members])
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


def _ring(assembly: Assembly, group: Group, contacts: np.ndarray, mass: float, on_progress: OnProgress | None) -> _Ring:
    (index,), copies = group.members, group.copies
    body, rows, first = assembly.bodies[index], assembly.part(index), int(assembly.starts[index])
    free = free_nodes(assembly, index)
    cells = np.asarray(body.operator.cells, dtype=np.int64)
    mine = contacts[rows.start // 3 : rows.stop // 3]
    contact = np.unique(np.concatenate([np.flatnonzero(mine[part - first]) for part in copies.nodes]))
    cut = np.concatenate([copies.before, copies.behind])
    if np.isin(contact, cut).any():
        copies = Copies.single(body.points, cells, first)
        contact = np.flatnonzero(mine)
    local = copies.nodes[0] - first
    contact = contact[free[local[contact]]]
    if not contact.size:
        why = f"{body.name}: no node of its groove below a contact is free: its seat reaches into the groove. Mesh the ring with free nodes there"
        raise MeshError(why)
    bed = None
    if body.foundation is not None:  # the cells of a sector that stand on it, numbered in the sector
        (on_bed, matrices), key = bed_of_cells(body), {tuple(row): k for k, row in enumerate(local[copies.cells])}
        pairs = [(key[row], matrix) for row, matrix in zip(map(tuple, cells[on_bed]), matrices, strict=True) if row in key]
        bed = np.array([k for k, _ in pairs], dtype=np.int64), np.array([matrix for _, matrix in pairs])
    element = _Substructure(body.name, copies, body.operator, contact, free[local], mass, bed, on_progress).ring()
    inertia = mass * np.repeat(body.operator.lumped_mass() * free, 3)
    ride = assembly.carried[rows] if body.frame is not None else np.zeros((rows.stop - rows.start, 0))

    def apply(displacement: np.ndarray) -> np.ndarray:
        out = np.zeros_like(displacement)
        local = displacement[rows]
        force = assembly.body_forces.of_body(index, displacement) + inertia * local
        for foundation, _ in assembly.foundations:
            force += (foundation[rows][:, rows]) @ local
        out[rows] = force * np.repeat(free, 3)
        return out

    return _Ring(element, rows, ride, apply, inertia, 3 * assembly.nodes)


def _balls(assembly: Assembly, group: Group, contacts: np.ndarray, mass: float, on_progress: OnProgress | None) -> _Balls:
    copies, index = group.copies, group.members[0]
    body, rows = assembly.bodies[index], assembly.part(index)
    contact = np.unique(np.concatenate([np.flatnonzero(contacts[nodes]) for nodes in copies.nodes]))
    cage_rows, stiffness = np.zeros((0, rows.stop - rows.start)), np.zeros(0)
    if assembly.cage is not None:
        motions = slice(4 * (index - 2), 4 * (index - 2) + 4)
        cage_rows, stiffness = assembly.cage.rows[motions, rows].toarray(), assembly.cage.stiffness[motions]
    inertia = mass * np.repeat(body.operator.lumped_mass(), 3)[:, None]

    def apply(displacement: np.ndarray) -> np.ndarray:
        return assembly.body_forces.of_mesh(index, displacement) + inertia * displacement

    forces = np.ascontiguousarray(cage_rows.T)
    free = np.ones(len(copies.points), dtype=bool)
    ball = _Substructure(body.name, copies, body.operator, contact, free, mass, None, on_progress)
    loose, response = ball.ball(forces, apply)
    return _Balls(loose, cage_rows, stiffness, response, mass > 0.0)
