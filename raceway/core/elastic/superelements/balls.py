"""Equal balls seen from the nodes of their contacts, with their cage: what forces there and of the cage do to them."""

from __future__ import annotations

import numpy as np

from raceway.core.elastic.superelements.loose import Loose


class Balls:
    """Copies of one ball.

    Parameters
    ----------
    loose : Loose
    rows : (c, 3 n) mean motions of the first copy that the cage holds;  stiffness : (c,) [N/m, N m/rad]
    response : (3 n, c) displacements of the first copy under forces on them
    inert : whether a mass holds a ball that touches nothing

    Attributes
    ----------
    flexibility : (3 k + e, 3 k + e) of the first copy: contacts' nodes, then mean motions of the contacts' nodes and of the cage
    springs : (e,) stiffness of what acts on these motions: minus the springs of ``loose``, and the cage's
    alone : (e,) of a ball that touches nothing: without a mass the springs of ``loose`` stay, or nothing would hold it
    """

    def __init__(
        self,
        loose: Loose,
        rows: np.ndarray,
        stiffness: np.ndarray,
        response: np.ndarray,
        inert: bool,
    ) -> None:
        self.loose, self.response = loose, response
        places = loose.unknowns
        size, held, caged = len(places), loose.motions.shape[1], len(rows)
        outputs = np.zeros((size, held + caged))
        outputs[:, :held] = loose.flexibility @ loose.motions
        outputs[:, held:] = self.response[places]
        corner = np.zeros((held + caged, held + caged))
        corner[:held] = loose.motions.T @ outputs
        corner[held:, :held] = corner[:held, held:].T
        corner[held:, held:] = rows @ self.response
        self.flexibility = np.block([[loose.flexibility, outputs], [outputs.T, corner]])
        self.springs = np.concatenate([np.full(held, -loose.hold), stiffness])
        self.alone = self.springs if inert else np.maximum(self.springs, 0.0)
        self.size = size

    @property
    def count(self) -> int:
        return len(self.loose.nodes)

    def forward(self, force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Motions (copies, 3 k + e) under nodal forces (3 nodes,) alone, and what ``backward`` needs."""
        loads, carried = self.loose.forward(force)
        out = np.empty((self.count, len(self.flexibility)))
        local = self.loose.to_first(loads)
        moved = local @ self.flexibility[: self.size, : self.size]
        out[:, : self.size] = self.loose.to_copies(moved)
        held = self.loose.motions.shape[1]
        out[:, self.size : self.size + held] = moved @ self.loose.motions
        out[:, self.size + held :] = self.loose.part.gathered(force, float).T @ self.response
        return out, carried

    def backward(self, carried: np.ndarray, moved: np.ndarray, forces: np.ndarray, out: np.ndarray) -> None:
        """Displacements of all nodes, into ``out`` (3 nodes,).

        Parameters
        ----------
        moved : (copies, 3 k) of the contacts' nodes;  forces : (copies, e) on the other motions
        """
        held = self.loose.motions.shape[1]
        cage = forces[:, held:] @ self.response.T  # (copies, 3 n)
        places = self.loose.unknowns
        local = self.loose.to_first(moved) + cage[:, places]
        self.loose.part.spread(self.loose.inner(carried, local) - cage.T, out)
