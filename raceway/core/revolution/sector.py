"""Matrices of one sector of a body of revolution, and the real symmetric system of each harmonic.

With u_k = u exp(i n k a), a = 2 pi / N, the stiffness of a ring of equal sectors becomes
K(n) = D + U exp(i n a) + U^T exp(-i n a) in nodal components r, theta, x; D couples nodes of one meridian, U those of
neighbouring ones.  The sector is its own mirror image, so that K(n) is real once u_theta is counted in units of i:
K(n) = A + B cos(n a) + S sin(n a), where A and B couple r and x among themselves and theta with theta, S the two groups.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from raceway.core.hexahedron.operator import HexOperator
from raceway.core.revolution.profile import Profile

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


class Sector:
    """One sector of a body of N equal ones: element matrices and masses.

    Attributes
    ----------
    even, cosine, sine : (M, 12, 12) float
        Parts A, B, S of the quadrilaterals' matrices, component by component of their four nodes [N/m].
    mass : (N,) float
        Lumped masses of the nodes of one meridian [kg].
    """

    def __init__(
        self,
        profile: Profile,
        divisions: int,
        young: float,
        poisson: float,
        density: float,
        formulation: str,
        hourglass: float,
    ) -> None:
        half, count = np.pi / divisions, len(profile.points)
        r, x = profile.points.T
        c, s = np.cos(half), np.sin(half)
        points = np.concatenate([np.column_stack([x, c * r, -s * r]), np.column_stack([x, c * r, s * r])])
        cells = np.concatenate([profile.quads, profile.quads + count], axis=1)
        operator = HexOperator(points, cells, young, poisson, density, formulation, hourglass)
        # Columns: r, theta, x of the nodes on either side in x, y, z.
        sides = np.stack([_frame(-half)] * 4 + [_frame(half)] * 4)
        elements = operator.element_stiffness(slice(0, len(cells))).reshape(-1, 8, 3, 8, 3)
        k = np.einsum("iab,eiajc,jcd->eibjd", sides, elements, sides, optimize=True)
        here, there = slice(0, 4), slice(4, 8)
        near = k[:, here, :, here] + k[:, there, :, there]
        far, back = k[:, here, :, there], np.einsum("eiajb->ejbia", k[:, here, :, there])
        alike = np.ones((3, 3), dtype=bool)
        alike[1, [0, 2]] = alike[[0, 2], 1] = False
        # conj(w_a) w_b with w = 1 for r and x, i for theta: +i couples r and x to theta, -i theta to r and x.
        sign = np.array([[0, -1, 0], [1, 0, 1], [0, -1, 0]], dtype=float)
        size = (-1, 12, 12)
        self.even = (near * alike[:, None, :]).reshape(size)
        self.cosine = ((far + back) * alike[:, None, :]).reshape(size)
        self.sine = ((far - back) * sign[:, None, :]).reshape(size)
        masses = operator.element_masses
        self.mass = np.bincount(profile.quads.ravel(), weights=(masses[:, :4] + masses[:, 4:]).ravel(), minlength=count)

    def assembled(self, quads: np.ndarray, place: np.ndarray) -> Pencil:
        """The sector's matrices with the degree of freedom 3 node + component in row ``place`` (-1: held)."""
        from scipy.sparse import coo_matrix

        number = place[(3 * quads[:, :, None] + np.arange(3)).reshape(len(quads), 12)]
        rows = np.broadcast_to(number[:, :, None], self.even.shape).ravel()
        columns = np.broadcast_to(number[:, None, :], self.even.shape).ravel()
        kept = (rows >= 0) & (columns >= 0)
        rows, columns, size = rows[kept], columns[kept], int(place.max()) + 1

        def total(part: np.ndarray) -> csr_matrix:
            return coo_matrix((part.ravel()[kept], (rows, columns)), shape=(size, size)).tocsc()

        return Pencil(total(self.even), total(self.cosine).data, total(self.sine).data)


class Pencil:
    """K(n) = A + B cos(n a) + S sin(n a) in one sparsity pattern."""

    def __init__(self, even: csr_matrix, cosine: np.ndarray, sine: np.ndarray) -> None:
        self.even, self.cosine, self.sine = even, cosine, sine

    def add_to_diagonal(self, values: np.ndarray) -> None:
        """Add springs (m,) [N/m] to every harmonic."""
        matrix = self.even
        rows, columns = matrix.indices, np.repeat(np.arange(matrix.shape[1]), np.diff(matrix.indptr))
        matrix.data[rows == columns] += values

    def at(self, angle: float) -> csr_matrix:
        """(m, m) scipy.sparse.csc_matrix of the harmonic with n a = ``angle``."""
        from scipy.sparse import csc_matrix

        data = self.even.data + np.cos(angle) * self.cosine + np.sin(angle) * self.sine
        return csc_matrix((data, self.even.indices, self.even.indptr), shape=self.even.shape)


def _frame(angle: float) -> np.ndarray:
    """(3, 3) Columns: directions r, theta, x at an azimuth from y towards z, in x, y, z."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[0.0, 0.0, 1.0], [c, -s, 0.0], [s, c, 0.0]])
