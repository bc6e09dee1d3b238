"""Sets of rows on one rigid shaft: rows of ``ring.Ring`` mirrored, placed and pressed together; in plain numpy, with scipy.

A row at the place X that faces ``side`` meets the motion q of the set as
q' = (side x + shift, y + X tilt_z, z - X tilt_y, side tilt_y, side tilt_z).
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq, root

from checks.validation.reference.ring import Ring


def press(ring: Ring, load: float) -> float:
    """Axial displacement [m] of a row under an axial load [N]."""
    return float(brentq(lambda x: force_at(ring, x) - load, -6e-5, 3e-4, xtol=1e-16, rtol=1e-13))


def force_at(ring: Ring, x: float) -> float:
    """Axial force [N] of a row at an axial displacement [m]."""
    return float(ring(np.array([x, 0.0, 0.0, 0.0, 0.0]))[0][0])


def press_together(rings: list[Ring], load: float) -> float:
    """Axial displacement [m] of rows in tandem under one load [N]."""
    return float(brentq(lambda x: sum(force_at(one, x) for one in rings) - load, -6e-5, 3e-4, xtol=1e-16, rtol=1e-13))


def warmed(ring: Ring, strains: tuple[float, float, float], side: float = 1.0, place: float = 0.0) -> Ring:
    """A row whose inner ring, outer ring and balls have grown by these strains, all points of a ring away from the origin.

    Groove centres lie on circles of their rings and grooves are arcs of their rings: both grow with them.  ``place`` is the plane
    of the inner groove centres [m]; the outer ones lie A sin(alpha) from it, against the side that the row faces.
    """
    inner, outer, ball = strains
    half = 0.5 * ring.ball_diameter
    alpha = ring.contact_angle
    circle_i = 0.5 * ring.pitch_diameter + ring.li * np.cos(alpha)
    circle_o = 0.5 * ring.pitch_diameter - ring.lo * np.cos(alpha)
    axial = side * ((1.0 + inner) * place - (1.0 + outer) * (place - side * (ring.li + ring.lo) * np.sin(alpha)))
    ring.rest = np.array([axial, (1.0 + inner) * circle_i - (1.0 + outer) * circle_o])
    ring.li, ring.lo = (
        (1.0 + inner) * (ring.li + half) - (1.0 + ball) * half, (1.0 + outer) * (ring.lo + half) - (1.0 + ball) * half,
    )  # fmt: skip
    ring.distance = ring.li + ring.lo
    return ring


@dataclass
class RowSet:
    """Rows with their sides (+1, -1), places [m] and shifts [m]."""

    rings: list[Ring]
    sides: list[float]
    places: list[float]
    shifts: list[float]

    def _seen(self, k: int) -> np.ndarray:
        side, place = self.sides[k], self.places[k]
        out = np.diag([side, 1.0, 1.0, side, side])
        out[1, 4], out[2, 3] = place, -place
        return out

    def rows(self, q: np.ndarray) -> list[float]:
        """Axial force of each row in its seating direction [N]."""
        return [float(self._row(k, q)[0][0]) for k in range(len(self.rings))]

    def _row(self, k: int, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        seen = self._seen(k)
        return self.rings[k](seen @ q + np.array([self.shifts[k], 0.0, 0.0, 0.0, 0.0]))

    def __call__(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Force (5,) and tangent (5, 5)."""
        force, tangent = np.zeros(5), np.zeros((5, 5))
        for k in range(len(self.rings)):
            seen = self._seen(k)
            f, t, _ = self._row(k, q)
            force, tangent = force + seen.T @ f, tangent + seen.T @ t @ seen
        return force, tangent

    def solve_equilibrium(self, load: np.ndarray) -> np.ndarray:
        """(5,) under axial and radial loads (3,), the tilts held."""
        scale = 1e-6

        def residual(u: np.ndarray) -> np.ndarray:
            return np.asarray(self(np.array([*u * scale, 0.0, 0.0]))[0][:3] - load)

        found = root(residual, np.zeros(3), tol=1e-13)
        return np.array([*found.x * scale, 0.0, 0.0])

    def lift_off(self, sense: float) -> float:
        """Axial load [N], with its sign, at which the first row that it unloads carries nothing."""
        rest = float(brentq(lambda x: self._axial(x), -1e-4, 1e-4, xtol=1e-16, rtol=1e-13))

        def least(x: float) -> float:
            # Where the line of the groove centres is as long as both radii of the grooves allow without a load.
            gaps = []
            for k, (ring, side) in enumerate(zip(self.rings, self.sides, strict=True)):
                if side != sense:
                    e = ring.rest + [side * x + self.shifts[k], 0.0]
                    gaps.append(np.hypot(*e) - ring.distance)
            return min(gaps)

        return self._axial(brentq(least, rest, rest + sense * 2e-4, xtol=1e-16, rtol=1e-13))

    def _axial(self, x: float) -> float:
        return float(self(np.array([x, 0.0, 0.0, 0.0, 0.0]))[0][0])
