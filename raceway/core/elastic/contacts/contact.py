"""Forces and tangents of a contact from gaps, memory and friction, with bounds of steps: common to all kinds of contacts."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

import numpy as np

from raceway.core.contact.damping import add_damping, stored_energy
from raceway.core.elastic.contacts.gap import forces_and_tangents, gaps, row_sums
from raceway.core.elastic.contacts.near import Near
from raceway.core.elastic.contacts.traction import Friction

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

    from raceway.core.jit import Kernel

#: Growth of a point's stiffness that asks for the stable step anew: half of it is what a step may be too long by.
_STIFFER = 1.02


class Contact(ABC):
    """Places at which forces act between two bodies: points of a surface, or contact resultants.

    Parameters
    ----------
    place : (n, 3) undisplaced [m];  area : (n,) what pressures are multiplied with [m2], 1 for resultants
    counts : (pairs,) places of each pair of surfaces;  surfaces : (pairs, 8), see ``raceway.core.elastic.contacts.gap``
    law, params, state_size : kernel of signature ``LAW``, (n, k) its parameters, columns of its memory
    damping : normal damping, pressure per gap rate [N s/m3]; of resultants [N s/m]
    friction : Friction | None

    Attributes
    ----------
    move : (3 n, 3 nodes) sparse B: displacement of the places against the second bodies

    Notes
    -----
    With y = X + B u, gap = g(y) of the exact surface and its normal n = grad g, the force on a place of the first body is
    A p n: forces on the nodes are f = -B^T F and the tangent is B^T D B with 3 x 3 blocks D.  No momentum is lost.
    """

    #: Whether each place is a contact resultant: few of them, and each on many nodes.
    whole = False

    def __init__(
        self,
        place: np.ndarray,
        area: np.ndarray,
        counts: np.ndarray,
        surfaces: np.ndarray,
        law: Kernel,
        params: np.ndarray,
        state_size: int = 0,
        damping: float = 0.0,
        friction: Friction | None = None,
    ) -> None:
        self.place, self.area, self.counts, self.law = place, area, counts, law
        self.params = np.ascontiguousarray(params, dtype=float)
        self.damping, self.friction = float(damping), friction
        self.pair = np.repeat(np.arange(len(counts)), counts)
        self.surfaces = np.ascontiguousarray(surfaces)
        n = len(area)
        self.memory = np.zeros((n, state_size))
        self._trial = self.memory.copy()
        self.gap, self.pressure, self.d_gap, self.d_rate = np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n)
        self.normal, self.bend = np.zeros((n, 3)), np.zeros((n, 3, 3))
        self.force, self.stiffness, self.rate_stiffness = np.zeros((n, 3)), np.zeros((n, 3, 3)), np.zeros((n, 3, 3))
        self._stiffest = np.zeros(n)
        self.move: csr_matrix = None
        #: (n, 3) where the places were at the last forces [m].
        self.where = place
        self._near: tuple[csr_matrix, Near] | None = None

    # What kinds of contacts differ in

    @property
    def projected(self) -> np.ndarray:
        """(n, 3) where the places lay when B was last made [m]."""
        return self.place

    def restore(self, projected: np.ndarray, memory: np.ndarray) -> None:
        """B and the law's memory as another contact had them."""
        self.memory[:] = memory

    def update(self, where: np.ndarray, in_motion: bool = False) -> bool:
        """Make B anew for places at ``where`` (n, 3) [m] that are too far from ``projected``; whether anything changed."""
        return False

    @abstractmethod
    def nodes_of(self, pair: int) -> tuple[int, int]:
        """A node of the first and one of the second body of a pair."""

    @abstractmethod
    def overlap(self, pair: int) -> tuple[str, float, float]:
        """Name of a pair, how deep it overlaps at the last gaps [m], and how deep undeformed bodies may [m]."""

    @abstractmethod
    def stable_step(self, mass: np.ndarray) -> float:
        """Bound of the explicit step by the contacts alone [s]; ``mass`` (nodes,) of the nodes [kg]."""

    @abstractmethod
    def refuse(self) -> None:
        """Raise ``ConvergenceError`` where the last forces are none that the law may end with."""

    def press(self, gap: np.ndarray, rate: np.ndarray, dt: float) -> np.ndarray:
        """Sets ``pressure``, ``d_gap`` and ``d_rate`` at gaps (n,) and their rates; what is left of the gaps for the law (n,)."""
        self.law(gap, rate, self.params, self.memory, self._trial, dt, self.pressure, self.d_gap, self.d_rate)
        return gap

    def evaluate(self, dt: float, u: np.ndarray, v: np.ndarray | None = None, share: float = 0.0) -> np.ndarray:
        """(3 nodes,) internal forces of the contacts [N] at displacements u (3 nodes,) [m] and velocities v.

        Parameters
        ----------
        share : places less deep than this share of their pair's deepest one count as open
            Of an overlap that nothing has deformed yet, half the depth bounds the contact area.
        """
        rate = None if v is None else self.move @ v
        self._respond(dt, self.move @ u, rate, share)
        return np.asarray(-(self.move.T @ self.force.reshape(-1)))

    @property
    def near(self) -> Near:
        """The displacements that the places hang on; another object when B was made anew."""
        if self._near is None or self._near[0] is not self.move:
            self._near = self.move, Near.of(self.move)
        return self._near[1]

    def evaluate_near(self, dt: float, u: np.ndarray, v: np.ndarray | None) -> np.ndarray:
        """(k,) forces as ``evaluate`` gives them, at the entries of ``near`` alone, of displacements and velocities (k,) there."""
        move = self.near.move
        self._respond(dt, move @ u, None if v is None else move @ v, 0.0)
        return np.asarray(-(move.T @ self.force.reshape(-1)))

    def _respond(self, dt: float, u: np.ndarray, v: np.ndarray | None, share: float) -> None:
        """Forces and tangents of the places, from their displacements and velocities (3 n,) against the second bodies."""
        moved = u.reshape(-1, 3)
        where = self.where = self.place + moved
        gaps(where, self.pair, self.surfaces, self.gap, self.normal, self.bend)
        gap = self.gap
        if share > 0.0:
            deepest = np.minimum.reduceat(gap, np.r_[0, np.cumsum(self.counts)[:-1]])
            gap = np.where(gap > share * np.minimum(deepest, 0.0)[self.pair], np.maximum(gap, 0.0), gap)
        rate = np.zeros(len(gap))
        if v is not None and dt > 0.0:
            rate = np.einsum("ia,ia->i", v.reshape(-1, 3), self.normal)
        gap = self.press(gap, rate, dt)
        if dt > 0.0:
            add_damping(self.damping, gap, rate, self.pressure, self.d_gap, self.d_rate)
        forces_and_tangents(
            self.area, self.pressure, self.d_gap, self.d_rate, self.normal, self.bend,
            self.force, self.stiffness, self.rate_stiffness,
        )  # fmt: skip
        if share > 0.0:
            # Pressures of such an overlap are many times too large, and so would be their geometric stiffness: leave it out.
            across = self.normal[:, :, None] * self.normal[:, None, :]
            self.stiffness = -(self.area * self.d_gap)[:, None, None] * across
        if self.friction is not None:
            traction, tangent = self.friction.evaluate(moved, self.normal, self.pressure, self.d_gap)
            self.force += self.area[:, None] * traction
            self.stiffness += self.area[:, None, None] * tangent

    def tangent(self, blocks: np.ndarray) -> csr_matrix:
        """(3 nodes, 3 nodes) sparse B^T D B, of the points whose block is not zero."""
        from scipy.sparse import bsr_array

        chosen = np.flatnonzero(blocks.any(axis=(1, 2)))
        rows = (3 * chosen[:, None] + np.arange(3)).ravel()
        move = self.move[rows]
        size = len(chosen)
        middle = bsr_array(
            (np.ascontiguousarray(blocks[chosen]), np.arange(size), np.arange(size + 1)), shape=(3 * size, 3 * size)
        )
        return (move.T @ (middle @ move)).tocsr()

    def resultants(self) -> np.ndarray:
        """(pairs, 3) forces on the first bodies [N]."""
        return np.stack([np.bincount(self.pair, self.force[:, a], len(self.counts)) for a in range(3)], axis=1)

    def deepest(self) -> np.ndarray:
        """(pairs,) smallest gap [m]."""
        return np.minimum.reduceat(self.gap, np.r_[0, np.cumsum(self.counts)[:-1]])

    def energy(self) -> float:
        """Energy stored by the law and by sticking points at the last gaps [J]; meant for laws without memory."""
        n = len(self.gap)
        out = np.empty(n)
        stored_energy(self.law, self.params, self.memory, self._trial.copy(), self.gap, np.zeros((6, n)), out)
        stored = 0.0 if self.friction is None else float(self.area @ self.friction.stored())
        return float(self.area @ out) + stored

    def friction_energy(self) -> float:
        """Work of friction up to the last commit [J]."""
        return 0.0 if self.friction is None else float(self.area @ self.friction.dissipated)

    def stiffened(self) -> bool:
        """Whether a point has closed or become stiffer than at any ``stable_step`` before."""
        return bool((self._sizes() > _STIFFER * self._stiffest).any())

    def _sizes(self) -> np.ndarray:
        """(n,) largest row sum of each point's stiffness [N/m]."""
        out = np.empty(len(self.area))
        row_sums(self.stiffness, out)
        return out

    def commit(self) -> None:
        self.refuse()
        self.memory, self._trial = self._trial, self.memory
        if self.friction is not None:
            self.friction.commit()

    def rollback(self) -> None:
        if self.friction is not None:
            self.friction.rollback()
