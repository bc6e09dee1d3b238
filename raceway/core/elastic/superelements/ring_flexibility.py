"""What forces at some of the contacts' nodes of the rings do there: one ring does not feel those on another."""

from __future__ import annotations

import attrs
import numpy as np


@attrs.frozen(eq=False)
class RingFlexibility:
    """A matrix with one dense block for each ring.

    Attributes
    ----------
    nodes : (k,) sorted numbers of nodes
    blocks : rows of each ring among the unknowns (3 k,), and its flexibility [m/N]
    carried : (3 k, m) motion with the frame
    """

    nodes: np.ndarray
    blocks: list[tuple[slice, np.ndarray]]
    carried: np.ndarray

    def times(self, forces: np.ndarray) -> np.ndarray:
        """(3 k,) displacements under forces (3 k,)."""
        out = np.empty_like(forces)
        for rows, block in self.blocks:
            out[rows] = block @ forces[rows]
        return out

    def under(self, places: np.ndarray, forces: np.ndarray) -> np.ndarray:
        """(3 k, n) displacements under forces (p, n) at sorted places (p,)."""
        out = np.empty((3 * len(self.nodes), forces.shape[1]))
        for (rows, block), own in zip(self.blocks, self._split(places), strict=True):
            out[rows] = block[:, places[own] - rows.start] @ forces[own]
        return out

    def among(self, places: np.ndarray, forces: np.ndarray) -> np.ndarray:
        """(p, n) of these displacements those at ``places`` themselves."""
        out = np.empty_like(forces)
        for (rows, block), own in zip(self.blocks, self._split(places), strict=True):
            here = places[own] - rows.start
            out[own] = block[np.ix_(here, here)] @ forces[own]
        return out

    def _split(self, places: np.ndarray) -> list[slice]:
        ends = [np.searchsorted(places, (rows.start, rows.stop)) for rows, _ in self.blocks]
        return [slice(int(first), int(last)) for first, last in ends]
