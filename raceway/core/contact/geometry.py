"""Lengths and curvatures of a ball bearing at rest, at the free contact angle.

B = (f_i + f_o - 1) D is the distance of the groove centres, R_i = d_m/2 + (f_i - 1/2) D cos(alpha) the radius of the
inner ones.  With g = D cos(alpha)/d_m the curvature sums are (4 - 1/f + 2g/(1-g))/D inside and (4 - 1/f - 2g/(1+g))/D
outside.  An internal radial clearance P_d sets cos(alpha) = 1 - P_d/(2B).

Harris & Kotzalas, Essential Concepts of Bearing Technology, chapters 2 and 6; ISO/TS 16281.
"""

from math import pi, sqrt
from typing import Any

import attrs
import numpy as np

from raceway.core.columns import Number, cos, is_column, sin
from raceway.core.contact.hertz import Ellipse, ellipse
from raceway.core.deferred import deferred


@attrs.frozen
class BallBearing:
    """Geometry of one row, all in metres and radians; numbers may be columns.

    ``centred``: the axial displacement counts from the middle of the axial clearance, not from the first touch.
    """

    ball_diameter: float
    pitch_diameter: float
    ball_count: int
    contact_angle: float
    conformity_inner: float
    conformity_outer: float
    centred: bool = False

    @classmethod
    def of(cls, bearing: object, centred: bool = False) -> "BallBearing":
        """The lengths of the same names of a scene's bearing, or of one of its rows."""
        return cls(**{field.name: getattr(bearing, field.name) for field in attrs.fields(cls)[:-1]}, centred=centred)

    @property
    def centre_distance(self) -> float:
        """B: distance of the groove centres at rest."""
        return (self.conformity_inner + self.conformity_outer - 1.0) * self.ball_diameter

    @property
    def inner_centre_radius(self) -> float:
        """R_i: radius of the circle of the inner groove centres."""
        return 0.5 * self.pitch_diameter + self.offset_inner * cos(self.contact_angle)

    @property
    def offset_inner(self) -> float:
        """Distance of groove centre and ball centre at the first touch, inner."""
        return (self.conformity_inner - 0.5) * self.ball_diameter

    @property
    def offset_outer(self) -> float:
        """Distance of groove centre and ball centre at the first touch, outer."""
        return (self.conformity_outer - 0.5) * self.ball_diameter

    @property
    def gamma(self) -> float:
        """D cos(alpha) / d_m at the free contact angle."""
        return self.ball_diameter * cos(self.contact_angle) / self.pitch_diameter

    @property
    def rest(self) -> tuple[float, float]:
        """Axial and radial part of the vector from the outer to the inner groove centre at zero displacement."""
        return 0.0 * self.seat if self.centred else self.seat, self.centre_distance * cos(self.contact_angle)

    @property
    def seat(self) -> float:
        """Axial displacement from the middle of the axial clearance to the first touch."""
        return self.centre_distance * sin(self.contact_angle)

    def ellipses(self, modulus: float) -> tuple[Ellipse, Ellipse]:
        """Hertz contact of the inner and of the outer race, for a contact modulus E* [Pa]."""
        g, d = self.gamma, self.ball_diameter
        pair = []
        for f, rolling in ((self.conformity_inner, 2 * g / (1 - g)), (self.conformity_outer, -2 * g / (1 + g))):
            total = 4.0 - 1.0 / f + rolling
            pair.append(ellipse(total / d, (1.0 / f + rolling) / total, modulus))
        return pair[0], pair[1]

    def cage_speed(self, spin_speed: float) -> float:
        """Speed of the ball set [rad/s], inner ring turning at ``spin_speed``, free contact angle."""
        return 0.5 * spin_speed * (1.0 - self.gamma)

    def ball_mass(self, density: float) -> float:
        """Mass of one ball [kg]."""
        return density * pi * self.ball_diameter**3 / 6.0


@attrs.frozen(eq=False)
class Growth:
    """By how much the grooves of a running, warm bearing differ from those before mounting [m]."""

    common: np.ndarray  # (5,) of the scalars REST_AXIAL, REST_RADIAL, OFFSET_INNER, OFFSET_OUTER, TILT_ARM
    by_ball: np.ndarray  # (Z, 5) of the rows' own columns of the same, beyond that


#: Steps at most; a dozen do.
_ITERATIONS = 120


def axial_balance(*numbers: Number) -> tuple[Number, Number]:
    """(x [m], load of a ball [N]), columns (n,) of columns.

    numbers : K [N/m^1.5], distance of the groove centres [m], sine and cosine of the free contact angle, balls, axial load [N]
    """
    if not any(map(is_column, numbers)):
        rows: Any = [list(numbers)]
        _balance.__wrapped__(rows)
        return rows[0][0], rows[0][1]
    rows = np.empty((max(map(np.size, numbers)), len(numbers)))
    for k, number in enumerate(numbers):
        rows[:, k] = number
    _balance()(rows)
    return rows[:, 0], rows[:, 1]


@deferred("ROWS")
def _balance(rows: Any) -> None:
    for row in rows:
        factor, distance, count, target = row[0], row[1], row[4], row[5]
        along, across, load = distance * row[2], distance * row[3], 0.0
        # From above, where the force grows faster than the displacement, Newton's iteration falls until rounding ends it.  The contact
        # angle grows with the load: at the free one a ball would be pressed more.
        x = distance + (2.0 * target / (count * factor)) ** (2.0 / 3.0)
        if row[2] > 0.0:
            most = (target / (count * factor * row[2])) ** (2.0 / 3.0)
            x = min(x, most * (2.0 * distance + most) / (sqrt((distance + most) ** 2 - across**2) + along))
        for _ in range(_ITERATIONS):
            a = along + x
            s = sqrt(a * a + across * across)
            press = max(s - distance, 0.0)
            stiffness = factor * sqrt(press)
            load = stiffness * press
            slope = count * (1.5 * stiffness * (a / s) ** 2 + load * across**2 / s**3)
            step = (count * load * a / s - target) / max(slope, 1e-300) if slope > 0.0 else 0.0
            if not 1e-15 * x < step <= x:
                break
            x -= step
        row[0], row[1] = x, load
