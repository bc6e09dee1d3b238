"""Friction of balls that roll between races: losses in the contacts and in the mixture of oil and air around the balls.

Powers are work that the shaft loses: force or moment times the rate at which it slips or rolls, all rates in proportion to the shaft's
speed w.  Divided by w they are the torque on the shaft.  Of a contact, with its load Q, semi-axes a across and b along the running
direction, entraining speed u, radius R_x = D (1 -+ g) / 2 along it, g = D cos(angle) / d_m, - at the inner race:

rolling          u 2 F_R, the oil's shear F_R on each surface in inlet and outlet
elastic rolling  u / R_x M, hysteresis of the bodies
sliding          mu Q times the mean slip by spin and by the curvature of the contact, with the coefficient of the oil's traction curve; the
                 gyroscopic moment adds slip across the running direction
drag             of the balls in the mixture

Balls turn about an axis in the plane of the two contacts, rolling without slip at both centres.  Its angle is between those at which the
outer and the inner contact do not spin, next to the one that dissipates less: of Coulomb friction all angles between cost the same where
both ends do, so the passage from one to the other costs nothing.

The terms are those of ``raceway.core.quantities.losses``, a compiled loop.

Not modelled: heat of the contact's own shear, which lowers traction at high slip; starvation; roughness; cage and lands.  What is missing
by ``MEASURED`` bearings decides how far the friction is known (``measured_factors``).

Harris & Kotzalas, Advanced Concepts of Bearing Technology, 5th ed., chapters 2 and 5 (spin, race control, R = 2 f D / (2 f + 1)).
"""

from typing import NamedTuple

import attrs
import numpy as np

from raceway.core.columns import Number
from raceway.core.quantities.losses import Contacts, ball_losses

#: Density of air [kg/m3].
_AIR = 1.2
#: E' of steel on steel, 206 GPa and 0.3 [Pa], for which the hysteresis moment was published.
_STEEL = 226.4e9

#: Margin of ``measured_factors``: the least with which each of ``MEASURED`` lies in the band of the others is 1.41.
_MARGIN = 1.45
#: Power of a distance in speed by which that band widens, and by how much at most: measured over computed friction goes with the speed to
#: the power -0.5 (35 mm) to 0.1 (167 mm); nothing was measured from 7600 to 800 000 mm r/min, to whose middle it is 1.8.
_BY_SPEED, _WIDEST = 0.25, 1.8


class MeasuredFriction(NamedTuple):
    """Of one bearing: d_m [m], n d_m of its runs [mm r/min], factors of the computed friction with which torque or heat are the measured ones."""

    name: str
    pitch_diameter: float
    slowest: float
    fastest: float
    least: float
    largest: float


#: By size; sources in docs/measurements.md.  The load of the last two is assumed, 22 240 N; under a tenth of it 120 mm would have 2.4 and more.
MEASURED = (
    MeasuredFriction("51205 with three balls", 0.036, 2.16e3, 7.56e3, 1.11, 1.79),
    MeasuredFriction("35 mm bore, jets", 0.0465, 1.302e6, 3.348e6, 0.76, 1.17),
    MeasuredFriction("120 mm bore, jets", 0.16, 0.8e6, 1.92e6, 1.61, 2.24),
    MeasuredFriction("167 mm bore, jets", 0.196, 1.176e6, 2.94e6, 1.47, 1.66),
)


