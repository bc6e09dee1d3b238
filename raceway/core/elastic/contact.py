"""Nodal contact: pressure at the points of one surface against another exact surface that moves with its body."""

from __future__ import annotations

from typing import Any, Protocol

import attrs
import numpy as np

from raceway.core.contact import add_damping, stored_energy
from raceway.core.elastic.facets import Facets
from raceway.core.elastic.gap import forces_and_tangents, gaps
from raceway.core.elastic.surface import SurfacePoints

#: Growth of a point's stiffness that asks for the stable step anew: half of it is what a step may be too long by.
_STIFFER = 1.02
#: Half widths of a facet by which a point may have moved along a surface before its place there is looked up anew.
_MOVED = 0.02


@attrs.frozen(eq=False)
class Pair:
    """Two surfaces that may touch.

    Attributes
    ----------
    name : str
    points : SurfacePoints of the first surface; node numbers are the assembly's
    surface : (8,) the second one, exact (``raceway.core.elastic.gap``)
    facets : Facets of the second surface;  first_node : what to add to its node numbers for those of the assembly
    """

    name: str
    points: SurfacePoints
    surface: np.ndarray
    facets: Facets
    first_node: int


class Friction(Protocol):
    """Tangential traction at the points.

    1. ``evaluate(moved, normal, pressure, d_gap)``: moved (n, 3), displacement of the points against the other surface
       [m]; traction (n, 3) on the points [Pa] and minus its derivative by ``moved`` (n, 3, 3) [Pa/m].
    2. ``commit()``, ``rollback()``: as for the system;  ``dissipated``: density (n,) [J/m2] up to the last commit;
       ``stored()``: density (n,) in what sticks.
    3. ``begin(moved)``: nothing carries or has lost anything there.  ``state()``: arrays by name that ``restore(arrays)`` takes back.
    """

    dissipated: np.ndarray

    def evaluate(
        self, moved: np.ndarray, normal: np.ndarray, pressure: np.ndarray, d_gap: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]: ...
    def stored(self) -> np.ndarray: ...
    def begin(self, moved: np.ndarray) -> None: ...
    def commit(self) -> None: ...
    def rollback(self) -> None: ...
    def state(self) -> dict[str, np.ndarray]: ...
    def restore(self, arrays: dict[str, np.ndarray]) -> None: ...


