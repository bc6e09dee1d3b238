"""The unknowns of all bodies in one vector: the frames' motions first, then the displacements of the free nodes."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import TYPE_CHECKING

import attrs
import numpy as np

from raceway.core.fem.elastic.body_forces import BodyForces, threads_for
from raceway.core.fem.elastic.contact import Contact
from raceway.core.fem.elastic.copies import Group
from raceway.core.fem.elastic.linear_statics import MOTIONS
from raceway.core.fem.elastic.surface import surface_points
from raceway.core.fem.elastic.unknowns import MeanMotions, Selection, gather, of_nodes, spread
from raceway.core.fem.hexahedron.operator import HexOperator
from raceway.core.fem.mesh.hex_mesh import FACES
from raceway.core.threads import ThreadPool

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


@attrs.frozen(eq=False)
class Cage:
    """Springs on mean motions: energy 1/2 k (L u)^2.

    Where nothing pushes a ball along its orbit, the cage carries nothing, whatever its stiffness.  Friction pushes: see ``raceway.core.fem.elastic.bearing``.
    """

    rows: csr_matrix  # (m, 3 nodes) sparse L: a mean displacement [m], or a mean turn [rad], of one ball
    stiffness: np.ndarray  # (m,) k [N/m, N m/rad]
    nodal: np.ndarray  # (3 nodes,) springs on single displacements that hold the balls' means about as well [N/m]
    #: fields, centres : (balls, rows, 6), (balls, 3) the rows of each ball as its masses times t + w x r
    fields: np.ndarray = attrs.field(factory=lambda: np.zeros((0, 4, 6)))
    centres: np.ndarray = attrs.field(factory=lambda: np.zeros((0, 3)))

    def force(self, u: np.ndarray) -> np.ndarray:
        """(m,) forces and moments [N, N m]."""
        return np.asarray(self.stiffness * (self.rows @ u))

    def internal(self, u: np.ndarray) -> np.ndarray:
        return np.asarray(self.rows.T @ self.force(u))


@attrs.frozen(eq=False)
class Frame:
    """A rigid frame of a few degrees of freedom, and the nodes that move with it."""

    nodes: np.ndarray  # (k,) int, of the body that the frame belongs to; tied to it, or on a bed between it and them
    centre: np.ndarray  # (3,) float, the reference point [m]
    #: columns of ``rigid`` that are unknowns, 0 to 2 translations [m], 3 to 5 rotations [rad] about x, y, z
    motions: tuple[int, ...]
    #: mass, damping, stiffness : (k, k) of the frame itself, for instance of a rotor
    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray
    free: np.ndarray  # (k,) bool, which motions are unknowns; the others keep the value that a state gives them

    def basis(self, points: np.ndarray) -> np.ndarray:
        """(3 n, k) displacements of points (n, 3) under unit motions of the frame, linear in the rotations."""
        arm = points - self.centre
        out = np.zeros((len(points), 3, len(self.motions)))
        for column, motion in enumerate(self.motions):
            axis = np.eye(3)[motion % 3]
            out[:, :, column] = axis if motion < 3 else np.cross(axis, arm)
        return out.reshape(-1, len(self.motions))


@attrs.frozen(eq=False)
class Body:
    """One body.

    name : str;  operator : HexOperator;  held : (n, 3) bool, displacements that are zero;  frame : Frame | None
    bed : (quads (k, 4) nodes, stiffness [N/m3]) | None: springs on a surface, to the ground or to the frame
    """

    name: str
    operator: HexOperator
    held: np.ndarray
    frame: Frame | None = None
    foundation: tuple[np.ndarray, float] | None = None

    @property
    def points(self) -> np.ndarray:
        return self.operator.points

    def quads(self, facets: np.ndarray) -> np.ndarray:
        """(k, 4) nodes of facets (k, 2)."""
        return np.asarray(self.operator.cells[facets[:, :1], FACES[facets[:, 1]]], dtype=np.int64)


def _bed_blocks(body: Body) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (4 k, 4) of the points of a bed's facets, and the stiffness (4 k, 4, 4) between them in each direction [N/m]."""
    assert body.foundation is not None
    quads, stiffness = body.foundation
    p = surface_points(body.points, quads)
    return p.nodes, stiffness * p.area[:, None, None] * p.weights[:, :, None] * p.weights[:, None, :]


