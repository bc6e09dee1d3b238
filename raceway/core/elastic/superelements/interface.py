"""All bodies seen from the nodes of their contacts: displacements there from forces there, and linearised steps.

A ball answers for itself: its contacts' nodes, and the mean motions that its cage and the springs of its superelement act on.  The
rings answer for all contacts at once.  So a linearised step eliminates the balls one by one and solves for the rings' nodes in
contact and the frame.
"""

from __future__ import annotations

import attrs
import numpy as np

from raceway.core.elastic.superelements.balls import Balls
from raceway.core.elastic.superelements.loose import turned
from raceway.core.elastic.superelements.rings import Ring
from raceway.core.elastic.superelements.tangent import BallTangent


@attrs.frozen(eq=False)
class Motions:
    """Displacements, or forces, at what bodies are seen from.

    Attributes
    ----------
    nodes : (n, 3) the contacts' nodes of all bodies
    balls : (Z, e) mean motions of the balls
    frame : (m,) motions of the frame
    """

    nodes: np.ndarray
    balls: np.ndarray
    frame: np.ndarray

    def plus(self, part: float, other: Motions) -> Motions:
        """Self + part * other."""
        return Motions(self.nodes + part * other.nodes, self.balls + part * other.balls, self.frame + part * other.frame)


class Interface:
    """Superelements of all bodies of a bearing.

    Parameters
    ----------
    rings : the inner ring, with the frame, and the outer one
    balls : groups of equal balls, each with the numbers of its balls
    nodes : of the assembly

    Attributes
    ----------
    numbers : (n,) of the contacts' nodes in the assembly;  place : (nodes,) the way back, -1 elsewhere
    """

    def __init__(self, rings: list[Ring], balls: list[tuple[Balls, list[int]]], nodes: int) -> None:
        self.rings, self.groups = rings, balls
        self.numbers = np.concatenate([ring.nodes for ring in rings] + [group.loose.nodes.ravel() for group, _ in balls])
        self.place = np.full(nodes, -1, dtype=np.int64)
        self.place[self.numbers] = np.arange(len(self.numbers))
        self.frame_size = max(ring.carried.shape[1] for ring in rings)
        self.extra = len(balls[0][0].springs)
        self._first = np.cumsum([0, *(len(ring.nodes) for ring in rings)])
        self._balls: dict[int, tuple[Balls, int, int]] = {}
        begin = int(self._first[-1])
        for group, members in balls:
            for copy, ball in enumerate(members):
                self._balls[ball] = group, copy, begin
                begin += group.size // 3

    @property
    def ball_count(self) -> int:
        return len(self._balls)

    def moved(self, forces: Motions, frame: np.ndarray) -> Motions:
        """Motions under forces on contacts' nodes and balls, and motions (m,) of the frame."""
        out, balls = np.empty_like(forces.nodes), np.empty_like(forces.balls)
        for k, ring in enumerate(self.rings):
            rows = slice(self._first[k], self._first[k + 1])
            found = ring.flexibility @ forces.nodes[rows].ravel() + ring.carried @ frame[: ring.carried.shape[1]]
            out[rows] = found.reshape(-1, 3)
        begin = int(self._first[-1])
        for group, members in self.groups:
            rows = slice(begin, begin + len(members) * group.size // 3)
            begin = rows.stop
            loads = group.loose.to_first(forces.nodes[rows].reshape(len(members), -1))
            found = np.concatenate([loads, forces.balls[members]], axis=1) @ group.flexibility
            out[rows] = group.loose.to_copies(found[:, : group.size]).reshape(-1, 3)
            balls[members] = found[:, group.size :]
        return Motions(out, balls, frame)

    def on_frame(self, force: np.ndarray) -> np.ndarray:
        """(m,) what forces (n, 3) on contacts' nodes are on the frame."""
        out = np.zeros(self.frame_size)
        for k, ring in enumerate(self.rings):
            out[: ring.carried.shape[1]] += ring.carried.T @ force[self._first[k] : self._first[k + 1]].ravel()
        return out

    def linearised(
        self, driver: Motions, tangents: dict[int, BallTangent], frame: np.ndarray, unknown: np.ndarray
    ) -> tuple[Motions, np.ndarray]:
        """Forces of the contacts' tangents, and motions of the frame, for x = driver - flexibility (T x) + carried q.

        Parameters
        ----------
        driver : ``nodes`` and ``balls`` are motions, ``frame`` is a force (m,) on the frame
        tangents : of each ball;  frame : (m, m) matrix of the frame;  unknown : (m,) bool, motions that are not held

        Returns
        -------
        force, frame : Motions T x, of which ``frame`` is what it is on the frame, and q (m,)
        """
        used = [one.rings for one in tangents.values()]
        nodes = np.unique(np.concatenate(used)) if used else np.zeros(0, dtype=np.int64)
        size, m = 3 * len(nodes), self.frame_size
        whole, rest = np.zeros((size, size)), np.zeros(size)
        solved = {}
        for k, one in tangents.items():
            places = _unknowns(np.searchsorted(nodes, one.rings))
            solved[k] = self._eliminated(k, one, driver)
            whole[np.ix_(places, places)] += solved[k][2]
            rest[places] += solved[k][3]
        flexibility, carried = self._of_rings(nodes)
        matrix = np.zeros((size + m, size + m))
        matrix[:size, :size] = flexibility @ whole
        matrix[np.arange(size), np.arange(size)] += 1.0
        matrix[:size, size:] = -carried
        matrix[size:, :size] = carried.T @ whole
        matrix[size:, size:] = frame
        right = np.concatenate([driver.nodes[nodes].ravel() - flexibility @ rest, driver.frame - carried.T @ rest])
        held = size + np.flatnonzero(~unknown)
        matrix[held] = 0.0
        matrix[held, held], right[held] = 1.0, 0.0
        found = np.linalg.solve(matrix, right)
        force, balls = np.zeros_like(driver.nodes), np.zeros_like(driver.balls)
        for k, one in tangents.items():
            at_rings = found[_unknowns(np.searchsorted(nodes, one.rings))]
            at_ball = solved[k][0] - solved[k][1] @ at_rings
            cut = 3 * len(one.ball)
            pressed = one.matrix @ np.concatenate([at_ball[:cut], at_rings])
            force[one.ball] += pressed[:cut].reshape(-1, 3)
            force[one.rings] += pressed[cut:].reshape(-1, 3)
            balls[k] = self._springs(k, one) * at_ball[cut:]
        return Motions(force, balls, self.on_frame(force)), found[size:]

    def _eliminated(self, ball: int, one: BallTangent, driver: Motions) -> tuple[np.ndarray, ...]:
        """x_b = b - X x_r of a ball's nodes and mean motions, and the force E x_r + e on the rings' nodes: b, X, E, e."""
        from scipy.linalg import lu_factor, lu_solve

        group, copy, begin = self._balls[ball]
        cut = 3 * len(one.ball)
        flexibility = self._of_ball(group, copy, _unknowns(one.ball - begin))
        own = np.zeros((len(flexibility), len(flexibility)))
        own[:cut, :cut] = one.matrix[:cut, :cut]
        own[np.arange(cut, len(own)), np.arange(cut, len(own))] = self._springs(ball, one)
        system = flexibility @ own
        system[np.arange(len(own)), np.arange(len(own))] += 1.0
        right = np.concatenate([driver.nodes[one.ball].ravel(), driver.balls[ball]])
        columns = np.column_stack([right, flexibility[:, :cut] @ one.matrix[:cut, cut:]])
        found = lu_solve(lu_factor(system, check_finite=False), columns, check_finite=False)
        across = one.matrix[cut:, :cut]
        stiffness = one.matrix[cut:, cut:] - across @ found[:cut, 1:]
        return found[:, 0], found[:, 1:], stiffness, across @ found[:cut, 0]

    def _springs(self, ball: int, one: BallTangent) -> np.ndarray:
        """(e,) on mean motions."""
        group = self._balls[ball][0]
        return group.springs if len(one.ball) else group.alone

    def _of_ball(self, group: Balls, copy: int, places: np.ndarray) -> np.ndarray:
        """Flexibility of some nodes and the mean motions of a ball where it lies."""
        turn, size = group.loose.part.copies.turns[copy], len(places)
        chosen = np.concatenate([places, np.arange(group.size, len(group.flexibility))])
        out = group.flexibility[np.ix_(chosen, chosen)]
        out[:size, :size] = turned(out[:size, :size], turn)
        out[:size, size:] = (turn @ out[:size, size:].reshape(-1, 3, self.extra)).reshape(size, self.extra)
        out[size:, :size] = out[:size, size:].T
        return out

    def _of_rings(self, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Flexibility of some of the rings' nodes, and their motion with the frame."""
        size = 3 * len(nodes)
        flexibility, carried = np.zeros((size, size)), np.zeros((size, self.frame_size))
        for k, ring in enumerate(self.rings):
            chosen = np.flatnonzero((nodes >= self._first[k]) & (nodes < self._first[k + 1]))
            places, rows = _unknowns(nodes[chosen] - self._first[k]), _unknowns(chosen)
            flexibility[np.ix_(rows, rows)] = ring.flexibility[np.ix_(places, places)]
            carried[rows, : ring.carried.shape[1]] = ring.carried[places]
        return flexibility, carried


def _unknowns(nodes: np.ndarray) -> np.ndarray:
    return np.asarray((3 * nodes[:, None] + np.arange(3)).ravel())
