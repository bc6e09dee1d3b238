"""Fits of rings on shafts and in housings of any material, warm or cold, from the displacements of each body by itself.

Nothing here uses ``raceway.scene.growth``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from raceway import Scene
    from raceway.scene.bearing import Material

ALUMINIUM = {"young": 70e9, "poisson": 0.33, "density": 2700.0, "thermal_expansion": 23e-6}


def lame(inside: float, outside: float, pressures: tuple[float, float], radius: float, body: Material) -> float:
    """Radial displacement [m] of a plane-stress annulus under pressures inside and outside [Pa], at a radius.

    References
    ----------
    Timoshenko & Goodier, Theory of Elasticity, 3rd ed., section 28.
    """
    a, b, (p, q) = inside, outside, pressures
    first = (p * a**2 - q * b**2) / (b**2 - a**2)
    second = (p - q) * a**2 * b**2 / (b**2 - a**2)
    return ((1.0 - body.poisson) * first * radius + (1.0 + body.poisson) * second / radius) / body.young


def fits_by_hand(scene: Scene) -> tuple[float, float]:
    """Growth of inner and outer raceway [m]: the pressure at which both surfaces of a fit meet; 0 where they do not.

    Notes
    -----
    The axis of a solid shaft is a hole of 1 nm here, a housing without a diameter 1 km wide.
    """
    b, warm = scene.bearing, scene.mounting
    race, bore, rings = 0.5 * (b.pitch_diameter - b.ball_diameter), 0.5 * (b.bore or 0.0), b.rings
    core, shaft, housing = max(0.5 * warm.shaft_bore, 1e-9), warm.shaft_material or rings, warm.housing_material or rings
    steel = rings.thermal_expansion or 0.0
    tight = 0.5 * warm.shaft_interference + bore * warm.inner_temperature * ((shaft.thermal_expansion or 0.0) - steel)
    unit = lame(bore, race, (1.0, 0.0), bore, rings) - lame(core, bore, (0.0, 1.0), bore, shaft)
    inner = lame(bore, race, (max(tight, 0.0) / unit, 0.0), race, rings)
    race, seat, wide = (
        0.5 * (b.pitch_diameter + b.ball_diameter),
        0.5 * (b.outer_diameter or 0.0),
        0.5 * (warm.housing_diameter or 1e3),
    )
    tight = 0.5 * warm.housing_interference - seat * warm.outer_temperature * ((housing.thermal_expansion or 0.0) - steel)
    unit = lame(seat, wide, (1.0, 0.0), seat, housing) - lame(race, seat, (0.0, 1.0), seat, rings)
    return inner, lame(race, seat, (0.0, max(tight, 0.0) / unit), race, rings)
