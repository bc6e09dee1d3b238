"""Gyroscopic moment of a ball on nodal contacts: tangential resultants, as of rigid balls.

Notes
-----
``raceway.core.ring.kernels.gyroscopic`` has the equations: T = share M / D at both contacts along the grooves, M a function of
both contact angles; the inner race takes no more than its normal force, the outer one the rest.
"""

from __future__ import annotations

import attrs
import numpy as np

from raceway.core.patches.contact import ContactState
from raceway.core.ring.kernels.gyroscopic import gyroscopic_moment

#: Step of the difference quotients of the moment [rad], see there.
_STEP = 1e-5


@attrs.frozen(eq=False)
class Turned:
    """Tangential resultants of a ball's gyroscopic moment.

    Attributes
    ----------
    force : (4,) on the ball, inner and outer contact, each axial and radial [N]
    stiffness : (4, 4) minus its derivative by both places of the ball, D_inner and D_outer [N/m]
    couple : on the section of the inner ring [N m];  couple_by_place : (4,) [N]
    """

    force: np.ndarray
    stiffness: np.ndarray
    couple: float
    couple_by_place: np.ndarray


@attrs.frozen
class Gyroscopic:
    """Moments of the balls.

    Attributes
    ----------
    scale : J times the speeds of ring and cage [N m];  ratio : D / d_m;  shares : of inner and outer race, 2 in all
    diameter, groove : of the ball, and the inner groove's radius [m]
    """

    scale: float
    ratio: float
    shares: tuple[float, float]
    diameter: float
    groove: float

    def of(self, inner: np.ndarray, outer: np.ndarray, pressed: ContactState) -> Turned:
        """At places D (2,) of the ball in both grooves; pressed : the inner contact."""
        si, so = float(np.hypot(*inner)), float(np.hypot(*outer))
        ni, no = -inner / si, outer / so
        ti, to = np.array([ni[1], -ni[0]]), np.array([no[1], -no[0]])
        here = float(np.arctan2(*ni)), float(np.arctan2(*no))
        angle = np.zeros((2, 4))  # derivatives of both angles by both places
        angle[0, :2], angle[1, 2:] = -ti / si, to / so
        moment = self._moment(*here)
        slope = np.array(
            [
                self._moment(here[0] + _STEP, here[1]) - self._moment(here[0] - _STEP, here[1]),
                self._moment(here[0], here[1] + _STEP) - self._moment(here[0], here[1] - _STEP),
            ]
        ) / (2.0 * _STEP)
        grows = slope @ angle
        pull = [share * moment / self.diameter for share in self.shares]
        by_place = [share / self.diameter * grows for share in self.shares]
        normal = pressed.force if pressed.traction_state is None else pressed.normal
        size = float(np.hypot(*normal))
        if abs(pull[0]) > size:
            sign = float(np.sign(moment))
            fades = np.zeros(4)
            if size > 0.0:
                fades[:2] = -sign * (normal / size) @ (pressed.stiffness - pressed.along)
            pull = [sign * size, 2.0 * moment / self.diameter - sign * size]
            by_place = [fades, 2.0 / self.diameter * grows - fades]
        stiffness = np.zeros((4, 4))
        stiffness[:2] = np.outer(ti, by_place[0]) - pull[0] * np.outer(ni, angle[0])
        stiffness[2:] = -np.outer(to, by_place[1]) + pull[1] * np.outer(no, angle[1])
        force = np.concatenate([-pull[0] * ti, pull[1] * to])
        return Turned(force, stiffness, self.groove * pull[0], self.groove * by_place[0])

    def _moment(self, inner: float, outer: float) -> float:
        return float(gyroscopic_moment(inner, outer, self.ratio, self.scale))
