"""The eight-node hexahedron written down plainly: one element, one Gauss point, one node after the other.

Nothing here is shared with the package.  ``one_point_force`` is plain enough for numba too, and is the readable loop
that ``checks/kernel.py`` compares speeds with.
"""

import itertools

import numpy as np

CORNERS = np.array(
    [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]], dtype=float
)
#: Hourglass vectors: eta zeta, xi zeta, xi eta, xi eta zeta at the corners.
HOURGLASS = np.array(
    [[c[1] * c[2] for c in CORNERS], [c[0] * c[2] for c in CORNERS], [c[0] * c[1] for c in CORNERS],
     [c[0] * c[1] * c[2] for c in CORNERS]]
)  # fmt: skip


def gauss(count: int) -> list[tuple[np.ndarray, float]]:
    """Points and weights on the reference cube."""
    x, w = np.polynomial.legendre.leggauss(count)
    line = list(zip(x, w, strict=True))
    return [(np.array([a[0], b[0], c[0]]), a[1] * b[1] * c[1]) for a, b, c in itertools.product(line, line, line)]


def values(at: np.ndarray) -> np.ndarray:
    """(8,) shape functions."""
    return np.array([np.prod(1.0 + c * at) / 8.0 for c in CORNERS])


def slopes(at: np.ndarray) -> np.ndarray:
    """(8, 3) derivatives along xi, eta, zeta."""
    out = np.zeros((8, 3))
    for n, c in enumerate(CORNERS):
        for k in range(3):
            a, b = (k + 1) % 3, (k + 2) % 3
            out[n, k] = c[k] * (1.0 + c[a] * at[a]) * (1.0 + c[b] * at[b]) / 8.0
    return out


#: Slopes (points, 8, 3) and weights for ``one_point_force``: the exact mean gradient, or that at the centre.
EXACT = (np.array([slopes(at) for at, _ in gauss(2)]), np.ones(8))
CENTRE = (slopes(np.zeros(3))[None], np.array([8.0]))


def one_point_force(cells, points, u, lame, shear, hourglass, slopes_at, weights, hourglass_at, f):  # type: ignore[no-untyped-def]
    """Add the forces of all elements to f (n, 3): mean gradient, stress, hourglass control, in plain loops."""
    B, J, inverse = np.empty((8, 3)), np.empty((3, 3)), np.empty((3, 3))
    G, stress, gamma = np.empty((3, 3)), np.empty((3, 3)), np.empty(8)
    for e in range(cells.shape[0]):
        B[:, :] = 0.0
        volume = 0.0
        for p in range(weights.size):
            for i in range(3):
                for j in range(3):
                    J[i, j] = 0.0
                    for n in range(8):
                        J[i, j] += points[cells[e, n], i] * slopes_at[p, n, j]
            for i in range(3):  # cofactors: det J times the inverse
                i1, i2 = (i + 1) % 3, (i + 2) % 3
                for j in range(3):
                    j1, j2 = (j + 1) % 3, (j + 2) % 3
                    inverse[j, i] = J[i1, j1] * J[i2, j2] - J[i1, j2] * J[i2, j1]
            determinant = J[0, 0] * inverse[0, 0] + J[0, 1] * inverse[1, 0] + J[0, 2] * inverse[2, 0]
            volume += weights[p] * determinant
            for n in range(8):
                for i in range(3):
                    for j in range(3):
                        B[n, i] += weights[p] * slopes_at[p, n, j] * inverse[j, i]
        squares = 0.0
        for i in range(3):
            for j in range(3):
                G[i, j] = 0.0
                for n in range(8):
                    G[i, j] += u[cells[e, n], i] * B[n, j] / volume
        for n in range(8):
            for i in range(3):
                squares += B[n, i] * B[n, i]
        for i in range(3):
            for j in range(3):
                stress[i, j] = shear * (G[i, j] + G[j, i])
            stress[i, i] += lame * (G[0, 0] + G[1, 1] + G[2, 2])
        for n in range(8):
            for i in range(3):
                for j in range(3):
                    f[cells[e, n], i] += stress[i, j] * B[n, j]
        kappa = hourglass * (lame + 2.0 * shear) * squares / volume
        for a in range(4):
            for n in range(8):
                gamma[n] = hourglass_at[a, n]
            for j in range(3):
                slope = 0.0
                for n in range(8):
                    slope += hourglass_at[a, n] * points[cells[e, n], j] / volume
                for n in range(8):
                    gamma[n] -= slope * B[n, j]
            for i in range(3):
                held = 0.0
                for n in range(8):
                    held += gamma[n] * u[cells[e, n], i]
                for n in range(8):
                    f[cells[e, n], i] += kappa / 8.0 * held * gamma[n]


