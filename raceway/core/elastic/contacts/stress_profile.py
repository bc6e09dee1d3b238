"""Stresses of a meshed body along the normal of a contact, from the surface downwards, and the largest shear stress there."""

from __future__ import annotations

import attrs
import numpy as np

from raceway.core.elastic.contacts.contact_axis import ContactAxis
from raceway.core.hexahedron.operator import HexOperator
from raceway.core.hexahedron.recovery import centre_stress, largest_shear, von_mises
from raceway.core.hexahedron.shape import CORNERS
from raceway.core.hexahedron.stress_fit import StressFit

#: Places along the line, and the fewest elements around it that stresses are taken from.
_PLACES, _FEWEST = 121, 200
#: Where the shear stress is above this part of its largest value, a polynomial of this degree is fitted: on Hertz's own line it
#: gives the size to 0.02 % and the depth to 0.01 %, and what the elements leave of waves is smoothed.
_TOP, _DEGREE = 0.85, 4


@attrs.frozen(eq=False)
class StressProfile:
    """Stresses at points of a line into a body.

    Attributes
    ----------
    depth : (n,) float below the surface, evenly from 0 [m]
    stress : (n, 6) float [Pa], xx yy zz xy yz zx of the bearing's axes
    lengths : (n, 3) float, of the elements there: across the rolling direction, along it, in depth [m]
    """

    depth: np.ndarray
    stress: np.ndarray
    lengths: np.ndarray

    @property
    def shear(self) -> np.ndarray:
        """(n,) largest shear stress of each point [Pa]."""
        return largest_shear(self.stress)

    @property
    def von_mises(self) -> np.ndarray:
        """(n,) [Pa]."""
        return von_mises(self.stress)

    def largest(self) -> tuple[float, float]:
        """The largest shear stress [Pa] and its depth [m], below the centre of the first element."""
        first = min(int(np.searchsorted(self.depth, 0.5 * self.lengths[0, 2])), len(self.depth) - 1)
        depth, shear = self.depth[first:], self.shear[first:]
        most = int(shear.argmax())
        high = shear >= _TOP * shear[most]
        low = most - int(np.argmin(np.r_[high[most::-1], False])) + 1
        end = most + int(np.argmin(np.r_[high[most:], False]))
        if end - low <= _DEGREE:
            return float(shear[most]), float(depth[most])
        fit = np.polynomial.Polynomial.fit(depth[low:end], shear[low:end], _DEGREE)
        fine = np.linspace(depth[low], depth[end - 1], 20 * _PLACES)
        values = fit(fine)
        return float(values.max()), float(fine[values.argmax()])

    def cells_to(self, depth: float) -> float:
        """How many elements lie above a depth [m]."""
        at = np.linspace(0.0, depth, _PLACES)
        return float(np.trapezoid(1.0 / np.interp(at, self.depth, self.lengths[:, 2]), at))


def cells_near(points: np.ndarray, cells: np.ndarray, place: np.ndarray, reach: float) -> np.ndarray:
    """(k,) numbers of the cells (m, 8) that have a node within ``reach`` [m] of a place (3,); arrays of one byte a cell's node."""
    near = np.einsum("na,na->n", points - place, points - place) < reach * reach
    return np.flatnonzero(near[cells].any(axis=1))


def stress_profile(axis: ContactAxis, body: HexOperator, u: np.ndarray, reach: float, deep: float) -> StressProfile:
    """Stresses of a body along a line.

    Parameters
    ----------
    body : the mesh with its material;  u : (n, 3) displacements of its nodes [m]
    reach : elements within this distance of the pole are looked at [m], and more where they are few
    deep : end of the line [m]
    """
    chosen = cells_near(body.points, body.cells, axis.pole, reach)
    while len(chosen) < min(_FEWEST, len(body.cells)):
        reach *= 1.5
        chosen = cells_near(body.points, body.cells, axis.pole, reach)
    cells = body.cells[chosen]
    corners = axis.local(body.points[cells])
    # Of the three mean edges of an element, what lies along each axis: the element's own edges where it is aligned.
    edges = np.einsum("ne,kna->kea", CORNERS, corners) / 4.0
    fit = StressFit(
        corners.mean(axis=1),
        np.sqrt(np.square(edges).sum(axis=1)),
        centre_stress(body.points, cells, u, body.moduli, body.formulation),
    )
    depth = np.linspace(0.0, deep, _PLACES)
    line = np.stack([0.0 * depth, 0.0 * depth, depth], axis=1)
    return StressProfile(depth, fit.at(line), fit.lengths_at(line))
