"""Elastic bodies with whole contacts: coarse meshes whose own compliance under a contact is taken off, against condensed ones."""

from __future__ import annotations

import tempfile
import time
from functools import cache
from pathlib import Path
from typing import Any

import attrs
import numpy as np

from benchmarks.evidence import Row, below
from benchmarks.evidence._kept import kept
from raceway.bodies.equilibrium import Equilibrium
from raceway.bodies.model import Model, build_model
from raceway.pipeline.run import run
from raceway.pipeline.settle import settle
from raceway.planning.plan import make_plan
from raceway.scene.reading import scene_from_dict
from validation.condensed import quantities, tables

TITLE = "Elastic bodies: coarse meshes with the calibrated law"
COMMAND = "python -m benchmarks.evidence elastic_resultants"
#: Largest element [m], elements around a ring, along a semi-axis; and how near condensed bodies of fine meshes it must come, which
#: themselves are below 0.1 % from their limit (report ``condensed``, elements of 0.5 mm).
MESHES = {"3.2 mm, 24 around": ((3.2e-3, 24, 0), 0.015), "3.2 mm, 36 around": ((3.2e-3, 36, 0), 0.01),
          "1.6 mm, 60 around": ((1.6e-3, 60, 0), 0.01), "3.2 mm, refined at the contacts": ((3.2e-3, 36, 1), 0.005)}  # fmt: skip
COARSEST = MESHES["3.2 mm, 24 around"][0]
CONDENSED: dict[str, Any] = {"mesh": {"kind": "structured", "element_size": 0.5e-3, "nodes_per_semi_axis": 2}}
#: What is changed in the scene, and how far apart the coarsest mesh and condensed bodies may be.
SCENES: dict[str, tuple[dict[str, Any], float]] = {
    "tilt free": ({"tilt": "free"}, 0.02),
    "100 N axial alone": ({"load": {"axial": 100.0}}, 0.015),
    "10 kN axial alone": ({"load": {"axial": 10000.0}}, 0.025),
    "500 N radial alone": ({"load": {"radial": [500.0, 0.0]}}, 0.015),
    "30 000 r/min": ({"kinematics": {"ball_inertia": True, "spin_speed_rpm": 30000.0}}, 0.02),
    "law penalty": ({"contact": {"kind": "penalty"}}, 0.015),
    "outer ring on a bed of 500 N/mm3": ({"supports": {"outer_seat": 5e11}}, 0.03),
}
EXCITED: dict[str, Any] = {
    "rotor": {"mass": 2.0}, "load": {"axial": 1000.0},
    "excitation": {"kind": "bidirectional", "speed_rpm": 12000.0, "amplitude": "constant", "force": 500.0},
}  # fmt: skip


def rows() -> list[Row]:
    jobs: list[tuple[Any, ...]] = [(_mesh, name) for name in MESHES]
    jobs += [(_scene, name) for name in SCENES]
    return kept("elastic_resultants", [*jobs, (_half_held,), (_moving, "quasi_static"), (_moving, "newmark")])


def elastic(mesh: tuple[float, int, int], **more: Any) -> dict[str, Any]:
    """Tables of a scene with elastic bodies: largest element [m], elements around, along a semi-axis."""
    size, around, fine = mesh
    structured = {"kind": "structured", "element_size": size, "azimuth_cells": around, "nodes_per_semi_axis": fine}
    return tables(**{"bodies": {"kind": "elastic", "formulation": "incompatible"}, "mesh": structured, **more})


def _settled(of: dict[str, Any]) -> tuple[Model, Equilibrium]:
    scene = scene_from_dict(of)
    model = build_model(scene, make_plan(scene))
    return model, settle(model)


@cache
def _reference() -> dict[str, float]:
    return quantities(_settled(tables(**CONDENSED))[1])


def _apart(found: dict[str, float], expected: dict[str, float]) -> tuple[float, str]:
    """Largest relative difference of what is not zero, and its name."""
    largest = max(abs(value) for value in expected.values())
    apart = {name: found[name] / value - 1.0 for name, value in expected.items() if abs(value) > 1e-6 * largest}
    name = max(apart, key=lambda one: abs(apart[one]))
    return abs(apart[name]), f"in {name}, {100 * apart[name]:+.2f} %"


