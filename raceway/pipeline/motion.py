"""What the motion does besides its 1x line: the table ``motion`` of result.json."""

from __future__ import annotations

import numpy as np

from raceway.bodies.model import Model
from raceway.core.stepping.record import Record
from raceway.storage.tables import Tables


def motion_table(model: Model, record: Record) -> Tables:
    """Mean axial displacement, and the largest ball loads with their pressure, in the turns that are used.

    Parameters
    ----------
    record : its columns of ``contact_force`` (n, 2 Z) are the inner races, then the outer ones [N]
    """
    z = model.system.ball_count
    inner, outer = peak(record.contact_force[:, :z]), peak(record.contact_force[:, z:])
    return {
        "axial_displacement_m": float(record.displacement[:, 0].mean()),
        "peak_ball_load_n": inner,
        "peak_pressure_inner_pa": float(model.bearing.contact_ellipse(model, 0, np.array([inner]))[0][0]),
        "peak_pressure_outer_pa": float(model.bearing.contact_ellipse(model, 1, np.array([outer]))[0][0]),
    }


def peak(samples: np.ndarray) -> float:
    """Largest value of curves sampled at equidistant times, (n, k), by a parabola through the largest sample's neighbours."""
    row, column = np.unravel_index(int(np.argmax(samples)), samples.shape)
    top = float(samples[row, column])
    if not 0 < row < len(samples) - 1:
        return top
    before, after = float(samples[row - 1, column]), float(samples[row + 1, column])
    bend = before - 2.0 * top + after
    return top if bend >= 0.0 else top - (before - after) ** 2 / (8.0 * bend)
