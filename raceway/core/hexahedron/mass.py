"""Masses of the hexahedron, by numpy over batches of elements."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from raceway.core.hexahedron.shape import Floats, determinants, gauss, jacobians, shape_slopes, shape_values
from raceway.errors import MeshError

#: Elements of a batch: some 50 MB of work space.
BATCH = 16384


def batches(count: int, size: int = BATCH) -> Iterator[slice]:
    """Slices that cover ``count`` elements."""
    return (slice(begin, min(begin + size, count)) for begin in range(0, count, size))


def nodal_volumes(points: Floats, cells: NDArray[np.uint32]) -> Floats:
    """(m, 8) Integral of each shape function over each element [m3]; the 2 x 2 x 2 rule is exact.

    Raises
    ------
    MeshError
        An element whose Jacobian is not positive at a Gauss point, or that holds a coordinate that is not finite.
    """
    at, weights = gauss(2)
    slopes, values = shape_slopes(at), shape_values(at)
    out = np.empty((len(cells), 8))
    for part in batches(len(cells)):
        with np.errstate(invalid="ignore"):  # a coordinate that is no number is refused below
            determinant = determinants(jacobians(points[cells[part]], slopes))
        bad = ~(determinant > 0.0).all(axis=1)
        if bad.any():
            e = part.start + int(np.argmax(bad))
            raise MeshError(
                f"element {e} is inverted or degenerate: the determinant of its Jacobian falls to "
                f"{determinant[e - part.start].min():.3g} m3 at a Gauss point; it must be positive. Check the order of its "
                "nodes (VTK's hexahedron) and its shape"
            )
        out[part] = np.einsum("kp,pn->kn", determinant * weights, values)
    return out
