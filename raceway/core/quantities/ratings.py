"""Load ratings of a row of balls, the loads of single contacts that they stand for, and lives from the loads of contacts.

C = b_m f_c cos(a)^0.7 Z^(2/3) D^1.8 with D in mm (3.647 D^1.4 above 25.4 mm) and C0 = f_0 Z D^2 cos(a), f_c and f_0 being
tabulated over g = D cos(a) / d_m for grooves of 0.52 D; one row of balls, lengths in metres.

Below g = 0.1 the table of f_0 bends down, because it allows an outer groove of 0.53 D, which then carries less than the inner one.
Makers whose outer groove is as narrow as the inner one go on with the inner race (one prints f_0 up to 16.8 for bearings of
g = 0.08): ``static_load_factor`` is the table from 0.1 on and the inner race's Hertz load at 4200 MPa below.

ISO 281:2007, table 2 and annex B, and ISO/TR 1281-1:2021 (closed form of f_c); ISO 76:2006, table 1, and ISO/TR 10657:2021
(4200 MPa); ISO/TS 16281:2008 (ratings of single contacts).

In lives contact loads are (..., 2, Z) [N], race 0 inner, 1 outer; the inner ring turns, the outer one stands.  Every number
broadcasts over the leading axes, one operating point each.

The risk of a point p of a ring goes with its equivalent load Q_e(p) = (mean over time of Q^3)^(1/3), the load that it sees once a
ball passes, and the risks of all points add up to that of the ring, (mean over its points of Q_e^(10/3))^(3/10).  Under a standing
load a point of the standing ring has one load and a point of the turning ring sees all: the exponents 10/3 and 3 of ISO/TS 16281.  A
load that turns with the inner ring exchanges the two.

Lundberg, Palmgren, Dynamic capacity of rolling bearings, Acta Polytechnica 7 (1947); ISO/TS 16281:2008, point contact;
ISO 281:2007, sections 8.3 and 9.3; ISO/TR 1281-2:2008.
"""

from functools import cache

import attrs
import numpy as np
from numpy.typing import ArrayLike

from raceway.core.columns import elliptic_integrals

#: Points of the table, and the smallest (b/a)^2 in it.
_POINTS, _FLATTEST = 4000, 1e-6

#: b_m of single-row radial and angular-contact ball bearings of contemporary steel.
_MATERIAL_FACTOR = 1.3
#: Ball diameter [m] above which the exponent of D changes, and the pressures of static rating and fatigue limit [Pa].
_LARGE, _PERMITTED, _FATIGUE = 25.4e-3, 4200e6, 1500e6
#: Conformity of the standards' tables, and contact modulus of steel on steel [Pa] in ISO/TR 10657.
_STANDARD, STEEL = 0.52, 0.5 * 207e9 / (1.0 - 0.3**2)
#: Mean load of the balls over that of the most loaded one, radial load and usual clearance (Stribeck).
STRIBECK = 5.0
#: Contact angle [rad] up to which a bearing is rated by its radial load.
STEEPEST = np.pi / 4.0
#: Pitch diameter [m] above which large bearings lose some of their fatigue limit.
_LARGE_PITCH = 0.1
#: f_c and f_0 over g = 0, 0.01 ... 0.40.
_F_C = np.array([
    0.0, 29.1, 35.8, 40.3, 43.8, 46.7, 49.1, 51.1, 52.8, 54.3, 55.5, 56.6, 57.5, 58.2,
    58.8, 59.3, 59.6, 59.8, 59.9, 60.0, 59.9, 59.8, 59.6, 59.3, 59.0, 58.6, 58.2, 57.7,
    57.1, 56.6, 56.0, 55.3, 54.6, 53.9, 53.2, 52.4, 51.7, 50.9, 50.0, 49.2, 48.4,
])  # fmt: skip
_F_0 = np.array([
    14.7, 14.9, 15.1, 15.3, 15.5, 15.7, 15.9, 16.1, 16.3, 16.5, 16.4, 16.1, 15.9, 15.6,
    15.4, 15.2, 14.9, 14.7, 14.4, 14.2, 14.0, 13.7, 13.5, 13.2, 13.0, 12.8, 12.5, 12.3,
    12.1, 11.8, 11.6, 11.4, 11.2, 10.9, 10.7, 10.5, 10.3, 10.0, 9.8, 9.6, 9.4,
])  # fmt: skip
_G = np.arange(_F_C.size) / 100.0
#: From here on the inner race limits the static rating.
_INNER_LIMITS = 10


