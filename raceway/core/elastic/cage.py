"""An ideal cage: it holds the mean place of a ball along its orbit, and the mean turning of the ball."""

from __future__ import annotations

from typing import TYPE_CHECKING

import attrs
import numpy as np

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


@attrs.frozen(eq=False)
class Cage:
    """Springs on mean motions: energy 1/2 k (L u)^2.

    Attributes
    ----------
    rows : (m, 3 nodes) sparse L: a mean displacement [m], or a mean turn [rad], of one ball
    stiffness : (m,) k [N/m, N m/rad];  names : (m,) words for them
    nodal : (3 nodes,) springs on single displacements that hold the balls' means about as well [N/m]

    Notes
    -----
    Where nothing pushes a ball along its orbit, the cage carries nothing, whatever its stiffness.
    """

    rows: csr_matrix
    stiffness: np.ndarray
    names: tuple[str, ...]
    nodal: np.ndarray

    def force(self, u: np.ndarray) -> np.ndarray:
        """(m,) forces and moments [N, N m]."""
        return np.asarray(self.stiffness * (self.rows @ u))

    def internal(self, u: np.ndarray) -> np.ndarray:
        return np.asarray(self.rows.T @ self.force(u))

    def energy(self, u: np.ndarray) -> float:
        return float(0.5 * self.force(u) @ (self.rows @ u))


def cage_rows(points: np.ndarray, mass: np.ndarray, along: np.ndarray) -> np.ndarray:
    """(4, 3 n) of one ball: mass means of the displacement along a unit vector, and of the turns about x, y, z.

    Notes
    -----
    A rigid motion u = c + w x r about the centre of mass gives c . along and w; elastic motions that are orthogonal to the
    rigid ones give nothing.
    """
    total = mass.sum()
    arm = points - (mass[:, None] * points).sum(axis=0) / total
    inertia = ((arm**2).sum(axis=1)[:, None, None] * np.eye(3) - arm[:, :, None] * arm[:, None, :]) * mass[:, None, None]
    turn = np.stack([np.cross(np.eye(3)[a], arm) for a in range(3)]) * mass[:, None]
    turn = np.linalg.solve(inertia.sum(axis=0), turn.reshape(3, -1))
    return np.vstack([(mass[:, None] / total * along).reshape(1, -1), turn])
