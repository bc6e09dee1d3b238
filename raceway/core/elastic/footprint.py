"""Where a whole contact acts on a meshed body, and how the body's surface moves there.

Notes
-----
Along the normal the contact presses on a disc, wide enough for the half-space's answer to stay finite on any mesh.  Across it
the surface moves as its surroundings do, as a rigid body taken to the centre of curvature: a ball that turns, and a groove that
tilts about the centre of its own arc, leave the line between the two centres where it is.
"""

from __future__ import annotations

import attrs
import numpy as np

from raceway.core.elastic.facets import Facets

#: Rings of the disc, points on each, and points on the circle that tells the surroundings' motion.
_RINGS, _ANGLES, _AROUND = 6, 12, 8
#: Radius of that circle over the disc's.
_WIDER = 2.0


@attrs.frozen(eq=False)
class Footprint:
    """A contact on one body.

    Attributes
    ----------
    nodes : (k,) int of the body;  weights : (k,) float, of the disc: a unit force, and the mean displacement under it
    share : (3, k, 3) float: displacement of the surface against which the other body moves
    """

    nodes: np.ndarray
    weights: np.ndarray
    share: np.ndarray


def disc(radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 2) [m] of a disc and weights (n,) of a unit force, its pressure falling as 1 - (r / radius)^2."""
    x, w = np.polynomial.legendre.leggauss(_RINGS)
    r = 0.5 * (x + 1.0)
    angle = 2.0 * np.pi * (np.arange(_ANGLES) + 0.5) / _ANGLES
    points = radius * np.stack([np.outer(r, np.cos(angle)).ravel(), np.outer(r, np.sin(angle)).ravel()], axis=1)
    weights = np.repeat(w * r * (1.0 - r * r), _ANGLES)
    return points, weights / weights.sum()


def footprint(facets: Facets, pole: np.ndarray, normal: np.ndarray, centre: np.ndarray, radius: float) -> Footprint:
    """A contact of a disc's radius [m] at ``pole`` (3,), into the body along ``normal`` (3,), its surface curved about ``centre``."""
    first = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    first /= np.linalg.norm(first)
    axes = np.stack([first, np.cross(normal, first)])
    places, force = disc(radius)
    facet, weights, _ = facets.locate(pole + places @ axes)
    angle = 2.0 * np.pi * np.arange(_AROUND) / _AROUND
    circle = _WIDER * radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    facet_around, weights_around, _ = facets.locate(pole + circle @ axes)
    nodes = np.unique(np.concatenate([facets.quads[facet].ravel(), facets.quads[facet_around].ravel()]))
    pressed = np.zeros(len(nodes))
    np.add.at(pressed, np.searchsorted(nodes, facets.quads[facet]).ravel(), (force[:, None] * weights).ravel())
    moved = np.zeros((_AROUND, len(nodes)))
    rows = np.repeat(np.arange(_AROUND), 4)
    np.add.at(moved, (rows, np.searchsorted(nodes, facets.quads[facet_around]).ravel()), weights_around.ravel())
    fit = _rigid_fit(moved @ facets.points[nodes], centre)
    along = np.outer(normal, normal)
    across = np.einsum("ab,bjc,jk->akc", np.eye(3) - along, fit, moved)
    return Footprint(nodes, pressed, across + along[:, None, :] * pressed[None, :, None])


def _rigid_fit(places: np.ndarray, centre: np.ndarray) -> np.ndarray:
    """(3, n, 3) what displacements of points (n, 3) say of that of a centre (3,), as one rigid body, by least squares."""
    arm = places - centre
    size = np.linalg.norm(arm, axis=1).max()
    columns = np.zeros((len(places), 3, 6))
    columns[:, :, :3] = np.eye(3)
    for a in range(3):
        columns[:, :, 3 + a] = np.cross(np.eye(3)[a], arm / size)
    return np.linalg.pinv(columns.reshape(-1, 6))[:3].reshape(3, len(places), 3)
