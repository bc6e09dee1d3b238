"""The inner ring as a solid: groove depth, mass, transverse inertia and growth from the bearing's dimensions."""

from __future__ import annotations

from math import asin, cos, pi, sin, sqrt
from typing import Any

from raceway.scene import Scene


def ring_inertia(scene: Scene) -> tuple[float, float]:
    """Mass [kg] and transverse inertia [kg m2] of the inner ring, or of a pair's two; zeros when bore or width are not known.

    Notes
    -----
    Of ``bearing.inner_profile``, or of a hollow cylinder from the bore to a land at d_m - D + 2 h (groove depth h); the groove
    is cut out exactly.
    """
    moments = _moments(scene)
    places = [place for _, place in scene.bearing.rows]
    if moments is None:
        return 0.0, 0.0
    mass, transverse, _ = (scene.bearing.rings.density * moment for moment in moments)
    return mass * len(places), sum(transverse + mass * place**2 for place in places)


def _moments(scene: Scene) -> tuple[float, float, float] | None:
    """Volume [m3] of one inner ring, transverse and polar inertia over density [m5]; None when bore or width are not known."""
    b = scene.bearing
    if b.inner_profile is not None:
        from raceway.core.meshing.ring_shape import ring_shape

        return ring_shape(b, True).moments
    if b.bore is None or b.width is None:
        return None
    import numpy as np

    offset = (b.conformity_inner - 0.5) * b.ball_diameter
    groove, centre_x = b.conformity_inner * b.ball_diameter, offset * sin(b.contact_angle)
    centre_r = 0.5 * b.pitch_diameter + offset * cos(b.contact_angle)
    bore, land = 0.5 * b.bore, 0.5 * (b.pitch_diameter - b.ball_diameter) + shoulder_height(scene)
    half = sqrt(max(groove**2 - (centre_r - land) ** 2, 0.0))
    # Where the groove meets the land, or a side face before that.
    ends = [min(max(x, -0.5 * b.width), 0.5 * b.width) for x in (centre_x - half, centre_x + half)]
    low, high = (asin(max(min((x - centre_x) / groove, 1.0), -1.0)) for x in ends)
    at, weight = np.polynomial.legendre.leggauss(48)
    angle = 0.5 * (low + high) + 0.5 * (high - low) * at
    sections = [
        (centre_x + groove * np.sin(angle), centre_r - groove * np.cos(angle), 0.5 * (high - low) * groove * np.cos(angle)),
    ]
    for left, right in ((-0.5 * b.width, ends[0]), (ends[1], 0.5 * b.width)):
        x = 0.5 * (left + right) + 0.5 * (right - left) * at
        sections.append((x, np.full_like(x, land), np.full_like(x, 0.5 * (right - left))))
    out = np.zeros(3)
    for x, r, slope in sections:
        square, fourth = r**2 - bore**2, r**4 - bore**4
        for k, part in enumerate((square, 0.25 * fourth + x**2 * square, 0.5 * fourth)):
            out[k] += pi * float(weight @ (part * slope))
    return float(out[0]), float(out[1]), float(out[2])


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
