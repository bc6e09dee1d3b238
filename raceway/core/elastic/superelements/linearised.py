"""Bodies and the tangents of their contacts: one factorisation, then forces for every driver.

The balls are eliminated one by one; what is left are the rings' nodes in contact and the frame.
"""

from __future__ import annotations

import numpy as np

from raceway.core.elastic.superelements.interface import Interface, Motions, unknowns
from raceway.core.elastic.superelements.tangent import BallTangent


class Linearised:
    """x = driver - flexibility (T x) + carried q, with the tangents T of the contacts.

    Parameters
    ----------
    face : Interface
    tangents : of each ball;  frame : (m, m) matrix of the frame;  unknown : (m,) bool, motions that are not held
    """

    def __init__(
        self, face: Interface, tangents: dict[int, BallTangent], frame: np.ndarray, unknown: np.ndarray
    ) -> None:
        from scipy.linalg import lu_factor

        self._face, self._tangents = face, tangents
        used = [one.rings for one in tangents.values()]
        self._nodes = np.unique(np.concatenate(used)) if used else np.zeros(0, dtype=np.int64)
        size, m = 3 * len(self._nodes), face.frame_size
        flexibility, self._carried = face.of_rings(self._nodes)
        matrix = np.zeros((size + m, size + m), order="F")
        matrix[np.arange(size), np.arange(size)] = 1.0
        self._balls, self._places = {}, {}
        for k, one in tangents.items():
            places = self._places[k] = unknowns(np.searchsorted(self._nodes, one.rings))
            self._balls[k] = _Ball(face, k, one)
            stiffness = self._balls[k].stiffness
            matrix[:size, places] += flexibility[:, places] @ stiffness
            matrix[size:, places] += self._carried[places].T @ stiffness
        matrix[:size, size:] = -self._carried
        matrix[size:, size:] = frame
        self._held = size + np.flatnonzero(~unknown)
        matrix[self._held] = 0.0
        matrix[self._held, self._held] = 1.0
        self._flexibility = flexibility
        self._factors = lu_factor(matrix, overwrite_a=True, check_finite=False)

    def forces(self, driver: Motions) -> tuple[Motions, np.ndarray]:
        """T x, of which ``frame`` is what it is on the frame, and motions (m,) of the frame.

        Parameters
        ----------
        driver : ``nodes`` and ``balls`` are motions, ``frame`` is a force (m,) on the frame
        """
        from scipy.linalg import lu_solve

        face, size = self._face, 3 * len(self._nodes)
        rest, own = np.zeros(size), {}
        for k, one in self._tangents.items():
            own[k] = self._balls[k].alone(driver.nodes[one.ball], driver.balls[k])
            rest[self._places[k]] += self._balls[k].across @ own[k][: 3 * len(one.ball)]
        right = np.concatenate(
            [driver.nodes[self._nodes].ravel() - self._flexibility @ rest, driver.frame - self._carried.T @ rest]
        )
        right[self._held] = 0.0
        found = lu_solve(self._factors, right, check_finite=False)
        force, balls = np.zeros_like(driver.nodes), np.zeros_like(driver.balls)
        for k, one in self._tangents.items():
            at_rings = found[self._places[k]]
            at_ball = own[k] - self._balls[k].follows @ at_rings
            cut = 3 * len(one.ball)
            pressed = one.matrix @ np.concatenate([at_ball[:cut], at_rings])
            force[one.ball] += pressed[:cut].reshape(-1, 3)
            force[one.rings] += pressed[cut:].reshape(-1, 3)
            balls[k] = face.springs(k, len(one.ball) > 0) * at_ball[cut:]
        return Motions(force, balls, face.on_frame(force)), found[size:]


class _Ball:
    """A ball between the rings, x_b = b - X x_r of its nodes and mean motions: X ``follows``, b ``alone``.

    Attributes
    ----------
    stiffness : of the rings' nodes through the ball;  across : force on them of the ball's nodes
    """

    def __init__(self, face: Interface, ball: int, one: BallTangent) -> None:
        from scipy.linalg import lu_factor, lu_solve

        cut = 3 * len(one.ball)
        flexibility = face.of_ball(ball, one.ball)
        own = np.zeros((len(flexibility), len(flexibility)))
        own[:cut, :cut] = one.matrix[:cut, :cut]
        own[np.arange(cut, len(own)), np.arange(cut, len(own))] = face.springs(ball, cut > 0)
        system = flexibility @ own
        system[np.arange(len(own)), np.arange(len(own))] += 1.0
        self._factors = lu_factor(system, check_finite=False)
        self.across = one.matrix[cut:, :cut]
        self.follows = lu_solve(self._factors, flexibility[:, :cut] @ one.matrix[:cut, cut:], check_finite=False)
        self.stiffness = one.matrix[cut:, cut:] - self.across @ self.follows[:cut]

    def alone(self, nodes: np.ndarray, motions: np.ndarray) -> np.ndarray:
        from scipy.linalg import lu_solve

        return np.asarray(lu_solve(self._factors, np.concatenate([nodes.ravel(), motions]), check_finite=False))
