"""Structural compliance of a ball: the exact elastic sphere under a Hertz ellipse, less the half-space.

Notes
-----
A point force on a sphere is a series of Legendre polynomials, balanced by uniform acceleration, displacements measured from
the mean of its masses.  Its terms tend to c0 + c1 / n: c0 is the half-space with the chord as distance, c1 a logarithm; both
are summed in closed form, the rest falls off as 1 / n^2.  A mesh would have to resolve the ellipse to give the same number.

References
----------
Love, A Treatise on the Mathematical Theory of Elasticity, 4th ed., sections 172-173 (solutions of degree n in a sphere).
"""

from __future__ import annotations

from functools import cache, lru_cache

import numpy as np

_TERMS = 400
_POINTS = 16


@lru_cache(maxsize=64)
def ball_compliance(
    radius: float, young: float, poisson: float, semi_major: float, semi_minor: float
) -> tuple[float, float]:
    """(own, opposite) [m/N]: what a load adds to the approach of its own contact beyond Hertz, and to that of the opposite one.

    Parameters
    ----------
    radius : of the ball [m];  semi_major, semi_minor : of the contact ellipse [m]; own depends on them as a logarithm
    """
    c0, c1, rest = _series(poisson)
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
    smooth = np.interp(half_chord.ravel(), grid, np.polynomial.legendre.legval(1.0 - 2.0 * grid**2, rest))
    s = half_chord.ravel()
    field = (smooth - c1 * np.log(s + s * s)).reshape(half_chord.shape)
    own = float(share @ field @ share)
    opposite = float(np.polynomial.legendre.legval(-1.0, rest)) + 0.5 * c0 - c1 * np.log(2.0)
    return own / (young * radius), float(opposite) / (young * radius)


@cache
def _series(nu: float) -> tuple[float, float, np.ndarray]:
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
