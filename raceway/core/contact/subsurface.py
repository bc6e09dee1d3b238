"""Hertz's stresses below the centre of an elliptical contact, and the largest shear stress there.

Notes
-----
With S(s) = sqrt((a^2 + s^2) (b^2 + s^2)), Boussinesq's potential V of the pressure p0 sqrt(1 - x^2/a^2 - y^2/b^2) has, on the
axis at the depth z,

    V_z  = -2 pi p0 a b z int_z^inf ds / (s^2 S),    V_xx = -2 pi p0 a b int_z^inf ds / ((a^2 + s^2) S),    V_yy with b^2,
    chi_xx = 2 pi p0 a b int_z^inf (s - z) ds / ((a^2 + s^2) S),                          chi its integral along z,

    2 pi sigma_z = V_z - z V_zz,    2 pi sigma_x = 2 nu V_z - z V_xx - (1 - 2 nu) chi_xx,    sigma_y likewise with V_yy, chi_yy.

The integrals are Carlson's R_D; those with s ds are elementary.  x is along the major semi-axis a, y along the minor one b, z into
the body; on the axis these are the principal directions.

References
----------
Thomas, Hoersch, Stresses due to the pressure of one elastic solid upon another, Univ. Illinois Eng. Exp. Station Bull. 212 (1930).
Johnson, Contact Mechanics (1985), equations 3.19, 3.57 to 3.59 and sections 4.1, 4.2.
Harris, Kotzalas, Essential Concepts of Bearing Technology, 5th ed., chapter 6.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.special import elliprd

#: The largest shear stress lies at most 0.786 minor semi-axes deep (line contact); steps in which it is looked for.
_DEEP, _GRID = 1.2, 60


def axis_stresses(depth: np.ndarray, semi_axes: tuple[float, float], peak_pressure: float, poisson: float) -> np.ndarray:
    """(n, 3) Stresses along x, y, z on the axis of a frictionless contact [Pa], tension positive.

    Parameters
    ----------
    depth : (n,) float below the surface [m], not negative
    semi_axes : a along x, b along y [m];  peak_pressure : [Pa]
    """
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

    Parameters
    ----------
    semi_axes : [m], in any order;  peak_pressure : [Pa], above 0

    Notes
    -----
    Of long ellipses with a Poisson's ratio below 0.2 it lies at the surface, where the stress along the line is small.
    """
    minor = min(semi_axes)

    def shear(share: np.ndarray) -> np.ndarray:
        return axis_shear(minor * share, semi_axes, 1.0, poisson)

    grid = np.linspace(0.0, _DEEP, _GRID + 1)
    k = int(shear(grid).argmax())
    bounds = (grid[max(k - 1, 0)], grid[min(k + 1, _GRID)])
    found = minimize_scalar(
        lambda x: -float(shear(np.array([x]))[0]), bounds=bounds, method="bounded", options={"xatol": 1e-9}
    )
    return -float(found.fun) * peak_pressure, float(found.x) * minor
