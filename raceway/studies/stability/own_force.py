"""Approaches and displacements of a bearing from a law's own force function, by numerical inversion; slopes."""

from __future__ import annotations

from collections.abc import Callable
from math import atan2, sin, sqrt

import numpy as np

from raceway.bodies.model import Model
from raceway.bodies.running import running_pairs
from raceway.core.ring.surrogate import surrogate
from raceway.framework.duties import reach_of, renews

#: Halvings of an interval: to the last bit of a double from any first one.
_HALVINGS = 200
#: Rounds in which the contact angle settles: films depend on its cosine, and move it by a thousandth of that.
_ANGLES = 6
#: Loads of a ball over the mean one at which bodies that deform refuse a law.
_LOADS = (1.0, 5.0)


def inverted(function: Callable[[float], float], value: float, first: float) -> float:
    """Argument at which a function that grows from 0 at 0 takes a value; ``first``: a guess of the size."""
    low, high = 0.0, first
    while function(high) < value:
        low, high = high, 2.0 * high
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        low, high = (middle, high) if function(middle) < value else (low, middle)
    return high


def force_and_slope(model: Model, pair: int, approach: float, params: np.ndarray | None = None) -> tuple[float, float]:
    """Force [N] and stiffness [N/m] of one ball-race pair at rest, by the law's kernel; ``params`` (2 Z, k): not the model's."""
    system = surrogate(model.system)
    law_params = system.law_params if params is None else params
    params, state = (np.ascontiguousarray(each[pair : pair + 1]) for each in (law_params, system.law_state))
    force, d_gap, d_rate = np.empty(1), np.empty(1), np.empty(1)
    system.law(np.array([-approach]), np.zeros(1), params, state, state.copy(), 0.0, force, d_gap, d_rate)
    return float(force[0]), -float(d_gap[0])


def axial_displacement(model: Model) -> float:
    """Displacement [m] under the axial load alone, the balls weightless.

    Notes
    -----
    All balls carry the same load Q at both races, so that groove centres are s = s0 + delta_i(Q) + delta_o(Q) apart; their
    radial distance r stays, and cos alpha = r / s, F = Z Q sin alpha, which grows with Q and is inverted.  A law that begins to
    carry before surfaces touch has its reach taken off delta; one that follows speed and loads is built at Q and alpha.
    """
    z, rest_axial, rest_radial = model.system.ball_count, *model.geometry.rest
    size = 1e-3 * model.geometry.ball_diameter

    def axial(load: float) -> float:
        angle = model.scene.bearing.contact_angle
        for _ in range(_ANGLES if renews(model.scene.contact.law) else 1):
            params, reach = _at_load(model, load, angle)
            approach = 0.0
            for pair in (0, z):
                own = inverted(lambda d, p=pair, k=params: force_and_slope(model, p, d, k)[0], load, size)  # type: ignore[misc]
                approach += own - float(reach[pair])
            distance = model.geometry.centre_distance + approach
            moved = sqrt(max(distance**2 - rest_radial**2, 0.0))
            angle = atan2(moved, rest_radial)
        return moved

    def force(load: float) -> float:
        moved = axial(load)
        return z * load * moved / sqrt(moved**2 + rest_radial**2)

    total = model.scene.load.axial
    load = inverted(force, total, total / (z * max(sin(model.scene.bearing.contact_angle), 0.1)))
    return axial(load) - rest_axial


def _at_load(model: Model, load: float, angle: float) -> tuple[np.ndarray | None, np.ndarray]:
    """Parameters and reach (2 Z,) of the law where all contacts carry a load [N] at an angle [rad]."""
    z, law = model.system.ball_count, model.scene.contact.law
    if not renews(law):
        return None, np.zeros(2 * z)
    angles = np.full(z, angle)
    pairs = running_pairs(model.scene, model.basis, np.full(2 * z, load), (angles, angles))
    return law.build(pairs), reach_of(law, pairs)


def stiffer_than_hertz(model: Model, ball_load: float) -> bool:
    """Whether the law's own slope is above Hertz's where bodies that deform look at it; they leave Hertz's law room."""
    for pair, ellipse in ((0, model.inner), (model.system.ball_count, model.outer)):
        for factor in _LOADS:
            approach = float(ellipse.approach(factor * ball_load))
            if force_and_slope(model, pair, approach)[1] > 1.5 * factor * ball_load / approach:
                return True
    return False
