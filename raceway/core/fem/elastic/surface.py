"""Facets under points of a meshed surface, and the weights of their four nodes."""

import attrs
import numpy as np
from numba import float64, int64, void

from raceway.core.jit import jit
from raceway.core.signatures import MATRIX

_NODES = int64[:, ::1]
#: Facets that a search may cross, and steps of Gauss and Newton on one facet.
_CROSSED, _STEPS = 2000, 3


@jit(void(MATRIX, MATRIX, _NODES, _NODES, int64[::1], MATRIX, float64[::1]))
def _walk(where, points, quads, neighbours, facet, weights, outside):  # type: ignore[no-untyped-def]
    """From a facet near each point over edges to the one that the point projects onto.

    where : (n, 3);  points : (m, 3);  quads, neighbours : (k, 4), the facet across the edge from corner a to a + 1, or -1
    facet : (n,) in: a facet to start from; out: the one found
    weights : (n, 4) out;  outside : (n,) out: how far beyond the surface's rim, in facet half widths; 0 inside
    """
    for i in range(where.shape[0]):
        f = facet[i]
        before = -1
        s, t = 0.0, 0.0
        for _ in range(_CROSSED):
            a, b, c, d = quads[f, 0], quads[f, 1], quads[f, 2], quads[f, 3]
            s, t = 0.0, 0.0
            for _ in range(_STEPS):
                ss, st, tt, rs, rt = 0.0, 0.0, 0.0, 0.0, 0.0
                for k in range(3):
                    pa, pb, pc, pd = points[a, k], points[b, k], points[c, k], points[d, k]
                    x = 0.25 * (
                        (1 - s) * (1 - t) * pa + (1 + s) * (1 - t) * pb + (1 + s) * (1 + t) * pc + (1 - s) * (1 + t) * pd
                    )
                    xs = 0.25 * ((1 - t) * (pb - pa) + (1 + t) * (pc - pd))
                    xt = 0.25 * ((1 - s) * (pd - pa) + (1 + s) * (pc - pb))
                    r = where[i, k] - x
                    ss += xs * xs
                    st += xs * xt
                    tt += xt * xt
                    rs += r * xs
                    rt += r * xt
                det = ss * tt - st * st
                s += (tt * rs - st * rt) / det
                t += (ss * rt - st * rs) / det
                s = min(max(s, -8.0), 8.0)
                t = min(max(t, -8.0), 8.0)
            edge = -1
            far = 1.0 + 1e-9
            if -t > far and neighbours[f, 0] >= 0:
                edge, far = 0, -t
            if s > far and neighbours[f, 1] >= 0:
                edge, far = 1, s
            if t > far and neighbours[f, 2] >= 0:
                edge, far = 2, t
            if -s > far and neighbours[f, 3] >= 0:
                edge, far = 3, -s
            if edge < 0 or neighbours[f, edge] == before:  # above the edge between two facets that meet at an angle
                break
            before = f
            f = neighbours[f, edge]
        facet[i] = f
        outside[i] = max(max(abs(s), abs(t)) - 1.0, 0.0)
        s = min(max(s, -1.0), 1.0)
        t = min(max(t, -1.0), 1.0)
        weights[i, 0] = 0.25 * (1 - s) * (1 - t)
        weights[i, 1] = 0.25 * (1 + s) * (1 - t)
        weights[i, 2] = 0.25 * (1 + s) * (1 + t)
        weights[i, 3] = 0.25 * (1 - s) * (1 + t)


class Facets:
    """A surface of points (n, 3) [m] and quads (k, 4), the nodes of its facets, all in the same sense."""

    def __init__(self, points: np.ndarray, quads: np.ndarray) -> None:
        from scipy.spatial import KDTree

        self.points, self.quads = np.ascontiguousarray(points), np.ascontiguousarray(quads, dtype=np.int64)
        self._tree = KDTree(points[quads].mean(axis=1))
        self._neighbours = neighbours(self.quads)
        corner = points[quads]
        edges = np.linalg.norm(np.roll(corner, -1, axis=1) - corner, axis=2)
        #: (k,) mean lengths of the facets' shorter sides [m].
        self.short = np.minimum(0.5 * (edges[:, 0] + edges[:, 2]), 0.5 * (edges[:, 1] + edges[:, 3]))

    def locate(self, where: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Facets (n,), weights (n, 4) of their nodes, and how far outside of the rim (n,), of points ``where`` (n, 3) [m]."""
        at = np.ascontiguousarray(where, dtype=float)
        facet = np.ascontiguousarray(self._tree.query(at)[1], dtype=np.int64)
        weights, outside = np.empty((len(at), 4)), np.empty(len(at))
        _walk(at, self.points, self.quads, self._neighbours, facet, weights, outside)
        return facet, weights, outside


def neighbours(quads: np.ndarray) -> np.ndarray:
    """(k, 4) the facet across the edge from corner a to corner a + 1 of each facet, -1 at a rim."""
    pairs = np.stack([quads, np.roll(quads, -1, axis=1)], axis=2).reshape(-1, 2)
    keys = np.sort(pairs, axis=1)
    order = np.lexsort(keys.T)
    same = (keys[order[1:]] == keys[order[:-1]]).all(axis=1)
    out = np.full(len(pairs), -1, dtype=np.int64)
    first, second = order[:-1][same], order[1:][same]
    out[first], out[second] = second // 4, first // 4
    return out.reshape(-1, 4)


#: (4, 2) signs of a facet's corners in its own coordinates.
_CORNERS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])


@attrs.frozen(eq=False)
class SurfacePoints:
    """Points at which pressure acts."""

    place: np.ndarray  # (n, 3) float [m]
    area: np.ndarray  # (n,) float [m2], weights of the integral over the surface
    nodes: np.ndarray  # (n, 4) int, of the facet
    weights: np.ndarray  # (n, 4) float, which interpolate the nodes' displacements

    def __getitem__(self, rows: np.ndarray) -> "SurfacePoints":
        return SurfacePoints(self.place[rows], self.area[rows], self.nodes[rows], self.weights[rows])


def surface_points(points: np.ndarray, quads: np.ndarray, centre: np.ndarray | None = None) -> SurfacePoints:
    """Gauss points of the facets ``quads`` (k, 4) nodes of ``points`` (n, 3) [m].

    centre : (3,) float [m], optional
        Of the sphere on which the nodes lie: points and areas are then those of the exact sphere; else of the facets.

    The bilinear facet x(s, t) is mapped to c + R (x - c) / |x - c|, whose area element is that of the sphere.
    """
    root = 1.0 / np.sqrt(3.0)
    corner = points[quads]
    rules = []
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
        rules.append((x, area, np.broadcast_to(shape, (len(quads), 4))))
    places, areas, weights = (np.stack(parts, axis=1) for parts in zip(*rules, strict=True))
    return SurfacePoints(places.reshape(-1, 3), areas.ravel(), np.repeat(quads, 4, axis=0), weights.reshape(-1, 4))
