"""One ball against one race: resultant, tangent and pressures for a given place of the ball in the groove."""

from __future__ import annotations

import attrs
import numpy as np

from raceway.core.patches.factor import Factor
from raceway.core.patches.friction import Friction, Traction
from raceway.core.patches.gap import derivatives, sphere_in_torus
from raceway.core.patches.nodal_law import LawState, PointLaw, by_law
from raceway.core.patches.patch import Patch
from raceway.core.patches.unilateral import active_set
from raceway.errors import RacewayError


class BeyondPatch(RacewayError):
    """Points in contact at the end of a patch that could be larger: what it must reach.

    Attributes
    ----------
    sense : of the race, -1 inner, 1 outer;  angle : contact angle of the resultant [rad];  load : of the contact [N]
    across : whether it left along the rolling direction
    """

    def __init__(self, sense: float, angle: float, load: float, across: bool) -> None:
        race = "inner" if sense < 0.0 else "outer"
        way = "the rolling direction" if across else "the groove"
        super().__init__(
            f"the contact on the {race} race, {load:.4g} N at {np.degrees(angle):.2f} deg, leaves its surface points along {way}"
        )
        self.sense, self.angle, self.load, self.across = sense, angle, load, across


@attrs.frozen(eq=False)
class ContactState:
    """A contact's answer.

    Attributes
    ----------
    force : (2,) on the ball, axial and radial [N];  stiffness : (2, 2) minus its derivative by the ball's place [N/m]
    viscous : (2, 2) minus its derivative by the ball's velocity [N s/m]
    nodes, load : (n,) points that carry and their forces [N], number k * columns + i
    penetration : largest one that a law leaves [m]
    truncated : whether points at the groove's edge carry
    along : (2, 2) what friction adds to ``stiffness``
    couple : of friction on the section of the ring, derivative of its work by the section's turn [N m]
    by_turn : (2,) minus the derivative of the force by that turn [N];  couple_by_place : (2,) [N];  couple_by_turn [N m]
    gripped : tractions along the groove; None without friction
    normal : (2,) the part of ``force`` that pressures make, where there is friction [N]
    """

    force: np.ndarray
    stiffness: np.ndarray
    viscous: np.ndarray
    nodes: np.ndarray
    load: np.ndarray
    penetration: float = 0.0
    truncated: bool = False
    along: np.ndarray = attrs.field(factory=lambda: np.zeros((2, 2)))
    couple: float = 0.0
    by_turn: np.ndarray = attrs.field(factory=lambda: np.zeros(2))
    couple_by_place: np.ndarray = attrs.field(factory=lambda: np.zeros(2))
    couple_by_turn: float = 0.0
    traction_state: Traction | None = None
    normal: np.ndarray = attrs.field(factory=lambda: np.zeros(2))


@attrs.frozen(eq=False)
class SlipState:
    """State of friction at a contact: the turn of the ring's section [rad], slips (rows * columns,) [m]."""

    turn: float
    slip: np.ndarray


#: Places of the points over which a mean is taken.
_PLACES = 8
_NONE = np.zeros(0, dtype=np.int64)


