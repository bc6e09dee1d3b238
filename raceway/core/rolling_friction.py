"""Friction of balls that roll between races: losses in the contacts and in the mixture of oil and air around the balls.

Notes
-----
Powers are work that the shaft loses: force or moment times the rate at which it slips or rolls, all rates in proportion to the shaft's
speed w.  Divided by w they are the torque on the shaft.  Of a contact, with its load Q, semi-axes a across and b along the running
direction, entraining speed u, radius R_x = D (1 -+ g) / 2 along it, g = D cos(angle) / d_m, - at the inner race:

rolling          u 2 F_R, the oil's shear in the inlet (``_hydrodynamic_force``)
elastic rolling  u / R_x M, hysteresis of the bodies (``_hysteresis_moment``)
sliding          mu Q times the mean slip by spin and by the curvature of the contact (``_mean_slip``), with the coefficient of the oil's
                 traction curve (``_traction_coefficient``); the gyroscopic moment adds slip across the running direction

Balls turn about an axis in the plane of the two contacts, rolling without slip at both centres.  Its angle is between those at which the
outer and the inner contact do not spin, next to the one that dissipates less: of Coulomb friction all angles between cost the same where
both ends do, so the passage from one to the other costs nothing.

Not modelled: heat of the contact's own shear, which lowers traction at high slip; starvation; roughness; cage and lands.

References
----------
Harris & Kotzalas, Advanced Concepts of Bearing Technology, 5th ed., chapters 2 and 5 (spin, race control, R = 2 f D / (2 f + 1)).
"""

from __future__ import annotations

from functools import cached_property
from typing import TypeVar

import attrs
import numpy as np

from raceway.core.columns import Number

T = TypeVar("T", bound=attrs.AttrsInstance)
#: - at the inner race, + at the outer one.
_SIDES = np.array([[-1.0], [1.0]])
#: Points that are computed at once: their arrays stay in the processor's caches.
_BLOCK = 512
#: Slip by curvature stops at +-0.3473 a where spin is absent: half of the load lies inside.
_ROLLING = 0.34729635533386066**2
#: How sharply the axis of a ball turns from one race's control to the other's, as a power of the ratio of their losses.
_SHARPNESS = 8
#: Part of the traction limit that the gyroscopic moment takes at most: beyond, balls slip sideways and the slip is not bounded.
_GYROSCOPIC_LIMIT = 0.9
#: Density of air [kg/m3].
_AIR = 1.2
#: E' of steel on steel, 206 GPa and 0.3 [Pa], for which the hysteresis moment was published.
_STEEL = 226.4e9


@attrs.frozen(eq=False, slots=False)
class BallContacts:
    """Contacts of Z balls at n points; arrays that broadcast to (n, 2, Z), race 0 inner, 1 outer.

    Attributes
    ----------
    load : [N], 0 where open;  angle : [rad], nan where open
    semi_major, semi_minor : of the ellipse under the load [m], major across the running direction
    ball_diameter, pitch_diameter : [m];  conformity : groove radius over ball diameter
    modulus : E' = 2 E* [Pa];  inertia : of a ball [kg m2]
    """

    load: np.ndarray
    angle: np.ndarray
    semi_major: np.ndarray
    semi_minor: np.ndarray
    ball_diameter: Number
    pitch_diameter: Number
    conformity: Number
    modulus: Number
    inertia: Number

    @cached_property
    def direction(self) -> tuple[np.ndarray, np.ndarray]:
        """Cosine and sine of the angle; of an open contact those of the ball's other one."""
        angle = self.angle
        if (unknown := np.isnan(angle)).any():
            angle = np.where(unknown, angle[:, ::-1], angle)
            angle = np.where(np.isnan(angle), 0.0, angle)
        return np.cos(angle), np.sin(angle)

    @cached_property
    def along(self) -> np.ndarray:
        """Effective radius R_x along the running direction [m]."""
        g = self.ball_diameter / self.pitch_diameter * self.direction[0]
        return np.asarray(0.5 * self.ball_diameter * (1.0 + _SIDES * g))


