"""The pressure of a contact ellipse as a line along its major axis, on the nodes of a surface and on a half-space.

The minor axis is left out: at the depths that are looked at it is far smaller than the distance.
"""

from __future__ import annotations

import numpy as np

from raceway.core.contact.half_space import normal_displacement


def density(points: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss points on (-1, 1) and weights of 3/4 (1 - x^2), the ellipse's pressure summed over its minor axis; sum 1."""
    x, w = np.polynomial.legendre.leggauss(points)
    return x, 0.75 * (1.0 - x * x) * w


def nodal_weights(places: np.ndarray, centre: float, half: float) -> np.ndarray:
    """Consistent nodal forces of a unit line load on piecewise linear shape functions.

    Parameters
    ----------
    places : (n,) float, ascending [m or rad]
    centre, half : middle and half length of the load, in the same unit; what lies beyond the ends acts on the last nodes

    Returns
    -------
    weights : (n,) float, sum 1
    """
    x, w = density(64)
    at = np.clip(centre + half * x, places[0], places[-1])
    left = np.clip(np.searchsorted(places, at) - 1, 0, len(places) - 2)
    share = (at - places[left]) / (places[left + 1] - places[left])
    weights = np.zeros(len(places))
    np.add.at(weights, left, w * (1.0 - share))
    np.add.at(weights, left + 1, w * share)
    return weights


def half_space(depth: np.ndarray, half: float, young: float, poisson: float) -> np.ndarray:
    """Normal displacement below the middle of a unit line load on a half-space [m/N].

    Parameters
    ----------
    depth : (n,) float [m];  half : half length of the load [m];  young : [Pa]
    """
    x, w = density(41)
    return np.asarray(normal_displacement(depth, half * x, young, poisson) @ w)
