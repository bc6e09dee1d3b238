"""Bodies and the tangents of their contacts: forces of the tangents for every driver.

The balls are eliminated one by one; what is left are the rings' nodes in contact and the frame.  Small systems are factored.
Large ones are solved by GMRES, preconditioned with what each ball's contacts are without the other balls': what couples them,
the rings' stiffness from ball to ball and the frame, is smooth and has few modes.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from raceway.core.elastic.superelements.interface import Interface, Motions, unknowns
from raceway.core.elastic.superelements.tangent import BallTangent
from raceway.errors import ConvergenceError

#: Unknowns up to which one factorisation costs less than iterations.
_FACTORED = 900
#: Vectors that GMRES keeps.
_VECTORS = 120
#: Relative error of solutions unless asked for less.
TIGHT = 1e-12


class Linearised:
    """x = driver - flexibility (T x) + carried q, with the tangents T of the contacts.

    Parameters
    ----------
    face : Interface
    tangents : of each ball;  frame : (m, m) matrix of the frame;  unknown : (m,) bool, motions that are not held
    """

    def __init__(self, face: Interface, tangents: dict[int, BallTangent], frame: np.ndarray, unknown: np.ndarray) -> None:
        self._face, self._tangents, self._frame, self._unknown = face, tangents, frame, unknown
        used = [one.rings for one in tangents.values()]
        nodes = np.unique(np.concatenate(used)) if used else np.zeros(0, dtype=np.int64)
        self._rings = face.of_rings(nodes)
        self._nodes, self._carried = self._rings.nodes, self._rings.carried
        self._size = 3 * len(self._nodes)
        self._balls = {k: _Ball(face, k, one) for k, one in tangents.items()}
        self._places = {k: unknowns(np.searchsorted(self._nodes, one.rings)) for k, one in tangents.items()}
        shared = sum(map(len, used)) > len(nodes)
        self._inverse = self._factored() if shared or self._size <= _FACTORED else self._iterated()

    def forces(self, driver: Motions, tolerance: float = TIGHT) -> tuple[Motions, np.ndarray]:
        """T x, of which ``frame`` is what it is on the frame, and motions (m,) of the frame.

        Parameters
        ----------
        driver : ``nodes`` and ``balls`` are motions, ``frame`` is a force (m,) on the frame
        """
        face = self._face
        rest, own = np.zeros(self._size), {}
        for k, one in self._tangents.items():
            own[k] = self._balls[k].alone(driver.nodes[one.ball], driver.balls[k])
            rest[self._places[k]] += self._balls[k].across @ own[k][: 3 * len(one.ball)]
        right = driver.nodes[self._nodes].ravel() - self._rings.times(rest)
        on_frame = np.where(self._unknown, driver.frame - self._carried.T @ rest, 0.0)
        found = self._inverse(np.concatenate([right, on_frame]), tolerance)
        force, balls = np.zeros_like(driver.nodes), np.zeros_like(driver.balls)
        for k, one in self._tangents.items():
            at_rings = found[self._places[k]]
            at_ball = own[k] - self._balls[k].follows @ at_rings
            cut = 3 * len(one.ball)
            pressed = one.matrix @ np.concatenate([at_ball[:cut], at_rings])
            force[one.ball] += pressed[:cut].reshape(-1, 3)
            force[one.rings] += pressed[cut:].reshape(-1, 3)
            balls[k] = face.springs(k, len(one.ball) > 0) * at_ball[cut:]
        return Motions(force, balls, face.on_frame(force)), np.where(self._unknown, found[self._size :], 0.0)

    def _factored(self) -> Callable[[np.ndarray, float], np.ndarray]:
        from scipy.linalg import lu_factor, lu_solve

        size, m = self._size, len(self._frame)
        matrix = np.zeros((size + m, size + m), order="F")
        matrix[np.arange(size), np.arange(size)] = 1.0
        for k, places in self._places.items():
            stiffness = self._balls[k].stiffness
            matrix[:size, places] += self._rings.under(places, stiffness)
            matrix[size:, places] += self._carried[places].T @ stiffness
        matrix[:size, size:], matrix[size:, size:] = -self._carried, self._frame
        held = size + np.flatnonzero(~self._unknown)
        matrix[held] = 0.0
        matrix[held, held] = 1.0
        factors = lu_factor(matrix, overwrite_a=True, check_finite=False)
        return lambda right, tolerance: np.asarray(lu_solve(factors, right, check_finite=False))

    def _iterated(self) -> Callable[[np.ndarray, float], np.ndarray]:
        from scipy.linalg import lu_factor, lu_solve
        from scipy.sparse.linalg import LinearOperator, gmres

        size, m, carried, frame_stiffness, unknown = self._size, len(self._frame), self._carried, self._frame, self._unknown
        # What is kept below knows the arrays and not this object, which would know it: all iterations' would stay in memory.
        rings, balls, at = self._rings, self._balls, self._places
        factors = {}
        for k, places in at.items():
            own = rings.among(places, balls[k].stiffness)
            own[np.arange(len(own)), np.arange(len(own))] += 1.0
            factors[k] = lu_factor(own, overwrite_a=True, check_finite=False)

        def pressed(moved: np.ndarray) -> np.ndarray:
            out = np.zeros_like(moved)
            for k, places in at.items():
                out[places] = balls[k].stiffness @ moved[places]
            return out

        def apart(right: np.ndarray) -> np.ndarray:
            out = right.copy()
            for k, places in at.items():
                out[places] = lu_solve(factors[k], right[places], check_finite=False)
            return out

        along = apart(carried)
        small = np.where(unknown[:, None], frame_stiffness + carried.T @ pressed(along), np.eye(m))

        def preconditioned(right: np.ndarray) -> np.ndarray:
            moved = apart(right[:size])
            rest = right[size:] - np.where(unknown, carried.T @ pressed(moved), 0.0)
            frame = np.linalg.solve(small, rest)
            return np.concatenate([moved + along @ frame, frame])

        def applied(moved: np.ndarray) -> np.ndarray:
            moved = moved.ravel()
            force, frame = pressed(moved[:size]), moved[size:]
            on_frame = np.where(unknown, carried.T @ force + frame_stiffness @ frame, frame)
            out = moved[:size] + rings.times(force) - carried @ frame
            return preconditioned(np.concatenate([out, on_frame]))

        operator = LinearOperator((size + m, size + m), matvec=applied, dtype=float)

        def inverse(right: np.ndarray, tolerance: float) -> np.ndarray:
            found, fault = gmres(operator, preconditioned(right), rtol=tolerance, restart=_VECTORS, maxiter=3)
            if fault or not np.isfinite(found).all():
                raise ConvergenceError("the contacts' linear equations have no solution: something is held by nothing")
            return np.asarray(found)

        return inverse


class _Ball:
    """A ball between the rings, x_b = b - X x_r of its nodes and mean motions: X ``follows``, b ``alone``.

    Attributes
    ----------
    stiffness : of the rings' nodes through the ball;  across : force on them of the ball's nodes
    """

    def __init__(self, face: Interface, ball: int, one: BallTangent) -> None:
        from scipy.linalg import lu_factor, lu_solve
        from scipy.sparse import csr_array

        cut = 3 * len(one.ball)
        flexibility = face.of_ball(ball, one.ball)
        sparse = csr_array(one.matrix[:cut])  # a point couples eight nodes
        pressed = (
            sparse.T @ flexibility[:cut]
        ).T  # flexibility, which is symmetric, times stiffness, which is not with friction
        system = np.empty_like(flexibility, order="F")
        system[:, :cut] = pressed[:, :cut]
        system[:, cut:] = flexibility[:, cut:] * face.springs(ball, cut > 0)
        system[np.arange(len(system)), np.arange(len(system))] += 1.0
        self._factors = lu_factor(system, overwrite_a=True, check_finite=False)
        self.across = csr_array(one.matrix[cut:, :cut])
        self.follows = lu_solve(self._factors, np.asfortranarray(pressed[:, cut:]), overwrite_b=True, check_finite=False)
        self.stiffness = one.matrix[cut:, cut:] - self.across @ self.follows[:cut]

    def alone(self, nodes: np.ndarray, motions: np.ndarray) -> np.ndarray:
        from scipy.linalg import lu_solve

        return np.asarray(lu_solve(self._factors, np.concatenate([nodes.ravel(), motions]), check_finite=False))
