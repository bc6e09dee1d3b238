"""The unknowns of all bodies in one vector: the frames' motions first, then the displacements of the free nodes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from raceway.core.elastic.bed import bed_blocks
from raceway.core.elastic.body import Body
from raceway.core.elastic.cage import Cage
from raceway.core.linear.rigid_motions import MOTIONS, rigid_motions

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


class Assembly:
    """Linear part of a system: elastic bodies, beds, frames, cage.

    Parameters
    ----------
    bodies : list of Body
    cage : Cage | None

    Notes
    -----
    All displacements U (3 nodes,) follow from the unknowns y (size,) by U = G y: free nodes are unknowns, tied ones follow
    their frame, held ones are zero.  Forces on the unknowns are G^T F.
    """

    def __init__(self, bodies: list[Body], cage: Cage | None = None) -> None:
        self.bodies, self.cage = bodies, cage
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
        self._stiffness: csr_matrix = None

    def carried_tied(self) -> np.ndarray:
        """(3 nodes, frame_size) displacement of the tied nodes, the others zero."""
        out = np.zeros_like(self.carried)
        out[self.tied] = self._tie
        return out

    def part(self, index: int) -> slice:
        """Rows of a body's displacements in U."""
        return slice(3 * int(self.starts[index]), 3 * int(self.starts[index + 1]))

    def nodal(self, y: np.ndarray) -> np.ndarray:
        """U = G y, (3 nodes,)."""
        out = np.zeros(3 * self.nodes)
        out[self.free] = y[self.frame_size :]
        if self.frame_size:
            out[self.tied] = self._tie @ y[: self.frame_size]
        return out

    def reduced(self, force: np.ndarray) -> np.ndarray:
        """G^T F, (size,)."""
        return np.concatenate([self._tie.T @ force[self.tied], force[self.free]])

    def internal(self, y: np.ndarray, u: np.ndarray, v_frame: np.ndarray | None = None) -> np.ndarray:
        """(size,) forces of bodies, beds, cage and frames at y, U = G y, without matrices of the bodies."""
        force = np.empty(3 * self.nodes)
        for index, body in enumerate(self.bodies):
            rows = self.part(index)
            body.operator.internal_force(u[rows], out=force[rows].reshape(-1, 3))
        if self.cage is not None:
            force += self.cage.internal(u)
        frame = self.frame_stiffness @ y[: self.frame_size]
        for foundation, ride in self.foundations:
            pull = foundation @ (u - ride @ y[: self.frame_size])
            force += pull
            frame -= ride.T @ pull
        out = self.reduced(force)
        out[: self.frame_size] += frame
        return out

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
                out += (body.operator.internal_force(u[self.part(index)]) * body.held).sum(axis=0)
        for foundation, ride in self.foundations:
            if not ride.any():
                out -= (foundation @ u).reshape(-1, 3).sum(axis=0)
        return out

    def hourglass_energy(self, u: np.ndarray) -> float:
        """The part that hourglass control holds [J]."""
        return sum(b.operator.hourglass_energy(u[self.part(i)]) for i, b in enumerate(self.bodies))

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

    def rigid_share(self, r: np.ndarray, index: int) -> np.ndarray:
        """(6,) resultant of nodal forces (3 nodes,) on a body about the origin of its points' mean."""
        rows = self.part(index)
        return np.asarray(rigid_motions(self.bodies[index].points).T @ r[rows])

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
