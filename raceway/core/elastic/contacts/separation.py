"""Local compliance of a mesh under a contact: the part that Hertz's formula contains, and that the calibrated law replaces.

Notes
-----
Under the force of a footprint the surface of the mesh deflects by s, which depends on the cells there.  Below it, the mesh's
displacement u(z) and that of a half-space h(z) differ by a nearly constant amount, the structural compliance c of the body
(``raceway.core.condensed.structural``).  Of s, the part s - c is local: to be replaced by Hertz's.

The depths lie further down than those of condensed bodies: there the field of the coarsest useful mesh, two cells through a
ring's wall, is right.  A ball needs no depths: its c is that of the exact sphere (``raceway.core.contact.sphere``).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import attrs
import numpy as np

from raceway.core.contact.half_space import normal_displacement
from raceway.core.elastic.contacts.footprint import Footprint, ellipse
from raceway.core.elastic.contacts.interior import locate
from raceway.core.linear.statics import StaticSolver

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

#: Depths between which the fields are compared, over the body's reach, and how many.
DEPTHS, COUNT = (0.5, 0.9), 7
#: Frequency of the springs that hold a floating body, over the speed of sound by its size: far below its own.
_SLOW = 0.05


@attrs.frozen(eq=False)
class Separation:
    """Compliances of a mesh under one contact.

    Attributes
    ----------
    local : s - c [m/N];  structural : c, of a body held as it is [m/N]
    spread : largest less smallest difference of the fields over the depths [m/N]: what the mesh leaves open
    """

    local: float
    structural: float
    spread: float


class LoadedBody:
    """One body, to be pressed in many places.

    Parameters
    ----------
    points, cells : of its mesh
    stiffness : (3 n, 3 n) CSR, with beds [N/m];  held : (n, 3) bool
    mass : (n,) of its nodes [kg], where nothing holds it: a force accelerates it, and displacements are those from the mean of
        its masses; None: ``held`` holds it
    material : young [Pa], poisson, density [kg/m3]
    """

    def __init__(
        self,
        points: np.ndarray,
        cells: np.ndarray,
        stiffness: csr_matrix,
        held: np.ndarray,
        mass: np.ndarray | None,
        material: tuple[float, float, float],
    ) -> None:
        self._points, self._cells, self._material = points, cells, material
        self._share = None if mass is None else mass / mass.sum()
        if mass is not None:
            from scipy.sparse import diags_array

            size = np.ptp(points, axis=0).max()
            slow = (_SLOW / size) ** 2 * material[0] / material[2]
            stiffness = stiffness + diags_array(slow * np.repeat(mass, 3))
        self._solver = StaticSolver(stiffness.tocsr(), points, held)

    def along(self, contact: Footprint, normal: np.ndarray) -> np.ndarray:
        """(n,) displacements of the nodes along a unit force on a footprint, into the body along ``normal`` (3,) [m/N]."""
        load = np.zeros_like(self._points)
        load[contact.nodes] = contact.weights[:, None] * normal
        if self._share is not None:
            load -= self._share[:, None] * normal
        return np.asarray(self._solver.solve(load).displacement @ normal)

    def replaced(self, contact: Footprint, normal: np.ndarray, structural: float) -> float:
        """Local compliance of a body whose structural compliance [m/N] is known."""
        return float(contact.weights @ self.along(contact, normal)[contact.nodes]) - structural

    def separated(
        self, contact: Footprint, pole: np.ndarray, normal: np.ndarray, semi_axes: tuple[float, float], reach: float
    ) -> Separation:
        """Compliances under a contact of ``footprint`` with the same pole, normal and semi-axes.

        Parameters
        ----------
        reach : thickness below the contact [m], as ``raceway.core.condensed.structural.reach``
        """
        along = self.along(contact, normal)
        depth = reach * np.linspace(*DEPTHS, COUNT)
        nodes, weights = locate(self._points, self._cells, pole + depth[:, None] * normal)
        places, force = ellipse(semi_axes)
        half = normal_displacement(depth, np.linalg.norm(places, axis=1), *self._material[:2]) @ force
        difference = np.einsum("nk,nk->n", weights, along[nodes]) - half
        structural = float(difference.mean())
        return Separation(float(contact.weights @ along[contact.nodes]) - structural, structural, float(np.ptp(difference)))
