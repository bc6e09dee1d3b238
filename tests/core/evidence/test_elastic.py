"""Elastic bodies at rest.

What each formulation of the hexahedron fulfils is in tests/core/hexahedron, the growth of a turning ring in tests/core/test_growth.py,
the stiffness of a sticking contact in tests/test_stick_stiffness.py.
"""

import json
import subprocess
import sys
import time
from functools import cache
from math import log2

import attrs
import numpy as np
import pytest

from checks.validation.command_line import EXAMPLES
from checks.validation.condensed import largest, quantities, tables
from checks.validation.groove import HERTZ, pressed, solve
from checks.validation.scenes import built_in
from raceway import load_scene, scene_from_dict
from raceway.extend import mesh_bodies, resolve
from raceway.testing import run, settled
from tests.core.validation.below_groove import below

Vtu = built_in("format", "vtu")
Condensed = built_in("bodies", "condensed")

pytestmark = pytest.mark.night

ROOT = EXAMPLES.parent
#: Growth of meshes: a quicker one where the outer parts hardly matter.
QUICK = {"growth": 1.35, "coarse": 0.8e-3}
#: Elements per semi-axis -> ratio of neighbouring elements: each mesh halves those of the one before, in depth as well.
HALVED = {2.0: 2.25, 4.0: 1.5, 8.0: 1.5**0.5}
#: Condensed bodies, tilt locked, 1000 N and 500 N [um, N].
CONDENSED_BEARING = {"x": 28.69, "y": 1.957, "largest": 350.4, "smallest": 174.8}
CONDENSED = {"mesh": {"kind": "structured", "element_size": 0.5e-3, "nodes_per_semi_axis": 2}}
#: Largest element [m], elements around a ring, along a semi-axis; how near they must come.
MESHES = {
    "3.2 mm, 24 around": ((3.2e-3, 24, 0), 0.015), "3.2 mm, 36 around": ((3.2e-3, 36, 0), 0.01),
    "1.6 mm, 60 around": ((1.6e-3, 60, 0), 0.01), "3.2 mm, refined at the contacts": ((3.2e-3, 36, 1), 0.005),
}  # fmt: skip
COARSEST, FINER = MESHES["3.2 mm, 24 around"][0], MESHES["1.6 mm, 60 around"][0]
OWN, HERTZIAN = {"basis": "own other method"}, {"basis": "closed form", "source": "Hertz"}


def rows_of(benchmark):
    """In a process of its own: its peak memory is that of this case."""
    words = [sys.executable, "-m", f"checks.{benchmark}"]
    return json.loads(subprocess.run(words, cwd=ROOT, stdout=subprocess.PIPE, check=True).stdout)["rows"]


@pytest.mark.parametrize(("nodes", "mesh", "within"), [(4.0, {}, 0.05), (8.0, QUICK, 0.02)])
def test_ball_on_a_groove(claim, nodes, mesh, within):
    points, at_nodes, penalty, rest = [], [], [], []
    for load in (100.0, 300.0, 1000.0):
        found, peak = solve(load, nodes, **mesh), float(HERTZ.peak_pressure(load))
        points.append(abs(found.peak_points / peak - 1.0))
        at_nodes.append(abs(found.peak_nodes / peak - 1.0))
        penalty.append(found.penalty_share)
        rest.append(1e9 * (found.approach - float(HERTZ.approach(load))) / load)
    where = f"ball on a groove, 100, 300, 1000 N, {nodes:g} elements per semi-axis"
    quantity = f"{where}: peak pressure at points and nodes: largest relative error"
    claim(quantity, max(points + at_nodes), at_most=within, **HERTZIAN)
    source = "a contact of no penalty; a hundredth of its approach"
    quantity = f"{where}: share of the approach that is penalty: largest"
    claim(quantity, max(penalty), at_most=0.01, basis="closed form", source=source)
    source = "a structural compliance does not depend on the load; 0.1 nm/N is 1 % of Hertz's at 1000 N"
    quantity = f"{where}: (approach - Hertz's) / load: spread"
    claim(quantity, max(rest) - min(rest), at_most=0.1, unit="nm/N", basis="closed form", source=source)


