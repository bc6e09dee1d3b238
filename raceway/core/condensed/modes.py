"""First elastic natural frequencies of the rings: how far their inertia may be left out."""

from __future__ import annotations

import numpy as np

from raceway.core.condensed.structural import SOURCES, reach, ring_section
from raceway.core.mesh.ring_mesh import RingShape
from raceway.core.revolution.body import Revolution
from raceway.storage.array_cache import kept

#: Harmonics that are looked at; the lowest mode of a free ring is its second, that of a mounted one the 0th or 1st.
_HARMONICS = (0, 1, 2, 3)
_DIVISIONS = 120


def first_frequency(
    shape: RingShape, ball_diameter: float, young: float, poisson: float, density: float, seat: str | float
) -> float:
    """Lowest elastic natural frequency of a ring [Hz]; seat as of ``Revolution``."""
    size = 0.31 * reach(shape, ball_diameter)
    profile = ring_section(shape, ball_diameter, size, size)
    inputs = {
        "points": profile.points, "quads": profile.quads, "seat_nodes": profile.seat, "seat": seat, "young": young,
        "poisson": poisson, "density": density, "divisions": _DIVISIONS,
    }  # fmt: skip

    def make() -> dict[str, np.ndarray]:
        body = Revolution(profile, _DIVISIONS, young, poisson, density, seat=seat)
        return {"frequency": np.array([body.frequencies(_HARMONICS, 1).min()])}

    name = "inner" if shape.inner else "outer"
    return float(kept("frequency", f"{name} ring, seat {seat}", inputs, SOURCES, make)["frequency"][0])
