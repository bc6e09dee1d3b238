"""The largest ball loads and pressures, each with its race, and what the motion does besides its 1x line."""

from __future__ import annotations

import numpy as np

from raceway.bodies.model import Model
from raceway.core.stepping.record import Record
from raceway.storage.tables import Tables


def motion_table(model: Model, record: Record) -> Tables:
    """The table ``motion`` of result.json: mean axial displacement, and the largest of each race in the turns that are used.

    Parameters
    ----------
    record : its columns of ``contact_force`` (n, 2 Z) are the inner races, then the outer ones [N]
    """
    peaks = np.array([peak(column[:, None]) for column in record.contact_force.T])
    axial = float(record.displacement[:, 0].mean())
    return {"axial_displacement_m": axial, **largest_contacts(peaks, pressures(model, peaks), "peak")}


def pressures(model: Model, loads: np.ndarray) -> np.ndarray:
    """(2 Z,) peak pressures [Pa] at loads (2 Z,) [N] of the inner races, then of the outer ones."""
    return np.concatenate([model.bearing.contact_ellipse(model, k, half)[0] for k, half in enumerate(np.split(loads, 2))])


def largest_contacts(loads: np.ndarray, pressures: np.ndarray, word: str) -> Tables:
    """Of loads and pressures (2 Z,) [N, Pa] the largest of both races, its race, and each race's; ``word`` begins the names."""
    found: Tables = {}
    for name, unit, values in (("ball_load", "n", loads), ("pressure", "pa", pressures)):
        ends = values.reshape(2, -1).max(axis=1).tolist()
        found |= {f"{word}_{name}_{unit}": max(ends), f"{word}_{name}_race": race_of(*ends)}
        found |= {f"{word}_{name}_{race}_{unit}": end for race, end in zip(("inner", "outer"), ends, strict=True)}
    return found


def race_of(inner: float, outer: float) -> str:
    """The race of the larger number: "inner", "outer", or "both" where they are equal but for rounding."""
    return "both" if np.isclose(inner, outer, rtol=1e-9, atol=0.0) else "inner" if inner > outer else "outer"


def peak(samples: np.ndarray) -> float:
    """Largest value of curves sampled at equidistant times, (n, k), by a parabola through the largest sample's neighbours."""
    row, column = np.unravel_index(int(np.argmax(samples)), samples.shape)
    top = float(samples[row, column])
    if not 0 < row < len(samples) - 1:
        return top
    before, after = float(samples[row - 1, column]), float(samples[row + 1, column])
    bend = before - 2.0 * top + after
    return top if bend >= 0.0 else top - (before - after) ** 2 / (8.0 * bend)
