"""Stresses in a half-space under Hertz's pressure, by quadrature of Boussinesq's point loads over the ellipse.

x along the semi-axis a, y along b, z into the body; tension positive.

Johnson, Contact Mechanics (1985), equations 3.19; written with 1 / (R (R + z)), which has no 0 / 0 below the load (Love 1929).
"""

import numpy as np


def point_stress(x: np.ndarray, y: np.ndarray, z: np.ndarray, poisson: float) -> np.ndarray:
    """(6, ...) xx yy zz xy yz zx of a unit force at the origin, pressing along +z."""
    r = np.sqrt(x * x + y * y + z * z)
    near = (2.0 * r + z) / (r**3 * (r + z) ** 2)
    free = 1.0 - 2.0 * poisson
    flat = z / r**3 - 1.0 / (r * (r + z))
    cubed = 3.0 * z / r**5
    xx, yy = (free * (flat + near * s * s) - cubed * s * s for s in (x, y))
    xy = (free * near - cubed) * x * y
    return np.stack([xx, yy, -cubed * z * z, xy, -cubed * y * z, -cubed * x * z]) / (2.0 * np.pi)


def pressed_stress(
    where: np.ndarray,
    semi_axes: tuple[float, float],
    peak_pressure: float,
    poisson: float,
    points: tuple[int, int] = (160, 960),
) -> np.ndarray:
    """(n, 6) stresses at points (n, 3), z > 0, under the pressure p0 sqrt(1 - x^2/a^2 - y^2/b^2).  ``points``: Gauss points
    in t where the radius is sin t, which takes the root at the edge away, and equal angles."""
    a, b = semi_axes
    at, weight = np.polynomial.legendre.leggauss(points[0])
    t = 0.25 * np.pi * (at + 1.0)
    angle = 2.0 * np.pi * (np.arange(points[1]) + 0.5) / points[1]
    x, y = np.outer(a * np.sin(t), np.cos(angle)), np.outer(b * np.sin(t), np.sin(angle))
    load = peak_pressure * a * b * (0.25 * np.pi * weight * np.sin(t) * np.cos(t) ** 2)[:, None] * (2.0 * np.pi / points[1])
    return np.array([(point_stress(u - x, v - y, w, poisson) * load).sum(axis=(1, 2)) for u, v, w in where])
