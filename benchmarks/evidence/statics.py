"""Multigrid iterations over mesh sizes, and natural frequencies against closed forms over refinements."""

from __future__ import annotations

import time

import numpy as np

from benchmarks.evidence import Row, below, near
from raceway.core.hexahedron.operator import HexOperator
from raceway.core.linear_statics import solve_static
from raceway.core.natural_modes import natural_modes
from tests.reference import elastic

TITLE = "Static solver and natural frequencies"
COMMAND = "python -m benchmarks.evidence statics"
YOUNG, POISSON, DENSITY = 212e9, 0.29, 7810.0
MATERIAL = (YOUNG, POISSON, DENSITY)


def solved(count: int) -> Row:
    """A ball held on its cap and pressed at its top."""
    points, cells = elastic.ball(3e-3, count)
    stiffness = HexOperator(points, cells, *MATERIAL).stiffness()
    held = np.repeat((points[:, 2] < -2.5e-3)[:, None], 3, axis=1)
    load = np.zeros_like(points)
    load[points[:, 2].argmax(), 2] = -1.0
    start = time.perf_counter()
    found = solve_static(stiffness, points, load, held)
    note = f"residual {found.residual:.1e}, {time.perf_counter() - start:.1f} s"
    return below(f"iterations, ball of {len(cells)} hexahedra, 1e-8", found.iterations, 20, COMMAND, note)


def cube(count: int) -> Row:
    """Lame mode of a free cube: f = c_s / (sqrt(2) L), exact (Lame 1852)."""
    side = 0.01
    points, cells = elastic.block((side,) * 3, (count,) * 3)
    operator = HexOperator(points, cells, *MATERIAL, "full")
    _, mass = elastic.matrices(points, cells, *MATERIAL)
    found = natural_modes(operator.stiffness(), mass, points, 12)
    x = np.pi * points / side
    exact = np.stack([np.cos(x[:, 0]) * np.sin(x[:, 1]), -np.sin(x[:, 0]) * np.cos(x[:, 1]), 0.0 * x[:, 2]], axis=1).ravel()
    share = (found.shape.reshape(12, -1) @ (mass @ exact)) ** 2
    wanted = np.sqrt(YOUNG / (2.0 * (1.0 + POISSON)) / DENSITY) / (np.sqrt(2.0) * side)
    # Two-point bound of linear elements: (pi h / L)^2 / 24 for a half wave of length L.
    bound = 3.0 * (np.pi / count) ** 2 / 24.0
    return near(f"Lame mode of a free cube, {count}^3 [Hz]", found.frequency_hz[share.argmax()], wanted, bound, COMMAND)


def ring(around: int) -> Row:
    """In-plane bending, n = 2, of a free slender ring (Timoshenko, Vibration Problems in Engineering)."""
    radius, height = 0.05, 0.002
    wanted = np.sqrt(YOUNG * height**2 / 12.0 / (DENSITY * radius**4) * 36.0 / 5.0) / (2.0 * np.pi)
    points, cells = elastic.ring(radius - 0.5 * height, radius + 0.5 * height, height, (2, 2, around))
    _, mass = elastic.matrices(points, cells, *MATERIAL)
    found = natural_modes(HexOperator(points, cells, *MATERIAL, "incompatible").stiffness(), mass, points, 4)
    in_plane = (found.shape[:, :, 0] ** 2).sum(axis=1) < 0.1 * (found.shape**2).sum(axis=(1, 2))
    # Shear and rotary inertia, left out of the formula, are (h / R)^2; waves n = 2 on chords err by (2 pi n / N)^2 / 6.
    bound = 0.002 + (4.0 * np.pi / around) ** 2 / 6.0
    return near(f"bending of a free ring, {around} around [Hz]", found.frequency_hz[in_plane][0], wanted, bound, COMMAND)


def rows() -> list[Row]:
    return [
        *(solved(count) for count in (22, 30, 46, 67)),
        *(cube(count) for count in (4, 6, 8)),
        *(ring(around) for around in (48, 64, 96)),
    ]