def measured_factors(
    pitch_diameter: Number, speed: Number, known: tuple[MeasuredFriction, ...] = MEASURED
) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest factor of the computed friction that bearings measured near a size [m] and a speed [rad/s] leave possible.

    The least and the largest factor of the bearings on both sides, linear in log d_m between them and constant beyond, times
    ``_MARGIN`` and, apart from all measured n d_m, (distance in n d_m)^(1/4).  1 is always inside.
    """
    turns = np.maximum(3e4 / np.pi * np.asarray(speed) * pitch_diameter, 1e-9)
    apart = np.min([np.maximum(np.maximum(one.slowest / turns, turns / one.fastest), 1.0) for one in known], axis=0)
    wide, sizes = _MARGIN * np.minimum(apart**_BY_SPEED, _WIDEST), np.log([one.pitch_diameter for one in known])
    low, high = (np.interp(np.log(pitch_diameter), sizes, [getattr(w, end) for w in known]) for end in ("least", "largest"))
    return np.minimum(low, 1.0) / wide, np.maximum(high, 1.0) * wide


@attrs.frozen(eq=False)
class BallContacts:
    """Contacts of Z balls at n points, race 0 inner, 1 outer.

    The last seven are numbers, or arrays that broadcast to (1 or n, 2, Z).
    """

    #: load, angle : (n, 2, Z) [N], [rad], the angle nan where open
    load: np.ndarray
    angle: np.ndarray
    row: np.ndarray  # (Z,) of the balls
    #: semi_major, semi_minor : of the ellipse over the cube root of the load [m/N^(1/3)], major across the running direction
    semi_major: np.ndarray
    semi_minor: np.ndarray
    #: ball_diameter, pitch_diameter : [m]
    ball_diameter: Number
    pitch_diameter: Number
    conformity: Number  # groove radius over ball diameter
    modulus: Number  # E' = 2 E* [Pa]
    inertia: Number  # of a ball [kg m2]

    def columns(self, drag: Number) -> Contacts:
        """As the compiled loop sees them; ``drag`` : of ``Lubrication``."""
        a, b, e, diameter, load = self.semi_major, self.semi_minor, self.modulus, self.ball_diameter, self.load
        k, across = a / b, 2.0 * self.conformity * diameter / (2.0 * self.conformity + 1.0)
        r, further = 2.0 / 3.0 * e * a * b * b, np.maximum(k - 1.0, 0.0)
        numbers = Contacts(
            load=load,
            half_tangent=np.tan(0.5 * self.angle),
            root=np.cbrt(load),
            ratio=diameter / self.pitch_diameter,
            pitch=self.pitch_diameter,
            inertia=self.inertia,
            drag=drag * diameter**2,
            major=a,
            spin=a * spin_shape(k),
            curvature=a * a / (2.0 * across),
            pressure=1.0 / (np.pi * a * b),
            strain=e**0.073 / (2.69 * (1.0 - 0.61 * np.exp(-0.73 * k))),
            slope=(2.0 / e) ** 0.75 * r**-0.25,
            rigid=0.77 * k**-0.12 * (2.0 / e) ** (2.0 / 3.0) / np.cbrt(r),
            regime=1.0 / (6.6 * k * e),
            front=4.0 * a * e,
            hysteresis=7.48e-7 * (0.5 * diameter) ** 0.33 * (1.0 - 3.519e-3 * further**0.8063) * np.cbrt(_STEEL / e),
        )
        first, *coefficients = np.broadcast_arrays(load[:1], *numbers[3:])
        rows = *numbers[:3], *coefficients
        return Contacts(*(np.ascontiguousarray(part, dtype=float).reshape(-1, 2 * first.shape[-1]) for part in rows))


@attrs.frozen(eq=False)
class Lubrication:
    """The oil in and around the contacts; numbers, or columns (n,); ``oil_fraction`` may be (n, 1, Z)."""

    viscosity: Number  # dynamic, at the inlets [Pa s]
    pressure_viscosity: Number  # alpha [1/Pa]
    temperature_viscosity: Number  # beta [1/K]
    conductivity: Number  # [W/m/K]
    density: Number  # [kg/m3]
    traction_limit: Number  # largest traction coefficient
    eyring_stress: Number  # [Pa]
    oil_fraction: Number  # volume of oil over that of the space around the balls
    drag_coefficient: Number  # of a ball in the mixture

    @property
    def film(self) -> np.ndarray:
        """(1 or n, 5) as in ``raceway.core.quantities.losses._Film``."""
        thermal = self.viscosity * self.temperature_viscosity / self.conductivity
        numbers = self.viscosity, self.pressure_viscosity, thermal, self.traction_limit, self.eyring_stress
        return np.stack(np.broadcast_arrays(*map(np.atleast_1d, numbers)), axis=-1)

    @property
    def drag(self) -> Number:
        """Of a ball over the squares of its diameter and its speed [kg/m3], a number or (1 or n, 1, 1 or Z)."""

        def spread(number: Number) -> Number:
            return number[:, None, None] if np.ndim(number) == 1 else number

        oil, share, coefficient = map(spread, (self.density, self.oil_fraction, self.drag_coefficient))
        return 0.125 * np.pi * (share * oil + (1.0 - share) * _AIR) * coefficient


@attrs.frozen(eq=False)
class Losses:
    """Torques on the shaft by source and place [N m], and powers [W] at its speed."""

    speed: np.ndarray  # (n,) of the shaft [rad/s]
    #: rolling, elastic_rolling, sliding : (n, 2, rows) of the contacts of both races
    rolling: np.ndarray
    elastic_rolling: np.ndarray
    sliding: np.ndarray
    drag: np.ndarray  # (n, rows) of the balls in the mixture
    seals: np.ndarray  # (n,) of seals and cage, as given
    #: (n, rows) largest part of the traction limit that a gyroscopic moment takes; from 1 on balls slip sideways
    gyroscopic: np.ndarray

    @property
    def contacts(self) -> np.ndarray:
        """(n, 2, rows) torque of the contacts."""
        return self.rolling + self.elastic_rolling + self.sliding

    @property
    def torque(self) -> np.ndarray:
        """(n,) of the bearing."""
        return np.asarray(self.contacts.sum(axis=(1, 2)) + self.drag.sum(axis=1) + self.seals)

    @property
    def contact_power(self) -> np.ndarray:
        """(n, 2, rows) heat that arises in the contacts."""
        return self.contacts * self.speed[:, None, None]

    @property
    def drag_power(self) -> np.ndarray:
        """(n,) heat that arises in the mixture of oil and air."""
        return np.asarray(self.drag.sum(axis=1) * self.speed)

    @property
    def seal_power(self) -> np.ndarray:
        """(n,) heat that arises at seals and cage."""
        return self.seals * self.speed


def losses(
    contacts: BallContacts, oil: Lubrication, speed: np.ndarray, seals: Number = 0.0, outer_race: bool = False
) -> Losses:
    """Friction of all contacts and balls at n points.

    speed : (n,) of the shaft [rad/s], 0 or more;  seals : torque of seals and cage [N m]
    outer_race : the outer race controls the spin and takes all of the gyroscopic moment; else the race that it costs less
    """
    n, rows = len(contacts.load), int(contacts.row.max()) + 1
    by_contacts, by_balls = np.zeros((n, 3, 2, rows)), np.zeros((n, 2, rows))
    speed = np.ascontiguousarray(speed, dtype=float)
    ball_losses(contacts.columns(oil.drag), oil.film, speed, outer_race, contacts.row, by_contacts, by_balls)
    rolling, elastic, sliding = by_contacts.swapaxes(0, 1)
    drag, gyroscopic = by_balls.swapaxes(0, 1)
    return Losses(speed, rolling, elastic, sliding, drag, np.broadcast_to(seals, speed.shape), gyroscopic)


def spin_shape(k: np.ndarray) -> np.ndarray:
    """Complete elliptic integral of the second kind at 1 - 1/k^2, by which 3/8 mu Q a is the moment of spin, to 4e-5.

    Source: Abramowitz, Stegun, Handbook of Mathematical Functions, 17.3.36.
    """
    m1 = np.minimum(1.0 / (k * k), 1.0)
    return np.asarray(1.0 + m1 * (0.46301506 + 0.10778124 * m1) - m1 * (0.24527272 + 0.04124960 * m1) * np.log(m1))
