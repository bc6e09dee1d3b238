"""Quadrature points of a contacting surface: 2 x 2 Gauss points on every facet, moved onto the exact sphere."""

from __future__ import annotations

import attrs
import numpy as np

#: (4, 2) signs of a facet's corners in its own coordinates.
_CORNERS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])


@attrs.frozen(eq=False)
class SurfacePoints:
    """Points at which pressure acts.

    Attributes
    ----------
    place : (n, 3) float [m];  area : (n,) float [m2], weights of the integral over the surface
    nodes : (n, 4) int, of the facet;  weights : (n, 4) float, which interpolate the nodes' displacements
    """

    place: np.ndarray
    area: np.ndarray
    nodes: np.ndarray
    weights: np.ndarray

    def __getitem__(self, chosen: np.ndarray) -> SurfacePoints:
        return SurfacePoints(self.place[chosen], self.area[chosen], self.nodes[chosen], self.weights[chosen])


def surface_points(points: np.ndarray, quads: np.ndarray, centre: np.ndarray | None = None) -> SurfacePoints:
    """Gauss points of the facets ``quads`` (k, 4) nodes of ``points`` (n, 3) [m].

    Parameters
    ----------
    centre : (3,) float [m], optional
        Of the sphere on which the nodes lie: points and areas are then those of the exact sphere; else of the facets.

    Notes
    -----
    The bilinear facet x(s, t) is mapped to c + R (x - c) / |x - c|, whose area element is that of the sphere.
    """
    root = 1.0 / np.sqrt(3.0)
    corner = points[quads]
    found = []
    for at in _CORNERS * root:
        shape = 0.25 * (1.0 + _CORNERS[:, 0] * at[0]) * (1.0 + _CORNERS[:, 1] * at[1])
        ds = 0.25 * _CORNERS[:, 0] * (1.0 + _CORNERS[:, 1] * at[1])
        dt = 0.25 * _CORNERS[:, 1] * (1.0 + _CORNERS[:, 0] * at[0])
        x, xs, xt = (np.einsum("a,kai->ki", w, corner) for w in (shape, ds, dt))
        if centre is not None:
            radius = float(np.linalg.norm(corner - centre, axis=2).mean())
            away = x - centre
            size = np.linalg.norm(away, axis=1, keepdims=True)
            out = away / size
            xs, xt = (radius / size * (d - (d * out).sum(axis=1, keepdims=True) * out) for d in (xs, xt))
            x = centre + radius * out
        area = np.linalg.norm(np.cross(xs, xt), axis=1)
        found.append((x, area, np.broadcast_to(shape, (len(quads), 4))))
    places, areas, weights = (np.stack(parts, axis=1) for parts in zip(*found, strict=True))
    return SurfacePoints(places.reshape(-1, 3), areas.ravel(), np.repeat(quads, 4, axis=0), weights.reshape(-1, 4))