def test_finer_ball(claim):
    approach = float(HERTZ.approach(300.0)) - 0.55e-9 * 300.0
    one, other = (pressed(300.0, 4.0, approach, ball_finer=finer, **QUICK).reaction for finer in (1.0, 1.3))
    quantity, source = "reaction where the ball's rows are 1.3 times finer: relative change", "meshes that do not match"
    claim(quantity, abs(other / one - 1.0), at_most=0.02, **OWN, source=source)


@pytest.mark.needs("ccx")
def test_calculix(claim):
    mine, *others = rows_of("against_calculix")
    other = min((row for row in others if not row["failure"]), key=lambda row: row["cpu_s"])
    name, once = "ball on groove, over CalculiX's quickest deck", {"basis": "other program", "source": "CalculiX, one core"}
    why = "an eighth"
    claim(f"{name}: CPU time", mine["cpu_s"] / other["cpu_s"], at_most=0.1, **once, misses=why, machine=True)
    why = "Python and its libraries are included"
    claim(f"{name}: memory", mine["memory_bytes"] / other["memory_bytes"], at_most=1.0, **once, misses=why)


def test_bearing_in_nodal_contact(claim):
    """63 120 elements."""
    begin = time.process_time()
    result = run(load_scene(ROOT / "checks" / "b7206_elastic_60k.toml")).to_dict()
    cpu = time.process_time() - begin
    inner = np.array([ball["load_inner_n"] for ball in result["equilibrium"]["balls"]])
    mirror = float(np.abs(inner[1:] / inner[:0:-1] - 1.0).max())
    assert result["model"]["mesh"]["cells"] >= 60_000
    found = {name: 1e6 * result["equilibrium"]["displacement"][name] for name in ("x", "y")}
    found |= {"largest": inner.max(), "smallest": inner.min()}
    where = "bearing of 63 120 elements, 1000 N axial, 500 N radial"
    quantity = f"{where}: balls that are mirror images: largest difference"
    claim(quantity, mirror, at_most=1e-3, basis="closed form", source="symmetry")
    for word, names, within in (("ball loads", ("largest", "smallest"), 0.02), ("displacements", ("x", "y"), 0.05)):
        error = largest(found, {name: CONDENSED_BEARING[name] for name in names})
        source = "condensed bodies; coarse elements"
        claim(f"{where}: {word}: largest relative error", error, at_most=within, **OWN, source=source)
    source = "CalculiX with facets, 334 CPU-s, before this program existed"
    claim(f"{where}: CPU time over CalculiX's", cpu / 334.0, at_most=1.0, basis="other program", source=source)


@pytest.mark.parametrize("formulation", ["incompatible", "one_point", "full"])
def test_stresses_below_a_contact(claim, formulation):
    """100 N, where the ellipse is small against the radii of curvature; ball and groove."""
    meshes = [below(100.0, nodes, formulation, growth=growth, coarse=1e-3) for nodes, growth in HALVED.items()]
    assert min(side.cells for side in meshes[-1]) >= 4.0
    where, bounds = f"{formulation}, 100 N, 4 elements down to Hertz's depth", {"at_most": 0.05, **HERTZIAN}
    quantity = f"{where}: largest shear stress: relative error"
    claim(quantity, max(abs(s.shear / s.hertz_shear - 1.0) for s in meshes[-1]), **bounds)
    depth = [[abs(side.depth / side.hertz_depth - 1.0) for side in mesh] for mesh in meshes]
    claim(f"{where}: its depth: relative error", max(depth[-1]), **bounds)
    rate = min(log2(first / last) / 2.0 for first, last in zip(depth[0], depth[-1], strict=True))
    source = "second order; Hertz's own error is left"
    claim(
        f"{formulation}, 100 N: order of the depth's error: lowest", rate, at_least=1.5, basis="closed form", source=source
    )


