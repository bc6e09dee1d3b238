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
    Where nothing pushes a ball along its orbit, the cage carries nothing, whatever its stiffness.  Friction pushes: see ``cage_stiffness``.
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


#: What a ball's cage holds, in the order of its rows.
NAMES = ("along its orbit", "turning about its orbit", "turning about its radius", "turning about the bearing's axis")
#: Stiffness of the cage's springs over that of a Hertz contact: it only has to be there.
SHARE = 0.1
#: With friction: of a motion in which a ball rolls, and of turning in the meridian plane, where it does not.
_ROLLS, _HELD = 1e-3, 100.0


def cage_stiffness(normal: float, diameter: float, friction: bool) -> np.ndarray:
    """(4,) springs [N/m, N m/rad] of a ball's cage, for the rows of ``cage_rows``.

    Parameters
    ----------
    normal : stiffness of a Hertz contact [N/m];  diameter : of the ball [m]

    Notes
    -----
    With friction a cage's stiffness is felt: what pushes a ball that cannot turn slides or sticks.  Balls roll along their orbits,
    hence freely about axes in the meridian plane; about the orbit they do not, as for rigid and condensed bodies.
    """
    turning = 0.1 * diameter**2  # of a sphere: what a spring on every node by its mass holds against turning
    share = np.array([_ROLLS, _HELD, _ROLLS, _ROLLS] if friction else [SHARE] * 4)
    return np.asarray(share * normal * np.array([1.0, turning, turning, turning]))


def cage_rows(points: np.ndarray, mass: np.ndarray, along: np.ndarray) -> np.ndarray:
    """(4, 3 n) of one ball: mass means of the displacement along its orbit, a unit vector, and of the turns in ``NAMES``.

    Notes
    -----
    A rigid motion u = c + w x r about the centre of mass gives c . along and the parts of w; elastic motions that are orthogonal to
    the rigid ones give nothing.
    """
    total = mass.sum()
    arm = points - (mass[:, None] * points).sum(axis=0) / total
    inertia = ((arm**2).sum(axis=1)[:, None, None] * np.eye(3) - arm[:, :, None] * arm[:, None, :]) * mass[:, None, None]
    turn = np.stack([np.cross(np.eye(3)[a], arm) for a in range(3)]) * mass[:, None]
    turn = np.linalg.solve(inertia.sum(axis=0), turn.reshape(3, -1))
    axis = np.array([1.0, 0.0, 0.0])
    about = np.stack([along, np.cross(along, axis), axis])
    return np.vstack([(mass[:, None] / total * along).reshape(1, -1), about @ turn])
