"""Nodal contact: pressure at the points of one surface against another exact surface that moves with its body."""

from __future__ import annotations

from typing import TYPE_CHECKING

import attrs
import numpy as np

from raceway.core.elastic.contacts.contact import Contact
from raceway.core.elastic.contacts.facets import Facets
from raceway.core.elastic.contacts.gap import has_moved
from raceway.core.elastic.contacts.surface import SurfacePoints
from raceway.core.elastic.contacts.traction import Friction

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

    from raceway.core.jit import Kernel

#: Half widths of a facet by which a point may have moved along a surface before its place there is looked up anew: at rest, and in
#: motion, where every new place takes or gives a little energy, while a vibration moves points by less.
_AT_REST, _IN_MOTION = 0.02, 0.5


@attrs.frozen(eq=False)
class Pair:
    """Two surfaces that may touch.

    Attributes
    ----------
    name : str
    points : SurfacePoints of the first surface; node numbers are the assembly's
    surface : (8,) the second one, exact (``raceway.core.elastic.contacts.gap``)
    facets : Facets of the second surface;  first_node : what to add to its node numbers for those of the assembly
    """

    name: str
    points: SurfacePoints
    surface: np.ndarray
    facets: Facets
    first_node: int


class NodalContact(Contact):
    """Points of all pairs of an assembly.

    Parameters
    ----------
    pairs : list of Pair
    nodes : int, of the assembly
    law, params, state_size, damping, friction : see ``Contact``

    Notes
    -----
    A point moves by y = X + u_1(X) - u_2(projection of y); the force on it goes to the nodes of its facet, and the opposite
    to those of the second one's, with the interpolation's weights.
    """

    def __init__(
        self,
        pairs: list[Pair],
        nodes: int,
        law: Kernel,
        params: np.ndarray,
        state_size: int = 0,
        damping: float = 0.0,
        friction: Friction | None = None,
    ) -> None:
        self.pairs, self._nodes = pairs, nodes
        counts = np.array([len(pair.points.area) for pair in pairs])
        place = np.concatenate([pair.points.place for pair in pairs])
        area = np.concatenate([pair.points.area for pair in pairs])
        surfaces = np.array([pair.surface for pair in pairs])
        super().__init__(place, area, counts, surfaces, law, params, state_size, damping, friction)
        self.outside = np.zeros(len(area))
        self._projected = np.full((len(area), 3), np.inf)
        #: (n, 8) nodes of the assembly that a point's motion is interpolated from, and their weights.
        self.nodes, self.weights = np.zeros((len(area), 8), dtype=np.int64), np.zeros((len(area), 8))
        #: (n,) half widths of the facets that points were projected on [m].
        self._facet = np.zeros(len(area))
        self._weights: csr_matrix = None
        self.update(self.place)

    @property
    def projected(self) -> np.ndarray:
        return self._projected

    def restore(self, projected: np.ndarray, memory: np.ndarray) -> None:
        self._projected[:] = np.inf
        self.update(projected)
        super().restore(projected, memory)

    def nodes_of(self, pair: int) -> tuple[int, int]:
        one = self.pairs[pair]
        return int(one.points.nodes[0, 0]), one.first_node

    def overlap(self, pair: int) -> tuple[str, float, float]:
        gap, one = self.gap[self.pair == pair], self.pairs[pair]
        # A facet has four points.
        return one.name, -float(gap.min()), float(np.sqrt(4.0 * one.points.area[gap.argmin()]))

    def refuse(self) -> None:
        """Points find a pressure at any gap."""

    def update(self, where: np.ndarray, in_motion: bool = False) -> bool:
        """Look up where the points lie on the second surface; whether anything changed."""
        where = np.ascontiguousarray(where, dtype=float)
        if not has_moved(where, self._projected, (_IN_MOTION if in_motion else _AT_REST) * self._facet):
            return False
        from scipy.sparse import csr_array, kron

        n = len(self.area)
        columns, weights = self.nodes, self.weights
        begin = 0
        for pair, count in zip(self.pairs, self.counts, strict=True):
            part = slice(begin, begin + count)
            begin += count
            facet, values, self.outside[part] = pair.facets.locate(where[part])
            self._facet[part] = pair.facets.short[facet]
            columns[part, :4], weights[part, :4] = pair.points.nodes, pair.points.weights
            columns[part, 4:], weights[part, 4:] = pair.facets.quads[facet] + pair.first_node, -values
        self._projected = where.copy()
        rows = np.arange(0, 8 * n + 1, 8)
        one = csr_array((weights.ravel().copy(), columns.ravel().copy(), rows), shape=(n, self._nodes))
        self._weights, self.move = abs(one), kron(one, np.eye(3), format="csr")
        return True

    def stable_step(self, mass: np.ndarray) -> float:
        """See ``Contact``.

        Notes
        -----
        By Gershgorin's theorem on M^-1 B^T D B: 2 / sqrt(largest row sum).
        """
        size = self._sizes()
        np.maximum(self._stiffest, size, out=self._stiffest)
        touching = np.flatnonzero(size)
        if not len(touching):
            return np.inf
        one = self._weights[touching]
        rows = one.T @ (size[touching] * np.asarray(one.sum(axis=1)).ravel())
        return float(2.0 / np.sqrt((rows / mass).max()))
