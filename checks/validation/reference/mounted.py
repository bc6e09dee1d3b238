"""Rows of a B7206C at a given axial displacement: preload, secant stiffness on an orbit; in plain numpy, with scipy's brentq."""

import numpy as np
from scipy.optimize import brentq

from checks.validation.reference.ring import Ring
from raceway import scene_from_dict

#: Turning force of ``secant`` [N].
FORCE = 200.0


def row(rpm: float = 0.0, growth: float = 0.0) -> Ring:
    """One row whose inner ring turns at a speed [r/min] and whose inner raceway has grown [m]."""
    b = scene_from_dict({"title": "row", "bearing": {"preset": "B7206C"}, "load": {"axial": 1.0}}).bearing
    found = Ring(
        b.ball_diameter, b.pitch_diameter, b.ball_count, b.contact_angle, b.conformity_inner, b.conformity_outer,
        spin_speed=rpm * np.pi / 30.0,
    )  # fmt: skip
    found.rest[1] += growth
    return found


def axial(ring: Ring, x: float) -> float:
    """Axial force [N] at an axial displacement [m]."""
    return float(ring(np.array([x, 0.0, 0.0, 0.0, 0.0]))[0][0])


def approach(ring: Ring, load: float) -> float:
    """Axial displacement [m] under an axial load [N]."""
    return float(brentq(lambda x: axial(ring, x) - load, -6e-5, 2e-4, xtol=1e-16, rtol=1e-13))


def secant(
    ring: Ring, load: float | None, rows: int, mass: float, speed: float, x: float = 0.0, force: float = FORCE
) -> float:
    """K [N/m] of a circular orbit under a turning force, with its inertia: 1x line of the rows' force over one ball pitch.

    load : axial load [N] under which x follows, or None: all rows stay at x [m]
    mass : [kg];  speed : of whirl [rad/s];  force : [N]
    """
    angles = 2.0 * np.pi / ring.ball_count * np.arange(4) / 4.0
    n = [np.array([0.0, np.cos(a), np.sin(a), 0.0, 0.0]) for a in angles]

    def at(x: float, r: float) -> np.ndarray:
        forces = [ring(np.array([x, 0.0, 0.0, 0.0, 0.0]) + r * one)[0] for one in n]
        return np.mean([[f[0], f @ one] for f, one in zip(forces, n, strict=True)], axis=0)

    def carried(r: float) -> float:
        place = x if load is None else brentq(lambda s: at(s, r)[0] - load, -6e-5, 2e-4, xtol=1e-16, rtol=1e-13)
        return rows * float(at(place, r)[1])

    r = brentq(lambda r: carried(r) - force - mass * speed**2 * r, 1e-9, 2e-5, xtol=1e-16, rtol=1e-12)
    return carried(r) / r
