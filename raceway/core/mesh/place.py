"""Places of the balls in the bearing."""

from __future__ import annotations

from math import cos, pi, sin
from typing import Any

import numpy as np


def azimuth(bearing: Any, index: int) -> float:
    """Azimuth of a ball [rad], from +y towards +z."""
    return float(bearing.first_ball_azimuth_deg * pi / 180.0 + 2.0 * pi * index / bearing.ball_count)


def ball_names(bearing: Any) -> list[str]:
    """ball_00, ball_01, ..., with as many digits as the largest needs."""
    digits = len(str(bearing.ball_count - 1))
    return [f"ball_{index:0{digits}d}" for index in range(bearing.ball_count)]


def placed(points: np.ndarray, bearing: Any, psi: float, side: float = 1.0, place: float = 0.0) -> np.ndarray:
    """A ball's points (n, 3) from its own axes (rolling, across, towards the outer contact) to its place in the bearing."""
    alpha = bearing.contact_angle
    radial = np.array([0.0, cos(psi), sin(psi)])
    u = np.array([0.0, -sin(psi), cos(psi)])
    w = np.array([side * sin(alpha), 0.0, 0.0]) + cos(alpha) * radial
    v = np.cross(w, u)
    centre = 0.5 * bearing.pitch_diameter * radial + [place, 0.0, 0.0]
    return np.asarray(points @ np.stack([u, v, w]) + centre)
