"""The inner ring as a solid: groove depth, mass, transverse inertia and growth from the bearing's dimensions."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from raceway.scene.scene import Scene

if TYPE_CHECKING:
    from raceway.core.contact.hertz import Ellipse
    from raceway.scene.bearing import Bearing


def ring_inertia(scene: Scene) -> tuple[float, float, float]:
    """Mass [kg], transverse and polar inertia [kg m2] of the inner rings of all rows; zeros when bore or width are not known.

    Notes
    -----
    Of ``bearing.inner_profile``, or of a hollow cylinder from the bore to a land at d_m - D + 2 h (groove depth h); the groove
    is cut out exactly.
    """
    total = np.zeros(3)
    for (_, place), bearing in zip(scene.bearing.rows, scene.bearing.of_rows, strict=True):
        moments = _moments(bearing, groove_depth(bearing))
        if moments is None:
            return 0.0, 0.0, 0.0
        mass, transverse, polar = (bearing.rings.density * moment for moment in moments)
        total += mass, transverse + mass * place**2, polar
    return float(total[0]), float(total[1]), float(total[2])


@cache
def _moments(b: Bearing, depth: float) -> tuple[float, float, float] | None:
    """Volume [m3] of one inner ring, transverse and polar inertia over density [m5]; None when bore or width are not known."""
    if b.inner_profile is not None:
        from raceway.core.mesh.ring_mesh import ring_shape

        return ring_shape(b, True).moments
    if b.bore is None or b.width is None:
        return None
    from raceway.core.mesh.ring_mesh import RingSection

    return RingSection.of(b, depth).moments


def radial_growth(scene: Scene, row: int = 0) -> float:
    """Radial growth of a row's inner raceway [m]: what the scene gives, and with ``ring_growth`` the centrifugal one.

    Notes
    -----
    Of a free ring of the exact section, at the free contact angle.  Without a width the ring is taken for a plane-stress annulus
    from the bore a to the land b, which grows at b by rho w^2 b / (4 E) ((1 - nu) b^2 + (3 + nu) a^2).

    References
    ----------
    Timoshenko & Goodier, Theory of Elasticity, 3rd ed., section 32.
    """
    growth = scene.kinematics.radial_expansion
    b = scene.bearing.of_rows[row]
    if scene.kinematics.ring_growth and b.bore is not None and scene.spin_speed != 0.0:
        growth += b.rings.density * scene.spin_speed**2 * _growth(b, groove_depth(b))
    return growth


@cache
def _growth(b: Bearing, depth: float) -> float:
    """Centrifugal growth [m] for 1 kg/m3 and 1 rad/s; ``b`` is a scene's [bearing], ``depth`` that of its grooves."""
    young, poisson = b.rings.young, b.rings.poisson
    if b.width is not None:
        from raceway.core.mesh.ring_mesh import RingSection

        return RingSection.of(b, depth).growth(young, poisson)
    bore, land = 0.5 * (b.bore or 0.0), 0.5 * (b.pitch_diameter - b.ball_diameter) + depth
    return float(land / (4.0 * young) * ((1.0 - poisson) * land**2 + (3.0 + poisson) * bore**2))


def shoulder_height(scene: Scene) -> float:
    """Depth of the grooves [m]: given, or 0.2 D."""
    return groove_depth(scene.bearing)


def groove_depth(bearing: Bearing) -> float:
    """Depth of a bearing's grooves [m]: given, or 0.2 D."""
    return bearing.shoulder_height or 0.2 * bearing.ball_diameter


def load_at_edge(ellipse: Ellipse, ball_radius: float, angle: float) -> float:
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
