"""Exact elliptic Hertz contact of two bodies that touch at a point.

With the ellipticity chi = a/b, m = 1 - 1/chi^2 and the complete elliptic integrals K(m), E(m), the curvature
difference is F = 1 - 2 / (chi^2 - 1) (K/E - 1).  a* = (2 chi^2 E / pi)^(1/3), b* = a*/chi and
delta* = (2 K / pi) (pi / (2 chi^2 E))^(1/3) give, with S the curvature sum and E* the contact modulus,
a = a* (3 Q / (2 S E*))^(1/3), b likewise, delta = delta* (3 Q / (2 S E*))^(2/3) S / 2.

Harris & Kotzalas, Essential Concepts of Bearing Technology, 5th ed., chapter 6 (with E' written as E*).
"""

from collections.abc import Callable, Sequence
from functools import cache, lru_cache
from typing import Any

import attrs
import numpy as np

from raceway.core.columns import Number, elliptic_integrals, is_column
from raceway.errors import RacewayError


def contact_modulus(young_a: float, poisson_a: float, young_b: float, poisson_b: float) -> float:
    """E* [Pa] with 1/E* = (1 - nu_a^2)/E_a + (1 - nu_b^2)/E_b (lubrication's E' is twice this)."""
    return 1.0 / ((1.0 - poisson_a**2) / young_a + (1.0 - poisson_b**2) / young_b)


#: Steps of Newton's method for a column; five do.
_NEWTON = 12


def _difference(log_chi: float) -> float:
    chi2 = np.exp(2.0 * log_chi)
    excess = np.expm1(2.0 * log_chi)
    m1 = 1.0 / chi2
    first, second = elliptic_integrals(m1)
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
    return float(np.exp(regula_falsi(lambda log_chi: _difference(log_chi) - curvature_difference, low, high)))


def regula_falsi(function: Callable[[float], float], low: float, high: float) -> float:
    """Zero to rounding of a function that is below 0 at ``low`` and above it at ``high`` (Illinois)."""
    below, above, last = function(low), function(high), 0
    for _ in range(200):
        middle = (low * above - high * below) / (above - below)
        if not low < middle < high:  # rounded to the end that the zero is next to, however far the other one stayed
            return min(max(middle, low), high)
        value = function(middle)
        if value == 0.0:
            return middle
        side = -1 if value < 0.0 else 1
        # An end that stays for a second time counts half, or it would stay for ever.
        if side < 0:
            low, below, above = middle, value, 0.5 * above if last == side else above
        else:
            high, above, below = middle, value, 0.5 * below if last == side else below
        last = side
    return 0.5 * (low + high)


