"""Structural compliances that tests choose freely, without finite elements."""

from __future__ import annotations

import numpy as np

from raceway.core.condensed.elastic_bodies import ElasticBodies, elastic_system
from raceway.core.condensed.structural import RingCompliance
from raceway.core.ring.system import System

ANGLES = np.linspace(-0.7, 0.7, 13)
#: Of the inner ring, the outer ring, a ball on itself and from its other contact [m/N]: docs/physics.md, condensed bodies.
INNER, OUTER, BALL, OPPOSITE = -0.62e-9, -0.64e-9, -0.304e-9, 0.167e-9
#: Between groove centres on elastic beds of 500 N/mm3, none to six balls further: axial by axial, axial by radial, radial by
#: radial force [m/N]; a little skewed, as rings of another section have it.
BED = 1e-9 * np.array([
    [5.5, -0.6, 5.3], [2.9, -0.25, 0.71], [1.07, -0.09, -0.77], [0.47, -0.02, -0.4], [0.16, 0.0, -0.12], [0.03, 0.0, -0.06],
    [0.0, 0.0, -0.05],
])  # fmt: skip


def ring(own: float, slope: float = 0.0, balls: int = 12, between: np.ndarray | None = None) -> RingCompliance:
    """A ring whose own compliance [m/N] changes by ``slope`` [m/N/rad] and as much again by its square.

    between : (7, 3) compliances between groove centres; the first one is added to the ring's own.
    """
    values = own + slope * (ANGLES - 0.3) + slope * (ANGLES - 0.3) ** 2
    table = np.zeros((len(ANGLES), len(ANGLES), balls))
    if between is not None:
        sine, cosine = np.sin(ANGLES), np.cos(ANGLES)
        for k in range(balls):
            axial, cross, radial = between[min(k, balls - k)]
            table[:, :, k] = axial * np.outer(sine, sine) + radial * np.outer(cosine, cosine)
            table[:, :, k] += cross * (np.outer(sine, cosine) + np.outer(cosine, sine))
        values = values + np.diagonal(table[:, :, 0])
    return RingCompliance(ANGLES, values, table, 1, np.array([1e-3]), 1e-3)


def elastic(
    system: System, factor: float = 1.0, slope: float = 0.0, bed: bool = False, inner: float = INNER, outer: float = OUTER,
    rows: int = 1,
) -> System:  # fmt: skip
    """A rigid system with chosen compliances, all times ``factor``; with ``bed`` both rings of each row couple their balls."""
    balls = system.ball_count // rows
    rings = [ring(factor * own, factor * slope, balls, factor * BED * part if bed else None)
             for own, part in ((inner, 1.3), (outer, 1.0))]  # fmt: skip
    bodies = ElasticBodies(rings[0], rings[1], factor * BALL, factor * OPPOSITE)
    return elastic_system(system, bodies, np.full(system.ball_count, 0.32) if bed else None)
