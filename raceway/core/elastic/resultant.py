"""Whole contacts on a mesh: one force each, by a law whose compliance replaces that of the mesh below it."""

from __future__ import annotations

from typing import Any

import attrs
import numpy as np

from raceway.core.elastic.contact import Contact
from raceway.core.elastic.footprint import Footprint
from raceway.errors import ConvergenceError

#: Newton's iterations of the law with the mesh's compliance, their tolerance over the deepest gap, and what has to be left of
#: the law's own compliance.
_ITERATIONS, _TOLERANCE, _LEFT = 60, 1e-12, 0.02


@attrs.frozen(eq=False)
class Touch:
    """One ball on one race.

    Attributes
    ----------
    name : str
    ball, race : Footprint; node numbers are the assembly's
    centre : (3,) of the ball [m]
    surface : (8,) on which that centre lies at a gap of zero (``raceway.core.elastic.gap``): the groove, its tube smaller by the ball
    local : compliance of both meshes that the law's replaces [m/N];  spread : how well they know it [m/N]
    size : length of an element [m]
    """

    name: str
    ball: Footprint
    race: Footprint
    centre: np.ndarray
    surface: np.ndarray
    local: float
    spread: float
    size: float


class ResultantContact(Contact):
    """All balls on all races of an assembly.

    Parameters
    ----------
    touches : list of Touch
    nodes : int, of the assembly
    law, params, state_size, damping : see ``Contact``

    Notes
    -----
    The centres of ball and groove approach by -g, the law's own approach by -h: h = g - m Q(h) with the compliance m of the
    meshes below the contact, which Q compresses already.  From dQ = (dg - m dQ) dQ/dh follows dQ/dg = Q' / (1 + m Q'),
    stiffer than the law's Q' = dQ/dh < 0.  A law that is told the rate of the gap is told that of g.
    """

    whole = True

    def __init__(
        self, touches: list[Touch], nodes: int, law: Any, params: np.ndarray, state_size: int = 0, damping: float = 0.0
    ) -> None:
        self.touches = touches
        place, surfaces = np.array([t.centre for t in touches]), np.array([t.surface for t in touches])
        one = np.ones(len(touches))
        super().__init__(place, one, one.astype(int), surfaces, law, params, state_size, damping)
        self.local = np.array([t.local for t in touches])
        self._carried = np.zeros(len(touches))
        self.move, self._reach = _moves(touches, nodes)

    def nodes_of(self, pair: int) -> tuple[int, int]:
        one = self.touches[pair]
        return int(one.ball.nodes[0]), int(one.race.nodes[0])

    def overlap(self, pair: int) -> tuple[str, float, float]:
        one = self.touches[pair]
        return one.name, -float(self.gap[pair]), one.size

    def press(self, gap: np.ndarray, rate: np.ndarray, dt: float) -> np.ndarray:
        own = gap.copy()
        smallest = _TOLERANCE * max(-float(gap.min()), 1e-300)
        for _ in range(_ITERATIONS):
            super().press(own, rate, dt)
            left = 1.0 + self.local * self.d_gap
            rest = own + self.local * self.pressure - gap
            if (left < _LEFT).any():
                break
            if np.abs(rest).max() <= smallest:
                self.d_gap /= left
                self.d_rate /= left
                self.gap, self._carried = own, self.pressure.copy()
                return own
            own = own - rest / left
        worst = int(np.argmin(left))
        raise ConvergenceError(
            f"{self.touches[worst].name}: under {self.pressure[worst]:.3g} N the contact is stiffer than the {1e9 * self.local[worst]:.3g} nm/N "
            "of the mesh below it, which its law replaces. Take a smaller load, or 'nodal'."
        )

    def energy(self) -> float:
        """What the law stores at the last gaps, less what the meshes do in its place [J]."""
        return super().energy() - 0.5 * float(self.local @ self._carried**2)


def _moves(touches: list[Touch], nodes: int) -> tuple[Any, Any]:
    """(3 n, 3 nodes) displacement of balls against races, and (n, nodes) bounds of its blocks' row and column sums."""
    from scipy.sparse import coo_array

    rows, columns, values, bounds, sums, at = [], [], [], [], [], []
    for k, touch in enumerate(touches):
        for sign, side in ((1.0, touch.ball), (-1.0, touch.race)):
            rows.append(np.broadcast_to(3 * k + np.arange(3)[:, None, None], side.share.shape).ravel())
            columns.append(np.broadcast_to((3 * side.nodes)[:, None] + np.arange(3), side.share.shape).ravel())
            values.append(sign * side.share.ravel())
            size = np.abs(side.share)
            sums.append(np.maximum(size.sum(axis=2).max(axis=0), size.sum(axis=0).max(axis=1)))
            bounds.append(np.full(len(side.nodes), k))
            at.append(side.nodes)
    join = np.concatenate
    move = coo_array((join(values), (join(rows), join(columns))), shape=(3 * len(touches), 3 * nodes)).tocsr()
    move.eliminate_zeros()
    reach = coo_array((join(sums), (join(bounds), join(at))), shape=(len(touches), nodes)).tocsr()
    return move, reach
