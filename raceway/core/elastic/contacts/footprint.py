"""Footprint of a contact resultant on a mesh: nodal weights of its force, and the motion of the surface there.

Notes
-----
The normal force is spread over an ellipse far wider than Hertz's, so that the local compliance of the mesh is smaller than the
contact's and can be subtracted from it.  The tangential displacement of the surface is that of its surroundings, moved as a rigid body to
the centre of curvature: a ball that turns, and a groove that
tilts about the centre of its own arc, leave the line between the two centres where it is.
"""

from __future__ import annotations

import attrs
import numpy as np

from raceway.core.elastic.contacts.facets import Facets

#: Rings of the ellipse, points on each, and points on the circle that gives the motion of the surroundings.
_RINGS, _ANGLES, _AROUND = 6, 12, 8


@attrs.frozen(eq=False)
class Footprint:
    """A contact on one body.

    Attributes
    ----------
    nodes : (k,) int of the body;  weights : (k,) float, of the ellipse: a unit force, and the mean displacement under it
    share : (3, k, 3) float: displacement of the surface against which the other body moves
    """

    nodes: np.ndarray
    weights: np.ndarray
    share: np.ndarray


def ellipse(semi_axes: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 2) [m] of an ellipse and weights (n,) of a unit force, its pressure falling as 1 - (x / a)^2 - (y / b)^2."""
    x, w = np.polynomial.legendre.leggauss(_RINGS)
    r = 0.5 * (x + 1.0)
    angle = 2.0 * np.pi * (np.arange(_ANGLES) + 0.5) / _ANGLES
    points = np.stack([np.outer(r, np.cos(angle)).ravel(), np.outer(r, np.sin(angle)).ravel()], axis=1)
    weights = np.repeat(w * r * (1.0 - r * r), _ANGLES)
    return points * semi_axes, weights / weights.sum()


def footprint(
    facets: Facets,
    pole: np.ndarray,
    normal: np.ndarray,
    along: np.ndarray,
    centre: np.ndarray,
    semi_axes: tuple[float, float],
) -> Footprint:
    """A contact at a pole of a body.

    Parameters
    ----------
    pole : (3,) [m];  normal : (3,) into the body;  along : (3,) of the first semi-axis, both of length 1
    centre : (3,) of the surface's curvature [m];  semi_axes : of the ellipse, along the groove and across [m]
    """
    axes = np.stack([along, np.cross(normal, along)])
    places, force = ellipse(semi_axes)
    facet, weights, _ = facets.locate(pole + places @ axes)
    angle = 2.0 * np.pi * np.arange(_AROUND) / _AROUND
    circle = max(semi_axes) * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    facet_around, weights_around, _ = facets.locate(pole + circle @ axes)
    nodes = np.unique(np.concatenate([facets.quads[facet].ravel(), facets.quads[facet_around].ravel()]))
    pressed = np.zeros(len(nodes))
    np.add.at(pressed, np.searchsorted(nodes, facets.quads[facet]).ravel(), (force[:, None] * weights).ravel())
    moved = np.zeros((_AROUND, len(nodes)))
    rows = np.repeat(np.arange(_AROUND), 4)
    np.add.at(moved, (rows, np.searchsorted(nodes, facets.quads[facet_around]).ravel()), weights_around.ravel())
    fit = _rigid_fit(moved @ facets.points[nodes], centre)
    inward = np.outer(normal, normal)
    across = np.einsum("ab,bjc,jk->akc", np.eye(3) - inward, fit, moved)
    return Footprint(nodes, pressed, across + inward[:, None, :] * pressed[None, :, None])


def _rigid_fit(places: np.ndarray, centre: np.ndarray) -> np.ndarray:
    """(3, n, 3) what displacements of points (n, 3) say of that of a centre (3,), as one rigid body, by least squares."""
    arm = places - centre
    size = np.linalg.norm(arm, axis=1).max()
    columns = np.zeros((len(places), 3, 6))
    columns[:, :, :3] = np.eye(3)
    for a in range(3):
        columns[:, :, 3 + a] = np.cross(np.eye(3)[a], arm / size)
    return np.linalg.pinv(columns.reshape(-1, 6))[:3].reshape(3, len(places), 3)
