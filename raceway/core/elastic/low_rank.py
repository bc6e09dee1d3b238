"""Contact resultants and the cage in a preconditioner: low-rank changes of the inverse of the bodies without them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from raceway.core.elastic.cage import Cage
from raceway.core.elastic.contacts.contact import Contact


class LowRankContacts:
    """Low-rank change of an inverse by a few contact resultants and a cage.

    Parameters
    ----------
    contact : Contact;  cage : Cage | None
    inverse : of the bodies without either, on columns (m, k) of the free nodes;  free : (m,) their rows of all nodes

    Notes
    -----
    With the contacts' motions and the cage's as rows of B and their stiffness D, (A + B^T D B)^-1 = A^-1 - Y (I + D G)^-1 D B A^-1,
    where Y = A^-1 B^T and G = B Y (Woodbury).  Each of them acts on dozens of nodes or on all of a ball: in the matrix itself
    it would couple all of these, and no factor or multigrid stays sparse.  Y does not depend on D, which changes from
    iteration to iteration.
    """

    def __init__(
        self, contact: Contact, cage: Cage | None, inverse: Callable[[np.ndarray], np.ndarray], free: np.ndarray
    ) -> None:
        from scipy.sparse import vstack

        self._contact, self._held = contact, np.zeros(0) if cage is None else cage.stiffness
        rows = contact.move if cage is None else vstack([contact.move, cage.rows], format="csr")
        self._rows = rows[:, free]
        self._answers = np.asarray(inverse(np.ascontiguousarray(self._rows.toarray().T)))
        self._flexibility = self._rows @ self._answers

    def inverse(self, bodies: Callable[[np.ndarray], np.ndarray], rates: float) -> Callable[[np.ndarray], np.ndarray]:
        """With the contacts' present tangents: ``bodies`` is the inverse without them, ``rates`` the weight of the dampers'."""
        from scipy.linalg import block_diag

        # Curvature takes a little of the stiffness across, in iterations far off a lot: conjugate gradients need the positive part.
        values, vectors = np.linalg.eigh(self._contact.stiffness + rates * self._contact.rate_stiffness)
        blocks = (vectors * np.maximum(values, 0.0)[:, None, :]) @ vectors.transpose(0, 2, 1)
        stiffness = block_diag(*blocks, np.diag(self._held))
        middle = np.linalg.solve(np.eye(len(stiffness)) + stiffness @ self._flexibility, stiffness)

        def apply(residual: np.ndarray) -> np.ndarray:
            alone = bodies(residual)
            return np.asarray(alone - self._answers @ (middle @ (self._rows @ alone)))

        return apply
