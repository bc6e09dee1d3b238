"""Hertz contacts of balls in many grooves at once, and the axial stiffness of a preloaded pair in closed form.

Notes
-----
Ellipticity and approach are interpolated in a table of exact elliptic integrals over the curvature difference, whose 4000 points
leave 1e-7.  Under a purely axial load all balls are alike: with B the distance of the groove centres, a the free and b the loaded
contact angle, F = Z K B^1.5 sin(b) (cos(a) / cos(b) - 1)^1.5, K of Q = K delta^1.5 holding both races in series.

References
----------
Harris & Kotzalas, Essential Concepts of Bearing Technology, 5th ed., chapters 6 and 7.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import ArrayLike

#: Steps of Newton's method, of which four reach rounding at preloads that bearings have.
_NEWTON = 8
#: Points of the table, and the smallest (b/a)^2 in it.
_POINTS, _FLATTEST = 4000, 1e-6


@cache
def _table() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Curvature difference, (b/a)-scaled product a* b*, and delta* of growing ellipticity."""
    from scipy.special import ellipe, ellipkm1

    m1 = np.logspace(-1e-6, np.log10(_FLATTEST), _POINTS)
    first, second, chi2 = ellipkm1(m1), ellipe(1.0 - m1), 1.0 / m1
    difference = ((chi2 + 1.0) * second - 2.0 * first) / ((chi2 - 1.0) * second)
    area = (2.0 * chi2 * second / np.pi) ** (2.0 / 3.0) / np.sqrt(chi2)
    return difference, area, 2.0 * first / np.pi * (np.pi / (2.0 * chi2 * second)) ** (1.0 / 3.0)


def groove(diameter: ArrayLike, g: ArrayLike, conformity: ArrayLike, inner: bool) -> tuple[np.ndarray, np.ndarray]:
    """Curvature sum [1/m] and difference of a ball in a groove, at g = D cos(a) / d_m; arrays that broadcast."""
    d, g, f = np.asarray(diameter), np.asarray(g), np.asarray(conformity)
    rolling = 2.0 * g / (1.0 - g) if inner else -2.0 * g / (1.0 + g)
    total = 4.0 - 1.0 / f + rolling
    return total / d, (1.0 / f + rolling) / total


def load_at_pressure(curvature: np.ndarray, difference: np.ndarray, modulus: float, pressure: float) -> np.ndarray:
    """Load [N] at a peak pressure [Pa]: p = 1.5 Q / (pi a b), a b = a* b* (3 Q / (2 S E*))^(2/3)."""
    area = np.interp(difference, *_table()[:2])
    return (2.0 * np.pi * area * pressure / 3.0) ** 3 * (1.5 / (curvature * modulus)) ** 2


def load_factor(curvature: np.ndarray, difference: np.ndarray, modulus: float) -> np.ndarray:
    """K [N/m^1.5] of Q = K delta^1.5."""
    known, _, delta = _table()
    unit = 2.0 / (curvature * np.interp(difference, known, delta))
    return 2.0 / 3.0 * curvature * modulus * unit**1.5


def pair_stiffness(
    count: ArrayLike,
    diameter: ArrayLike,
    pitch: ArrayLike,
    angle: ArrayLike,
    inner: ArrayLike,
    outer: ArrayLike,
    preload: ArrayLike,
    young: float,
    poisson: float,
) -> np.ndarray:
    """Axial stiffness [N/m] of two equal rows back to back or face to face under a rigid preload.

    Parameters
    ----------
    count, diameter, pitch, angle, inner, outer, preload : arrays that broadcast: Z, D [m], d_m [m], free contact angle [rad],
        r / D of both grooves, preload [N]
    young, poisson : of balls and rings [Pa]
    """
    d, free = np.asarray(diameter), np.asarray(angle)
    g, modulus = d * np.cos(free) / np.asarray(pitch), 0.5 * young / (1.0 - poisson**2)
    compliance = sum(
        load_factor(*groove(d, g, f, race), modulus) ** (-2.0 / 3.0) for f, race in ((inner, True), (outer, False))
    )
    factor = np.asarray(compliance) ** -1.5
    distance = (np.asarray(inner) + np.asarray(outer) - 1.0) * d
    wanted = np.asarray(preload) / (np.asarray(count) * factor * distance**1.5)
    stretch = _stretch(wanted, np.cos(free))
    cosine = np.cos(free) / (1.0 + stretch)
    approach, length = stretch * distance, (1.0 + stretch) * distance
    along = 1.5 * factor * np.sqrt(approach) * (1.0 - cosine**2) + factor * approach**1.5 / length * cosine**2
    return 2.0 * np.asarray(count) * along


def _stretch(wanted: np.ndarray, cosine: np.ndarray) -> np.ndarray:
    """t = cos(a) / cos(b) - 1 of sin(b) t^1.5 = ``wanted``, by Newton's method from above: sin(b) is at least sin(a)."""
    t = (wanted / np.sqrt(1.0 - cosine**2)) ** (2.0 / 3.0)
    for _ in range(_NEWTON):
        sine = np.sqrt(1.0 - (cosine / (1.0 + t)) ** 2)
        slope = 1.5 * np.sqrt(t) * sine + t**1.5 * cosine**2 / ((1.0 + t) ** 3 * sine)
        t = t - (sine * t**1.5 - wanted) / slope
    return np.asarray(t)
