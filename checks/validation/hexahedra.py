"""Distorted boxes of hexahedra, and a manufactured solution with the elements' errors from it."""

import numpy as np
from scipy.sparse import diags_array
from scipy.sparse.linalg import cg

from checks.validation.reference.elastic import block
from checks.validation.reference.hexahedron import gauss, slopes, values
from raceway.extend import HexOperator

DIRECTION = np.array([1.0, -0.5, 0.7])


def distorted(
    counts: tuple[int, int, int], share: float = 0.25, seed: int = 0, sides: tuple[float, float, float] = (1.0, 1.0, 1.0)
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A box with every node moved at random by up to ``share`` of an element: points, cells, which nodes are inner ones."""
    points, cells = block(sides, counts)
    inner = np.all((points > 1e-12) & (points < np.array(sides) - 1e-12), axis=1)
    size = np.array(sides) / np.array(counts)
    return points + np.random.default_rng(seed).uniform(-share, share, points.shape) * size, cells, inner


def warped(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A smoothly distorted unit cube, faces kept: its elements become parallelepipeds only slowly as ``count`` grows."""
    points, cells = block((1.0, 1.0, 1.0), (count, count, count))
    inner = np.all((points > 1e-12) & (points < 1.0 - 1e-12), axis=1)
    bump = np.prod(np.sin(np.pi * points), axis=1)
    return points + bump[:, None] * np.array([0.10, -0.08, 0.06]), cells, inner


def _field(x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A bubble c sin(pi x) sin(pi y) sin(pi z): values, gradients, second derivatives of the scalar."""
    s, c = np.sin(np.pi * x), np.cos(np.pi * x)
    gradient = np.stack([np.pi * c[..., k] * s[..., k - 1] * s[..., k - 2] for k in range(3)], axis=-1)
    second = np.empty((*x.shape, 3))
    for i in range(3):
        for j in range(3):
            k = 3 - i - j
            second[..., i, j] = -(np.pi**2) * s.prod(axis=-1) if i == j else np.pi**2 * c[..., i] * c[..., j] * s[..., k]
    return s.prod(axis=-1), gradient, second


def errors(kind: str, count: int, poisson: float = 0.3) -> np.ndarray:
    """Errors in L2 and in the H1 seminorm, relative to the field's own."""
    points, cells, inner = warped(count)
    op = HexOperator(points, cells, 1.0, poisson, 1.0, kind)
    lame, shear = op.moduli[:2]
    at_points, corners, load = [], points[cells], np.zeros_like(points)
    for at, weight in gauss(3):
        N, J = values(at), np.einsum("eni,nj->eij", corners, slopes(at))
        x, volume = np.einsum("n,eni->ei", N, corners), weight * np.linalg.det(J)
        _, _, second = _field(x)
        trace = np.trace(second, axis1=1, axis2=2)
        body = -(lame + shear) * second @ DIRECTION - shear * trace[:, None] * DIRECTION
        np.add.at(load, cells, volume[:, None, None] * N[None, :, None] * body[:, None, :])
        at_points.append((N, slopes(at) @ np.linalg.inv(J), volume, x))
    free = np.repeat(inner, 3)
    K = op.stiffness()[free][:, free]
    u = np.zeros(points.size)
    u[free], info = cg(K, load.ravel()[free], rtol=1e-9, M=diags_array(1.0 / K.diagonal()))
    assert info == 0
    nodal, sums = u.reshape(-1, 3)[cells], np.zeros(4)
    for N, gradients, volume, x in at_points:
        value, slope, _ = _field(x)
        exact, exact_slope = value[:, None] * DIRECTION, DIRECTION[None, :, None] * slope[:, None, :]
        off = np.einsum("n,eni->ei", N, nodal) - exact
        off_slope = np.einsum("eni,enj->eij", nodal, gradients) - exact_slope
        sums += [np.sum(volume @ part.reshape(len(cells), -1) ** 2) for part in (off, off_slope, exact, exact_slope)]
    return np.sqrt(sums[:2] / sums[2:])
