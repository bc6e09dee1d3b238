"""Whole contacts in a preconditioner: three motions each, added to the inverse of the bodies without them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from raceway.core.elastic.contact import Contact


class WholeContacts:
    """What a few contacts change in an inverse.

    Parameters
    ----------
    contact : Contact
    inverse : of the bodies without contacts, on the free nodes;  free : (m,) their rows of all nodes

    Notes
    -----
    With the blocks D of all contacts, (A + B^T D B)^-1 = A^-1 - Y (I + D G)^-1 D B A^-1, where Y = A^-1 B^T and G = B Y
    (Woodbury).  Each force acts on dozens of nodes: in the matrix itself it would couple all of them, and no factor or
    multigrid stays sparse.  Y does not depend on D, which changes from iteration to iteration.
    """

    def __init__(self, contact: Contact, inverse: Callable[[np.ndarray], np.ndarray], free: np.ndarray) -> None:
        self._contact, self._move = contact, contact.move[:, free]
        self._answers = np.column_stack([inverse(row) for row in self._move.toarray()])
        self._flexibility = self._move @ self._answers

    def inverse(self, bodies: Callable[[np.ndarray], np.ndarray], rates: float) -> Callable[[np.ndarray], np.ndarray]:
        """With the contacts' present tangents: ``bodies`` is the inverse without them, ``rates`` the weight of the dampers'."""
        n = len(self._flexibility)
        blocks = self._contact.stiffness + rates * self._contact.rate_stiffness
        whole = np.zeros((n // 3, 3, n // 3, 3))
        whole[np.arange(n // 3), :, np.arange(n // 3)] = blocks
        stiffness = whole.reshape(n, n)
        middle = np.linalg.solve(np.eye(n) + stiffness @ self._flexibility, stiffness)

        def apply(residual: np.ndarray) -> np.ndarray:
            alone = bodies(residual)
            return np.asarray(alone - self._answers @ (middle @ (self._move @ alone)))

        return apply