class Contact:
    """One ball-race pair with the memory that makes the next solution cheap: points in contact and their factor.

    Parameters
    ----------
    patch : Patch
    law : what gives the pressure at a point; None for no penetration
    friction : coefficient of Coulomb friction; the patch has compliances along the groove where it is not 0
    """

    def __init__(self, patch: Patch, law: PointLaw | None, friction: float = 0.0) -> None:
        self.patch, self.law = patch, law
        self.friction = Friction(patch, friction) if friction > 0.0 else None
        self._factor = Factor(patch)
        self._nodes = _NONE
        self._depth = np.zeros(patch.rows * patch.columns)
        self._gap = np.empty((patch.rows, patch.columns))
        self.iterations = 0

    def press(self, place: np.ndarray, rate: np.ndarray, slipping: SlipState | None = None) -> ContactState:
        """Solve for a place (2,) and a velocity (2,) of the ball's centre, seen from the groove's centre.

        Friction acts where ``slipping`` is given.

        Raises
        ------
        BeyondPatch
            Contact at the end of the patch, short of the groove's edge.
        """
        patch = self.patch
        axial, radial = float(place[0]), float(place[1])
        sphere_in_torus(axial, radial, patch.geometry, patch.meridian, patch.parallel, self._gap)
        gap = self._gap.reshape(-1)
        if not (gap < 0.0).any():
            return self._open(place, slipping)
        if self.law is None:
            nodes, load, count = active_set(gap, self._nodes, self._factor)
            solve = lambda right: self._factor.solve(nodes, right)  # noqa: E731
            state, penetration = None, 0.0
        else:
            every = np.arange(len(gap))
            speed = self._derivatives(every, np.zeros(len(gap)), axial, radial)[0] @ rate
            state = by_law(gap, speed, self.law, self._depth, self._factor)
            nodes, load, count, solve = state.nodes, state.load, state.iterations, state.solve
            penetration = float(-state.gap.min(initial=0.0))
        self.iterations += count
        self._nodes = nodes
        if not len(nodes):
            return self._open(place, slipping)
        slope, curved = self._derivatives(nodes, load, axial, radial)
        force = slope.T @ load
        carried = solve(slope)
        stiffness = slope.T @ carried - curved
        viscous = self._viscous(state, slope, carried)
        truncated = self._ends(nodes, force)
        normal = ContactState(force, stiffness, viscous, nodes, load, penetration, truncated)
        return normal if slipping is None else self._rubbed(normal, place, slipping, -carried)

    def mean_stiffness(self, place: np.ndarray) -> np.ndarray:
        """(2, 2) stiffness as ``press`` gives it, the mean over all places of the points under the ellipse [N/m].

        Notes
        -----
        A set of points changes in steps as the ellipse slides over it, and the stiffness of the set with it, by some percent.
        Turned about the groove's centre by one distance of rows the ellipse meets the same points again: the mean over
        that distance has no ripple.
        """
        pitch = self.patch.race.angle[1] - self.patch.race.angle[0]
        kept = self._nodes, self._depth.copy()
        total = np.zeros((2, 2))
        for angle in pitch * ((np.arange(_PLACES) + 0.5) / _PLACES - 0.5):
            c, s = np.cos(angle), np.sin(angle)
            turn = np.array([[c, s], [-s, c]])
            total += turn.T @ self.press(turn @ place, np.zeros(2)).stiffness @ turn
        self._nodes, self._depth = kept
        return total / _PLACES

    def _open(self, place: np.ndarray, slipping: SlipState | None) -> ContactState:
        self._nodes = _NONE
        zero = np.zeros((2, 2))
        open_ = ContactState(np.zeros(2), zero, zero, _NONE, np.zeros(0))
        return open_ if slipping is None else self._rubbed(open_, place, slipping, np.zeros((0, 2)))

    def along(self, place: np.ndarray, turn: float = 0.0) -> float:
        """Place of the contact along the groove [m]: all points of the ball move so far over the race."""
        race = self.patch.race
        angle = np.arctan2(race.sense * place[0], race.sense * place[1])
        return float((race.groove - self.patch.ball.radius) * angle - (race.groove * turn if race.sense < 0.0 else 0.0))

    def _rubbed(
        self, normal: ContactState, place: np.ndarray, slipping: SlipState, load_by_place: np.ndarray
    ) -> ContactState:
        """With friction; load_by_place (n, 2): derivatives of the points' forces by the ball's place [N/m]."""
        assert self.friction is not None
        race = self.patch.race
        traction_state = self.friction.pull(normal.nodes, normal.load, self.along(place, slipping.turn), slipping.slip)
        length = float(np.hypot(*place))
        n = race.sense * place / length
        t = np.array([n[1], -n[0]])
        lever = (race.groove - self.patch.ball.radius) / length
        ahead = race.sense * lever * t  # derivative of the place along the groove by the ball's
        tau = traction_state.force
        by_place = traction_state.by_place * ahead + traction_state.by_load @ load_by_place
        along = np.outer(ahead, by_place) - tau * lever / length * (np.outer(t, n) + np.outer(n, t))
        arm = race.groove if race.sense < 0.0 else 0.0
        return attrs.evolve(
            normal, force=normal.force - tau * ahead, stiffness=normal.stiffness + along, along=along, traction_state=traction_state, normal=normal.force,
            couple=-arm * tau, by_turn=-arm * traction_state.by_place * ahead, couple_by_place=-arm * by_place,
            couple_by_turn=arm * arm * traction_state.by_place,
        )  # fmt: skip

    def _derivatives(
        self, nodes: np.ndarray, load: np.ndarray, axial: float, radial: float
    ) -> tuple[np.ndarray, np.ndarray]:
        patch = self.patch
        slope, curved = np.empty((len(nodes), 2)), np.empty(3)
        derivatives(
            axial, radial, patch.geometry, patch.meridian, patch.parallel, nodes, np.ascontiguousarray(load), slope, curved
        )
        return slope, curved[[0, 1, 1, 2]].reshape(2, 2)

    @staticmethod
    def _viscous(state: LawState | None, slope: np.ndarray, held: np.ndarray) -> np.ndarray:
        if state is None or not state.viscous.any():
            return np.zeros((2, 2))
        return -held.T @ (state.viscous[:, None] * slope)

    def _ends(self, nodes: np.ndarray, force: np.ndarray) -> bool:
        """Whether the contact is cut off by the groove's edge."""
        patch = self.patch
        row, column = nodes // patch.columns, nodes % patch.columns
        low, high = row[0] == 0, row[-1] == patch.rows - 1
        first, last = patch.race.ends
        sense = patch.race.sense
        wide = bool((column == 0).any() or (column == patch.columns - 1).any())
        if wide or (low and not first) or (high and not last):
            angle = float(np.arctan2(-sense * force[0], -sense * force[1]))
            raise BeyondPatch(sense, angle, float(np.hypot(*force)), wide)
        return bool(low or high)