def test_stresses_below_a_large_contact(claim):
    """As fine in units of the ellipse, which is 2.2 times as large against the radii of ball and groove."""
    sides = below(1000.0, 8.0, "incompatible", growth=HALVED[8.0], coarse=1e-3)
    assert min(side.cells for side in sides) >= 4.0
    error = max(abs(side.shear / side.hertz_shear - 1.0) for side in sides)
    claim("incompatible, 1000 N: largest shear stress: relative error", error, at_most=0.05, **HERTZIAN)
    error = max(abs(side.depth / side.hertz_depth - 1.0) for side in sides)
    why = "half-spaces: the semi-axes are 0.65 and 1.4 mm on a ball of 9.5 mm"
    claim("incompatible, 1000 N: its depth: relative error", error, at_most=0.05, **HERTZIAN, misses=why)


def elastic(mesh, **more):
    """Tables of a scene with elastic bodies: largest element [m], elements around, along a semi-axis."""
    size, around, fine = mesh
    structured = {"kind": "structured", "element_size": size, "azimuth_cells": around, "nodes_per_semi_axis": fine}
    return tables(**{"bodies": {"kind": "elastic", "formulation": "incompatible"}, "mesh": structured, **more})


@cache
def on(mesh):
    """Model and quantities of an elastic mesh, or of condensed bodies."""
    model, found = settled(tables(**CONDENSED) if mesh is None else elastic(mesh))
    return model, found, quantities(found)


def apart(found, wanted):
    """Largest relative difference of what is not zero."""
    return largest(found, {name: k for name, k in wanted.items() if abs(k) > 1e-6 * max(map(abs, wanted.values()))})


@pytest.mark.parametrize("name", MESHES)
def test_coarse_meshes_with_resultants(claim, name):
    mesh, bound = MESHES[name]
    model, state, found = on(mesh)
    quantity, source = (
        f"{name}: displacements and stiffness: largest difference",
        "condensed bodies of fine meshes, themselves to 0.1 %",
    )
    claim(quantity, apart(found, on(None)[2]), at_most=bound, **OWN, source=source)
    force = model.bearing.report(model, state)["unbalanced_n"]
    source = "equilibrium; Newton's residual is 1e-7 of the forces"
    claim(f"{name}: unbalanced force", force, at_most=1e-2, unit="N", basis="closed form", source=source)


@pytest.mark.parametrize(("words", "bound", "changes"), [
    ("tilt free", 0.02, {"tilt": "free"}), ("100 N axial alone", 0.015, {"load": {"axial": 100.0}}),
    ("10 kN axial alone", 0.025, {"load": {"axial": 10000.0}}),
    ("500 N radial alone", 0.015, {"load": {"radial": [500.0, 0.0]}}),
    ("30 000 r/min", 0.02, {"kinematics": {"ball_inertia": True, "spin_speed_rpm": 30000.0}}),
    ("law penalty", 0.015, {"contact": {"kind": "penalty"}}),
    ("outer ring on 500 N/mm3", 0.03, {"supports": {"outer_seat": 5e11}}),
])  # fmt: skip
def test_coarsest_mesh_in_other_scenes(claim, words, bound, changes):
    found, wanted = (quantities(settled(one)[1]) for one in (elastic(COARSEST, **changes), tables(**CONDENSED, **changes)))
    quantity = f"{words}, 3.2 mm, 24 around: displacements and stiffness: largest difference"
    claim(quantity, apart(found, wanted), at_most=bound, **OWN, source="condensed bodies of fine meshes")


