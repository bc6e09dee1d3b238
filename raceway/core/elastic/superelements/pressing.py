"""The contacts' forces on their nodes, at motions of these nodes alone."""

from __future__ import annotations

import numpy as np

from raceway.core.elastic.contacts.near import Near
from raceway.core.elastic.contacts.nodal import NodalContact
from raceway.core.elastic.superelements.interface import Interface


class Beyond(Exception):
    """A contact presses on nodes (k,) that its bodies were not reduced to."""

    def __init__(self, nodes: np.ndarray) -> None:
        super().__init__()
        self.nodes = nodes


class Pressing:
    """Contacts during one step.

    Parameters
    ----------
    contact : NodalContact;  face : Interface
    u, v : (3 nodes,) displacements and velocities at which the last contact forces were evaluated; v None at rest
    rate : by which velocities change with displacements [1/s];  dt : step [s]
    """

    def __init__(
        self, contact: NodalContact, face: Interface, u: np.ndarray, v: np.ndarray | None, rate: float, dt: float
    ) -> None:
        self._contact, self._face, self._u, self._v, self._rate, self._dt = contact, face, u, v, rate, dt
        self._of: Near | None = None
        self._near_v: np.ndarray | None = None

    def forces(self) -> np.ndarray:
        """(n, 3) internal forces of the contacts on the contacts' nodes, as last evaluated."""
        self._follow()
        return self._on_nodes(-(self._near.move.T @ self._contact.force.reshape(-1)))

    def forces_at(self, moved: np.ndarray) -> np.ndarray:
        """The same at motions (n, 3) on top of u."""
        self._follow()
        rate = None if self._near_v is None else self._with(self._near_v, self._rate * moved)
        return self._on_nodes(self._contact.evaluate_near(self._dt, self._with(self._near_u, moved), rate))

    def locate(self, moved: np.ndarray) -> bool:
        """Look up where the points lie on the second surfaces at motions (n, 3); whether anything changed."""
        self._follow()
        where = self._near.move @ self._with(self._near_u, moved)
        return self._contact.update(self._contact.place + where.reshape(-1, 3))

    def _follow(self) -> None:
        """The entries that the points hang on, which are others when these were looked up."""
        near = self._near = self._contact.near
        if near is self._of:
            return
        self._of = near
        rows = self._face.place[near.entries // 3]
        self._inside = np.flatnonzero(rows >= 0)
        self._outside = np.flatnonzero(rows < 0)
        self._at = 3 * rows[self._inside] + near.entries[self._inside] % 3
        self._near_u = self._u[near.entries]
        self._near_v = None if self._v is None else self._v[near.entries]

    def _with(self, values: np.ndarray, moved: np.ndarray) -> np.ndarray:
        out = values.copy()
        out[self._inside] += moved.ravel()[self._at]
        return out

    def _on_nodes(self, forces: np.ndarray) -> np.ndarray:
        beyond = self._outside[forces[self._outside] != 0.0]
        if beyond.size:
            raise Beyond(np.unique(self._near.entries[beyond] // 3))
        out = np.zeros(3 * len(self._face.numbers))
        out[self._at] = forces[self._inside]
        return out.reshape(-1, 3)
