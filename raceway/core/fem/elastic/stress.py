"""The normal of a loaded contact at points, through its centre of pressure, in the ball and in the other body."""

from __future__ import annotations

import attrs
import numpy as np

from raceway.core.fem.elastic.contact import NodalContact
from raceway.core.fem.hexahedron.operator import HexOperator
from raceway.core.fem.hexahedron.rows import centre_stress, largest_shear, von_mises
from raceway.core.fem.hexahedron.stress_fit import StressFit
from raceway.core.fem.mesh.hex_mesh import CORNERS


@attrs.frozen(eq=False)
class ContactAxis:
    """A line from the surface into one body.

    Attributes
    ----------
    pole : (3,) float, of the undeformed surface [m]
    axes : (3, 3) float, unit vectors in rows: across the rolling direction, along it, into the body
    """

    pole: np.ndarray
    axes: np.ndarray

    def local(self, points: np.ndarray) -> np.ndarray:
        """(..., 3) coordinates of points along the axes, from the pole [m]."""
        return np.asarray((points - self.pole) @ self.axes.T)

    def at_depth(self, depth: np.ndarray) -> np.ndarray:
        """(n, 3) points below the pole [m]."""
        return np.asarray(self.pole + np.multiply.outer(depth, self.axes[2]))


def contact_axes(
    contact: NodalContact, pair: int, centre: np.ndarray, rolling: np.ndarray
) -> tuple[ContactAxis, ContactAxis] | None:
    """The line in the ball and that in the other body, at the last pressures; None where nothing presses.

    Parameters
    ----------
    centre : (3,) of the undeformed ball [m];  rolling : (3,) direction that is not the normal's

    Notes
    -----
    The centre of pressure of points on a curved surface lies below it: the ball's pole is above it on the exact sphere, the other
    body's on the facet that the pole projects onto when it has moved as the points have.
    """
    part = contact.pair == pair
    force = contact.area[part] * contact.pressure[part]
    total = float(force.sum())
    if not total > 0.0:
        return None
    share = force / total
    middle, surface = share @ contact.place[part], share @ contact.projected[part]
    outward = (middle - centre) / np.linalg.norm(middle - centre)
    pole = centre + float(np.linalg.norm(contact.place[part] - centre, axis=1).mean()) * outward
    facets = contact.pairs[pair].facets
    facet, weights, _ = facets.locate((pole + surface - middle)[None])
    partner = weights[0] @ facets.points[facets.quads[facet[0]]]
    return ContactAxis(pole, _axes(-outward, rolling)), ContactAxis(np.asarray(partner), _axes(outward, rolling))


def _axes(inward: np.ndarray, rolling: np.ndarray) -> np.ndarray:
    along = rolling - (rolling @ inward) * inward
    along /= np.linalg.norm(along)
    return np.stack([np.cross(along, inward), along, inward])


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


def cells_near(points: np.ndarray, cells: np.ndarray, where: np.ndarray, reach: float) -> np.ndarray:
    """(k,) numbers of the cells (m, 8) that have a node within ``reach`` [m] of a place (3,); arrays of one byte a cell's node."""
    near = np.einsum("na,na->n", points - where, points - where) < reach * reach
    return np.flatnonzero(near[cells].any(axis=1))


def stress_profile(axis: ContactAxis, body: HexOperator, u: np.ndarray, reach: float, deep: float) -> StressProfile:
    """Stresses of a body along a line.

    Parameters
    ----------
    body : the mesh with its material;  u : (n, 3) displacements of its nodes [m]
    reach : elements within this distance of the pole are looked at [m], and more where they are few
    deep : end of the line [m]
    """
    near = cells_near(body.points, body.cells, axis.pole, reach)
    while len(near) < min(_FEWEST, len(body.cells)):
        reach *= 1.5
        near = cells_near(body.points, body.cells, axis.pole, reach)
    cells = body.cells[near]
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
