"""Reference life of a ball bearing from the loads of its contacts, and its modified life.

Contact loads are (..., 2, Z) [N], race 0 inner, 1 outer; the inner ring turns, the outer one stands.  Every number broadcasts over
the leading axes, one operating point each.

The risk of a point p of a ring goes with its equivalent load Q_e(p) = (mean over time of Q^3)^(1/3), the load that it sees once a
ball passes, and the risks of all points add up to that of the ring, (mean over its points of Q_e^(10/3))^(3/10).  Under a standing
load a point of the standing ring has one load and a point of the turning ring sees all: the exponents 10/3 and 3 of ISO/TS 16281.  A
load that turns with the inner ring exchanges the two.

Lundberg, Palmgren, Dynamic capacity of rolling bearings, Acta Polytechnica 7 (1947); ISO/TS 16281:2008, point contact;
ISO 281:2007, sections 8.3 and 9.3; ISO/TR 1281-2:2008.
"""

import numpy as np
from numpy.typing import ArrayLike

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
