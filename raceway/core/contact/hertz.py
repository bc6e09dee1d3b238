"""Exact elliptic Hertz contact of two bodies that touch at a point.

Notes
-----
With the ellipticity chi = a/b, m = 1 - 1/chi^2 and the complete elliptic integrals K(m), E(m), the curvature
difference is F = 1 - 2 / (chi^2 - 1) (K/E - 1).  a* = (2 chi^2 E / pi)^(1/3), b* = a*/chi and
delta* = (2 K / pi) (pi / (2 chi^2 E))^(1/3) give, with S the curvature sum and E* the contact modulus,
a = a* (3 Q / (2 S E*))^(1/3), b likewise, delta = delta* (3 Q / (2 S E*))^(2/3) S / 2.

References
----------
Harris & Kotzalas, Essential Concepts of Bearing Technology, 5th ed., chapter 6 (with E' written as E*).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import attrs
import numpy as np
from scipy.special import ellipe, ellipkm1

from raceway.errors import RacewayError


def contact_modulus(young_a: float, poisson_a: float, young_b: float, poisson_b: float) -> float:
    """E* [Pa] with 1/E* = (1 - nu_a^2)/E_a + (1 - nu_b^2)/E_b (lubrication's E' is twice this)."""
    return 1.0 / ((1.0 - poisson_a**2) / young_a + (1.0 - poisson_b**2) / young_b)


def _difference(log_chi: float) -> float:
    chi2 = np.exp(2.0 * log_chi)
    excess = np.expm1(2.0 * log_chi)
    m1 = 1.0 / chi2
    first, second = ellipkm1(m1), ellipe(1.0 - m1)
    if log_chi < 1e-4:  # K/E - 1 = m/2 + 5 m^2/16 + 7 m^3/32 + ... : the difference cancels
        m = excess / chi2
        return float(1.0 - 2.0 / chi2 * (0.5 + 5.0 * m / 16.0 + 7.0 * m * m / 32.0))
    return float(1.0 - 2.0 / excess * (first / second - 1.0))


@lru_cache(maxsize=1024)
def ellipticity(curvature_difference: float) -> float:
    """chi = a/b of the contact ellipse for a curvature difference in [0, 1), by regula falsi (Illinois) to rounding."""
    if not 0.0 <= curvature_difference < 1.0:
        raise RacewayError(f"curvature difference {curvature_difference!r} is outside [0, 1): no elliptic contact")
    if curvature_difference < 1e-12:
        return 1.0
    low, high = 0.0, 1.0
    while _difference(high) < curvature_difference:
        high *= 2.0
        if high > 300.0:
            raise RacewayError("the contact ellipse is longer than 1e100 widths: a line contact, not a point")
    below, above = -curvature_difference, _difference(high) - curvature_difference
    low = 0.0
    last = 0
    for _ in range(200):
        middle = (low * above - high * below) / (above - below)
        if not low < middle < high:
            break
        left = _difference(middle) - curvature_difference
        if left == 0.0:
            return float(np.exp(middle))
        side = -1 if left < 0.0 else 1
        # An end that stays for a second time counts half, or it would stay for ever.
        if side < 0:
            low, below, above = middle, left, 0.5 * above if last == side else above
        else:
            high, above, below = middle, left, 0.5 * below if last == side else below
        last = side
    return float(np.exp(0.5 * (low + high)))


@attrs.frozen
class Ellipse:
    """Hertz contact of one pair of surfaces, load-independent part; of several pairs every number is an array (``every``).

    Attributes
    ----------
    curvature_sum : float [1/m]
    contact_modulus : float [Pa]
    a_star, b_star, delta_star : float, dimensionless
    """

    curvature_sum: float
    curvature_difference: float
    contact_modulus: float
    a_star: float
    b_star: float
    delta_star: float

    @property
    def factor(self) -> float:
        """K [N/m^1.5] of Q = K delta^1.5."""
        unit = 2.0 / (self.curvature_sum * self.delta_star)
        return 2.0 / 3.0 * self.curvature_sum * self.contact_modulus * unit**1.5

    @property
    def curvatures(self) -> tuple[float, float]:
        """A, B [1/m] of the gap A x^2 + B y^2, x along the major semi-axis."""
        s, d = self.curvature_sum, self.curvature_difference
        return 0.25 * s * (1.0 - d), 0.25 * s * (1.0 + d)

    def stick_ratio(self, poisson: float) -> tuple[float, float]:
        """Stiffness of the sticking contact along the major and the minor axis over the normal one, bodies of one material.

        Notes
        -----
        Without slip the traction is that of a flat punch, 1 / sqrt(1 - x^2/a^2 - y^2/b^2); Cerruti's solution gives the
        displacement T ((1 - nu) K + nu D) / (2 pi G a) along the major axis, with K - D for D along the minor one, against
        (1 - nu) K / (2 pi G a) normal to it: K and D = (K - E) / e^2 at e^2 = 1 - (b/a)^2.  A circle has 2 (1 - nu) / (2 - nu).

        References
        ----------
        Mindlin, J. Appl. Mech. 16 (1949) 259; Vermeulen, Johnson, J. Appl. Mech. 31 (1964) 338.
        """
        m1 = (self.b_star / self.a_star) ** 2
        first = float(ellipkm1(m1))
        # D runs to pi / 4 at a circle, where its formula is 0 / 0.
        along = 0.25 * np.pi if 1.0 - m1 < 1e-9 else (first - float(ellipe(1.0 - m1))) / (1.0 - m1)
        normal = (1.0 - poisson) * first
        return normal / (normal + poisson * along), normal / (normal + poisson * (first - along))

    def semi_axes(self, load: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
        """a, b [m] at a load [N]."""
        unit = np.cbrt(1.5 * np.asarray(load) / (self.curvature_sum * self.contact_modulus))
        return self.a_star * unit, self.b_star * unit

    def approach(self, load: np.ndarray | float) -> np.ndarray:
        """delta [m] at a load [N]."""
        return np.cbrt(np.asarray(load) / self.factor) ** 2

    def peak_pressure(self, load: np.ndarray | float) -> np.ndarray:
        """p0 = 3 Q / (2 pi a b) [Pa]; zero at zero load."""
        load = np.asarray(load, dtype=float)
        a, b = self.semi_axes(np.where(load > 0.0, load, 1.0))
        return np.where(load > 0.0, 1.5 * load / (np.pi * a * b), 0.0)


def every(contacts: Sequence[Ellipse], chosen: np.ndarray) -> Ellipse:
    """Hertz contacts of many pairs at once, whose numbers and answers are arrays (n,); ``chosen`` (n,) indices of the contacts."""
    columns: Any = np.array([attrs.astuple(one) for one in contacts])[chosen].T.copy()
    return Ellipse(*columns)


@lru_cache(maxsize=256)
def ellipse(curvature_sum: float, curvature_difference: float, modulus: float) -> Ellipse:
    """Hertz contact from curvature sum [1/m], curvature difference and E* [Pa]."""
    chi = ellipticity(curvature_difference)
    m1 = 1.0 / chi**2
    first, second = float(ellipkm1(m1)), float(ellipe(1.0 - m1))
    a_star = (2.0 * chi**2 * second / np.pi) ** (1.0 / 3.0)
    delta_star = 2.0 * first / np.pi * (np.pi / (2.0 * chi**2 * second)) ** (1.0 / 3.0)
    return Ellipse(curvature_sum, curvature_difference, modulus, float(a_star), float(a_star / chi), float(delta_star))