@attrs.frozen
class Ellipse:
    """Hertz contact of one pair of surfaces, load-independent part; of several pairs every number is an array (``every``)."""

    curvature_sum: Number  # [1/m]
    curvature_difference: Number
    contact_modulus: Number  # [Pa]
    #: a_star, b_star, delta_star : float, dimensionless
    a_star: Number
    b_star: Number
    delta_star: Number

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

        Without slip the traction is that of a flat punch, 1 / sqrt(1 - x^2/a^2 - y^2/b^2); Cerruti's solution gives the
        displacement T ((1 - nu) K + nu D) / (2 pi G a) along the major axis, with K - D for D along the minor one, against
        (1 - nu) K / (2 pi G a) normal to it: K and D = (K - E) / e^2 at e^2 = 1 - (b/a)^2.  A circle has 2 (1 - nu) / (2 - nu).

        Mindlin, J. Appl. Mech. 16 (1949) 259; Vermeulen, Johnson, J. Appl. Mech. 31 (1964) 338.
        """
        m1 = (self.b_star / self.a_star) ** 2
        first, second = elliptic_integrals(m1)
        # D runs to pi / 4 at a circle, where its formula is 0 / 0.
        along = 0.25 * np.pi if 1.0 - m1 < 1e-9 else (first - second) / (1.0 - m1)
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


def every(contacts: Sequence[Ellipse], indices: np.ndarray) -> Ellipse:
    """Hertz contacts of many pairs at once, whose numbers and answers are arrays (n,); ``chosen`` (n,) indices of the contacts."""
    columns: Any = np.array([attrs.astuple(contact) for contact in contacts])[indices].T.copy()
    return Ellipse(*columns)


def ellipse(curvature_sum: Number, curvature_difference: Number, modulus: Number) -> Ellipse:
    """Hertz contact from curvature sum [1/m], curvature difference and E* [Pa]; of columns all numbers are columns."""
    chi, a_star, delta_star = (_ellipses if is_column(curvature_difference) else _ellipticity)(curvature_difference)
    return Ellipse(curvature_sum, curvature_difference, modulus, a_star, a_star / chi, delta_star)


def _shape(chi: Number) -> tuple[Number, Number, Number]:
    """chi, a* and delta*."""
    m1 = 1.0 / chi**2
    first, second = elliptic_integrals(m1)
    a_star = (2.0 * chi**2 * second / np.pi) ** (1.0 / 3.0)
    return chi, a_star, 2.0 * first / np.pi * (np.pi / (2.0 * chi**2 * second)) ** (1.0 / 3.0)


@lru_cache(maxsize=256)
def _ellipticity(curvature_difference: float) -> tuple[float, float, float]:
    chi, a_star, delta_star = _shape(ellipticity(curvature_difference))
    return chi, float(a_star), float(delta_star)


def _ellipses(curvature_difference: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The same of a column: Newton's method in log chi, from the formula of Hamrock and Brewe; nan where there is no ellipse.

    With K and E of m = 1 - 1/chi^2, dK/dm = (E/(1-m) - K) / (2 m) and dE/dm = (E - K) / (2 m).
    """
    inside = (curvature_difference > 1e-12) & (curvature_difference < 1.0)
    difference = np.where(inside, curvature_difference, 0.5)
    log_chi = 0.636 * np.log((1.0 + difference) / (1.0 - difference))
    for _ in range(_NEWTON):
        excess, m1 = np.expm1(2.0 * log_chi), np.exp(-2.0 * log_chi)
        m, (first, second) = -np.expm1(-2.0 * log_chi), elliptic_integrals(m1)
        ratio = first / second
        slope = ((second / m1 - first) * second - first * (second - first)) / (2.0 * m * second**2) * 2.0 * m1
        value = 1.0 - 2.0 / excess * (ratio - 1.0)
        by_log = 4.0 * (excess + 1.0) / excess**2 * (ratio - 1.0) - 2.0 / excess * slope
        step = (value - difference) / by_log
        log_chi = np.maximum(log_chi - step, 0.1 * log_chi)
        if np.abs(step).max() < 1e-15 * log_chi.max():
            break
    chi = np.exp(log_chi)
    return _shape(np.where(inside, chi, np.where(np.abs(curvature_difference) <= 1e-12, 1.0, np.nan)))


def normal_displacement(depth: np.ndarray, away: np.ndarray, young: float, poisson: float) -> np.ndarray:
    """Displacement (n, m) along a unit force on the surface, at a depth and a distance along the surface from it [m/N].

    depth : (n,) float [m];  away : (m,) float [m];  young : [Pa]

    Johnson, Contact Mechanics (1985), equation 3.18b (Boussinesq): u = (1 + nu) / (2 pi E) (z^2 / r^3 + 2 (1 - nu) / r).
    """
    z = np.asarray(depth, dtype=float)[:, None]
    r = np.hypot(z, np.asarray(away, dtype=float))
    return np.asarray((1.0 + poisson) / (2.0 * np.pi * young) * (z * z / r**3 + 2.0 * (1.0 - poisson) / r))


_TERMS = 400
_POINTS = 16


