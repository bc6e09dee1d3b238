"""Contacts' tangents between superelements: small dense matrices, one for each ball, and one of the rings."""

from __future__ import annotations

import attrs
import numpy as np
from numba import int64, void

from raceway.core.jit import jit
from raceway.core.signatures import CUBE, MATRIX


@jit(void(int64[:, ::1], MATRIX, CUBE, MATRIX))
def add_points(places, weights, blocks, matrix):  # type: ignore[no-untyped-def]
    """Add B^T D B of points to a matrix (3 k, 3 k).

    Parameters
    ----------
    places : (n, 8) nodes in the matrix;  weights : (n, 8) by which a point moves with them
    blocks : (n, 3, 3) D
    """
    for i in range(places.shape[0]):
        for a in range(8):
            for b in range(8):
                w = weights[i, a] * weights[i, b]
                if w != 0.0:
                    row, column = 3 * places[i, a], 3 * places[i, b]
                    for c in range(3):
                        for d in range(3):
                            matrix[row + c, column + d] += w * blocks[i, c, d]


@attrs.frozen(eq=False)
class BallTangent:
    """Tangent of the contacts of one ball with both rings.

    Attributes
    ----------
    ball, rings : (a,), (b,) numbers of the nodes that points in contact lie on
    matrix : (3 (a + b), 3 (a + b)) of both, those of the ball first [N/m]
    """

    ball: np.ndarray
    rings: np.ndarray
    matrix: np.ndarray

    @classmethod
    def of(cls, nodes: np.ndarray, weights: np.ndarray, blocks: np.ndarray) -> BallTangent:
        """From points: ``nodes`` (n, 8), four of the ball, then four of a ring, ``weights`` (n, 8), ``blocks`` (n, 3, 3)."""
        ball, rings = np.unique(nodes[:, :4]), np.unique(nodes[:, 4:])
        places = [np.searchsorted(ball, nodes[:, :4]), len(ball) + np.searchsorted(rings, nodes[:, 4:])]
        matrix = np.zeros((3 * (len(ball) + len(rings)),) * 2)
        add_points(np.concatenate(places, axis=1), np.ascontiguousarray(weights), np.ascontiguousarray(blocks), matrix)
        return cls(ball, rings, matrix)
