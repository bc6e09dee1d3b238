"""A ring seen from the nodes of its contacts and from the frame that it is fastened to."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from raceway.core.elastic.superelements.closed import Closed
from raceway.core.elastic.superelements.loose import REFINED, Loose


class Ring:
    """One ring, its displacement u = R q + w of the frame's motions q and of w, which is zero on the seat.

    Parameters
    ----------
    element : Loose | Closed
    part : rows of the ring among all nodes' (3 nodes,)
    ride : (3 n, m) R at all nodes; m = 0 without a frame
    apply : function of w (3 nodes,) -> c K w + d M w;  inertia : (3 n,) d / c times the nodes' masses
    size : 3 nodes

    Attributes
    ----------
    follow : (3 n, m) R - W, W the displacement by which the ring falls behind its frame for its inertia
    carried : (3 k, m) ``follow`` at the contacts' nodes
    """

    def __init__(
        self,
        element: Loose | Closed,
        part: slice,
        ride: np.ndarray,
        apply: Callable[[np.ndarray], np.ndarray],
        inertia: np.ndarray,
        size: int,
    ) -> None:
        self.element, self.part = element, part
        behind = np.zeros_like(ride)
        if inertia.any():
            for k in range(ride.shape[1]):
                force = np.zeros(size)
                force[part] = inertia * ride[:, k]
                behind[:, k] = self._solved(force, apply)[part]
        self.follow = ride - behind
        places = (3 * element.nodes.reshape(-1, 1) + np.arange(3)).ravel() - part.start
        self.carried = self.follow[places]
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
        loads, carried = self.element.forward(force)
        return self.element.respond(loads).ravel(), self.follow.T @ force[self.part], carried

    def backward(self, carried: Any, moved: np.ndarray, frame: np.ndarray, out: np.ndarray) -> None:
        """Displacements of all nodes, into ``out`` (3 nodes,), of those of the contacts (3 k,) and of the frame (m,)."""
        own = moved - self.carried @ frame
        self.element.backward(carried, own.reshape(len(self.element.nodes), -1), out)
        out[self.part] += self.follow @ frame

    def _solved(self, force: np.ndarray, apply: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
        found = np.zeros_like(force)
        for _ in range(REFINED):
            loads, carried = self.element.forward(force - apply(found))
            back: Any = carried
            step = np.zeros_like(force)
            self.element.backward(back, self.element.respond(loads), step)
            found += step
        return found
