"""Multigrid iterations over mesh sizes, and natural frequencies against closed forms over refinements."""

from __future__ import annotations

import time

import numpy as np

from benchmarks.evidence import Row, below, near
from raceway import load_scene
from raceway.core.hexahedron.operator import HexOperator
from raceway.core.linear.statics import solve_static
from raceway.core.mesh.quality import quality
from raceway.plugins.meshers.structured import Structured
from validation.natural_modes import natural_modes
from validation.reference import annulus, elastic

TITLE = "Static solver and natural frequencies"
COMMAND = "python -m benchmarks.evidence statics"
YOUNG, POISSON, DENSITY = 212e9, 0.29, 7810.0
MATERIAL = (YOUNG, POISSON, DENSITY)
RING = (0.049, 0.051)


#: Options of the mesher ``structured``: from 1e4 to 3e5 cells, up to 50 times as long as thick at the contacts.
RINGS = [
    {"element_size": 1.4e-3, "nodes_per_semi_axis": 2},
    {"element_size": 1e-3, "nodes_per_semi_axis": 4},
    {"element_size": 0.6e-3, "nodes_per_semi_axis": 5},
    {"element_size": 0.4e-3, "nodes_per_semi_axis": 6},
]
BALLS = [
    {"element_size": 1.2e-3, "nodes_per_semi_axis": 2, "growth": 1.6},
    {"element_size": 1e-3, "nodes_per_semi_axis": 3},
    {"element_size": 0.5e-3, "nodes_per_semi_axis": 6},
    {"element_size": 0.25e-3, "nodes_per_semi_axis": 7},
]


def solved(count: int) -> Row:
    """A ball of compact cells, held on its cap and pressed at its top."""
    points, cells = elastic.ball(3e-3, count)
    held = np.repeat((points[:, 2] < -2.5e-3)[:, None], 3, axis=1)
    load = np.zeros_like(points)
    load[points[:, 2].argmax(), 2] = -1.0
    return _iterations(f"compact ball of {len(cells)} hexahedra", points, cells, load, held)


def graded(body: str, options: dict[str, float]) -> Row:
    """A ring held at its seat and pulled along its groove, or a ball held on one patch and pressed on the other."""
    mesh = Structured(**options).mesh(load_scene("examples/minimal.toml").bearing)[body]
    held, load = np.zeros(mesh.points.shape, dtype=bool), np.zeros(mesh.points.shape)
    if body == "inner_ring":
        held[mesh.nodes("seat")] = True
        load[mesh.nodes("band")[::7], 0] = 1.0
    else:
        held[mesh.nodes("inner_patch")] = True
        load[mesh.nodes("outer_patch"), 0] = -1.0
    aspect = quality(mesh).aspect
    note = f"aspect of cells {aspect.mean():.0f} on average, {aspect.max():.0f} at most"
    word = "ring" if body == "inner_ring" else "ball"
    return _iterations(f"graded {word} of {len(mesh.cells)} hexahedra", mesh.points, mesh.cells, load, held, note)


def _iterations(name: str, points: np.ndarray, cells: np.ndarray, load: np.ndarray, held: np.ndarray, note: str = "") -> Row:
    stiffness = HexOperator(points, cells, *MATERIAL).stiffness()
    start = time.process_time()
    found = solve_static(stiffness, points, load, held)
    words = [note, f"residual {found.residual:.1e}", f"{time.process_time() - start:.1f} s of CPU"]
    return below(f"iterations, {name}, 1e-8", found.iterations, 20, COMMAND, ", ".join(filter(None, words)))


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


def bending(around: int, across: int) -> float:
    """In-plane bending, n = 2, of a free square ring [Hz]."""
    points, cells = elastic.ring(*RING, RING[1] - RING[0], (across, across, around))
    _, mass = elastic.matrices(points, cells, *MATERIAL)
    found = natural_modes(HexOperator(points, cells, *MATERIAL, "incompatible").stiffness(), mass, points, 4)
    in_plane = (found.shape[:, :, 0] ** 2).sum(axis=1) < 0.1 * (found.shape**2).sum(axis=(1, 2))
    return float(found.frequency_hz[in_plane][0])


def ring() -> list[Row]:
    """Against the annulus in plane stress, after extrapolation to no element size by the order that is found too."""
    wanted = annulus.bending(*RING, *MATERIAL)
    coarse, middle, fine = (bending(48 * 2**k, 2 * 2**k) for k in range(3))
    order = float(np.log2((coarse - middle) / (middle - fine)))
    # Plane stress: (poisson width n / R)^2 / 12 = 4.5e-5; the extrapolation leaves terms of fourth order, 1e-5.
    what = "bending of a free ring, extrapolated [Hz]"
    slender = annulus.slender(0.5 * sum(RING), RING[1] - RING[0], YOUNG, DENSITY)
    note = f"192 around: {fine:.2f}; slender ring without shear and rotary inertia: {slender:.2f}"
    return [
        near(what, fine + (fine - middle) / 3.0, wanted, 1e-4, COMMAND, note),
        near("order of its convergence", order, 2.0, 0.05, COMMAND),
    ]


def rows() -> list[Row]:
    return [
        *(solved(count) for count in (22, 30, 46, 67)),
        *(graded("inner_ring", options) for options in RINGS),
        *(graded("ball_00", options) for options in BALLS),
        *(cube(count) for count in (4, 6, 8)),
        *ring(),
    ]
