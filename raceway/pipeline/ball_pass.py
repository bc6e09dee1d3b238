"""Kinematic frequencies of a bearing whose inner ring turns: cage, ball passes, ball spin.

Notes
-----
With g = D cos(a) / d_m at the loaded contact angle a, over the shaft's frequency: FTF = (1 - g) / 2 (cage), BPFO = Z (1 - g) / 2 and
BPFI = Z (1 + g) / 2 (balls over a place of the outer and of the inner race), BSF = d_m (1 - g^2) / (2 D) (turns of a ball about its
own axis).  Balls roll without slip and cos(a) is the mean over both races of all loaded balls of a row: at speed the races' angles differ.
Forces know one cage speed, that of the free contact angle (``BallBearing.cage_speed``), told beside FTF as ``ftf_in_forces``.

References
----------
Harris & Kotzalas, Essential Concepts of Bearing Technology, 5th ed., chapter 10.
"""

from __future__ import annotations

from math import acos, cos, degrees, pi
from typing import TYPE_CHECKING

import numpy as np

from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from raceway.bodies.equilibrium import Equilibrium
    from raceway.bodies.model import Model

#: Names in the order in which they are told.
NAMES = ("ftf", "bpfo", "bpfi", "bsf")


def ball_pass(ball_count: int, ball_diameter: float, pitch_diameter: float, contact_angle: float) -> dict[str, float]:
    """FTF, BPFO, BPFI and BSF over the shaft's frequency.

    Parameters
    ----------
    ball_diameter, pitch_diameter : [m];  contact_angle : loaded [rad]
    """
    g = ball_diameter * cos(contact_angle) / pitch_diameter
    cage = 0.5 * (1.0 - g)
    spin = 0.5 * pitch_diameter / ball_diameter * (1.0 - g * g)
    return {"ftf": cage, "bpfo": ball_count * cage, "bpfi": ball_count * (1.0 - cage), "bsf": spin}


def ball_pass_table(model: Model, equilibrium: Equilibrium) -> Tables:
    """The table ``ball_pass`` of result.json: multiples of the shaft's speed, a row each, and Hz where the shaft turns."""
    speed = model.scene.spin_speed / (2.0 * pi)
    cosine = np.cos(0.5 * (np.abs(equilibrium.angle_inner) + np.abs(equilibrium.angle_outer)))
    rows = []
    for k, b in enumerate(model.scene.bearing.of_rows):
        loaded = (model.basis.row == k) & np.isfinite(cosine)  # by both races
        a = acos(float(cosine[loaded].mean())) if loaded.any() else b.contact_angle
        times = ball_pass(b.ball_count, b.ball_diameter, b.pitch_diameter, a)
        hertz = {f"{name}_hz": speed * times[name] if speed else None for name in NAMES}
        in_forces = {"ftf_in_forces": model.basis.geometries[k].cage_speed(1.0)}
        rows.append({"contact_angle_deg": degrees(a), **times, **hertz, **in_forces})
    return {"speed_rpm": 60.0 * speed, "rows": rows}
