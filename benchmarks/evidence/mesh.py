"""Meshes: the article's size, quality, convergence to the exact solids, renumbering, files."""

from __future__ import annotations

import json
import subprocess
import sys
from math import pi
from typing import Any

import numpy as np

from benchmarks.evidence import Row, below, near
from benchmarks.evidence._files import ROOT

TITLE = "Meshes of bearings"
COMMAND = "python -m benchmarks.evidence mesh"
SCENE = "examples/b7206_article_mesh.toml"
#: Of the article (Lubricants 2026, 14(3), 128, section 3.1).
ELEMENTS = 1_061_016

#: In a process of its own, so that the memory is that of the mesh.
BUILD = """
import json, resource, sys, time
from raceway import load_scene
from raceway.bodies.meshing import mesh_scene
scene = load_scene(sys.argv[1])
begin = time.perf_counter()
meshes = mesh_scene(scene)
seconds = time.perf_counter() - begin
memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
from raceway.core.mesh.summary import summary
found = summary(meshes)
begin = time.perf_counter()
tidy = meshes["outer_ring"].renumbered()
renumber = time.perf_counter() - begin
print(json.dumps({"seconds": seconds, "memory": memory, "summary": found, "renumber": renumber}))
"""


def rows() -> list[Row]:
    return [*_article(), *_rates(), *_numbering(), *_files(), *_calculix()]


def _article() -> list[Row]:
    command = [sys.executable, "-c", BUILD, str(ROOT / SCENE)]
    done = json.loads(subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout)
    found: dict[str, Any] = done["summary"]
    typed = f"raceway mesh {SCENE}"
    patch, bulk, rings = found["patch_size_m"], found["element_size_m"], found["bodies"]["inner_ring"]["patch_size_m"]
    ball = found["bodies"]["ball_00"]["patch_size_m"]

    def sizes(sides: dict[str, dict[str, float]]) -> str:
        return " x ".join(f"{1e3 * sides[word]['min']:.3g}" for word in ("short", "long", "depth"))

    quality = found["scaled_jacobian"]["min"]
    return [
        near("elements of the article's mesh", found["elements"], ELEMENTS, 0.02, typed),
        below("largest edge, mm", 1e3 * bulk["max"], 0.5, typed),
        below("seconds to build and judge it", done["seconds"], 30.0, typed),
        below("peak memory while building, GiB", done["memory"] / 2**30, 4.0, typed),
        Row("smallest scaled Jacobian", quality, "above 0.2", quality > 0.2, typed),
        Row("mean edge, mm", 1e3 * bulk["mean"], "told", bulk["mean"] > 0.0, typed),
        Row("smallest cells on a ball's patch, rolling x across x depth, mm", sizes(ball), "told", bool(patch), typed),
        Row(
            "smallest cells on the inner band, across x rolling x depth, mm",
            sizes(rings),
            "told",
            bool(patch),
            typed,
            "rings are uniform in azimuth here: azimuth_cells = 'graded' resolves the minor semi-axis at each ball",
        ),
        Row("seconds to renumber the outer ring", done["renumber"], "told", True, COMMAND),
    ]