@attrs.frozen(eq=False)
class BallRow:
    """One row of balls between its grooves; arrays that broadcast.

    count : Z;  diameter, pitch : D, d_m [m];  angle : nominal contact angle [rad]
    inner, outer : conformity r / D of the grooves, by default that of the standards' tables
    """

    count: np.ndarray = attrs.field(converter=np.asarray)
    diameter: np.ndarray = attrs.field(converter=np.asarray)
    pitch: np.ndarray = attrs.field(converter=np.asarray)
    angle: np.ndarray = attrs.field(converter=np.asarray)
    inner: np.ndarray = attrs.field(converter=np.asarray, default=_STANDARD)
    outer: np.ndarray = attrs.field(converter=np.asarray, default=_STANDARD)

    @property
    def gamma(self) -> np.ndarray:
        """g = D cos(a) / d_m."""
        return np.asarray(self.diameter * np.cos(self.angle) / self.pitch)

    @property
    def _grooves(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Curvature sum and difference at the inner and at the outer race."""
        races = ((self.inner, True), (self.outer, False))
        return [groove_curvatures(self.diameter, self.gamma, conformity, inner) for conformity, inner in races]

    def load_factor(self, modulus: float) -> np.ndarray:
        """K [N/m^1.5] of Q = K delta^1.5, both contacts in series, for a contact modulus E* [Pa]."""
        compliance = sum(hertz_load_factor(*shape, modulus) ** (-2.0 / 3.0) for shape in self._grooves)
        return np.asarray(np.asarray(compliance) ** -1.5)

    def dynamic_rating(self) -> np.ndarray:
        """C of ISO 281 [N]; conformities other than the tables' change f_c as the closed form of ISO/TR 1281-1 does."""
        d, g = self.diameter, self.gamma
        size = np.where(d <= _LARGE, (1e3 * d) ** 1.8, 3.647 * (1e3 * d) ** 1.4)
        standard = np.asarray(_STANDARD)
        factor = np.interp(g, _G, _F_C) * _closed_form(g, self.inner, self.outer) / _closed_form(g, standard, standard)
        return np.asarray(_MATERIAL_FACTOR * factor * np.cos(self.angle) ** 0.7 * self.count ** (2.0 / 3.0) * size)

    def static_rating(self) -> np.ndarray:
        """C0 of ISO 76 [N], by its table, whatever the conformities."""
        return np.asarray(static_load_factor(self.gamma) * self.count * (1e3 * self.diameter) ** 2 * np.cos(self.angle))

    def static_rating_of_grooves(self, modulus: float = STEEL) -> np.ndarray:
        """C0 [N] of the grooves: Z Q cos(a) / 5 with Q the ball load at 4200 MPa on the race that reaches it first.

        modulus : contact modulus E* [Pa], by default that of steel on steel in ISO/TR 10657
        """
        return np.asarray(self.count * self._loads_at(_PERMITTED, modulus).min(axis=0) * self._share(1.0 / STRIBECK))

    def _loads_at(self, pressure: float, modulus: float) -> np.ndarray:
        """Loads (2, ...) of a contact at the inner and at the outer race at a peak pressure [N]."""
        return np.stack(np.broadcast_arrays(*(_load_at_pressure(*shape, modulus, pressure) for shape in self._grooves)))

    def _share(self, mean: float) -> np.ndarray:
        """Rating over the load of all balls at that of the most loaded one: mean cos(a), of thrust bearings sin(a)."""
        return np.where(self.angle <= STEEPEST, mean * np.cos(self.angle), np.sin(self.angle))

    def contact_ratings(self, rating: ArrayLike) -> np.ndarray:
        """Loads Q_ci, Q_ce (2, ...) [N] of each ball under which inner and outer ring live a million revolutions.

        Parameters
        ----------
        rating : C [N] of one row: radial, of contact angles above 45 deg axial

        Notes
        -----
        With t = ((1 - g) / (1 + g))^1.72 (f_i / f_e (2 f_e - 1) / (2 f_i - 1))^0.41, radial bearings have
        Q_ci = C / (0.407 Z cos(a)^0.7) (1 + (1.044 t)^(10/3))^0.3, Q_ce = C / (0.389 Z cos(a)^0.7) (1 + (1.044 t)^(-10/3))^0.3,
        thrust bearings C / (Z sin(a)) (1 + t^(+-10/3))^0.3.

        References
        ----------
        ISO/TS 16281:2008, equations of Q_ci and Q_ce of ball bearings.
        """
        ratio = ((1.0 - self.gamma) / (1.0 + self.gamma)) ** 1.72
        ratio = ratio * (self.inner / self.outer * (2.0 * self.outer - 1.0) / (2.0 * self.inner - 1.0)) ** 0.41
        radial = self.angle <= STEEPEST
        ratio = np.where(radial, 1.044, 1.0) * ratio
        share = np.where(radial, np.cos(self.angle) ** 0.7, np.sin(self.angle)) * self.count
        inner = rating / np.where(radial, 0.407, 1.0) / share * (1.0 + ratio ** (10.0 / 3.0)) ** 0.3
        outer = rating / np.where(radial, 0.389, 1.0) / share * (1.0 + ratio ** (-10.0 / 3.0)) ** 0.3
        return np.stack(np.broadcast_arrays(inner, outer))

    def static_contact_ratings(self, rating: ArrayLike) -> np.ndarray:
        """Loads (2, ...) [N] of one contact at the inner and at the outer race that a static rating permits.

        Parameters
        ----------
        rating : C0 [N] of one row

        Notes
        -----
        C0 = Z Q cos(a) / 5 of radial bearings and Z Q sin(a) of thrust bearings give the load Q of the race that carries less
        (ISO/TR 10657); the other one may have the same pressure.
        """
        loads = self._loads_at(_PERMITTED, STEEL)
        return np.asarray(loads / loads.min(axis=0) * rating / (self.count * self._share(1.0 / STRIBECK)))

    def fatigue_load_limit(self, modulus: float = STEEL) -> np.ndarray:
        """C_u [N]: equivalent load under which no contact passes 1500 MPa, up to which clean, well lubricated steel does not tire.

        Parameters
        ----------
        modulus : contact modulus E* [Pa]

        Notes
        -----
        C_u = 0.2288 Z Q_u cos(a) (thrust bearings Z Q_u sin(a)), beyond pitch diameters of 100 mm times (100 mm / d_m)^0.5, with
        Q_u the load of the race that reaches 1500 MPa first.  Before the standard's shorter C_u = C0 / 22, of no special groove.

        References
        ----------
        ISO 281:2007, annex B, equations B.1 and B.9 to B.11.
        """
        limit = self.count * self._loads_at(_FATIGUE, modulus).min(axis=0) * self._share(0.2288)
        return np.asarray(limit * np.minimum(1.0, np.sqrt(_LARGE_PITCH / self.pitch)))


@cache
def _ellipse_table() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Curvature difference, (b/a)-scaled product a* b*, and delta* of growing ellipticity."""
    m1 = np.logspace(-1e-6, np.log10(_FLATTEST), _POINTS)
    (first, second), chi2 = elliptic_integrals(m1), 1.0 / m1
    difference = ((chi2 + 1.0) * second - 2.0 * first) / ((chi2 - 1.0) * second)
    area = (2.0 * chi2 * second / np.pi) ** (2.0 / 3.0) / np.sqrt(chi2)
    return difference, area, 2.0 * first / np.pi * (np.pi / (2.0 * chi2 * second)) ** (1.0 / 3.0)


def groove_curvatures(
    diameter: ArrayLike, g: ArrayLike, conformity: ArrayLike, inner: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Curvature sum [1/m] and difference of a ball in a groove, at g = D cos(a) / d_m; arrays that broadcast."""
    d, g, f = np.asarray(diameter), np.asarray(g), np.asarray(conformity)
    rolling = 2.0 * g / (1.0 - g) if inner else -2.0 * g / (1.0 + g)
    total = 4.0 - 1.0 / f + rolling
    return total / d, (1.0 / f + rolling) / total


def _load_at_pressure(curvature: np.ndarray, difference: np.ndarray, modulus: float, pressure: float) -> np.ndarray:
    """Load [N] at a peak pressure [Pa]: p = 1.5 Q / (pi a b), a b = a* b* (3 Q / (2 S E*))^(2/3)."""
    area = np.interp(difference, *_ellipse_table()[:2])
    return (2.0 * np.pi * area * pressure / 3.0) ** 3 * (1.5 / (curvature * modulus)) ** 2


def hertz_load_factor(curvature: np.ndarray, difference: np.ndarray, modulus: float) -> np.ndarray:
    """K [N/m^1.5] of Q = K delta^1.5."""
    differences, _, delta = _ellipse_table()
    unit = 2.0 / (curvature * np.interp(difference, differences, delta))
    return 2.0 / 3.0 * curvature * modulus * unit**1.5


def _closed_form(g: np.ndarray, fi: np.ndarray, fo: np.ndarray) -> np.ndarray:
    """The part of f_c that depends on g and on the conformities."""
    wide = (2.0 * fi / (2.0 * fi - 1.0)) ** 0.41
    both = 1.04 * ((1.0 - g) / (1.0 + g)) ** 1.72 * (fi / fo * (2.0 * fo - 1.0) / (2.0 * fi - 1.0)) ** 0.41
    return (1.0 + both ** (10.0 / 3.0)) ** -0.3 * wide


def static_load_factor(g: ArrayLike) -> np.ndarray:
    """f_0 [N/mm2] of ISO 76, below g = 0.1 that of the inner race."""
    g = np.asarray(g, dtype=float)
    low = np.clip(g, 1e-3, 0.1)
    inner = _load_at_pressure(*groove_curvatures(1.0, low, _STANDARD, True), STEEL, _PERMITTED)
    edge = _load_at_pressure(*groove_curvatures(1.0, np.array(0.1), _STANDARD, True), STEEL, _PERMITTED)
    return np.where(g < 0.1, _F_0[_INNER_LIMITS] * inner / edge, np.interp(g, _G, _F_0))


#: Weibull slope e of ball bearings: lives add up by L^-e.
_SLOPE = 10.0 / 9.0
#: Smallest life of any reliability, in basic lives, and the slope of the distribution above it (ISO/TR 1281-2).
_SMALLEST_LIFE, _SLOPE_OF_RELIABILITY = 0.05, 1.5
#: Viscosity ratios and the largest a_ISO that ISO 281's equations span.
VISCOSITY_RATIOS, _LARGEST_FACTOR = (0.1, 4.0), 50.0
#: Numerator and exponent of kappa in a_ISO of radial ball bearings, from a viscosity ratio on.
_LUBRICATION = (2.2649, 0.054381, 0.1), (1.9987, 0.19087, 0.4), (1.9987, 0.071739, 1.0)


def equivalent_loads(load: np.ndarray) -> np.ndarray:
    """Equivalent loads Q_ei, Q_ee (..., 2) [N] of inner and outer ring under standing contact loads (..., 2, Z) [N]."""
    cube = load * load * load
    standing = cube[..., 1, :] * np.cbrt(load[..., 1, :])
    return np.stack([np.cbrt(cube[..., 0, :].mean(axis=-1)), standing.mean(axis=-1) ** 0.3], axis=-1)


def equivalent_loads_of_turn(load: np.ndarray, follows: ArrayLike = True) -> np.ndarray:
    """Equivalent loads Q_ei, Q_ee (..., 2) [N] of inner and outer ring under contact loads that repeat themselves.

    load : (..., T, 2, Z) at T equally spaced moments of the motion, T a multiple of Z, at Z places that stand: the azimuths 2 pi j / Z
    follows : whether the inner ring turns once while the loads repeat themselves; else each of its points meets all of them

    The inner ring turns towards growing azimuths: its point at the place j of the first moment is at j + k after k of Z parts of a
    turn.  Of T = m Z moments each m-th one belongs to the same Z points of the inner ring.
    """
    turn, balls = load.shape[-3], load.shape[-1]
    if turn % balls:
        raise ValueError(f"{turn} moments of a turn are no multiple of {balls} balls")
    cube = load * load * load
    moment = np.arange(balls)[:, None]
    inner = cube[..., 0, :].reshape(*cube.shape[:-3], balls, turn // balls, balls)
    # Axes: parts of a turn, moments within a part, points of the ring.
    inner = np.moveaxis(inner, -2, -3)[..., moment, (np.arange(balls) + moment) % balls]
    points = inner.mean(axis=-2).reshape(*load.shape[:-3], turn), cube[..., 1, :].mean(axis=-2)
    of_inner, of_outer = ((point * np.cbrt(point) ** (1.0 / 3.0)).mean(axis=-1) ** 0.3 for point in points)
    return np.stack([np.where(follows, of_inner, np.cbrt(points[0].mean(axis=-1))), of_outer], axis=-1)


def at_places(load: np.ndarray, travel: np.ndarray) -> np.ndarray:
    """Contact loads (..., T, 2, Z) of balls that travel, at the places where they started, straight between neighbours.

    load : (..., T, 2, Z) of each ball [N];  travel : (..., T) of all balls towards growing azimuths, in pitches
    """
    pitches = np.floor(travel).astype(int)
    share = (travel - pitches)[..., None, None]
    ball = (np.arange(load.shape[-1]) - pitches[..., None])[..., None, :] % load.shape[-1]
    first, second = (np.take_along_axis(load, np.broadcast_to(each, load.shape), -1) for each in (ball, ball - 1))
    return np.asarray((1.0 - share) * first + share * second)


def ring_lives(load: np.ndarray, rating: np.ndarray) -> np.ndarray:
    """Lives (Q_c / Q_e)^3 [million revolutions] of rings under equivalent loads and ratings that broadcast; inf without load."""
    with np.errstate(divide="ignore"):
        return np.asarray((rating / load) ** 3)


def system_life(lives: np.ndarray, axis: int | tuple[int, ...] = -1) -> np.ndarray:
    """Life of what fails with its first part, (sum of L^(-10/9))^(-9/10), over the lives of rings and rows along ``axis``."""
    with np.errstate(divide="ignore"):
        return np.asarray((lives**-_SLOPE).sum(axis=axis) ** (-1.0 / _SLOPE))


def set_rating(ratings: np.ndarray) -> np.ndarray:
    """Dynamic rating [N] of a set from those (rows, ...) of its rows, i^0.7 C of i equal ones.

    i^-0.3 times the sum, of rows that share the load by their ratings: then all live (sum / F)^3, and the set i^-0.9 of that.
    """
    return np.asarray(len(ratings) ** (-1.0 / (3.0 * _SLOPE)) * ratings.sum(axis=0))


def reliability_factor(reliability: ArrayLike) -> np.ndarray:
    """a_1: life that a share of bearings reaches, over the basic life, which 90 % reach.

    Weibull's distribution of three parameters, a_1 = 0.05 + 0.95 (ln R / ln 0.9)^(2/3), gives the printed digits of ISO 281's
    table from 90 to 99.95 % and what is between them.
    """
    ratio = np.log(reliability) / np.log(0.9)
    return np.asarray(_SMALLEST_LIFE + (1.0 - _SMALLEST_LIFE) * ratio ** (1.0 / _SLOPE_OF_RELIABILITY))


def reference_viscosity(speed: ArrayLike, pitch_diameter: ArrayLike) -> np.ndarray:
    """nu_1 [m2/s], the kinematic viscosity that lubricates well at a speed of the inner ring [rad/s]; inf at rest.

    In mm2/s, r/min and mm: 45000 n^-0.83 d_m^-0.5 below 1000 r/min, 4500 n^-0.5 d_m^-0.5 from there on (ISO 281:2007, 9.3.3.3).
    """
    turns = np.abs(np.asarray(speed)) * 30.0 / np.pi
    with np.errstate(divide="ignore"):
        slow = np.where(turns < 1e3, 45000.0 * turns**-0.83, 4500.0 * turns**-0.5)
    return np.asarray(1e-6 * slow / np.sqrt(1e3 * np.asarray(pitch_diameter)))


def life_factor(viscosity_ratio: ArrayLike, load_ratio: ArrayLike) -> np.ndarray:
    """a_ISO of radial ball bearings: modified over basic life at 90 % reliability.

    viscosity_ratio : kappa = nu / nu_1; above 4 it counts as 4, below 0.1 the standard has no answer: nan
    load_ratio : e_C C_u / P, contamination factor times fatigue load limit over equivalent load

    a_ISO = 0.1 (1 - (2.5671 - c / kappa^p)^0.83 (e_C C_u / P)^(1/3))^-9.3, at most 50, with c, p = 2.2649, 0.054381 below
    kappa = 0.4, 1.9987, 0.19087 below 1, and 1.9987, 0.071739 from 1 on.

    ISO 281:2007, equations 31 to 33 (charts of figure 3).
    """
    kappa = np.minimum(viscosity_ratio, VISCOSITY_RATIOS[1])
    ranges = [kappa >= start for _, _, start in _LUBRICATION[::-1]]
    kappa_or_nan = np.where(ranges[-1], kappa, np.nan)
    lubrication = 2.5671 - np.select(ranges, [c / kappa_or_nan**p for c, p, _ in _LUBRICATION[::-1]], np.nan)
    with np.errstate(divide="ignore", invalid="ignore"):
        strength = 1.0 - lubrication**0.83 * np.cbrt(load_ratio)
        factor = 0.1 * np.maximum(strength, 0.0) ** -9.3
    return np.asarray(np.minimum(factor, _LARGEST_FACTOR))