class NodalContact:
    """All pairs of an assembly.

    Parameters
    ----------
    pairs : list of Pair
    nodes : int, of the assembly
    law, params, state_size : kernel of signature ``LAW``, (n, k) its parameters, columns of its memory
    damping : (n,) or one number: normal damping, pressure per gap rate [N s/m3]
    friction : Friction | None

    Notes
    -----
    With y = X + u_1(X) - u_2(projection of y), gap = g(y) of the exact surface, normal n = grad g, the force on a point of
    the first surface is A p n, and the opposite goes to the second one's nodes with the interpolation's weights: no
    momentum is lost.  y = X + B u with a sparse B, hence f = -B^T F and the tangent B^T D B with 3 x 3 blocks D.
    """

    def __init__(
        self,
        pairs: list[Pair],
        nodes: int,
        law: Any,
        params: np.ndarray,
        state_size: int = 0,
        damping: float = 0.0,
        friction: Friction | None = None,
    ) -> None:
        self.pairs, self._nodes, self.law = pairs, nodes, law
        self.params = np.ascontiguousarray(params, dtype=float)
        self.damping, self.friction = float(damping), friction
        self.counts = np.array([len(pair.points.area) for pair in pairs])
        self.pair = np.repeat(np.arange(len(pairs)), self.counts)
        self.place = np.concatenate([pair.points.place for pair in pairs])
        self.area = np.concatenate([pair.points.area for pair in pairs])
        self.surfaces = np.ascontiguousarray([pair.surface for pair in pairs])
        n = len(self.area)
        self.memory = np.zeros((n, state_size))
        self._trial = self.memory.copy()
        self.gap, self.pressure, self.d_gap, self.d_rate = np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n)
        self.normal, self.bend = np.zeros((n, 3)), np.zeros((n, 3, 3))
        self.force, self.stiffness, self.rate_stiffness = np.zeros((n, 3)), np.zeros((n, 3, 3)), np.zeros((n, 3, 3))
        self.outside = np.zeros(n)
        self._projected = np.full((n, 3), np.inf)
        self._short = np.zeros(n)
        self._stiffest = np.zeros(n)
        self._one: Any = None
        self._move: Any = None
        self.update(self.place)

    @property
    def projected(self) -> np.ndarray:
        """(n, 3) where the points lay when their places were last looked up [m]."""
        return self._projected

    @property
    def move(self) -> Any:
        """(3 n, 3 nodes) sparse B: displacement of the points against the second surface."""
        return self._move

    def restore(self, projected: np.ndarray, memory: np.ndarray) -> None:
        """Where the points were looked up last, and the law's memory, as another contact had them."""
        self._projected[:] = np.inf
        self.update(projected)
        self.memory[:] = memory

    def update(self, where: np.ndarray) -> bool:
        """Look up where the points lie on the second surface; whether anything changed."""
        away = np.abs(where - self._projected).max(axis=1)
        if not (away > _MOVED * self._short).any():
            return False
        from scipy.sparse import csr_array, kron

        n = len(self.area)
        columns, weights = np.empty((n, 8), dtype=np.int64), np.empty((n, 8))
        begin = 0
        for pair, count in zip(self.pairs, self.counts, strict=True):
            part = slice(begin, begin + count)
            begin += count
            facet, values, self.outside[part] = pair.facets.locate(where[part])
            self._short[part] = pair.facets.short[facet]
            columns[part, :4], weights[part, :4] = pair.points.nodes, pair.points.weights
            columns[part, 4:], weights[part, 4:] = pair.facets.quads[facet] + pair.first_node, -values
        self._projected = where.copy()
        rows = np.arange(0, 8 * n + 1, 8)
        one = csr_array((weights.ravel(), columns.ravel(), rows), shape=(n, self._nodes))
        self._one, self._move = one, kron(one, np.eye(3), format="csr")
        return True

    def evaluate(self, dt: float, u: np.ndarray, v: np.ndarray | None = None, share: float = 0.0) -> np.ndarray:
        """(3 nodes,) internal forces of the contacts [N] at displacements u (3 nodes,) [m] and velocities v.

        Parameters
        ----------
        share : points less deep than this share of their pair's deepest one count as open
            Of an overlap that nothing has deformed yet, half the depth bounds the contact area.
        """
        moved = (self._move @ u).reshape(-1, 3)
        where = self.place + moved
        gaps(where, self.pair, self.surfaces, self.gap, self.normal, self.bend)
        gap = self.gap
        if share > 0.0:
            deepest = np.minimum.reduceat(gap, np.r_[0, np.cumsum(self.counts)[:-1]])
            gap = np.where(gap > share * np.minimum(deepest, 0.0)[self.pair], np.maximum(gap, 0.0), gap)
        rate = np.zeros(len(gap))
        if v is not None and dt > 0.0:
            rate = np.einsum("ia,ia->i", (self._move @ v).reshape(-1, 3), self.normal)
        self.law(gap, rate, self.params, self.memory, self._trial, dt, self.pressure, self.d_gap, self.d_rate)
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
        return np.asarray(-(self._move.T @ self.force.reshape(-1)))

    def tangent_times(self, blocks: np.ndarray, u: np.ndarray) -> np.ndarray:
        """(3 nodes,) B^T D B u with blocks D (n, 3, 3)."""
        moved = (self._move @ u).reshape(-1, 3)
        return np.asarray(self._move.T @ np.einsum("iab,ib->ia", blocks, moved).reshape(-1))

    def tangent(self, blocks: np.ndarray) -> Any:
        """(3 nodes, 3 nodes) sparse B^T D B, of the points whose block is not zero."""
        from scipy.sparse import bsr_array

        chosen = np.flatnonzero(blocks.any(axis=(1, 2)))
        rows = (3 * chosen[:, None] + np.arange(3)).ravel()
        move = self._move[rows]
        size = len(chosen)
        middle = bsr_array(
            (np.ascontiguousarray(blocks[chosen]), np.arange(size), np.arange(size + 1)), shape=(3 * size, 3 * size)
        )
        return (move.T @ (middle @ move)).tocsr()

    def resultants(self) -> np.ndarray:
        """(pairs, 3) forces on the first bodies [N]."""
        return np.stack([np.bincount(self.pair, self.force[:, a], len(self.pairs)) for a in range(3)], axis=1)

    def deepest(self) -> np.ndarray:
        """(pairs,) smallest gap [m]."""
        return np.minimum.reduceat(self.gap, np.r_[0, np.cumsum(self.counts)[:-1]])

    def energy(self) -> float:
        """What the law and sticking points store at the last gaps [J]; meant for laws without memory."""
        n = len(self.gap)
        out = np.empty(n)
        stored_energy(self.law, self.params, self.memory, self._trial.copy(), self.gap, np.zeros((6, n)), out)
        stored = 0.0 if self.friction is None else float(self.area @ self.friction.stored())
        return float(self.area @ out) + stored

    def friction_energy(self) -> float:
        """What friction has taken up to the last commit [J]."""
        return 0.0 if self.friction is None else float(self.area @ self.friction.dissipated)

    def stable_step(self, mass: np.ndarray) -> float:
        """Bound of the explicit step by the contacts alone [s]; ``mass`` (nodes,) of the nodes [kg].

        Notes
        -----
        By Gershgorin's theorem on M^-1 B^T D B: 2 / sqrt(largest row sum).
        """
        size = self._sizes()
        np.maximum(self._stiffest, size, out=self._stiffest)
        touching = np.flatnonzero(size)
        if not len(touching):
            return np.inf
        one = abs(self._one[touching])
        rows = one.T @ (size[touching] * np.asarray(one.sum(axis=1)).ravel())
        return float(2.0 / np.sqrt((rows / mass).max()))

    def stiffened(self) -> bool:
        """Whether a point has closed or become stiffer than at any ``stable_step`` before."""
        return bool((self._sizes() > _STIFFER * self._stiffest).any())

    def _sizes(self) -> np.ndarray:
        """(n,) largest row sum of each point's stiffness [N/m]."""
        return np.asarray(np.abs(self.stiffness).sum(axis=2).max(axis=1))

    def commit(self) -> None:
        self.memory, self._trial = self._trial, self.memory
        if self.friction is not None:
            self.friction.commit()

    def rollback(self) -> None:
        if self.friction is not None:
            self.friction.rollback()