@attrs.frozen(eq=False)
class Lubrication:
    """The oil in and around the contacts; numbers, or arrays that broadcast to (n, 2, Z).

    Attributes
    ----------
    viscosity : dynamic, at the inlets [Pa s];  pressure_viscosity : alpha [1/Pa];  temperature_viscosity : beta [1/K]
    conductivity : [W/m/K];  density : [kg/m3]
    traction_limit : largest traction coefficient;  eyring_stress : [Pa]
    oil_fraction : volume of oil over that of the space around the balls;  drag_coefficient : of a ball in the mixture
    """

    viscosity: Number
    pressure_viscosity: Number
    temperature_viscosity: Number
    conductivity: Number
    density: Number
    traction_limit: Number
    eyring_stress: Number
    oil_fraction: Number
    drag_coefficient: Number


@attrs.frozen(eq=False)
class _Rates:
    """_Rates of n points over the shaft's speed; (n, 2, Z), but cage (n, 1, Z).

    Attributes
    ----------
    cage : turns of the cage;  entraining : u / w [m];  rolling : of the ball against the race about the contact's major axis
    spin : about the contact's normal;  gyroscopic : ball's rate of turn about its axis times the sine between axis and shaft
    """

    cage: np.ndarray
    entraining: np.ndarray
    rolling: np.ndarray
    spin: np.ndarray
    gyroscopic: np.ndarray


