"""A fixed division of the elements, and the sums over its parts: forces that do not depend on the number of threads.

The elements are cut into contiguous ranges, always the same for one mesh.  Each range has its own forces for the nodes
between its lowest and its highest; these parts are added in the order of the ranges, whoever computed them.  On a mesh
whose numbers follow its shape the parts hardly overlap.
"""

from __future__ import annotations

import numpy as np
from numba import float64, int64, void
from numpy.typing import NDArray

from raceway.core.hexahedron.one_point import WIDTH
from raceway.core.jit import jit
from raceway.core.signatures import VECTOR

#: Ranges of a mesh, and the most threads that can share it.
RANGES = 8
#: Nodes that are summed and moved together, so that their forces stay in the first cache.
_CHUNK = 512


def divide(cells: NDArray[np.uint32]) -> NDArray[np.int64]:
    """Ranges of whole blocks of elements.

    Returns
    -------
    ranges : (at most RANGES, 5) int
        First element, last element + 1, first node, last node + 1, first node's place among the parts.
    """
    blocks = -(-len(cells) // WIDTH)
    edges = np.unique(np.linspace(0, blocks, min(RANGES, blocks) + 1).astype(np.int64)) * WIDTH
    edges[-1] = len(cells)
    rows, place = [], 0
    for first, last in zip(edges[:-1], edges[1:], strict=True):
        low, high = int(cells[first:last].min()), int(cells[first:last].max()) + 1
        rows.append((first, last, low, high, place))
        place += high - low
    return np.array(rows, dtype=np.int64)


@jit(void(int64, int64, int64[:, ::1], VECTOR, VECTOR), releases=True)
def add_parts(first, last, ranges, parts, f):  # type: ignore[no-untyped-def]
    """Forces of the nodes ``first`` to ``last - 1``: the sum over the ranges, in their order."""
    for i in range(3 * first, 3 * last):
        f[i] = 0.0
    for r in range(ranges.shape[0]):
        begin, end = max(first, ranges[r, 2]), min(last, ranges[r, 3])
        shift = 3 * (ranges[r, 4] - ranges[r, 2])
        for i in range(3 * begin, 3 * end):
            f[i] += parts[i + shift]


@jit(void(int64, int64, int64[:, ::1], VECTOR, VECTOR, VECTOR, VECTOR, float64, VECTOR, VECTOR), releases=True)
def add_parts_and_move(first, last, ranges, parts, load, inverse_mass, f, dt, u, v):  # type: ignore[no-untyped-def]
    """One central-difference update of the nodes ``first`` to ``last - 1``.

    Parameters
    ----------
    load : (3 n,) float
        Outer forces [N].
    inverse_mass : (n,) float
        0 holds a node [1/kg].
    f : (3 n,) float
        Out: internal forces before the update [N].
    u, v : (3 n,) float
        Displacements at the step [m] and velocities half a step earlier [m/s]; both move on by ``dt``.
    """
    for begin in range(first, last, _CHUNK):
        end = min(begin + _CHUNK, last)
        add_parts(begin, end, ranges, parts, f)
        for n in range(begin, end):
            gain = dt * inverse_mass[n]
            for i in range(3 * n, 3 * n + 3):
                v[i] += gain * (load[i] - f[i])
                u[i] += dt * v[i]
