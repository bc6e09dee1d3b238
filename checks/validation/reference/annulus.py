"""In-plane vibration of a free thin annulus by plane elasticity: exact in the radius, for any thickness of the ring.

References
----------
G. Ambati, J. F. W. Bell, J. C. K. Sharp, In-plane vibrations of annular rings, J. Sound Vib. 47 (1976) 415-432.
S. P. Timoshenko, Vibration Problems in Engineering: the slender ring, where the search starts.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq
from scipy.special import jvp, yvp


def slender(mean_radius: float, thickness: float, young: float, density: float, waves: int = 2) -> float:
    """Frequency [Hz] of a ring without shear and rotary inertia: w^2 = E I / (rho A R^4) n^2 (n^2 - 1)^2 / (n^2 + 1)."""
    n2 = waves**2
    squared = young * thickness**2 / 12.0 / (density * mean_radius**4) * n2 * (n2 - 1.0) ** 2 / (n2 + 1.0)
    return float(np.sqrt(squared) / (2.0 * np.pi))


def bending(inner: float, outer: float, young: float, poisson: float, density: float, waves: int = 2) -> float:
    """Lowest frequency [Hz] with this number of waves, in plane stress.

    Notes
    -----
    u = grad phi + curl psi, phi = (A J_n + B Y_n)(a r) cos n t, psi = (C J_n + D Y_n)(b r) sin n t, a and b the wave numbers
    of plane stress waves; both faces are free where the 4 x 4 determinant of their tractions vanishes.  A width b adds a
    relative error of about (poisson b n / R)^2 / 12: the strain across it that plane stress leaves without inertia.
    """
    first = slender(0.5 * (inner + outer), outer - inner, young, density, waves)

    def determinant(frequency: float) -> float:
        return float(np.linalg.det(_tractions(frequency, inner, outer, young, poisson, density, waves)))

    lows = first * np.linspace(0.5, 1.05, 56)
    values = [determinant(f) for f in lows]
    at = next(i for i in range(len(lows) - 1) if values[i] * values[i + 1] < 0.0)
    return float(brentq(determinant, lows[at], lows[at + 1], xtol=1e-9 * first))


def _tractions(
    frequency: float, inner: float, outer: float, young: float, poisson: float, density: float, n: int
) -> np.ndarray:
    """(4, 4) radial and tangential traction at both faces for each of the four functions, columns of unit size."""
    shear = young / (2.0 * (1.0 + poisson))
    speeds = np.sqrt(young / (1.0 - poisson**2) / density), np.sqrt(shear / density)
    rows = []
    for r in (inner, outer):
        radial, tangential = [], []
        for kind, speed in enumerate(speeds):
            for bessel in (jvp, yvp):
                k = 2.0 * np.pi * frequency / speed
                f, f1, f2 = (k**order * float(bessel(n, k * r, order)) for order in (0, 1, 2))
                if kind == 0:  # u_r = f', u_t = -n f / r
                    strain_r, strain_t = f2, f1 / r - n * n * f / r**2
                    slide = -2.0 * n * (f1 / r - f / r**2)
                else:  # u_r = n f / r, u_t = -f'
                    strain_r = n * (f1 / r - f / r**2)
                    strain_t = -strain_r
                    slide = -n * n * f / r**2 - f2 + f1 / r
                radial.append(young / (1.0 - poisson**2) * (strain_r + poisson * strain_t))
                tangential.append(shear * slide)
        rows += [radial, tangential]
    matrix = np.array(rows)
    return np.asarray(matrix / np.abs(matrix).max(axis=0))