@lru_cache(maxsize=64)
def ball_compliance(
    radius: float, young: float, poisson: float, semi_major: float, semi_minor: float
) -> tuple[float, float]:
    """(own, opposite) [m/N]: what a load adds to the approach of its own contact beyond Hertz, and to that of the opposite one.

    radius : of the ball [m];  semi_major, semi_minor : of the contact ellipse [m]; own depends on them as a logarithm

    A point force on a sphere is a series of Legendre polynomials, balanced by uniform acceleration, displacements measured
    from the mean of its masses. Its terms tend to c0 + c1 / n: c0 is the half-space with the chord as distance, c1 a
    logarithm; both are summed in closed form, the rest falls off as 1 / n^2. A mesh would have to resolve the ellipse to
    give the same number.

    Love, A Treatise on the Mathematical Theory of Elasticity, 4th ed., sections 172-173 (solutions of degree n in a sphere).
    """
    c0, c1, coefficients = _stress_series(poisson)
    radial, weight = np.polynomial.legendre.leggauss(_POINTS)
    radial = 0.5 * (radial + 1.0)
    around = 2.0 * np.pi * (np.arange(_POINTS) + 0.5) / _POINTS
    share = np.repeat(weight * radial * np.sqrt(1.0 - radial**2), _POINTS)
    share /= share.sum()
    x = np.outer(radial, np.cos(around)).ravel() * semi_major / radius
    y = np.outer(radial, np.sin(around)).ravel() * semi_minor / radius
    half_chord = 0.5 * np.hypot(x[:, None] - x, y[:, None] - y)
    # Points on themselves: the mean distance within what one of them stands for; a logarithm hardly minds.
    np.fill_diagonal(half_chord, 0.3 / _POINTS * np.sqrt(semi_major * semi_minor) / radius)
    grid = np.linspace(0.0, half_chord.max(), 65)
    smooth = np.interp(half_chord.ravel(), grid, np.polynomial.legendre.legval(1.0 - 2.0 * grid**2, coefficients))
    s = half_chord.ravel()
    field = (smooth - c1 * np.log(s + s * s)).reshape(half_chord.shape)
    same = float(share @ field @ share)
    opposite = float(np.polynomial.legendre.legval(-1.0, coefficients)) + 0.5 * c0 - c1 * np.log(2.0)
    return same / (young * radius), float(opposite) / (young * radius)


