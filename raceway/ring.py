"""The inner ring as a solid: groove depth, mass and transverse inertia from the bearing's dimensions."""

from __future__ import annotations

from math import asin, pi, sqrt

from raceway.scene import Scene


def ring_inertia(scene: Scene) -> tuple[float, float]:
    """Mass [kg] and transverse inertia [kg m2] of the inner ring; zeros when bore or width are not known.

    Notes
    -----
    A hollow cylinder from the bore to a land at d_m - D + 2 h (groove depth h), less the groove's circular segment.
    """
    b = scene.bearing
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
    return mass, transverse


def shoulder_height(scene: Scene) -> float:
    """Depth of the grooves [m]: given, or 0.2 D."""
    return scene.bearing.shoulder_height or 0.2 * scene.bearing.ball_diameter