def _rates() -> list[Row]:
    """Orders between the two finest of three meshes, each half the size of the one before."""
    from raceway import load_scene
    from raceway.core.mesh.ball_mesh import ball_mesh
    from raceway.core.mesh.ring_mesh import ring_mesh
    from raceway.core.mesh.ring_shape import ring_shape
    from raceway.core.mesh.spacing import halved
    from raceway.plugins.meshers.structured import Structured

    bearing = load_scene(ROOT / SCENE).bearing
    coarse = Structured(element_size=1.5e-3, nodes_per_semi_axis=2, growth=1.6)
    typed, out = "pytest tests/mesh/test_structured.py", []

    def order(what: str, errors: list[float]) -> None:
        rate = float(np.log2(abs(errors[-2] / errors[-1])))
        out.append(
            near(f"order of the {what}", rate, 2.0, 0.025, typed, f"relative error {abs(errors[-1]):.1e} at the finest")
        )

    for inner in (True, False):
        shape = ring_shape(bearing, inner)
        left, arc, right, layers, _ = coarse._ring_lines(bearing, shape)
        volume, area, divisions = [], [], 24
        for _ in range(3):
            azimuths = np.linspace(0.0, 2.0 * pi, divisions, endpoint=False)
            mesh = ring_mesh(shape, left, arc, right, layers, azimuths)
            volume.append(mesh.volume() / shape.volume - 1.0)
            area.append(mesh.facet_areas("raceway").sum() / shape.raceway_area - 1.0)
            left, arc, right, layers, divisions = *map(halved, (left, arc, right, layers)), 2 * divisions
        word = "inner" if inner else "outer"
        order(f"{word} ring's volume", volume)
        order(f"{word} groove's area", area)
    radius = 0.5 * bearing.ball_diameter
    u, v, w, layers, _ = coarse._ball_lines(bearing)
    volume, area = [], []
    for _ in range(3):
        mesh = ball_mesh(radius, u, v, w, layers)
        volume.append(mesh.volume() / (4.0 / 3.0 * pi * radius**3) - 1.0)
        area.append(mesh.facet_areas("surface").sum() / (4.0 * pi * radius**2) - 1.0)
        u, v, w, layers = map(halved, (u, v, w, layers))
    order("ball's volume", volume)
    order("ball's area", area)
    return out


def _numbering() -> list[Row]:
    """A ring whose nodes and cells are numbered at random, and again after renumbering."""

    from raceway import load_scene
    from raceway.core.mesh.hex_mesh import HexMesh
    from raceway.plugins.meshers.structured import Structured

    bearing = load_scene(ROOT / SCENE).bearing
    ring = Structured().mesh(bearing)["inner_ring"]
    rng = np.random.default_rng(1)
    place = rng.permutation(len(ring.points))
    points = np.empty_like(ring.points)
    points[place] = ring.points
    mixed = HexMesh(points, rng.permutation(place[ring.cells]))
    told = f"ordered {ring.locality():.0f}, at random {mixed.locality():.0f}"
    after = mixed.renumbered().locality()
    return [
        below("mean span of a cell's node numbers after renumbering", after, 0.05 * mixed.locality(), COMMAND, told),
    ]


def _files() -> list[Row]:
    """Round trips of an inner ring through each format."""
    import tempfile
    from pathlib import Path

    from raceway import load_scene
    from raceway.plugins.formats.abaqus import Abaqus
    from raceway.plugins.formats.msh import Msh
    from raceway.plugins.formats.vtu import Vtu
    from raceway.plugins.meshers.structured import Structured
    from raceway.testing.format import TEN_FIGURES, same

    ring = Structured(element_size=1e-3, nodes_per_semi_axis=2).mesh(load_scene(ROOT / SCENE).bearing)["inner_ring"]
    out = []
    with tempfile.TemporaryDirectory() as folder:
        for form in (Vtu(), Abaqus(), Msh()):
            path = Path(folder) / f"ring{form.suffixes[0]}"
            form.write(path, ring)
            figures, limit = (TEN_FIGURES, "equal to ten figures") if form.name == "abaqus" else (0.0, "equal")
            back = same(form.read(path), ring, figures)
            out.append(
                Row(f"ring with its sets through {path.suffix}", "equal" if back else "differs", limit, back, COMMAND)
            )
    return out


def _calculix() -> list[Row]:
    """Whether CalculiX takes .inp files as they are written: a block under pressure, against its exact answer."""
    import tempfile
    from pathlib import Path

    from validation.squeezed import squeezed

    out = []
    for formulation in ("one_point", "full", "incompatible"):
        with tempfile.TemporaryDirectory() as folder:
            said, found, exact = squeezed(formulation, Path(folder))
        done = "Job finished" in said and "*ERROR" not in said
        error = float(abs(found / exact - 1.0).max())
        out.append(
            Row(
                f"CalculiX on a .inp file, {formulation}", "job finished" if done else "stops", "job finished", done, COMMAND
            )
        )
        out.append(below(f"its displacement against the exact one, {formulation}", error, 1e-6, COMMAND))
    return out
