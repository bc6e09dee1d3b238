"""Basic load ratings of ball bearings: ISO 281 (dynamic) and ISO 76 (static), one row of balls, lengths in metres.

Notes
-----
C = b_m f_c cos(a)^0.7 Z^(2/3) D^1.8 with D in mm (3.647 D^1.4 above 25.4 mm) and C0 = f_0 Z D^2 cos(a), f_c and f_0 being
tabulated over g = D cos(a) / d_m for grooves of 0.52 D.

Below g = 0.1 the table of f_0 bends down, because it allows an outer groove of 0.53 D, which then carries less than the inner one.
Makers whose outer groove is as narrow as the inner one go on with the inner race (one prints f_0 up to 16.8 for bearings of
g = 0.08): ``_static_factor`` is the table from 0.1 on and the inner race's Hertz load at 4200 MPa below.

References
----------
ISO 281:2007, table 2, and ISO/TR 1281-1:2021 (closed form of f_c); ISO 76:2006, table 1, and ISO/TR 10657:2021 (4200 MPa).
"""

from __future__ import annotations

from functools import cache

import attrs
import numpy as np
from numpy.typing import ArrayLike

#: Steps of Newton's method, of which four reach rounding at preloads that bearings have.
_NEWTON = 8
#: Points of the table, and the smallest (b/a)^2 in it.
_POINTS, _FLATTEST = 4000, 1e-6

#: b_m of single-row radial and angular-contact ball bearings of contemporary steel.
_MATERIAL_FACTOR = 1.3
#: Ball diameter [m] above which the exponent of D changes, and the pressure of the static rating [Pa].
_LARGE, _PERMITTED = 25.4e-3, 4200e6
#: Conformity of the standards' tables; modulus and Poisson's ratio of ISO/TR 10657.
_STANDARD, _YOUNG, _POISSON = 0.52, 207e9, 0.3
_MODULUS = 0.5 * _YOUNG / (1.0 - _POISSON**2)
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


