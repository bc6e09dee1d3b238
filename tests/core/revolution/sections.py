"""Small sections for the tests of bodies of revolution."""

from typing import Any

import attrs
import numpy as np

from checks.validation.command_line import EXAMPLES
from raceway import load_scene
from raceway.core.fem.revolution.sections import Profile, ball_profile, graded_profile
from raceway.extend import ring_shape

BEARING = load_scene(EXAMPLES / "minimal.toml").bearing
STEEL = (212e9, 0.29, 7810.0)
RADIUS = 0.5 * BEARING.ball_diameter


def shape(inner: bool, land: float | None = None) -> Any:
    """Of a ring of the preset, with another radius of its shoulders [m]."""
    found = ring_shape(BEARING, inner)
    return found if land is None else attrs.evolve(found, land=land)


def ring(inner: bool, step: float = 0.5e-3, size: float = 3e-3) -> Profile:
    window = (np.deg2rad(0.0), np.deg2rad(30.0))
    return graded_profile(shape(inner), step, window, 3.0 * step, size)


def ball(step: float = 0.5e-3) -> Profile:
    return ball_profile(RADIUS, step, 2.0 * step, 2.0 * step, 2e-3)
