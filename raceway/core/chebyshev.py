"""A smooth function at many points by Chebyshev interpolation between a few, where that is exact enough."""

from collections.abc import Callable

import numpy as np
from numpy.polynomial.chebyshev import chebvander

#: Nodes of each variable, tried in turn, and points at which the interpolation is compared with the function.
_NODES, _COMPARED = (3, 5, 9), 8


def interpolated(function: Callable[[np.ndarray], np.ndarray], points: np.ndarray, tolerance: float) -> np.ndarray:
    """Values (n,) of a function at points (k, n), exact or within a relative tolerance at some of them.

    function : of points (k, m), its values (m,), not zero

    Interpolation on the product of Chebyshev nodes of the variables that differ, as long as these are fewer than half of the points.

    Trefethen, Approximation Theory and Approximation Practice, SIAM 2013, chapters 3 and 8.
    """
    distinct, index = np.unique(points, axis=1, return_inverse=True)
    low, high = distinct.min(axis=1), distinct.max(axis=1)
    varied, count = np.flatnonzero(high > low), distinct.shape[1]
    middle, half = 0.5 * (low + high)[varied, None], 0.5 * (high - low)[varied, None]
    some = np.unique(np.linspace(0, count - 1, _COMPARED).astype(int))
    for nodes in _NODES:
        if 2 * nodes ** len(varied) > count:
            break
        t = np.cos(np.pi * (np.arange(nodes) + 0.5) / nodes)
        grid = np.repeat(distinct[:, :1], nodes ** len(varied), axis=1)
        grid[varied] = np.stack(np.meshgrid(*(middle + half * t), indexing="ij")).reshape(len(varied), -1)
        values, transform = function(grid).reshape([nodes] * len(varied)), np.linalg.inv(chebvander(t, nodes - 1))
        for axis in range(len(varied)):
            values = np.moveaxis(np.tensordot(transform, values, (1, axis)), 0, axis)
        total = np.broadcast_to(values, (count, *values.shape))
        for x in (distinct[varied] - middle) / half:
            total = np.einsum("nj...,nj->n...", total, chebvander(x, nodes - 1))
        if np.allclose(total[some], function(distinct[:, some]), rtol=tolerance, atol=0.0):
            return total[index.ravel()]
    return function(distinct)[index.ravel()]
