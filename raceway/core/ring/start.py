"""Where a time integration begins."""

from __future__ import annotations

import attrs
import numpy as np

from raceway.core.ring.orbit import Orbit, at_time
from raceway.core.ring.ring import Ring
from raceway.core.stepping.record import Motion


def from_orbit(system: Ring, orbit: Orbit, dt: float) -> Motion:
    """On a steady orbit, at the first of its times, moving with it."""
    before = at_time(orbit.ball, orbit.period, -dt)
    ball = orbit.ball[0].copy()
    if not system.conservative:
        ball[:, 2:4] = before[:, 2:4] = system.stress_free_slip(orbit.displacement[0], ball)
    now = system.evaluate(orbit.displacement[0], orbit.velocity[0], ball=ball)
    a = system.acceleration(orbit.displacement[0], orbit.velocity[0], orbit.force[0], now)
    return Motion(orbit.displacement[0], orbit.velocity[0], a, now.ball, before)


def at_rest(system: Ring, q: np.ndarray, ball: np.ndarray, ramped: bool) -> Motion:
    """At rest in a static equilibrium; under a ramp the excitation is still zero, else it acts at once."""
    outer = np.zeros(5) if ramped else system.outer_force(0.0)
    a = system.acceleration(q, np.zeros(5), outer, system.evaluate(q, ball=ball))
    return Motion(q, np.zeros(5), a, ball, ball.copy())


def static_orbit(system: Ring, q: np.ndarray, ball: np.ndarray, ramped: bool) -> Motion:
    """The equilibrium under the constant load and the excitation's force at time zero: for series of equilibria."""
    outer = np.zeros(5) if ramped else system.outer_force(0.0)
    loaded = attrs.evolve(system, load=system.load + outer)
    q, ball, _ = loaded.settle(q, ball)
    return Motion(q, np.zeros(5), np.zeros(5), ball, ball.copy())
