"""Shape functions of the trilinear hexahedron in VTK's order of nodes, and what follows from them by numpy."""

import numpy as np
from numpy.typing import NDArray

from raceway.core.fem.mesh.hex_mesh import CORNERS, shape_slopes

Floats = NDArray[np.float64]

#: (8, 4) Nodal values of eta zeta, xi zeta, xi eta and xi eta zeta: what a constant gradient does not see.
HOURGLASS: Floats = np.stack(
    [CORNERS[:, 1] * CORNERS[:, 2], CORNERS[:, 0] * CORNERS[:, 2], CORNERS[:, 0] * CORNERS[:, 1], CORNERS.prod(axis=1)],
    axis=1,
)


def shape_values(at: Floats) -> Floats:
    """(p, 8) Shape functions at points (p, 3) of the reference cube."""
    return np.asarray(np.prod(1.0 + at[:, None, :] * CORNERS, axis=2) / 8.0)


def gauss(count: int) -> tuple[Floats, Floats]:
    """Points (count^3, 3) and weights of the Gauss rule on the reference cube."""
    x, w = np.polynomial.legendre.leggauss(count)
    grid = np.stack(np.meshgrid(x, x, x, indexing="ij"), axis=-1).reshape(-1, 3)
    return grid, np.einsum("i,j,k->ijk", w, w, w).ravel()


def jacobians(corners: Floats, slopes: Floats) -> Floats:
    """(k, p, 3, 3) d(x_i) / d(xi_j) of elements with corners (k, 8, 3) at p points."""
    return np.asarray(np.einsum("kni,pnj->kpij", corners, slopes, optimize=True))


def determinants(jacobian: Floats) -> Floats:
    """(...) of matrices (..., 3, 3): six times as quick as a factorisation of each."""
    a, b, c = (jacobian[..., i, :] for i in range(3))
    return np.asarray(
        a[..., 0] * (b[..., 1] * c[..., 2] - b[..., 2] * c[..., 1])
        + a[..., 1] * (b[..., 2] * c[..., 0] - b[..., 0] * c[..., 2])
        + a[..., 2] * (b[..., 0] * c[..., 1] - b[..., 1] * c[..., 0])
    )


def mean_gradients(corners: Floats) -> tuple[Floats, Floats]:
    """Exact means of the gradients of the shape functions (k, 8, 3) [1/m], and volumes (k,) [m3].

    The 2 x 2 x 2 rule is exact: the integrand, slopes times cofactors, is quadratic in each coordinate.
    """
    slopes = shape_slopes(gauss(2)[0])
    jacobian = jacobians(corners, slopes)
    determinant = determinants(jacobian)
    cofactors = determinant[..., None, None] * np.linalg.inv(jacobian)
    volume = determinant.sum(axis=1)
    return np.einsum("pnj,kpji->kni", slopes, cofactors, optimize=True) / volume[:, None, None], volume


def centre_gradients(corners: Floats) -> Floats:
    """(k, 8, 3) Gradients of the shape functions at the elements' centres [1/m]."""
    slopes = shape_slopes(np.zeros((1, 3)))
    return np.asarray(slopes[0] @ np.linalg.inv(jacobians(corners, slopes)[:, 0]))