@cache
def _table() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Curvature difference, (b/a)-scaled product a* b*, and delta* of growing ellipticity."""
    from scipy.special import ellipe, ellipkm1

    m1 = np.logspace(-1e-6, np.log10(_FLATTEST), _POINTS)
    first, second, chi2 = ellipkm1(m1), ellipe(1.0 - m1), 1.0 / m1
    difference = ((chi2 + 1.0) * second - 2.0 * first) / ((chi2 - 1.0) * second)
    area = (2.0 * chi2 * second / np.pi) ** (2.0 / 3.0) / np.sqrt(chi2)
    return difference, area, 2.0 * first / np.pi * (np.pi / (2.0 * chi2 * second)) ** (1.0 / 3.0)


def _groove(diameter: ArrayLike, g: ArrayLike, conformity: ArrayLike, inner: bool) -> tuple[np.ndarray, np.ndarray]:
    """Curvature sum [1/m] and difference of a ball in a groove, at g = D cos(a) / d_m; arrays that broadcast."""
    d, g, f = np.asarray(diameter), np.asarray(g), np.asarray(conformity)
    rolling = 2.0 * g / (1.0 - g) if inner else -2.0 * g / (1.0 + g)
    total = 4.0 - 1.0 / f + rolling
    return total / d, (1.0 / f + rolling) / total


def _load_at_pressure(curvature: np.ndarray, difference: np.ndarray, modulus: float, pressure: float) -> np.ndarray:
    """Load [N] at a peak pressure [Pa]: p = 1.5 Q / (pi a b), a b = a* b* (3 Q / (2 S E*))^(2/3)."""
    area = np.interp(difference, *_table()[:2])
    return (2.0 * np.pi * area * pressure / 3.0) ** 3 * (1.5 / (curvature * modulus)) ** 2


def _load_factor(curvature: np.ndarray, difference: np.ndarray, modulus: float) -> np.ndarray:
    """K [N/m^1.5] of Q = K delta^1.5."""
    differences, _, delta = _table()
    unit = 2.0 / (curvature * np.interp(difference, differences, delta))
    return 2.0 / 3.0 * curvature * modulus * unit**1.5


@attrs.frozen(eq=False)
class BallRow:
    """One row of balls between its grooves; arrays that broadcast.

    Attributes
    ----------
    count : Z;  diameter, pitch : D, d_m [m];  angle : free contact angle [rad]
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
        return [_groove(self.diameter, self.gamma, conformity, inner) for conformity, inner in races]

    def dynamic_rating(self) -> np.ndarray:
        """C of ISO 281 [N]; conformities other than the tables' change f_c as the closed form of ISO/TR 1281-1 does."""
        d, g = self.diameter, self.gamma
        size = np.where(d <= _LARGE, (1e3 * d) ** 1.8, 3.647 * (1e3 * d) ** 1.4)
        standard = np.asarray(_STANDARD)
        factor = np.interp(g, _G, _F_C) * _closed(g, self.inner, self.outer) / _closed(g, standard, standard)
        return np.asarray(_MATERIAL_FACTOR * factor * np.cos(self.angle) ** 0.7 * self.count ** (2.0 / 3.0) * size)

    def static_rating(self) -> np.ndarray:
        """C0 of ISO 76 [N], by its table, whatever the conformities."""
        return np.asarray(_static_factor(self.gamma) * self.count * (1e3 * self.diameter) ** 2 * np.cos(self.angle))

    def static_rating_of_grooves(self) -> np.ndarray:
        """C0 [N] of the grooves: Z Q cos(a) / 5 with Q the ball load at 4200 MPa on the race that reaches it first."""
        loads = [_load_at_pressure(*shape, _MODULUS, _PERMITTED) for shape in self._grooves]
        return np.asarray(self.count * np.minimum(*loads) * np.cos(self.angle) / 5.0)

    def pair_stiffness(self, preload: ArrayLike, young: float, poisson: float) -> np.ndarray:
        """Axial stiffness [N/m] of two such rows back to back or face to face under a rigid preload.

        Parameters
        ----------
        preload : [N];  young, poisson : of balls and rings, [Pa] and 1
        """
        modulus = 0.5 * young / (1.0 - poisson**2)
        compliance = sum(_load_factor(*shape, modulus) ** (-2.0 / 3.0) for shape in self._grooves)
        factor = np.asarray(compliance) ** -1.5
        distance = (self.inner + self.outer - 1.0) * self.diameter
        stretch = _stretch(np.asarray(preload) / (self.count * factor * distance**1.5), np.cos(self.angle))
        cosine = np.cos(self.angle) / (1.0 + stretch)
        approach, length = stretch * distance, (1.0 + stretch) * distance
        along = 1.5 * factor * np.sqrt(approach) * (1.0 - cosine**2) + factor * approach**1.5 / length * cosine**2
        return np.asarray(2.0 * self.count * along)


def _stretch(load: np.ndarray, cosine: np.ndarray) -> np.ndarray:
    """t = cos(a) / cos(b) - 1 of sin(b) t^1.5 = ``load``, by Newton's method from above: sin(b) is at least sin(a)."""
    t = (load / np.sqrt(1.0 - cosine**2)) ** (2.0 / 3.0)
    for _ in range(_NEWTON):
        sine = np.sqrt(1.0 - (cosine / (1.0 + t)) ** 2)
        slope = 1.5 * np.sqrt(t) * sine + t**1.5 * cosine**2 / ((1.0 + t) ** 3 * sine)
        t = t - (sine * t**1.5 - load) / slope
    return np.asarray(t)


def _closed(g: np.ndarray, fi: np.ndarray, fo: np.ndarray) -> np.ndarray:
    """The part of f_c that depends on g and on the conformities."""
    wide = (2.0 * fi / (2.0 * fi - 1.0)) ** 0.41
    both = 1.04 * ((1.0 - g) / (1.0 + g)) ** 1.72 * (fi / fo * (2.0 * fo - 1.0) / (2.0 * fi - 1.0)) ** 0.41
    return (1.0 + both ** (10.0 / 3.0)) ** -0.3 * wide


def _static_factor(g: ArrayLike) -> np.ndarray:
    """f_0 [N/mm2] of ISO 76, below g = 0.1 that of the inner race."""
    g = np.asarray(g, dtype=float)
    low = np.clip(g, 1e-3, 0.1)
    inner = _load_at_pressure(*_groove(1.0, low, _STANDARD, True), _MODULUS, _PERMITTED)
    edge = _load_at_pressure(*_groove(1.0, np.array(0.1), _STANDARD, True), _MODULUS, _PERMITTED)
    return np.where(g < 0.1, _F_0[_INNER_LIMITS] * inner / edge, np.interp(g, _G, _F_0))
