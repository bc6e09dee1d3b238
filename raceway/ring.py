"""The inner ring as a solid: groove depth, mass, transverse inertia and growth from the bearing's dimensions."""

from __future__ import annotations

from math import asin, pi, sqrt
from typing import Any

from raceway.scene import Scene


def ring_inertia(scene: Scene) -> tuple[float, float]:
    """Mass [kg] and transverse inertia [kg m2] of the inner ring, or of a pair's two; zeros when bore or width are not known.

    Notes
    -----
    A hollow cylinder from the bore to a land at d_m - D + 2 h (groove depth h), less the groove's circular segment; with
    ``bearing.inner_profile`` that section, exactly.
    """
    b = scene.bearing
    places = [place for _, place in b.rows]
    if b.inner_profile is not None:
        from raceway.core.meshing.ring_shape import ring_shape

        mass, transverse = (b.rings.density * moment for moment in ring_shape(b, True).moments)
        return mass * len(places), sum(transverse + mass * place**2 for place in places)
    if b.bore is None or b.width is None:
        return 0.0, 0.0
    d, depth = b.ball_diameter, shoulder_height(scene)
    bottom = b.pitch_diameter - d
    land = bottom + 2.0 * depth
    groove = b.conformity_inner * d
    half = sqrt(max(2.0 * groove * depth - depth * depth, 0.0))
    segment = groove * groove * asin(min(half / groove, 1.0)) - half * (groove - depth)
    solid = b.rings.density * pi / 4.0 * (land**2 - b.bore**2) * b.width
    cut = b.rings.density * segment * pi * (bottom + 1.2 * depth)
    mass = solid - cut
    inner, outer = b.bore / 2.0, land / 2.0
    transverse = mass * (3.0 * (inner**2 + outer**2) + b.width**2) / 12.0
    return mass * len(places), sum(transverse + mass * place**2 for place in places)


def radial_growth(scene: Scene) -> float:
    """Radial growth of the inner raceway [m]: what the scene gives, and with ``ring_growth`` the centrifugal one.

    Notes
    -----
    A free rotating disc from the bore a to the land b grows at b by rho w^2 b / (4 E) ((1 - nu) b^2 + (3 + nu) a^2).

    References
    ----------
    Timoshenko & Goodier, Theory of Elasticity, 3rd ed., section 32.
    """
    growth = scene.kinematics.radial_expansion
    bearing = scene.bearing
    if scene.kinematics.ring_growth and bearing.bore is not None:
        steel = bearing.rings
        a, b = bearing.bore / 2.0, (bearing.pitch_diameter - bearing.ball_diameter) / 2.0 + shoulder_height(scene)
        size = steel.density * scene.spin_speed**2 * b / (4.0 * steel.young)
        growth += size * ((1.0 - steel.poisson) * b**2 + (3.0 + steel.poisson) * a**2)
    return growth


def shoulder_height(scene: Scene) -> float:
    """Depth of the grooves [m]: given, or 0.2 D."""
    return scene.bearing.shoulder_height or 0.2 * scene.bearing.ball_diameter


def load_at_edge(ellipse: Any, ball_radius: float, angle: float) -> float:
    """Load of a ball [N] at which its contact ellipse reaches the groove's edge.

    Parameters
    ----------
    ellipse : of the contact, with ``semi_axes(load)`` [m]
    angle : from the contact to the edge, seen from the ball's centre [rad]

    Notes
    -----
    The semi-major axis grows with the cube root of the load; the edge is reached where a = R angle.
    """
    return float((max(ball_radius * angle, 0.0) / float(ellipse.semi_axes(1.0)[0])) ** 3)
