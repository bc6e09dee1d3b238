"""A half-space under normal forces on its surface."""

from __future__ import annotations

import numpy as np


def normal_displacement(depth: np.ndarray, away: np.ndarray, young: float, poisson: float) -> np.ndarray:
    """Displacement (n, m) along a unit force on the surface, at a depth and a distance along the surface from it [m/N].

    Parameters
    ----------
    depth : (n,) float [m];  away : (m,) float [m];  young : [Pa]

    References
    ----------
    Johnson, Contact Mechanics (1985), equation 3.18b (Boussinesq): u = (1 + nu) / (2 pi E) (z^2 / r^3 + 2 (1 - nu) / r).
    """
    z = np.asarray(depth, dtype=float)[:, None]
    r = np.hypot(z, np.asarray(away, dtype=float))
    return np.asarray((1.0 + poisson) / (2.0 * np.pi * young) * (z * z / r**3 + 2.0 * (1.0 - poisson) / r))
