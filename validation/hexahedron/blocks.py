"""Small meshes for the tests of the hexahedron."""

from __future__ import annotations

import numpy as np


def block(
    counts: tuple[int, int, int], sides: tuple[float, float, float] = (1.0, 1.0, 1.0)
) -> tuple[np.ndarray, np.ndarray]:
    """Points and cells of a box, x running fastest."""
    axes = [np.linspace(0.0, side, count + 1) for side, count in zip(sides, counts, strict=True)]
    z, y, x = np.meshgrid(axes[2], axes[1], axes[0], indexing="ij")
    k, j, i = np.meshgrid(*[np.arange(count) for count in counts[::-1]], indexing="ij")
    row, layer = counts[0] + 1, (counts[0] + 1) * (counts[1] + 1)
    n = (k * layer + j * row + i).ravel()
    cells = np.stack([n, n + 1, n + 1 + row, n + row], axis=1)
    return np.stack([x, y, z], axis=-1).reshape(-1, 3), np.concatenate([cells, cells + layer], axis=1)


def on_surface(points: np.ndarray) -> np.ndarray:
    """(n,) Which nodes of an undistorted box lie on its faces."""
    return np.any((points <= points.min(axis=0) + 1e-12) | (points >= points.max(axis=0) - 1e-12), axis=1)


def distorted(
    counts: tuple[int, int, int], share: float = 0.25, seed: int = 0, sides: tuple[float, float, float] = (1.0, 1.0, 1.0)
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A box with every node moved at random by up to ``share`` of an element: points, cells, which nodes are inner ones."""
    points, cells = block(counts, sides)
    inner = ~on_surface(points)
    size = np.array(sides) / np.array(counts)
    return points + np.random.default_rng(seed).uniform(-share, share, points.shape) * size, cells, inner


def warped(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A smoothly distorted unit cube, faces kept: its elements become parallelepipeds only slowly as ``count`` grows."""
    points, cells = block((count, count, count))
    inner = ~on_surface(points)
    bump = np.prod(np.sin(np.pi * points), axis=1)
    return points + bump[:, None] * np.array([0.10, -0.08, 0.06]), cells, inner