def bed_of_cells(body: Body) -> tuple[np.ndarray, np.ndarray]:
    """Cells (b,) that a bed's facets belong to, and what it adds to their matrices (b, 24, 24)."""
    nodes, blocks = _bed_blocks(body)
    quads, blocks = nodes[::4], blocks.reshape(-1, 4, 4, 4).sum(axis=1)
    cells = np.asarray(body.operator.cells, dtype=np.int64)
    on_bed = np.zeros(len(body.points), dtype=bool)
    on_bed[quads.ravel()] = True
    near = np.flatnonzero(on_bed[cells].sum(axis=1) >= 4)
    owner: dict[int, list[int]] = {}
    for cell in near:
        for node in cells[cell][on_bed[cells[cell]]]:
            owner.setdefault(int(node), []).append(int(cell))
    owners, matrices = np.empty(len(quads), dtype=np.int64), np.zeros((len(quads), 24, 24))
    for k, (quad, block) in enumerate(zip(quads, blocks, strict=True)):
        (owners[k],) = set.intersection(*(set(owner[int(node)]) for node in quad))
        corners = np.array([int(np.flatnonzero(cells[owners[k]] == node)[0]) for node in quad])
        for axis in range(3):
            matrices[k][np.ix_(3 * corners + axis, 3 * corners + axis)] = block
    return owners, matrices


