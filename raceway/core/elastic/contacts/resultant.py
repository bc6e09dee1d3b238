"""Contact resultants on a mesh: one force each, by a law whose compliance replaces that of the mesh below it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import attrs
import numpy as np

from raceway.core.elastic.contacts.contact import Contact
from raceway.core.elastic.contacts.footprint import Footprint
from raceway.errors import ConvergenceError

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

    from raceway.core.jit import Kernel

#: Newton's iterations of the law with the mesh's compliance, and their tolerance over the deepest gap.
_ITERATIONS, _TOLERANCE = 60, 1e-12
#: Share of the law's own compliance that has to be left, and halvings of the search for the gap where no more is.
_LEFT, _HALVINGS = 0.2, 60
#: Deepest gap that is looked at [m]: no contact is pressed by a millimetre.
_DEEPEST = 1e-3


@attrs.frozen(eq=False)
class Touch:
    """One ball on one race.

    Attributes
    ----------
    name : str
    ball, race : Footprint; node numbers are the assembly's
    centre : (3,) of the ball [m]
    surface : (8,) on which that centre lies at a gap of zero (``raceway.core.elastic.contacts.gap``): the groove, its tube smaller by the ball
    local : compliance of both meshes that the law's replaces, less what calibrates it [m/N];  spread : how well they know it [m/N]
    size : largest overlap of undeformed bodies [m]
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

    Where a law has less compliance than that, the force goes on along its tangent: iterations may pass there, but what ends
    there is refused by ``refuse``.
    """

    whole = True

    def __init__(
        self, touches: list[Touch], nodes: int, law: Kernel, params: np.ndarray, state_size: int = 0, damping: float = 0.0
    ) -> None:
        self.touches = touches
        place, surfaces = np.array([t.centre for t in touches]), np.array([t.surface for t in touches])
        one = np.ones(len(touches))
        super().__init__(place, one, one.astype(int), surfaces, law, params, state_size, damping)
        self.local = np.array([t.local for t in touches])
        self._carried, self._approach = np.zeros(len(touches)), np.zeros(len(touches))
        self.move = _moves(touches, nodes)
        self._mobility: np.ndarray | None = None
        self._last = self._last_gap()

    def nodes_of(self, pair: int) -> tuple[int, int]:
        one = self.touches[pair]
        return int(one.ball.nodes[0]), int(one.race.nodes[0])

    def overlap(self, pair: int) -> tuple[str, float, float]:
        one = self.touches[pair]
        return one.name, float(self._approach[pair]), one.size

    def stable_step(self, mass: np.ndarray) -> float:
        """See ``Contact``.

        Notes
        -----
        The eigenvalues of M^-1 B^T D B that are not zero are those of D B M^-1 B^T, of three rows a contact.
        """
        np.maximum(self._stiffest, self._sizes(), out=self._stiffest)
        if self._mobility is None:
            from scipy.sparse import diags_array

            self._mobility = (self.move @ diags_array(np.repeat(1.0 / mass, 3)) @ self.move.T).toarray()
        values, vectors = np.linalg.eigh(self.stiffness)
        n = len(values)
        root = np.zeros((n, 3, n, 3))
        root[np.arange(n), :, np.arange(n)] = (vectors * np.sqrt(np.abs(values))[:, None, :]).transpose(0, 2, 1)
        square = root.reshape(3 * n, 3 * n)
        largest = float(np.linalg.eigvalsh(square @ self._mobility @ square.T).max())
        return 2.0 / np.sqrt(largest) if largest > 0.0 else np.inf

    def press(self, gap: np.ndarray, rate: np.ndarray, dt: float) -> np.ndarray:
        own, self._approach = np.maximum(gap, self._last), -gap
        smallest = _TOLERANCE * max(-float(gap.min()), 1e-300)
        for _ in range(_ITERATIONS):
            super().press(own, rate, dt)
            left = np.maximum(1.0 + self.local * self.d_gap, _LEFT)
            rest = own + self.local * self.pressure - gap
            beyond = (own <= self._last) & (rest > 0.0)
            if np.abs(np.where(beyond, 0.0, rest)).max() <= smallest:
                self.d_gap /= left
                self.d_rate /= left
                self.pressure -= np.where(beyond, rest * self.d_gap, 0.0)
                self.gap, self._carried = own, self.pressure.copy()
                return own
            own = np.maximum(own - rest / left, self._last)
        raise ConvergenceError(f"the law of whole contacts finds no force at gaps down to {1e6 * gap.min():.3g} um.")

    def refuse(self) -> None:
        worst = int(np.argmin(self.gap - self._last))
        if self.gap[worst] <= self._last[worst]:
            one = self.touches[worst]
            raise ConvergenceError(
                f"{one.name}: under {self.pressure[worst]:.3g} N the contact is stiffer than the mesh below it, which gives "
                f"{1e9 * one.local:.3g} nm/N that the law replaces. Take a smaller load, a softer law, or contact.discretisation = 'nodal'; check clearance and radial_expansion."
            )

    def _last_gap(self) -> np.ndarray:
        """(n,) the deepest gap of the law [m] that leaves it some compliance, at rest and without history."""
        deep, shallow = np.full(len(self.local), -_DEEPEST), np.zeros(len(self.local))
        for _ in range(_HALVINGS):
            middle = 0.5 * (deep + shallow)
            super().press(middle, np.zeros_like(middle), 0.0)
            stays = 1.0 + self.local * self.d_gap >= _LEFT
            deep, shallow = np.where(stays, deep, middle), np.where(stays, middle, shallow)
        return shallow

    def energy(self) -> float:
        """Energy stored by the law at the last gaps, less the local energy of the meshes [J]."""
        return super().energy() - 0.5 * float(self.local @ self._carried**2)


def _moves(touches: list[Touch], nodes: int) -> csr_matrix:
    """(3 n, 3 nodes) sparse displacement of balls against races."""
    from scipy.sparse import coo_array

    rows, columns, values = [], [], []
    for k, touch in enumerate(touches):
        for sign, side in ((1.0, touch.ball), (-1.0, touch.race)):
            rows.append(np.broadcast_to(3 * k + np.arange(3)[:, None, None], side.share.shape).ravel())
            columns.append(np.broadcast_to((3 * side.nodes)[:, None] + np.arange(3), side.share.shape).ravel())
            values.append(sign * side.share.ravel())
    join = np.concatenate
    move = coo_array((join(values), (join(rows), join(columns))), shape=(3 * len(touches), 3 * nodes)).tocsr()
    move.eliminate_zeros()
    return move