def strain_columns(gradient: np.ndarray) -> np.ndarray:
    """(6, 3 k) strains of unit displacements of k functions with these gradients (k, 3)."""
    blocks = []
    for x, y, z in gradient:
        blocks.append(np.array([[x, 0, 0], [0, y, 0], [0, 0, z], [y, x, 0], [0, z, y], [z, 0, x]]))
    return np.concatenate(blocks, axis=1)


def element_stiffness(kind: str, corners: np.ndarray, lame: float, shear: float, hourglass: float) -> np.ndarray:
    """(24, 24) stiffness of one element [N/m] of any formulation."""
    D = shear * np.diag([2.0, 2.0, 2.0, 1.0, 1.0, 1.0])  # stress of strain, xx yy zz xy yz zx with angles as shears
    D[:3, :3] += lame
    points = [at for at, _ in gauss(2)]
    jacobians = [corners.T @ slopes(at) for at in points]
    gradients = [slopes(at) @ np.linalg.inv(J) for at, J in zip(points, jacobians, strict=True)]
    parts = [np.linalg.det(J) for J in jacobians]
    volume = sum(parts)
    mean = sum(part * gradient for part, gradient in zip(parts, gradients, strict=True)) / volume
    if kind == "one_point":
        B = strain_columns(mean)
        K = volume * B.T @ D @ B
        gamma = HOURGLASS.T - mean @ (corners.T @ HOURGLASS.T)
        kappa = hourglass * (lame + 2.0 * shear) * np.sum(mean**2) * volume
        return K + kappa / 8.0 * np.kron(gamma @ gamma.T, np.eye(3))
    if kind == "incompatible":
        centre = corners.T @ slopes(np.zeros(3))
        K = np.zeros((33, 33))
        for at, part, gradient in zip(points, parts, gradients, strict=True):
            modes = np.diag(-2.0 * at) @ np.linalg.inv(centre) * np.linalg.det(centre) / part
            B = strain_columns(np.concatenate([gradient, modes]))
            K += part * B.T @ D @ B
        return K[:24, :24] - K[:24, 24:] @ np.linalg.solve(K[24:, 24:], K[24:, :24])
    K = np.zeros((24, 24))
    for part, gradient in zip(parts, gradients, strict=True):
        B = strain_columns(gradient)
        if kind == "mean_dilatation":
            B[:3] += (mean - gradient).ravel() / 3.0
        K += part * B.T @ D @ B
    return K


def element_mass(corners: np.ndarray, density: float) -> np.ndarray:
    """(8, 8) consistent mass of one component [kg]."""
    M = np.zeros((8, 8))
    for at, weight in gauss(3):
        N = values(at)
        M += density * weight * np.linalg.det(corners.T @ slopes(at)) * np.outer(N, N)
    return M


def assembled(cells: np.ndarray, count: int, matrices: list[np.ndarray], components: int) -> np.ndarray:
    """The dense sum of element matrices."""
    K = np.zeros((components * count, components * count))
    for cell, matrix in zip(cells, matrices, strict=True):
        at = (components * cell[:, None] + np.arange(components)).ravel()
        K[np.ix_(at, at)] += matrix
    return K
