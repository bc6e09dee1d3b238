"""The unknowns of all bodies in one vector: the frames' motions first, then the displacements of the free nodes."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from raceway.core.elastic.bed import bed_blocks
from raceway.core.elastic.body import Body
from raceway.core.elastic.body_forces import BodyForces, fitting_threads
from raceway.core.elastic.cage import Cage
from raceway.core.elastic.copies import Group
from raceway.core.elastic.mean_motions import MeanMotions
from raceway.core.elastic.unknowns import Selection, gather, spread
from raceway.core.linear.rigid_motions import MOTIONS
from raceway.core.threads import ThreadPool

if TYPE_CHECKING:
    from collections.abc import Callable

    from scipy.sparse import csr_matrix

    from raceway.core.elastic.contacts.contact import Contact


class Assembly:
    """Linear part of a system: elastic bodies, beds, frames, cage.

    Parameters
    ----------
    bodies : list of Body

    Attributes
    ----------
    cage : Cage | None, set by ``hold``
    groups : of equal parts, set by ``share`` before forces are asked for

    Notes
    -----
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
        frames = [(index, body.frame) for index, body in enumerate(bodies) if body.frame is not None]
        #: Number of the frames' unknowns.
        self.frame_size = sum(len(frame.motions) for _, frame in frames)
        held = np.concatenate([body.held for body in bodies]).reshape(-1)
        tied = np.zeros(3 * self.nodes, dtype=bool)
        self.frame_mass = np.zeros((self.frame_size, self.frame_size))
        self.frame_damping, self.frame_stiffness = self.frame_mass.copy(), self.frame_mass.copy()
        self.frame_free = np.ones(self.frame_size, dtype=bool)
        #: (3 nodes, frame_size) displacement of every node of a frame's body, moving with the frame.
        self.carried = np.zeros((3 * self.nodes, self.frame_size))
        begin = 0
        for index, frame in frames:
            part = slice(begin, begin + len(frame.motions))
            begin = part.stop
            rows = slice(3 * int(self.starts[index]), 3 * int(self.starts[index + 1]))
            self.carried[rows, part] = frame.basis(bodies[index].points)
            if bodies[index].foundation is None:
                tied[(3 * (frame.nodes + self.starts[index])[:, None] + np.arange(3)).ravel()] = True
            self.frame_mass[part, part], self.frame_damping[part, part] = frame.mass, frame.damping
            self.frame_stiffness[part, part], self.frame_free[part] = frame.stiffness, frame.free
        self.carried[held] = 0.0
        self.tied = np.flatnonzero(tied & ~held)
        self.free = np.flatnonzero(~held & ~tied)
        self.size = self.frame_size + len(self.free)
        #: (size,) which unknowns are to be solved for.
        self.unknown = np.concatenate([self.frame_free, np.ones(len(self.free), dtype=bool)])
        self._tie, self._ride = self.carried[self.tied], self.carried[self.free]
        mass = np.repeat(self.node_mass, 3)
        self.free_mass = mass[self.free]
        self.frame_mass = self.frame_mass + self._tie.T @ (mass[self.tied, None] * self._tie)
        self.foundations = self._beds()
        self._seats = [self._seat(*bed) for bed in self.foundations]
        self._stiffness: csr_matrix = None
        #: Threads that share the work while they are open.
        self.threads = ThreadPool(fitting_threads(sum(len(body.operator.cells) for body in bodies)))
        self._means: MeanMotions | None = None
        self._near: tuple[object, Selection] | None = None
        self._u = np.zeros(3 * self.nodes)

    def hold(self, cage: Cage) -> None:
        """Hold mean motions of bodies by a cage."""
        self.cage, self._means = cage, MeanMotions(cage.rows)

    def share(self, groups: list[Group]) -> None:
        """Compute the forces of equal parts by one matrix (``raceway.core.elastic.equal_parts``)."""
        self.groups = groups

    def unequal(self) -> list[Body]:
        """One of each group of equal bodies; all where no groups are known."""
        first = [group.members[0] for group in self.groups] or range(len(self.bodies))
        return [self.bodies[index] for index in first]

    @cached_property
    def _forces(self) -> BodyForces:
        return BodyForces([body.operator for body in self.bodies], self.starts, self.groups)

    def carried_tied(self) -> np.ndarray:
        """(3 nodes, frame_size) displacement of the tied nodes, the others zero."""
        out = np.zeros_like(self.carried)
        out[self.tied] = self._tie
        return out

    def part(self, index: int) -> slice:
        """Rows of a body's displacements in U."""
        return slice(3 * int(self.starts[index]), 3 * int(self.starts[index + 1]))

    def nodal(self, y: np.ndarray, out: np.ndarray | None = None) -> np.ndarray:
        """U = G y, (3 nodes,); ``out`` is one of before, to be overwritten."""
        out, values = np.zeros(3 * self.nodes) if out is None else out, y[self.frame_size :]
        self.threads.do_shares(len(self.free), lambda a, b: spread(a, b, self.free, values, out))
        if self.frame_size:
            out[self.tied] = self._tie @ y[: self.frame_size]
        return out

    def reduced(self, force: np.ndarray) -> np.ndarray:
        """G^T F, (size,)."""
        out = np.empty(self.size)
        out[: self.frame_size] = self._tie.T @ force[self.tied]
        values = out[self.frame_size :]
        self.threads.do_shares(len(self.free), lambda a, b: gather(a, b, self.free, force, values))
        return out

    def internal(self, y: np.ndarray, u: np.ndarray, beside: Callable[[], None] | None = None) -> np.ndarray:
        """(size,) forces of bodies, beds, cage and frames at y, U = G y, without matrices of the bodies.

        Parameters
        ----------
        beside : work that is done at the same time
        """
        means = self._means
        moved = np.empty(0 if means is None else means.count)
        first = [beside] if beside else []
        self._forces.compute(u, self.threads, first + ([] if means is None else means.jobs(u, moved)))
        amounts = moved if self.cage is None else self.cage.stiffness * moved
        out = np.empty(self.size)
        values = out[self.frame_size :]

        def join(force: np.ndarray, begin: int, end: int) -> None:
            if means is not None:
                means.add(begin, end, amounts, force)
            gather(*np.searchsorted(self.free, (begin, end)), self.free, force, values)

        force = self._forces.sum(self.threads, join)
        out[: self.frame_size] = self._tie.T @ force[self.tied]
        frame = self.frame_stiffness @ y[: self.frame_size]
        for matrix, ride, seat in self._seats:
            pull = matrix @ (u[seat.entries] - ride @ y[: self.frame_size])
            seat.add(pull, out)
            frame -= ride.T @ pull
        out[: self.frame_size] += frame
        return out

    def body_force(self, index: int, u: np.ndarray) -> np.ndarray:
        """(3 n,) forces K u of one body at u (3 nodes,)."""
        return self._forces.of_body(index, u)

    def mesh_force(self, index: int, moved: np.ndarray) -> np.ndarray:
        """(3 n, m) forces K u of one body at m displacements (3 n, m) of its own."""
        return self._forces.of_mesh(index, moved)

    def forces(self, dt: float, y: np.ndarray, v: np.ndarray, contact: Contact | None) -> tuple[np.ndarray, np.ndarray]:
        """Internal forces (size,) at y and velocities v (size,) after a step dt [s], with those of the contacts; U = G y until the next call."""
        u = self.nodal(y, self._u)
        if contact is None:
            return self.internal(y, u), u
        near, at = contact.near, self._at(contact)
        rate = at.nodal(v) if dt > 0.0 else None
        pressing: list[np.ndarray] = []
        out = self.internal(y, u, lambda: pressing.append(contact.evaluate_near(dt, u[near.entries], rate)))
        at.add(pressing[0], out)
        return out, u

    def _at(self, contact: Contact) -> Selection:
        """The entries that a contact's places hang on; looked up anew when they have changed."""
        near = contact.near
        if self._near is None or self._near[0] is not near:
            self._near = near, Selection.of(near.entries, self.free, self.tied, self._tie)
        return self._near[1]

    def stiffness(self) -> csr_matrix:
        """(3 nodes, 3 nodes) sparse stiffness of bodies and beds, made at the first call."""
        if self._stiffness is None:
            from scipy.sparse import block_diag, csr_array

            whole = csr_array(block_diag([body.operator.stiffness() for body in self.bodies], format="csr"))
            for foundation, _ in self.foundations:
                whole = whole + foundation
            self._stiffness = whole.tocsr()
        return self._stiffness

    def elastic_energy(self, y: np.ndarray, u: np.ndarray) -> float:
        """Strain energy of the bodies and their beds and what the frames' springs and the cage hold [J]."""
        return float(0.5 * y @ self.internal(y, u))

    def reactions(self, y: np.ndarray) -> np.ndarray:
        """(3,) force of the ground on the bodies, through held nodes and beds [N]."""
        u, out = self.nodal(y), np.zeros(3)
        for index, body in enumerate(self.bodies):
            if body.held.any():
                out += (self.body_force(index, u).reshape(-1, 3) * body.held).sum(axis=0)
        for foundation, ride in self.foundations:
            if not ride.any():
                out -= (foundation @ u).reshape(-1, 3).sum(axis=0)
        return out

    def hourglass_energy(self, u: np.ndarray) -> float:
        """The part that hourglass control holds [J]."""
        return self._forces.hourglass_energy(u, self.threads)

    def loose_motions(self, contacts: list[tuple[int, int]]) -> list[str]:
        """Rigid motions that nothing holds: for each body in words; ``contacts`` are pairs of bodies that touch and so hold each other.

        Notes
        -----
        A body that touches another counts as held, but for the motions that no contact can hold: a ball's turning and,
        between two rings, its way along the orbit, unless the cage holds them.
        """
        found = []
        touching = {i for pair in contacts for i in pair}
        caged = set() if self.cage is None else {int(i) for i in np.unique(self._owners(self.cage.rows))}
        for index, body in enumerate(self.bodies):
            if body.held.any() or body.foundation is not None or body.frame is not None or index in caged:
                continue
            why = "it touches nothing" if index not in touching else "contact without friction does not hold them"
            free = ", ".join(MOTIONS if index not in touching else MOTIONS[3:])
            found.append(
                f"{body.name}: {free} ({why}); hold it by the cage, by fixed nodes, or by a bed under one of its surfaces"
            )
        return found

    def _owners(self, rows: csr_matrix) -> np.ndarray:
        return np.asarray(np.searchsorted(3 * self.starts, rows.tocoo().col, side="right") - 1)

    def _seat(self, foundation: csr_matrix, ride: np.ndarray) -> tuple[csr_matrix, np.ndarray, Selection]:
        """A bed at its own entries alone: matrix (k, k), the frame's motion (k, frame_size), and the entries."""
        entries = np.flatnonzero(np.diff(foundation.indptr))
        seat = Selection.of(entries, self.free, self.tied, self._tie)
        return foundation[entries][:, entries].tocsr(), np.ascontiguousarray(ride[entries]), seat

    def _beds(self) -> list[tuple[csr_matrix, np.ndarray]]:
        """For each bed its matrix (3 nodes, 3 nodes) and the frame's motion that it acts against (3 nodes, frame_size)."""
        from scipy.sparse import coo_array

        out = []
        for index, body in enumerate(self.bodies):
            if body.foundation is None:
                continue
            nodes, w = bed_blocks(body)
            nodes = nodes + self.starts[index]
            i = np.broadcast_to(nodes[:, :, None], w.shape).ravel()
            j = np.broadcast_to(nodes[:, None, :], w.shape).ravel()
            rows, columns = ((3 * k[:, None] + np.arange(3)).ravel() for k in (i, j))
            size = 3 * self.nodes
            foundation = coo_array((np.repeat(w.ravel(), 3), (rows, columns)), shape=(size, size)).tocsr()
            ride = self.carried if body.frame is not None else np.zeros_like(self.carried)
            out.append((foundation, ride))
        return out