class Assembly:
    """Linear part of a system: elastic bodies, beds, frames, cage.

    bodies : list of Body

    cage : Cage | None, set by ``hold``
    groups : of equal parts (``raceway.core.fem.elastic.interface``), set before forces are asked for

    All displacements U (3 nodes,) follow from the unknowns y (size,) by U = G y: free nodes are unknowns, tied ones follow
    their frame, held ones are zero.  Forces on the unknowns are G^T F.

    Inside ``with assembly.threads:`` threads share the work of all bodies; digits do not depend on how many there are.
    """

    def __init__(self, bodies: list[Body]) -> None:
        self.bodies = bodies
        self.cage: Cage | None = None
        self.groups: list[Group] = []
        counts = np.array([len(body.points) for body in bodies])
        self.starts = np.concatenate([[0], np.cumsum(counts)])
        #: Number of nodes.
        self.nodes = int(self.starts[-1])
        self.points = np.concatenate([body.points for body in bodies])
        self.node_mass = np.concatenate([body.operator.lumped_mass() for body in bodies])
        #: (nodes,) what of it is added for a larger explicit step [kg].
        self.added_mass = np.concatenate([body.operator.added_mass() for body in bodies])
        #: (nodes,) without that: means of bodies, and what acts on their mass, are those of the material.
        self.own_mass = self.node_mass - self.added_mass
        frames = [(index, body.frame) for index, body in enumerate(bodies) if body.frame is not None]
        #: Number of the frames' unknowns.
        self.frame_size = sum(len(frame.motions) for _, frame in frames)
        fixed_dofs = np.concatenate([body.held for body in bodies]).reshape(-1)
        frame_dofs = np.zeros(3 * self.nodes, dtype=bool)
        self.frame_mass = np.zeros((self.frame_size, self.frame_size))
        self.frame_damping, self.frame_stiffness = self.frame_mass.copy(), self.frame_mass.copy()
        self.frame_free = np.ones(self.frame_size, dtype=bool)
        #: (3 nodes, frame_size) displacement of every node of a frame's body, moving with the frame.
        self.carried = np.zeros((3 * self.nodes, self.frame_size))
        begin = 0
        for index, frame in frames:
            part = slice(begin, begin + len(frame.motions))
            begin = part.stop
            self.carried[self.part(index), part] = frame.basis(bodies[index].points)
            if bodies[index].foundation is None:
                frame_dofs[of_nodes(frame.nodes + self.starts[index])] = True
            self.frame_mass[part, part], self.frame_damping[part, part] = frame.mass, frame.damping
            self.frame_stiffness[part, part], self.frame_free[part] = frame.stiffness, frame.free
        self.carried[fixed_dofs] = 0.0
        self.tied = np.flatnonzero(frame_dofs & ~fixed_dofs)
        self.free = np.flatnonzero(~fixed_dofs & ~frame_dofs)
        self.size = self.frame_size + len(self.free)
        #: (size,) which unknowns are to be solved for.
        self.unknown = np.concatenate([self.frame_free, np.ones(len(self.free), dtype=bool)])
        self.tie, self._ride = self.carried[self.tied], self.carried[self.free]
        mass = np.repeat(self.node_mass, 3)
        self.free_mass = mass[self.free]
        self.frame_mass = self.frame_mass + self.tie.T @ (mass[self.tied, None] * self.tie)
        self.foundations = self._beds()
        #: Beds at their own entries alone: matrix (k, k), the frame's motion (k, frame_size), and the entries.
        self._seats = []
        for bed, ride in self.foundations:
            entries = np.flatnonzero(np.diff(bed.indptr))
            seat = Selection.of(entries, self.free, self.tied, self.tie)
            self._seats.append((bed[entries][:, entries].tocsr(), np.ascontiguousarray(ride[entries]), seat))
        self._stiffness: csr_matrix = None
        #: Threads that share the work while they are open.
        self.threads = ThreadPool(threads_for(sum(len(body.operator.cells) for body in bodies)))
        self.means: MeanMotions | None = None
        self._near: tuple[object, Selection] | None = None
        self._u = np.zeros(3 * self.nodes)

    def hold(self, cage: Cage) -> None:
        """Hold mean motions of bodies by a cage."""
        self.cage, self.means = cage, MeanMotions(cage.rows)

    def unequal(self) -> list[Body]:
        """One of each group of equal bodies; all where no groups are known."""
        first = [group.members[0] for group in self.groups] or range(len(self.bodies))
        return [self.bodies[index] for index in first]

    @cached_property
    def body_forces(self) -> BodyForces:
        return BodyForces([body.operator for body in self.bodies], self.starts, self.groups)

    def part(self, index: int) -> slice:
        """Rows of a body's displacements in U."""
        return slice(3 * int(self.starts[index]), 3 * int(self.starts[index + 1]))

    def nodal(self, y: np.ndarray, out: np.ndarray | None = None) -> np.ndarray:
        """U = G y, (3 nodes,); ``out`` is one of before, to be overwritten."""
        out, values = np.zeros(3 * self.nodes) if out is None else out, y[self.frame_size :]
        self.threads.do_shares(len(self.free), lambda a, b: spread(a, b, self.free, values, out))
        if self.frame_size:
            out[self.tied] = self.tie @ y[: self.frame_size]
        return out

    def reduced(self, force: np.ndarray) -> np.ndarray:
        """G^T F, (size,)."""
        out = np.empty(self.size)
        out[: self.frame_size] = self.tie.T @ force[self.tied]
        values = out[self.frame_size :]
        self.threads.do_shares(len(self.free), lambda a, b: gather(a, b, self.free, force, values))
        return out

    def internal(self, y: np.ndarray, u: np.ndarray, beside: Callable[[], None] | None = None) -> np.ndarray:
        """(size,) forces of bodies, beds, cage and frames at y, U = G y, without matrices of the bodies.

        beside : work that is done at the same time
        """
        means = self.means
        mean_displacement = np.empty(0 if means is None else means.count)
        first = [beside] if beside else []
        self.body_forces.compute(u, self.threads, first + ([] if means is None else means.jobs(u, mean_displacement)))
        amounts = mean_displacement if self.cage is None else self.cage.stiffness * mean_displacement
        out = np.empty(self.size)
        values = out[self.frame_size :]

        def join(force: np.ndarray, begin: int, end: int) -> None:
            if means is not None:
                means.add(begin, end, amounts, force)
            gather(*np.searchsorted(self.free, (begin, end)), self.free, force, values)

        force = self.body_forces.sum(self.threads, join)
        out[: self.frame_size] = self.tie.T @ force[self.tied]
        frame = self.frame_stiffness @ y[: self.frame_size]
        for matrix, ride, seat in self._seats:
            pull = matrix @ (u[seat.entries] - ride @ y[: self.frame_size])
            seat.add(pull, out)
            frame -= ride.T @ pull
        out[: self.frame_size] += frame
        return out

    def forces(self, dt: float, y: np.ndarray, v: np.ndarray, contact: Contact | None) -> tuple[np.ndarray, np.ndarray]:
        """Internal forces (size,) at y and velocities v (size,) after a step dt [s], with those of the contacts; U = G y until the next call."""
        u = self.nodal(y, self._u)
        if contact is None:
            return self.internal(y, u), u
        near = contact.near
        if self._near is None or self._near[0] is not near:
            self._near = near, Selection.of(near.entries, self.free, self.tied, self.tie)
        at = self._near[1]
        rate = at.nodal(v) if dt > 0.0 else None
        pressing: list[np.ndarray] = []
        out = self.internal(y, u, lambda: pressing.append(contact.evaluate_near(dt, u[near.entries], rate)))
        at.add(pressing[0], out)
        return out, u

    def stiffness(self) -> csr_matrix:
        """(3 nodes, 3 nodes) sparse stiffness of bodies and beds, made at the first call."""
        if self._stiffness is None:
            from scipy.sparse import block_diag, csr_array

            matrix = csr_array(block_diag([body.operator.stiffness() for body in self.bodies], format="csr"))
            for foundation, _ in self.foundations:
                matrix = matrix + foundation
            self._stiffness = matrix.tocsr()
        return self._stiffness

    def added_inertia(self) -> np.ndarray:
        """(frame_size, frame_size) what the frames' bodies gain as rigid ones by added mass."""
        return np.asarray(self.carried.T @ (np.repeat(self.added_mass, 3)[:, None] * self.carried))

    def reactions(self, y: np.ndarray) -> np.ndarray:
        """(3,) force of the ground on the bodies, through held nodes and beds [N]."""
        u, out = self.nodal(y), np.zeros(3)
        for index, body in enumerate(self.bodies):
            if body.held.any():
                out += (self.body_forces.of_body(index, u).reshape(-1, 3) * body.held).sum(axis=0)
        for foundation, ride in self.foundations:
            if not ride.any():
                out -= (foundation @ u).reshape(-1, 3).sum(axis=0)
        return out

    def loose_motions(self, contacts: list[tuple[int, int]]) -> list[str]:
        """Rigid motions that nothing holds: for each body in words; ``contacts`` are pairs of bodies that touch and so hold each other.

        A body that touches another counts as held, but for the motions that no contact can hold: a ball's turning and,
        between two rings, its way along the orbit, unless the cage holds them.
        """
        sentences = []
        touching = {i for pair in contacts for i in pair}
        caged_bodies = set[int]()
        if self.cage is not None:
            caged_bodies |= set((np.searchsorted(3 * self.starts, self.cage.rows.tocoo().col, side="right") - 1).tolist())
        for index, body in enumerate(self.bodies):
            if body.held.any() or body.foundation is not None or body.frame is not None or index in caged_bodies:
                continue
            why = "it touches nothing" if index not in touching else "frictionless contact does not constrain them"
            free = ", ".join(MOTIONS if index not in touching else MOTIONS[3:])
            words = f"{body.name}: {free} ({why}); constrain it by the cage, fixed nodes, or an elastic foundation under one of its surfaces"
            sentences.append(words)
        return sentences

    def _beds(self) -> list[tuple[csr_matrix, np.ndarray]]:
        """For each bed its matrix (3 nodes, 3 nodes) and the frame's motion that it acts against (3 nodes, frame_size)."""
        from scipy.sparse import coo_array

        out = []
        for index, body in enumerate(self.bodies):
            if body.foundation is None:
                continue
            nodes, w = _bed_blocks(body)
            nodes = nodes + self.starts[index]
            i = np.broadcast_to(nodes[:, :, None], w.shape).ravel()
            j = np.broadcast_to(nodes[:, None, :], w.shape).ravel()
            rows, columns = (of_nodes(k) for k in (i, j))
            size = 3 * self.nodes
            foundation = coo_array((np.repeat(w.ravel(), 3), (rows, columns)), shape=(size, size)).tocsr()
            ride = self.carried if body.frame is not None else np.zeros_like(self.carried)
            out.append((foundation, ride))
        return out
