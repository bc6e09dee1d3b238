"""Nodal contact written to be read: one point at a time, a sphere's point against a torus, no derivatives."""

import numpy as np


def groove_gap(place: np.ndarray, middle: np.ndarray, circle: float, tube: float) -> tuple[float, np.ndarray]:
    """Distance of a point from the inside of a torus about an axis along x, and the direction that opens it.

    place : (3,) [m];  middle : (3,) of the torus;  circle, tube : radii of the centre circle and of the tube [m]
    """
    x, y, z = place - middle
    around = np.array([0.0, y, z]) / np.hypot(y, z)
    nearest = middle + circle * around  # of the centre circle
    away = place - nearest
    distance = float(np.linalg.norm(away))
    return tube - distance, -away / distance


def contact_forces(
    place: np.ndarray,
    area: np.ndarray,
    shares: list[list[tuple[int, float]]],
    middle: np.ndarray,
    circle: float,
    tube: float,
    stiffness: float,
    u: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Pressures (n,) [Pa] of points, and the forces that nodes (m, 3) feel [N].

    place : (n, 3) of undeformed points [m];  area : (n,) [m2]
    shares : for each point its nodes with their weights; those of the other surface are negative
    u : (m, 3) displacements of the nodes [m]
    """
    pressure, force = np.zeros(len(place)), np.zeros_like(u)
    for i, nodes in enumerate(shares):
        moved = sum(weight * u[node] for node, weight in nodes)
        gap, normal = groove_gap(place[i] + moved, middle, circle, tube)
        pressure[i] = stiffness * max(-gap, 0.0)
        for node, weight in nodes:
            force[node] += weight * area[i] * pressure[i] * normal
    return pressure, force
