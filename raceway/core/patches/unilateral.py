"""Pressures without penetration: f >= 0, w = g + C f >= 0, f w = 0 at every point, by an active set.

Notes
-----
Points that pull leave the set, points that penetrate join it, all at once; near the solution the sets of successive
iterations are the same.  Entries of C are positive between points of a patch: only points with g < 0 can touch.
"""

from __future__ import annotations

import numpy as np

from raceway.core.patches.factor import Factor
from raceway.errors import ConvergenceError

#: Iterations with whole exchanges, after which only the worst point is exchanged, and their largest number.
_WHOLE, _LIMIT = 25, 400
#: Penetration that counts as none, of the deepest overlap.
_ROUNDING = 1e-10


def active_set(gap: np.ndarray, start: np.ndarray, factor: Factor) -> tuple[np.ndarray, np.ndarray, int]:
    """Points in contact (n,), ascending, their loads (n,) [N], and the number of iterations.

    Parameters
    ----------
    gap : (rows * columns,) without elastic displacement [m]
    start : points that were in contact in a similar state, or none

    Raises
    ------
    ConvergenceError
        The sets repeat themselves.
    """
    near = np.flatnonzero(gap < 0.0)
    if not len(near):
        return near, np.zeros(0), 0
    deepest = gap[near].min()
    nodes = start[gap[start] < 0.0] if len(start) else start
    if not len(nodes):
        nodes = near[gap[near] < 0.5 * deepest]  # Hertz: half the overlap's area carries
    allowed = _ROUNDING * abs(deepest)
    for iteration in range(1, _LIMIT + 1):
        load = factor.solve(nodes, -gap[nodes])
        free = gap < 0.0
        free[nodes] = False
        outside = np.flatnonzero(free)
        depth = gap[outside] + factor.displacement(outside, nodes, load)
        pulls, joins = load < 0.0, depth < -allowed
        if not (pulls.any() or joins.any()):
            return nodes, load, iteration
        if iteration > _WHOLE:
            pulls, joins = _worst(pulls, load), _worst(joins, depth) if not pulls.any() else np.zeros_like(joins)
        nodes = np.sort(np.concatenate([nodes[~pulls], outside[joins]]))
    raise ConvergenceError(f"the points in contact were not found after {_LIMIT} exchanges")


def _worst(flags: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Only the most negative of the flagged ones."""
    out = np.zeros_like(flags)
    if flags.any():
        out[np.argmin(np.where(flags, values, np.inf))] = True
    return out
