"""All bodies seen from the nodes of their contacts: displacements there from forces there.

A ball answers for itself: its contacts' nodes, and the mean motions that its cage and the springs of its superelement act on.  The
rings answer for all contacts at once.
"""

from __future__ import annotations

import attrs
import numpy as np

from raceway.core.elastic.superelements.balls import Balls
from raceway.core.elastic.superelements.loose import gather_turned
from raceway.core.elastic.superelements.ring_flexibility import RingFlexibility
from raceway.core.elastic.superelements.rings import Ring


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
        self._known: RingFlexibility | None = None
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
            along = ring.carried @ frame[: ring.carried.shape[1]]
            out[rows] = ring.respond(forces.nodes[rows]) + along.reshape(-1, 3)
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

    def springs(self, ball: int, touching: bool) -> np.ndarray:
        """(e,) on a ball's mean motions."""
        group = self._balls[ball][0]
        return group.springs if touching else group.alone

    def of_ball(self, ball: int, nodes: np.ndarray) -> np.ndarray:
        """(3 m + e, 3 m + e) flexibility of some nodes (m,) and the mean motions of a ball where it lies."""
        group, copy, begin = self._balls[ball]
        places, turn = unknowns(nodes - begin), group.loose.part.copies.turns[copy]
        size, none = len(places), np.zeros(len(nodes), dtype=np.int64)
        inner = np.empty((size, size))
        gather_turned(group.flexibility[None], turn[None], none, nodes - begin, inner)
        beside = (turn @ group.flexibility[places, group.size :].reshape(-1, 3, self.extra)).reshape(size, self.extra)
        return np.block([[inner, beside], [beside.T, group.flexibility[group.size :, group.size :]]])

    def of_rings(self, nodes: np.ndarray) -> RingFlexibility:
        """Of some of the rings' nodes (k,), ``nodes`` (m,) among them.

        Notes
        -----
        Contacts move little from iteration to iteration: what was asked for before stays, up to twice of what is asked.
        """
        known = np.union1d(self._known.nodes, nodes) if self._known else nodes
        if len(known) > 2 * len(nodes):
            known = nodes
        if self._known is None or not np.array_equal(known, self._known.nodes):
            self._known = self._among(known)
        return self._known

    def _among(self, nodes: np.ndarray) -> RingFlexibility:
        carried = np.zeros((3 * len(nodes), self.frame_size))
        blocks, ends = [], 3 * np.searchsorted(nodes, self._first)
        for k, ring in enumerate(self.rings):
            rows = slice(int(ends[k]), int(ends[k + 1]))
            own = nodes[rows.start // 3 : rows.stop // 3] - self._first[k]
            blocks.append((rows, ring.element.among(own)))
            carried[rows, : ring.carried.shape[1]] = ring.carried[unknowns(own)]
        return RingFlexibility(nodes, blocks, carried)


def unknowns(nodes: np.ndarray) -> np.ndarray:
    """(3 m,) of nodes (m,)."""
    return np.asarray((3 * nodes[:, None] + np.arange(3)).ravel())
