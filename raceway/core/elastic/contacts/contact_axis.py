"""The normal of a loaded contact at points, through its centre of pressure, in the ball and in the other body."""

from __future__ import annotations

import attrs
import numpy as np

from raceway.core.elastic.contacts.nodal import NodalContact


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
    middle, moved = share @ contact.place[part], share @ contact.projected[part]
    outward = (middle - centre) / np.linalg.norm(middle - centre)
    pole = centre + float(np.linalg.norm(contact.place[part] - centre, axis=1).mean()) * outward
    facets = contact.pairs[pair].facets
    facet, weights, _ = facets.locate((pole + moved - middle)[None])
    other = weights[0] @ facets.points[facets.quads[facet[0]]]
    return ContactAxis(pole, _axes(-outward, rolling)), ContactAxis(np.asarray(other), _axes(outward, rolling))


def _axes(inward: np.ndarray, rolling: np.ndarray) -> np.ndarray:
    along = rolling - (rolling @ inward) * inward
    along /= np.linalg.norm(along)
    return np.stack([np.cross(along, inward), along, inward])
