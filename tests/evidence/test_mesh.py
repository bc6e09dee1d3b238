"""Meshes, static solver and natural frequencies.

Orders of volume and area, numbering and files that CalculiX solves are in tests/mesh.
"""

from __future__ import annotations

import json
import subprocess
import sys

import numpy as np
import pytest

from checks.validation.command_line import EXAMPLES
from checks.validation.natural_modes import natural_modes
from checks.validation.reference import annulus, elastic
from checks.validation.scenes import built_in
from raceway import load_scene
from raceway.extend import HexOperator, solve_static

Structured = built_in("mesher", "structured")

pytestmark = pytest.mark.night

YOUNG, POISSON, DENSITY = STEEL = (212e9, 0.29, 7810.0)
RING = (0.049, 0.051)
#: Options of the mesher ``structured``: from 1e4 to 3e5 cells, up to 50 times as long as thick at the contacts.
RINGS = (
    {"element_size": 1.4e-3, "nodes_per_semi_axis": 2}, {"element_size": 1e-3, "nodes_per_semi_axis": 4},
    {"element_size": 0.6e-3, "nodes_per_semi_axis": 5}, {"element_size": 0.4e-3, "nodes_per_semi_axis": 6},
)  # fmt: skip
BALLS = (
    {"element_size": 1.2e-3, "nodes_per_semi_axis": 2, "growth": 1.6}, {"element_size": 1e-3, "nodes_per_semi_axis": 3},
    {"element_size": 0.5e-3, "nodes_per_semi_axis": 6}, {"element_size": 0.25e-3, "nodes_per_semi_axis": 7},
)  # fmt: skip
SCENE = EXAMPLES / "b7206_article_mesh.toml"
#: Of the article (Lubricants 2026, 14(3), 128, section 3.1).
ELEMENTS = 1_061_016
#: In a process of its own, so that the memory is that of the mesh.
BUILD = """
import json, resource, sys, time
from raceway import load_scene
from raceway.plugins.bodies.mesh import mesh_bodies
from raceway.planning.resolve import resolve
scene = load_scene(sys.argv[1])
begin = time.process_time()
meshes = mesh_bodies(resolve(scene))
seconds = time.process_time() - begin
memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
from raceway.core.fem.mesh.quality import summary
print(json.dumps({"seconds": seconds, "memory": memory, "summary": summary(meshes)}))
"""


def test_mesh_of_the_article(claim):
    words = [sys.executable, "-c", BUILD, str(SCENE)]
    done = json.loads(subprocess.run(words, cwd=EXAMPLES.parent, stdout=subprocess.PIPE, check=True).stdout)
    found, article = done["summary"], "Lubricants 2026, 14(3), 128, section 3.1"
    published, once = {"basis": "published", "source": article}, {"basis": "regression", "source": "one core"}
    claim("article's mesh: elements", found["elements"], near=ELEMENTS, within=0.02, **published)
    claim("article's mesh: largest edge", 1e3 * found["element_size_m"]["max"], at_most=0.5, unit="mm", **published)
    bounds = {"basis": "closed form", "source": "1 is a cube, 0 a cell without volume in a corner"}
    claim("article's mesh: smallest scaled Jacobian", found["scaled_jacobian"]["min"], at_least=0.2, **bounds)
    claim("article's mesh: CPU time", done["seconds"], at_most=30.0, unit="s", **once)
    claim("article's mesh: peak memory", done["memory"] / 2**30, at_most=4.0, unit="GiB", **once)


def compact(count):
    """A ball of compact cells, held on its cap and pressed at its top."""
    points, cells = elastic.ball(3e-3, count)
    held = np.repeat((points[:, 2] < -2.5e-3)[:, None], 3, axis=1)
    load = np.zeros_like(points)
    load[points[:, 2].argmax(), 2] = -1.0
    return points, cells, load, held


