"""Elimination written to be read: the whole matrix, dense, and nothing saved."""

from __future__ import annotations

import numpy as np


def assembled(operator, mass: float = 0.0) -> np.ndarray:
    """(3 n, 3 n) K + mass * M of a mesh."""
    return operator.stiffness().toarray() + mass * np.diag(np.repeat(operator.lumped_mass(), 3))


def schur(matrix: np.ndarray, kept: np.ndarray, inner: np.ndarray) -> np.ndarray:
    """A_kk - A_ki A_ii^-1 A_ik: what forces on the kept unknowns find with none on the inner ones."""
    return matrix[np.ix_(kept, kept)] - matrix[np.ix_(kept, inner)] @ np.linalg.solve(
        matrix[np.ix_(inner, inner)], matrix[np.ix_(inner, kept)]
    )


def unknowns(nodes: np.ndarray) -> np.ndarray:
    return (3 * np.asarray(nodes)[:, None] + np.arange(3)).ravel()
