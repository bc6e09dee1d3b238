"""Cells around points inside of a mesh, and the weights of their eight nodes."""

from __future__ import annotations

import numpy as np

from raceway.core.hexahedron.shape import shape_slopes, shape_values

#: Cells near a point that are tried, and Newton's steps in each of them.
_TRIED, _STEPS = 12, 15
#: Places in a cell's own coordinates that Newton's method may reach.
_FAR = 5.0


def locate(points: np.ndarray, cells: np.ndarray, where: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (n, 8) and weights (n, 8) that interpolate at ``where`` (n, 3) [m].

    Parameters
    ----------
    points : (m, 3) nodes [m];  cells : (k, 8) trilinear hexahedra

    Notes
    -----
    A point outside of the mesh is extrapolated from the cell that it is nearest to, in that cell's coordinates.
    """
    from scipy.spatial import KDTree

    near = KDTree(points[cells].mean(axis=1)).query(where, k=min(_TRIED, len(cells)))[1].reshape(len(where), -1)
    place = np.zeros((*near.shape, 3))
    corners = points[cells[near]]
    for _ in range(_STEPS):
        flat = place.reshape(-1, 3)
        rest = where[:, None] - np.einsum("nkc,nkca->nka", shape_values(flat).reshape(*near.shape, 8), corners)
        slopes = np.einsum("nkcb,nkca->nkab", shape_slopes(flat).reshape(*near.shape, 8, 3), corners)
        place = np.clip(place + np.linalg.solve(slopes, rest[..., None])[..., 0], -_FAR, _FAR)
    best = np.abs(place).max(axis=2).argmin(axis=1)
    rows = np.arange(len(where))
    return cells[near[rows, best]], shape_values(place[rows, best])
