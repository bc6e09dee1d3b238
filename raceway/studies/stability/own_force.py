"""Approaches and displacements of a bearing from a law's own force function, by numerical inversion; slopes."""

from __future__ import annotations

from collections.abc import Callable
from math import sin, sqrt

import numpy as np

from raceway.bodies.model import Model
from raceway.core.ring.surrogate import surrogate

#: Halvings of an interval: to the last bit of a double from any first one.
_HALVINGS = 200
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


def force_and_slope(model: Model, pair: int, approach: float) -> tuple[float, float]:
    """Force [N] and stiffness [N/m] of one ball-race pair at rest, by the law's kernel."""
    system = surrogate(model.system)
    params, state = (np.ascontiguousarray(each[pair : pair + 1]) for each in (system.law_params, system.law_state))
    force, d_gap, d_rate = np.empty(1), np.empty(1), np.empty(1)
    system.law(np.array([-approach]), np.zeros(1), params, state, state.copy(), 0.0, force, d_gap, d_rate)
    return float(force[0]), -float(d_gap[0])


def axial_displacement(model: Model) -> float:
    """Displacement [m] under the axial load alone, the balls weightless.

    Notes
    -----
    All balls carry the same load Q at both races, so that groove centres are s = s0 + delta_i(Q) + delta_o(Q) apart; their
    radial distance r stays, and cos alpha = r / s, F = Z Q sin alpha, which grows with Q and is inverted.
    """
    z, rest_axial, rest_radial = model.system.ball_count, *model.geometry.rest
    size = 1e-3 * model.geometry.ball_diameter

    def axial(load: float) -> float:
        pairs = (0, z)
        approach = sum(inverted(lambda d, p=p: force_and_slope(model, p, d)[0], load, size) for p in pairs)  # type: ignore[misc]
        distance = model.geometry.centre_distance + approach
        return sqrt(max(distance**2 - rest_radial**2, 0.0))

    def force(load: float) -> float:
        distance = sqrt(axial(load) ** 2 + rest_radial**2)
        return z * load * axial(load) / distance

    total = model.scene.load.axial
    load = inverted(force, total, total / (z * max(sin(model.scene.bearing.contact_angle), 0.1)))
    return axial(load) - rest_axial


def stiffer_than_hertz(model: Model, ball_load: float) -> bool:
    """Whether the law's own slope is above Hertz's where bodies that deform look at it; they leave Hertz's law room."""
    for pair, ellipse in ((0, model.inner), (model.system.ball_count, model.outer)):
        for factor in _LOADS:
            approach = float(ellipse.approach(factor * ball_load))
            if force_and_slope(model, pair, approach)[1] > 1.5 * factor * ball_load / approach:
                return True
    return False
