"""Patches and the solvers on them, shared by all copies of a system, so that each solution starts from the last one."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import attrs
import numpy as np

from raceway.core.patches.balls import AppliedLoads, Balls, LinearisedBalls
from raceway.core.patches.contact import BeyondPatch, Contact
from raceway.core.patches.nodal_law import PointLaw
from raceway.core.patches.patch import Patch
from raceway.core.ring.kernels.layout import CENTRIFUGAL
from raceway.errors import ConvergenceError, MeshError

T = TypeVar("T")
#: Largest step of a ball or the ring in an iteration, of the ball's diameter.
STEP = 5e-4
#: How often the patches may be made wider for one solution.
_WIDER = 12


@attrs.define(eq=False)
class Row:
    """The balls' solver of one system and where it was last.

    Attributes
    ----------
    balls : Balls
    force : (2 Z, 2) contact forces on the balls [N]
    last : the state of the last solution, with the places (Z, 2) of groove centres and balls there [m]
    """

    balls: Balls
    force: np.ndarray
    last: LinearisedBalls | None = None
    centre: np.ndarray = attrs.field(factory=lambda: np.zeros((0, 2)))
    where: np.ndarray = attrs.field(factory=lambda: np.zeros((0, 2)))

    def settle(
        self, centre: np.ndarray, where: np.ndarray, rate: np.ndarray, tolerance: float, given: AppliedLoads | None = None
    ) -> tuple[np.ndarray, LinearisedBalls]:
        """Balls in equilibrium between grooves at ``centre`` (Z, 2): places (Z, 2) and state; ``where`` is the first guess.

        Notes
        -----
        Near the last solution its linearisation tells places and forces better than any guess.
        """
        force = self.force
        if self.last is not None and np.abs(centre - self.centre).max() < STEP * np.abs(self.where).max():
            step, change = self.balls.move(self.last, (centre - self.centre).reshape(-1))
            try:
                near = self.balls.settle(centre, self.where + step, self.force + change, rate, tolerance, given)
                return self._keep(centre, near)
            except ConvergenceError:
                pass  # from the guess, then
        return self._keep(centre, self.balls.settle(centre, where, force, rate, tolerance, given))

    def _keep(
        self, centre: np.ndarray, found: tuple[np.ndarray, np.ndarray, LinearisedBalls]
    ) -> tuple[np.ndarray, LinearisedBalls]:
        self.centre, (self.where, self.force, self.last) = centre, found
        return self.where, self.last


class Pool:
    """Patches of both races and solvers for any set of balls on them.

    Parameters
    ----------
    patches : of the inner and the outer race
    laws : at the points of the inner and the outer race; None for no penetration
    wider : called with a ``BeyondPatch``, returns patches that reach further; None: contact that leaves is an error
    friction : coefficient of Coulomb friction; the patches have compliances along the groove where it is not 0
    """

    def __init__(
        self,
        patches: tuple[Patch, Patch],
        laws: tuple[PointLaw | None, PointLaw | None] = (None, None),
        wider: Callable[[BeyondPatch], tuple[Patch, Patch]] | None = None,
        friction: float = 0.0,
    ) -> None:
        self.generations, self.laws, self._wider, self.friction = [patches], laws, wider, friction
        self._rows: dict[tuple[bool, tuple[float, ...]], Row] = {}

    @property
    def patches(self) -> tuple[Patch, Patch]:
        """Of the inner and the outer race, the widest so far."""
        return self.generations[-1]

    @property
    def diameter(self) -> float:
        """Of the balls [m]."""
        return 2.0 * self.patches[0].ball.radius

    def row(self, table: np.ndarray, with_friction: bool = False) -> Row:
        """The solver for the balls of a system's ``table``; ``with_friction``: with friction."""
        key = with_friction, tuple(table[:, CENTRIFUGAL].tolist())
        if key not in self._rows:
            z = len(table)
            both, friction = zip(self.patches, self.laws, strict=True), self.friction if with_friction else 0.0
            contacts = [Contact(patch, law, friction) for patch, law in both for _ in range(z)]
            loads = np.zeros((z, 2))
            loads[:, 1] = table[:, CENTRIFUGAL]
            balls = Balls(contacts, self._coupling(z), loads, STEP * self.diameter)
            self._rows[key] = Row(balls, np.zeros((2 * z, 2)))
        return self._rows[key]

    def widened(self, solve: Callable[[], T]) -> T:
        """The solution, on patches that are made wider while the contact leaves them.

        Raises
        ------
        ConvergenceError
            The contact leaves every patch, or nothing makes them wider.
        """
        for _ in range(_WIDER):
            try:
                return solve()
            except BeyondPatch as left:
                if self._wider is None:
                    raise ConvergenceError(str(left)) from left
                try:
                    self.generations.append(self._wider(left))
                except MeshError as why:  # the bodies were meshed: what cannot be is this contact
                    raise ConvergenceError(f"the balls run away from the races: {left} ({why})") from why
                self._rows.clear()
        raise ConvergenceError("the contacts run away from every patch: there is no equilibrium near the first guess")

    def _coupling(self, z: int) -> np.ndarray:
        """(4 Z, 4 Z) W: between the poles of a ball, and between the balls of a row through both rings."""
        row = len(self.patches[0].race.crossing)
        out = np.zeros((2, z, 2, 2, z, 2))
        ball = np.arange(z)
        for component in (0, 1):
            for here, there in ((0, 1), (1, 0)):
                out[here, ball, component, there, ball, component] = -self.patches[0].ball.opposite
        for race, patch in enumerate(self.patches):
            for k in range(z):
                first = k // row * row
                for other in range(first, first + row):
                    out[race, k, :, race, other, :] += patch.race.crossing[(k - other) % row]
        return out.reshape(4 * z, 4 * z)