@cache
def _stress_series(nu: float) -> tuple[float, float, np.ndarray]:
    """c0, c1 and the remaining coefficients (_TERMS,) of the inward displacement under a unit inward force, radius and E 1."""
    n = np.arange(_TERMS, dtype=float)
    mu = 0.5 / (1.0 + nu)
    lam = nu / ((1.0 + nu) * (1.0 - 2.0 * nu))
    pressure = (2.0 * n + 1.0) / (4.0 * np.pi)
    out = np.empty(_TERMS)
    out[0] = pressure[0] / (3.0 * lam + 2.0 * mu)
    # Degree 1: the force is balanced by f along the axis, u = k r^2 e_z + b (r^2 e_z + alpha z r) + a e_z.
    alpha = _alpha(1.0, lam, mu)
    k = 3.0 / (4.0 * np.pi) / (8.0 * mu + 2.0 * lam)
    b = -2.0 * k / (2.0 + alpha)
    out[1] = k + b * (1.0 + alpha) - (0.6 * k + b * (0.6 + 0.2 * alpha))
    # Degree n: u = a grad(r^n Y) + b (r^2 grad(r^n Y) + alpha r^n Y r), free of shear tractions.
    m = n[2:]
    alpha = _alpha(m, lam, mu)
    normal_b = lam * (2.0 * m + alpha * (m + 3.0)) + 2.0 * mu * (m + 1.0) * (m + alpha)
    ratio = -(2.0 * m + alpha) / (2.0 * (m - 1.0))  # a / b
    b = pressure[2:] / (normal_b + ratio * 2.0 * mu * m * (m - 1.0))
    out[2:] = b * (ratio * m + m + alpha)
    c0 = (1.0 - nu**2) / np.pi
    tail = (out[2:] - c0) * m
    c1 = float(2.0 * tail[-1] - tail[_TERMS // 2 - 2])  # what is left falls off as 1 / n
    out -= c0
    out[1:] -= c1 / n[1:]
    return c0, c1, out


def _alpha(n: np.ndarray | float, lam: float, mu: float) -> np.ndarray | float:
    return -2.0 * (n * lam + (3.0 * n + 1.0) * mu) / ((n + 3.0) * lam + (n + 5.0) * mu)


#: The largest shear stress lies at most 0.786 minor semi-axes deep (line contact); steps in which it is looked for.
_DEEP, _GRID = 1.2, 60


def axis_stresses(depth: np.ndarray, semi_axes: tuple[float, float], peak_pressure: float, poisson: float) -> np.ndarray:
    """(n, 3) Stresses along x, y, z on the axis of a frictionless contact [Pa], tension positive.

    Parameters
    ----------
    depth : (n,) float below the surface [m], not negative
    semi_axes : a along x, b along y [m];  peak_pressure : [Pa]

    Notes
    -----
    With S(s) = sqrt((a^2 + s^2) (b^2 + s^2)), Boussinesq's potential V of the pressure p0 sqrt(1 - x^2/a^2 - y^2/b^2) has,
    on the axis at the depth z,

        V_z  = -2 pi p0 a b z int_z^inf ds / (s^2 S),    V_xx = -2 pi p0 a b int_z^inf ds / ((a^2 + s^2) S),    V_yy with b^2,
        chi_xx = 2 pi p0 a b int_z^inf (s - z) ds / ((a^2 + s^2) S),                          chi its integral along z,

        2 pi sigma_z = V_z - z V_zz,    2 pi sigma_x = 2 nu V_z - z V_xx - (1 - 2 nu) chi_xx,    sigma_y likewise with V_yy, chi_yy.

    The integrals are Carlson's R_D; those with s ds are elementary. x is along the major semi-axis a, y along the minor one
    b, z into the body; on the axis these are the principal directions.

    References
    ----------
    Thomas, Hoersch, Stresses due to the pressure of one elastic solid upon another, Univ. Illinois Eng. Exp. Station Bull.
    212 (1930). Johnson, Contact Mechanics (1985), equations 3.19, 3.57 to 3.59 and sections 4.1, 4.2. Harris, Kotzalas,
    Essential Concepts of Bearing Technology, 5th ed., chapter 6.
    """
    from scipy.special import elliprd

    z = np.maximum(np.asarray(depth, dtype=float), 1e-9 * min(semi_axes))
    a2, b2, z2 = semi_axes[0] ** 2 + z * z, semi_axes[1] ** 2 + z * z, z * z
    unit = peak_pressure * semi_axes[0] * semi_axes[1]  # 2 pi is cancelled throughout
    v_z = -unit * z / 3.0 * elliprd(a2, b2, z2)
    v_x, v_y = -unit / 3.0 * elliprd(z2, b2, a2), -unit / 3.0 * elliprd(z2, a2, b2)
    long, short = np.sqrt(a2), np.sqrt(b2)
    chi_x = unit / (long * (long + short)) + z * v_x
    chi_y = unit / (short * (long + short)) + z * v_y
    along = 2.0 * poisson * v_z - z * v_x - (1.0 - 2.0 * poisson) * chi_x
    across = 2.0 * poisson * v_z - z * v_y - (1.0 - 2.0 * poisson) * chi_y
    return np.stack([along, across, v_z + z * (v_x + v_y)], axis=1)


def axis_shear(depth: np.ndarray, semi_axes: tuple[float, float], peak_pressure: float, poisson: float) -> np.ndarray:
    """(n,) Largest shear stress at points of the axis [Pa]: half the difference of the outer principal stresses."""
    return np.asarray(0.5 * np.ptp(axis_stresses(depth, semi_axes, peak_pressure, poisson), axis=1))


def largest_shear(semi_axes: tuple[float, float], peak_pressure: float, poisson: float) -> tuple[float, float]:
    """The largest shear stress on the axis [Pa] and its depth [m]: 0.31 p0 at 0.48 a of a circle, 0.30 p0 at 0.786 b of a line.

    semi_axes : [m], in any order;  peak_pressure : [Pa], above 0

    Of long ellipses with a Poisson's ratio below 0.2 it lies at the surface, where the stress along the line is small.
    """
    from scipy.optimize import minimize_scalar

    minor = min(semi_axes)

    def shear(share: np.ndarray) -> np.ndarray:
        return axis_shear(minor * share, semi_axes, 1.0, poisson)

    grid = np.linspace(0.0, _DEEP, _GRID + 1)
    k = int(shear(grid).argmax())
    bounds = (grid[max(k - 1, 0)], grid[min(k + 1, _GRID)])
    optimum = minimize_scalar(
        lambda x: -float(shear(np.array([x]))[0]), bounds=bounds, method="bounded", options={"xatol": 1e-9}
    )
    return -float(optimum.fun) * peak_pressure, float(optimum.x) * minor