def graded(body, options):
    """A ring held at its seat and pulled along its groove, or a ball held on one patch and pressed on the other."""
    mesh = Structured(**options).mesh(load_scene(EXAMPLES / "minimal.toml").bearing)[body]
    held, load = np.zeros(mesh.points.shape, dtype=bool), np.zeros(mesh.points.shape)
    if body == "inner_ring":
        held[mesh.nodes("seat")] = True
        load[mesh.nodes("band")[::7], 0] = 1.0
    else:
        held[mesh.nodes("inner_patch")] = True
        load[mesh.nodes("outer_patch"), 0] = -1.0
    return mesh.points, mesh.cells, load, held


@pytest.mark.parametrize(
    ("words", "cases", "misses"),
    [
        ("compact balls", [(compact, count) for count in (22, 30, 46, 67)], ""),
        ("graded rings", [(graded, "inner_ring", options) for options in RINGS], ""),
        ("graded balls", [(graded, "ball_00", options) for options in BALLS], "cells 68 times as long as thick"),
    ],
)
def test_iterations(claim, words, cases, misses):
    most = 0
    for build, *given in cases:
        points, cells, load, held = build(*given)
        found = solve_static(HexOperator(points, cells, *STEEL).stiffness(), points, load, held)
        assert found.residual <= 1e-8
        most = max(most, found.iterations)
    source = "of 10 at the smallest mesh: multigrid takes as many at any size, and twice as many for slender cells"
    quantity = f"iterations to a residual of 1e-8, {words} of 1e4 to 3e5 hexahedra: most"
    claim(quantity, most, at_most=20, basis="regression", source=source, misses=misses)


def test_mode_of_a_free_cube(claim):
    """Error over that of linear elements for half a wave of n elements, (pi / n)^2 / 24 in each of three directions."""
    side, shares = 0.01, []
    wanted = np.sqrt(YOUNG / (2.0 * (1.0 + POISSON)) / DENSITY) / (np.sqrt(2.0) * side)
    for count in (4, 6, 8):
        points, cells = elastic.block((side,) * 3, (count,) * 3)
        _, mass = elastic.matrices(points, cells, *STEEL)
        found = natural_modes(HexOperator(points, cells, *STEEL, "full").stiffness(), mass, points, 12)
        x = np.pi * points / side
        exact = np.stack([np.cos(x[:, 0]) * np.sin(x[:, 1]), -np.sin(x[:, 0]) * np.cos(x[:, 1]), 0.0 * x[:, 2]], axis=1)
        share = (found.shape.reshape(12, -1) @ (mass @ exact.ravel())) ** 2
        shares.append(abs(found.frequency_hz[share.argmax()] / wanted - 1.0) / (3.0 * (np.pi / count) ** 2 / 24.0))
    quantity = "Lame mode of a free cube, 4, 6, 8 elements along a side: error over its bound: largest"
    claim(quantity, max(shares), at_most=1.0, basis="closed form", source="c_s / (sqrt(2) L), Lame (1852); (pi / n)^2 / 8")


def bending(around, across):
    """In-plane bending, n = 2, of a free square ring [Hz]."""
    points, cells = elastic.ring(*RING, RING[1] - RING[0], (across, across, around))
    _, mass = elastic.matrices(points, cells, *STEEL)
    found = natural_modes(HexOperator(points, cells, *STEEL, "incompatible").stiffness(), mass, points, 4)
    in_plane = (found.shape[:, :, 0] ** 2).sum(axis=1) < 0.1 * (found.shape**2).sum(axis=(1, 2))
    return float(found.frequency_hz[in_plane][0])


def test_bending_of_a_free_ring(claim):
    wanted = annulus.bending(*RING, *STEEL)
    coarse, middle, fine = (bending(48 * 2**k, 2 * 2**k) for k in range(3))
    quantity, source = "bending of a free ring, 48 to 192 elements around", "annulus in plane stress"
    claim(
        f"{quantity}: extrapolated", fine + (fine - middle) / 3.0, near=wanted, within=1e-4, unit="Hz", basis="closed form",
        source=f"{source}, itself good to (nu b n / R)^2 / 12 = 4.5e-5; terms of fourth order 1e-5",
    )  # fmt: skip
    order = np.log2((coarse - middle) / (middle - fine))
    claim(f"{quantity}: order", order, near=2.0, within=0.05, basis="closed form", source="second order; terms of fourth")
