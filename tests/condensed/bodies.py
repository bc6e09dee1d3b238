"""Structural compliances that tests choose freely, without finite elements."""

from __future__ import annotations

import numpy as np

from raceway.core.condensed.elastic_bodies import ElasticBodies, elastic_system
from raceway.core.condensed.structural import RingCompliance
from raceway.core.system import System

ANGLES = np.linspace(-0.7, 0.7, 13)
#: Of the inner ring, the outer ring, a ball on itself and from its other contact [m/N]: docs/physics.md, condensed bodies.
INNER, OUTER, BALL, OPPOSITE = -0.62e-9, -0.64e-9, -0.304e-9, 0.167e-9
#: Ball on ball on an elastic bed of 500 N/mm3, one to six balls further [m/N].
BED = np.array([0.77, -0.63, -0.32, -0.1, -0.05, -0.05]) * 1e-9


def ring(own: float, slope: float = 0.0, balls: int = 12, across: np.ndarray | None = None) -> RingCompliance:
    """A ring whose own compliance [m/N] changes by ``slope`` [m/N/rad] and as much again by its square."""
    values = own + slope * (ANGLES - 0.3) + slope * (ANGLES - 0.3) ** 2
    table = np.zeros((len(ANGLES), balls))
    table[:, 0] = values
    if across is not None:
        for k in range(1, balls):
            table[:, k] = across[min(k, balls - k) - 1]
    return RingCompliance(ANGLES, values, table, 1, np.array([1e-3]), 1e-3)


def elastic(
    system: System, factor: float = 1.0, slope: float = 0.0, bed: bool = False, inner: float = INNER, outer: float = OUTER
) -> System:
    """A rigid system with chosen compliances, all times ``factor``; with ``bed`` the outer ring couples its balls."""
    balls = system.ball_count
    soft = ring(factor * (outer + (5.6e-9 if bed else 0.0)), factor * slope, balls, factor * BED if bed else None)
    bodies = ElasticBodies(ring(factor * inner, factor * slope, balls), soft, factor * BALL, factor * OPPOSITE)
    return elastic_system(system, bodies, np.full(balls, 0.32) if bed else None)