@attrs.frozen(eq=False)
class Losses:
    """Torques on the shaft by source and place [N m], and powers [W] at its speed.

    Attributes
    ----------
    speed : (n,) of the shaft [rad/s]
    rolling, elastic_rolling, sliding : (n, 2, Z) of the contacts
    drag : (n, Z) of the balls in the mixture;  seals : (n,) of seals and cage, as given
    gyroscopic : (n, Z) part of the traction limit that the gyroscopic moment takes; from 1 on balls slip sideways
    """

    speed: np.ndarray
    rolling: np.ndarray
    elastic_rolling: np.ndarray
    sliding: np.ndarray
    drag: np.ndarray
    seals: np.ndarray
    gyroscopic: np.ndarray

    @property
    def contacts(self) -> np.ndarray:
        """(n, 2, Z) torque of each contact."""
        return self.rolling + self.elastic_rolling + self.sliding

    @property
    def torque(self) -> np.ndarray:
        """(n,) of the bearing."""
        return np.asarray(self.contacts.sum(axis=(1, 2)) + self.drag.sum(axis=1) + self.seals)

    @property
    def contact_power(self) -> np.ndarray:
        """(n, 2, Z) heat that arises in each contact."""
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

    Parameters
    ----------
    speed : (n,) of the shaft [rad/s], 0 or more;  seals : torque of seals and cage [N m]
    outer_race : the outer race controls the spin and takes all of the gyroscopic moment; else the race that it costs less
    """
    if len(speed) > _BLOCK:
        blocks = [slice(k, k + _BLOCK) for k in range(0, len(speed), _BLOCK)]
        parts = [losses(_at(contacts, k), _at(oil, k), speed[k], _part(seals, k), outer_race) for k in blocks]
        joined = {name: np.concatenate([getattr(part, name) for part in parts]) for name in attrs.fields_dict(Losses)}
        return Losses(**joined)
    with np.errstate(divide="ignore", invalid="ignore"):
        rates = _ball_rates(contacts, outer_race)
        w, q, a = speed[:, None, None], contacts.load, contacts.semi_major
        entraining = rates.entraining * w
        slip = _mean_slip(
            rates.spin * a * _spin_shape(a / contacts.semi_minor), rates.rolling * (a * a / (2.0 * _effective(contacts)))
        )
        sliding = _traction_coefficient(contacts, oil, slip * w, entraining) * q * slip
        # The moment acts on the ball, traction on its surface: as loads share it, or all at the outer race.
        able = oil.traction_limit * q
        held = able[:, 1:] if outer_race else able[:, :1] + able[:, 1:]
        moment = contacts.inertia * rates.gyroscopic * rates.cage * (w * w)
        sideways = np.where(held > 0.0, 2.0 * moment / (contacts.ball_diameter * held), 0.0)
        across = 1.0 / np.sqrt(1.0 - np.minimum(sideways, _GYROSCOPIC_LIMIT) ** 2)
        sliding = sliding * (np.concatenate([np.ones_like(across), across], axis=1) if outer_race else across)
        rolling = rates.entraining * _hydrodynamic_force(contacts, oil, entraining)
        elastic = rates.rolling * _hysteresis_moment(contacts)
    if not (loaded := q > 0.0).all():
        rolling, elastic, sliding = (np.where(loaded, part, 0.0) for part in (rolling, elastic, sliding))
    drag = _drag_force(contacts, oil, rates.cage * w) * 0.5 * contacts.pitch_diameter * rates.cage
    return Losses(speed, rolling, elastic, sliding, drag[:, 0], np.broadcast_to(seals, speed.shape), sideways[:, 0])


def _part(number: Number, block: slice) -> Number:
    """A number, or of a column or an array with a first axis of points those of a block."""
    return number[block] if np.ndim(number) and len(number) > 1 else number


def _at(part: T, block: slice) -> T:
    """A record with the points of a block."""
    return type(part)(*(_part(value, block) for value in attrs.astuple(part, recurse=False)))


def _ball_rates(contacts: BallContacts, outer_race: bool = False) -> _Rates:
    """_Rates of balls that roll without slip at the centres of both contacts; the axis as in ``losses``.

    Notes
    -----
    In the cage's frame, with the ball's rate w_B about an axis at the angle t against the shaft's:
    (w - w_c) d_m (1 - g_i) = w_B D cos(a_i - t), w_c d_m (1 + g_o) = w_B D cos(a_o - t).  Spin: (w - w_c) sin a_i + w_B sin(a_i - t) at
    the inner race, w_B sin(a_o - t) - w_c sin a_o at the outer one.  It is 0 at tan t = sin a / (cos a +- D / d_m), + at the outer race;
    the other contact then spins by w sin a + w sin(a_i - a_o) d_m / (D (1 + v)), v = (cos(a_i - a_o) -+ g) / (1 +- g), upper signs at the
    outer race.

    References
    ----------
    Jones, J. Basic Eng. 81 (1959) 1; Harris, J. Lubr. Technol. 93 (1971) 32.
    """
    (cosine, sine), ratio = contacts.direction, contacts.ball_diameter / contacts.pitch_diameter
    axial = cosine + _SIDES * ratio
    if outer_race:
        return _about(axial[:, 1:], sine[:, 1:], contacts)
    (inner, outer), (inner_sine, outer_sine) = ((part[:, :1], part[:, 1:]) for part in (cosine, sine))
    level, tilt = inner * outer + inner_sine * outer_sine, inner_sine * outer - inner * outer_sine
    over = (level - _SIDES * ratio * cosine) / (contacts.along / (0.5 * contacts.ball_diameter))
    loss = contacts.load * contacts.semi_major * np.abs(sine + tilt / (ratio * (1.0 + over)))
    share = loss[:, :1] / np.maximum(loss[:, :1] + loss[:, 1:], 1e-300)
    by_inner, by_outer = share**_SHARPNESS, (1.0 - share) ** _SHARPNESS
    part = by_outer / (by_inner + by_outer)
    x, y = (part * each[:, 1:] + (1.0 - part) * each[:, :1] for each in (axial, sine))
    return _about(x, y, contacts)


def _about(axial: np.ndarray, radial: np.ndarray, contacts: BallContacts) -> _Rates:
    """Rates of balls about an axis with components (n, 1, Z) along and across the shaft, of any length."""
    (cosine, sine), ratio = contacts.direction, contacts.ball_diameter / contacts.pitch_diameter
    width = contacts.along / (0.5 * contacts.ball_diameter)
    along = cosine * axial + sine * radial
    over = along / width
    ball = 1.0 / (ratio * (over[:, :1] + over[:, 1:]))
    race = ball * ratio * over
    spin = np.abs(ball * (sine * axial - cosine * radial) - _SIDES * race * sine)
    return _Rates(race[:, 1:], 0.5 * contacts.pitch_diameter * race * width, race / ratio, spin, np.abs(ball * radial))


def _effective(contacts: BallContacts) -> Number:
    """Radius across the running direction of the surface in which ball and groove meet [m]."""
    f = contacts.conformity
    return 2.0 * f * contacts.ball_diameter / (2.0 * f + 1.0)


def _hydrodynamic_force(contacts: BallContacts, oil: Lubrication, entraining: np.ndarray) -> np.ndarray:
    """2 F_R [N], shear of the oil in the inlet on both surfaces together, by which the entraining speed is resisted.

    Parameters
    ----------
    entraining : (n, 2, Z) mean speed of both surfaces against the contact [m/s]

    Notes
    -----
    Full film, from the isoviscous-rigid to the elastohydrodynamic regime: with p = 3 Q / (2 pi a b), r = b E' / (pi p R_x),
    W = Q / (E' R_x^2), U = 2 eta u / (E' R_x) and M = r^(1/4) (b/a) W U^(-3/4),
    2 F_R = 2 a E' R_x ((0.77 r^(-1/3) (b/a)^0.12 U^(2/3) - f) / (1 + M / 6.6) + f), f = 1.8 r^(-1/4) U^(3/4); reduced by the heat of the
    inlet, 1 / (1 + 0.29 L^0.78) at the thermal loading L = eta beta u^2 / k.  The shear of both surfaces in Grubin's inlet, summed over
    strips of the ellipse, is 0.75 to 1.25 times the isothermal force where contacts are elastohydrodynamic.

    References
    ----------
    Biboulet, Houpert, Proc. IMechE J 224 (2010) 777, as coded with a number in the open program D-BRAIN (Tribology.cpp), where the
    exponent -1/3 is written as an integer division and the number is that of the exact one; Aihara, J. Tribol. 109 (1987) 471 for the
    heat of the inlet, as coded there.
    """
    along = contacts.along
    a, b, q, e = contacts.semi_major, contacts.semi_minor, contacts.load, contacts.modulus
    r = 2.0 * e * a * b**2 / (3.0 * q * along)
    u = 2.0 * oil.viscosity * entraining / (e * along)
    root, cube = np.sqrt(u), np.cbrt(u)
    elastic, quarter = 1.8 * root * np.sqrt(root), np.sqrt(np.sqrt(r))
    regime = quarter * (b / a) * q / (e * along**2) / (root * np.sqrt(root))
    rigid = 0.77 * np.exp(0.12 * np.log(b / a)) * cube * cube / np.cbrt(r)
    force = 2.0 * a * e * along * ((rigid - elastic / quarter) / (1.0 + regime / 6.6) + elastic / quarter)
    heated = 1.0 + 0.29 * np.exp(0.78 * np.log(_loading(oil, entraining)))
    return np.asarray(np.where(entraining > 0.0, force / heated, 0.0))


def _hysteresis_moment(contacts: BallContacts) -> np.ndarray:
    """(n, 2, Z) moment against rolling by elastic hysteresis of steel [N m].

    Notes
    -----
    M = 7.48e-7 (D/2)^0.33 Q^1.33 (1 - 3.519e-3 (k - 1)^0.8063), k = a/b, in m and N; of other materials times (E'_steel / E')^(1/3), by
    which contacts of the same load are smaller.  Of a ball on a plane it is 3/16 c a Q with a loss c of 2.3 % of the elastic work.

    References
    ----------
    Houpert, Tribol. Trans. 45 (2002) 345, as coded in open programs of ball screws (MER; one prints 3.519e-36, a misprint).
    """
    k = np.maximum(contacts.semi_major / contacts.semi_minor - 1.0, 0.0)
    moment = 7.48e-7 * (0.5 * contacts.ball_diameter) ** 0.33 * contacts.load**1.33 * (1.0 - 3.519e-3 * k**0.8063)
    return np.asarray(moment * np.cbrt(_STEEL / contacts.modulus))


def _mean_slip(spin: np.ndarray, curvature: np.ndarray) -> np.ndarray:
    """Mean of the slip's size over a contact, weighted by the pressure: v = spin t + curvature (t^2 - c), t from -1 to 1 across.

    Parameters
    ----------
    spin, curvature : speeds at the end of the ellipse, of one unit, 0 or more

    Notes
    -----
    The load per width falls as 1 - t^2.  Where friction is the same in all directions, c is such that tractions balance, which is the
    least dissipation: 0 where spin is the larger, 0.1206 without spin, between them 0.1206 (1 - (spin / curvature)^2)^(3/2) to 2 %, which
    the mean hardly minds.  The slip is integrated exactly.  Limits: 3/8 spin, and 0.1611 curvature: Houpert's 0.0806 mu Q a^2 / R of
    curvature and 3/8 mu Q a of spin.
    """
    h = curvature
    ratio = np.minimum(spin / np.maximum(h, 1e-300), 1.0)
    c = _ROLLING * (1.0 - ratio * ratio) ** 1.5
    root = spin + np.sqrt(spin * spin + 4.0 * c * h * h)
    # Zeros of the slip: the upper one always within the contact, the lower one where curvature is the larger.
    upper = 2.0 * h * c / np.maximum(root, 1e-300)
    lower = np.maximum(-0.5 * root / np.maximum(h, 1e-300), -1.0)

    def below(t: np.ndarray) -> np.ndarray:
        square = t * t
        return np.asarray(
            square * (spin * (0.5 - 0.25 * square)) + t * h * (square * (1.0 / 3.0 - 0.2 * square + c / 3.0) - c)
        )

    return np.asarray(h * (0.2 - c) + 1.5 * (below(lower) - below(upper)))


def _spin_shape(k: np.ndarray) -> np.ndarray:
    """Complete elliptic integral of the second kind at 1 - 1/k^2, by which 3/8 mu Q a is the moment of spin, to 4e-5.

    References
    ----------
    Abramowitz, Stegun, Handbook of Mathematical Functions, 17.3.36.
    """
    m1 = np.minimum(1.0 / (k * k), 1.0)
    return np.asarray(
        1.0 + m1 * (0.46301506 + 0.10778124 * m1) - m1 * (0.24527272 + 0.04124960 * m1) * np.log(np.maximum(m1, 1e-300))
    )


def _traction_coefficient(contacts: BallContacts, oil: Lubrication, slip: np.ndarray, entraining: np.ndarray) -> np.ndarray:
    """Mean shear stress over mean pressure of the film.

    Parameters
    ----------
    slip, entraining : (n, 2, Z) [m/s]

    Notes
    -----
    Eyring: tau = tau_E asinh(eta(p) slip / (h tau_E)), eta(p) = eta exp(alpha p) (Barus) at the mean pressure p = Q / (pi a b), in the
    central film h of Hamrock and Dowson, less what the inlet's heat takes; at most ``traction_limit`` p.

    References
    ----------
    Johnson, Tevaarwerk, Proc. R. Soc. A 356 (1977) 215 (Eyring); Jacod, Venner, Lugt, J. Tribol. 123 (2001) 248.
    """
    a, b, q, along, e = contacts.semi_major, contacts.semi_minor, contacts.load, contacts.along, contacts.modulus
    pressure = q / (np.pi * a * b)
    u, w = oil.viscosity * entraining / (e * along), q / (e * along * along)
    film = 0.67 * np.log(u) - 0.067 * np.log(w) + 0.53 * np.log(oil.pressure_viscosity * e)
    bracket = 2.69 * along * (1.0 - 0.61 * np.exp(-0.73 * a / b)) * oil.eyring_stress
    thinned = 1.0 + 0.254 * np.exp(0.62 * np.log(_loading(oil, entraining)))
    # asinh(exp(y)) = y + log(1 + sqrt(1 + exp(-2 y)))
    y = np.log(np.maximum(oil.viscosity * slip * thinned / bracket, 1e-300)) - film + oil.pressure_viscosity * pressure
    y = np.maximum(y, -300.0)
    stress = oil.eyring_stress * (y + np.log1p(np.sqrt(1.0 + np.exp(-2.0 * y))))
    return np.asarray(np.where((slip > 0.0) & (entraining > 0.0), np.minimum(stress / pressure, oil.traction_limit), 0.0))


def _loading(oil: Lubrication, entraining: np.ndarray) -> np.ndarray:
    """Thermal loading of the inlets."""
    return np.asarray(oil.viscosity * oil.temperature_viscosity / oil.conductivity * entraining * entraining)


def _drag_force(contacts: BallContacts, oil: Lubrication, cage: np.ndarray) -> np.ndarray:
    """Force of oil and air on each ball [N]: half the density of the mixture times C_D pi D^2 / 4 and the square of its speed.

    Parameters
    ----------
    cage : turns of the cage [rad/s]

    Notes
    -----
    Density: that of oil and of air of 1.2 kg/m3, by volume.  A sphere alone has a C_D of 0.44 at Reynolds numbers of 1e3 to 2e5; balls
    in a cage shelter each other.

    References
    ----------
    Harris & Kotzalas, Essential Concepts of Bearing Technology, 5th ed., chapter 10 (with the speed to the power 1.95); Schiller,
    Naumann, VDI Z. 77 (1933) 318 (sphere).
    """
    density = oil.oil_fraction * oil.density + (1.0 - oil.oil_fraction) * _AIR
    front = 0.25 * np.pi * contacts.ball_diameter**2
    return np.asarray(0.5 * density * oil.drag_coefficient * front * (0.5 * contacts.pitch_diameter * cage) ** 2)
