"""Fully integrated hexahedra, written to be read: stiffness, consistent mass, and a few regular meshes."""

from itertools import product

import numpy as np
import scipy.sparse as sp

CORNERS = np.array([(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)])


def matrices(
    points: np.ndarray, cells: np.ndarray, young: float, poisson: float, density: float
) -> tuple[sp.csr_matrix, sp.csr_matrix]:
    """Stiffness [N/m] and consistent mass [kg], (3 n, 3 n), by 2 x 2 x 2 Gauss points."""
    lame = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
    shear = young / (2.0 * (1.0 + poisson))
    elastic = np.zeros((6, 6))
    elastic[:3, :3] = lame
    elastic[range(6), range(6)] += shear * np.array([2, 2, 2, 1, 1, 1])
    k, m = np.zeros((len(cells), 24, 24)), np.zeros((len(cells), 8, 8))
    for place in product((-1.0, 1.0), repeat=3):
        xi = np.array(place) / np.sqrt(3.0)
        factors = 0.5 * (1.0 + CORNERS * xi)
        shape = factors.prod(axis=1)
        slope = np.stack([0.5 * CORNERS[:, a] * np.delete(factors, a, axis=1).prod(axis=1) for a in range(3)], axis=1)
        jacobian = np.einsum("eni,nj->eij", points[cells], slope)
        volume = np.linalg.det(jacobian)
        assert (volume > 0.0).all(), "a cell is inside out"
        gradient = np.einsum("nj,eji->eni", slope, np.linalg.inv(jacobian))
        b = np.zeros((len(cells), 6, 24))
        for a in range(3):
            b[:, a, a::3] = gradient[:, :, a]
            i, j = (a + 1) % 3, (a + 2) % 3
            b[:, 3 + a, i::3], b[:, 3 + a, j::3] = gradient[:, :, j], gradient[:, :, i]
        k += np.matmul(np.swapaxes(b, 1, 2), elastic @ b) * volume[:, None, None]
        m += density * np.outer(shape, shape) * volume[:, None, None]
    rows = (3 * cells[:, :, None] + np.arange(3)).reshape(len(cells), 24)
    size = 3 * len(points)

    def assemble(blocks: np.ndarray, numbers: np.ndarray, count: int) -> sp.csr_matrix:
        i, j = np.broadcast_arrays(numbers[:, :, None], numbers[:, None, :])
        return sp.csr_matrix((blocks.ravel(), (i.ravel(), j.ravel())), shape=(count, count))

    return assemble(k, rows, size), sp.kron(assemble(m, cells, len(points)), sp.eye(3), format="csr")


def grid(counts: tuple[int, int, int], around: bool = False) -> np.ndarray:
    """Cells (m, 8) of a grid whose nodes run fastest along the first direction; ``around`` closes the last one."""
    a, b, c = counts
    i, j, k = (g.ravel() for g in np.meshgrid(np.arange(a), np.arange(b), np.arange(c), indexing="ij"))
    nodes = [
        i + di + (a + 1) * (j + dj + (b + 1) * ((k + dk) % c if around else k + dk))
        for dk in (0, 1)
        for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1))
    ]
    return np.stack(nodes, axis=1)


def block(size: tuple[float, float, float], counts: tuple[int, int, int]) -> tuple[np.ndarray, np.ndarray]:
    """A box with one corner at the origin."""
    axes = [np.linspace(0.0, length, count + 1) for length, count in zip(size, counts, strict=True)]
    z, y, x = np.meshgrid(*axes[::-1], indexing="ij")
    return np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1), grid(counts)


def ring(inner: float, outer: float, width: float, counts: tuple[int, int, int]) -> tuple[np.ndarray, np.ndarray]:
    """A ring around x; counts along x, along the radius, around."""
    x, r = np.linspace(0.0, width, counts[0] + 1), np.linspace(inner, outer, counts[1] + 1)
    angle, r, x = np.meshgrid(np.arange(counts[2]) * 2.0 * np.pi / counts[2], r, x, indexing="ij")
    points = np.stack([x.ravel(), (r * np.cos(angle)).ravel(), (r * np.sin(angle)).ravel()], axis=1)
    return points, grid(counts, around=True)


def ball(radius: float, count: int) -> tuple[np.ndarray, np.ndarray]:
    """A cube of ``count``^3 cells blown up to a sphere: cells get flat towards its edges, which is hard on a solver."""
    points, cells = block((2.0, 2.0, 2.0), (count, count, count))
    points -= 1.0
    largest = np.abs(points).max(axis=1, keepdims=True)
    length = np.maximum(np.linalg.norm(points, axis=1, keepdims=True), 1e-300)
    share = largest**2
    return radius * ((1.0 - share) * 0.6 * points + share * points * largest / length), cells