def _mesh(name: str) -> list[Row]:
    mesh, bound = MESHES[name]
    if mesh[2] == 0:
        _settled(elastic(COARSEST))  # kernels are loaded
    begin = time.process_time()
    model, found = _settled(elastic(mesh))
    cpu = time.process_time() - begin
    apart, where = _apart(quantities(found), _reference())
    told = model.bearing.report(model, found)
    cells, said = told["mesh"]["cells"], told["mesh"]
    note = (
        f"{where}; {cells} elements, {cpu:.1f} CPU-s; replaced {1e9 * said['replaced_inner_m_per_n']:.2f} and "
        f"{1e9 * said['replaced_outer_m_per_n']:.2f} nm/N, known to {1e9 * said['replaced_spread_m_per_n']:.2f}"
    )
    balance = below(
        f"{name}: unbalanced force, N", told["unbalanced_n"], 1e-2, COMMAND, "Newton's residual is 1e-7 of the forces"
    )
    quantity = f"{name}: largest difference from condensed bodies in displacement or diagonal stiffness"
    return [below(quantity, apart, bound, COMMAND, note), balance]


def _scene(name: str) -> list[Row]:
    changes, bound = SCENES[name]
    found = quantities(_settled(elastic(COARSEST, **changes))[1])
    apart, where = _apart(found, quantities(_settled(tables(**CONDENSED, **changes))[1]))
    return [below(f"{name}, coarsest mesh: the same difference", apart, bound, COMMAND, where)]


def _half_held() -> list[Row]:
    """An outer ring that its housing holds on one half only, from files: two meshes."""
    coarse, fine = (quantities(_settled(_half(MESHES[name][0]))[1]) for name in ("3.2 mm, 24 around", "1.6 mm, 60 around"))
    names = [name for name in fine if name.startswith("k")]
    apart, where = _apart({name: coarse[name] for name in names}, {name: fine[name] for name in names})
    whole = quantities(_settled(elastic(MESHES["1.6 mm, 60 around"][0]))[1])
    moved = f"y {fine['y']:.3f} um, {100 * (coarse['y'] / fine['y'] - 1.0):+.1f} %: the seat's ends lie on few nodes"
    note = f"{where}; {moved}; kyy {fine['kyy']:.1f} N/um, {100 * (fine['kyy'] / whole['kyy'] - 1.0):+.1f} % against a ring held all around"
    quantity = (
        "outer ring held where y > 0 only, meshes from files: largest difference in diagonal stiffness of 3.2 mm from 1.6 mm"
    )
    return [below(quantity, apart, 0.02, COMMAND, note)]


def _half(mesh: tuple[float, int, int]) -> dict[str, Any]:
    from raceway.bodies.meshing import mesh_scene
    from raceway.plugins.formats.vtu import Vtu

    scene = scene_from_dict(elastic(mesh))
    found, write = mesh_scene(scene), Vtu().write
    outer = found["outer_ring"]
    seat = outer.facet_sets["seat"][outer.points[outer.facet_nodes("seat")].mean(axis=1)[:, 1] > 0.0]
    held = attrs.evolve(outer, facet_sets={**outer.facet_sets, "seat": seat}, node_sets={})
    # A file holds a ball about its centre: x rolling, y across, z towards the outer contact.
    bearing, one = scene.bearing, found["ball_00"]
    towards = np.array([np.sin(bearing.contact_angle), np.cos(bearing.contact_angle), 0.0])
    rolling = np.array([0.0, 0.0, 1.0])
    axes = np.stack([rolling, np.cross(towards, rolling), towards], axis=1)
    ball = attrs.evolve(one, points=(one.points - [0.0, 0.5 * bearing.pitch_diameter, 0.0]) @ axes)
    folder = Path(tempfile.mkdtemp())
    files = {"inner_ring": found["inner_ring"], "outer_ring": held, "ball": ball}
    for name, body in files.items():
        write(str(folder / f"{name}.vtu"), body)
    names = {name: str(folder / f"{name}.vtu") for name in files}
    return {**elastic(mesh), "mesh": {"kind": "file", **names}}


def _moving(integrator: str) -> list[Row]:
    of: dict[str, Any] = {**EXCITED, "integrator": {"kind": integrator, "turns": 2, "steps_per_turn": 60}}
    begin = time.process_time()
    found = run(scene_from_dict(elastic(COARSEST, **of))).to_dict()
    cpu = time.process_time() - begin
    expected = run(scene_from_dict(tables(**CONDENSED, **of))).to_dict()
    one, other = (each["identification"]["equivalent_stiffness"] for each in (found, expected))
    quantity = f"dynamic stiffness at 12 000 r/min, {integrator}, coarsest mesh: difference from condensed bodies"
    note = f"{1e-6 * one:.1f} and {1e-6 * other:.1f} N/um; {found['cost']['steps']} steps, {cpu:.0f} CPU-s"
    return [below(quantity, abs(one / other - 1.0), 0.015, COMMAND, note)]
