"""Rigid motions of a body: near-nullspace of its stiffness, and what supports leave free."""

from __future__ import annotations

import numpy as np

#: Columns of ``rigid_motions``.
MOTIONS = (
    "translation along x",
    "translation along y",
    "translation along z",
    "rotation about x",
    "rotation about y",
    "rotation about z",
)
#: Squared singular values below this part of the largest are zero: a support over 1e-4 of a body is no support, rounding 1e-16.
_RANK = 1e-8


def rigid_motions(points: np.ndarray, centre: np.ndarray | None = None) -> np.ndarray:
    """Three translations and three rotations about the centre, all of size one.

    Parameters
    ----------
    points : (n, 3) float [m]
    centre : (3,) float [m]; mean of the points when None

    Returns
    -------
    (3 n, 6) float : rotations divided by the largest distance from the centre
    """
    arm = points - (points.mean(axis=0) if centre is None else centre)
    largest = float(np.abs(arm).max()) if len(arm) else 1.0
    arm = arm / (largest or 1.0)
    motions = np.zeros((len(points), 3, 6))
    for axis in range(3):
        motions[:, axis, axis] = 1.0
        motions[:, :, 3 + axis] = np.cross(np.eye(3)[axis], arm)
    return motions.reshape(-1, 6)


def free_motions(points: np.ndarray, held: np.ndarray) -> list[int]:
    """Indices into ``MOTIONS`` of what the supports leave free; rotations are those about the middle of the held points.

    Parameters
    ----------
    points : (n, 3) float [m]
    held : (n, 3) bool
    """
    somewhere = held.any(axis=1)
    centre = points[somewhere].mean(axis=0) if somewhere.any() else None
    rows = rigid_motions(points, centre)[held.reshape(-1)]
    if not len(rows):
        return list(range(6))
    _, sizes, directions = np.linalg.svd(rows.T @ rows)  # 6 x 6; its values are squares of the singular values
    loose = directions[sizes <= _RANK * sizes[0]]
    share = (loose**2).sum(axis=0)
    return [i for i in range(6) if share[i] > 0.1]