def half_held(mesh, folder):
    """Tables of an outer ring that its housing holds where y > 0, from files."""
    scene = scene_from_dict(elastic(mesh))
    found, write = mesh_bodies(resolve(scene)), Vtu().write
    outer = found["outer_ring"]
    seat = outer.facet_sets["seat"][outer.points[outer.facet_nodes("seat")].mean(axis=1)[:, 1] > 0.0]
    held = attrs.evolve(outer, facet_sets={**outer.facet_sets, "seat": seat}, node_sets={})
    # A file holds a ball about its centre: x rolling, y across, z towards the outer contact.
    bearing, one = scene.bearing, found["ball_00"]
    towards, rolling = (
        np.array([np.sin(bearing.contact_angle), np.cos(bearing.contact_angle), 0.0]), np.array([0.0, 0.0, 1.0]),
    )  # fmt: skip
    axes = np.stack([rolling, np.cross(towards, rolling), towards], axis=1)
    ball = attrs.evolve(one, points=(one.points - [0.0, 0.5 * bearing.pitch_diameter, 0.0]) @ axes)
    names = {}
    for name, body in {"inner_ring": found["inner_ring"], "outer_ring": held, "ball": ball}.items():
        names[name] = str(folder / f"{mesh[1]}-{name}.vtu")
        write(names[name], body)
    return {**elastic(mesh), "mesh": {"kind": "file", **names}}


def test_ring_held_on_one_half(claim, tmp_path):
    coarse, fine = (quantities(settled(half_held(mesh, tmp_path))[1]) for mesh in (COARSEST, FINER))
    stiff = {name: value for name, value in fine.items() if name.startswith("k")}
    quantity = "outer ring held where y > 0, meshes from files: diagonal stiffness, 3.2 mm: largest difference"
    claim(quantity, apart(coarse, stiff), at_most=0.02, **OWN, source="1.6 mm")


@pytest.mark.parametrize("integrator", ["quasi_static", "newmark"])
def test_dynamic_stiffness_of_the_coarsest_mesh(claim, integrator):
    excited = {
        "rotor": {"mass": 2.0}, "load": {"axial": 1000.0}, "integrator": {"kind": integrator, "turns": 2, "steps_per_turn": 60},
        "excitation": {"kind": "bidirectional", "speed_rpm": 12000.0, "amplitude": "constant", "force": 500.0},
    }  # fmt: skip
    one, other = (
        run(scene_from_dict(each)).to_dict()["identification"]["equivalent_stiffness"]
        for each in (elastic(COARSEST, **excited), tables(**CONDENSED, **excited))
    )
    quantity = f"dynamic stiffness at 12 000 r/min, {integrator}, 3.2 mm, 24 around: relative difference"
    claim(quantity, abs(one / other - 1.0), at_most=0.015, **OWN, source="condensed bodies of fine meshes")


def test_example(claim):
    scene = load_scene(EXAMPLES / "b7206_elastic.toml")
    found, wanted = (
        run(each).to_dict()["equilibrium"] for each in (scene, attrs.evolve(scene, bodies=Condensed(), mesh=None))
    )
    for words, at in (
        ("kyy", lambda one: one["stiffness"][1][1]), ("peak pressure", lambda one: one["balls"][0]["peak_pressure_inner_pa"]),
    ):  # fmt: skip
        error = abs(at(found) / at(wanted) - 1.0)
        claim(f"examples/b7206_elastic.toml: {words}: relative error", error, at_most=0.01, **OWN, source="condensed bodies")


def test_kernels(claim):
    """Of 1e5 and 1e6 elements, in ratios of one run."""
    rows = rows_of("kernel")
    once = {"basis": "regression", "source": "one core: ratios of one run"}
    claim("assembled product over force kernel: least", min(row["csr_over_force"] for row in rows), at_least=2.5, **once)
    claim("readable loop over force kernel: least", min(row["readable_over_force"] for row in rows), at_least=5.0, **once)
    quantity = "memory of the explicit step"
    claim(quantity, max(row["bytes_per_element"] for row in rows), at_most=1000.0, unit="B/element", **once)
    first, second = (row["renumbered_over_force"] for row in rows)
    quantity = "random numbering, renumbered, over ordered"
    claim(f"{quantity}, 1e5 elements", first, at_most=1.2, **once)
    why = "1.3 at ten times the elements"
    claim(f"{quantity}, 1e6 elements", second, at_most=1.2, **once, misses=why, machine=True)
