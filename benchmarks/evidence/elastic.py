"""Elastic bodies in nodal contact at rest: a ball on a groove against Hertz, a whole bearing, and CalculiX beside them."""

from __future__ import annotations

import time

import numpy as np

from benchmarks import against_calculix, calculix
from benchmarks.evidence import Row, below, near
from benchmarks.evidence._files import ROOT
from benchmarks.evidence._kept import kept
from benchmarks.groove import HERTZ, pressed, solve

TITLE = "Elastic bodies: statics"
COMMAND = "python -m benchmarks.evidence elastic"
COMPARE = "python -m benchmarks.against_calculix --json"
SCENE = "benchmarks/b7206_elastic_60k.toml"
LOADS = (100.0, 300.0, 1000.0)
#: Growth of the meshes: a quicker one where the outer parts hardly matter.
QUICK = {"growth": 1.35, "coarse": 0.8e-3}
#: Elements per semi-axis -> mesh, and how close the peak pressure has to be to Hertz's.
MESHES: dict[float, tuple[dict[str, float], float]] = {4.0: ({}, 0.05), 8.0: (QUICK, 0.02)}
#: physics.md, section 10: condensed bodies, tilt locked, 1000 N and 500 N [m, N].
EXPECTED = {"x": 28.69e-6, "y": 1.957e-6, "largest": 350.4, "smallest": 174.8}
#: The same size in CalculiX, with facets [CPU s], measured before this program existed.
CALCULIX_BEARING = 334.0


def rows() -> list[Row]:
    return kept("elastic", [(_pressures, 4.0), (_pressures, 8.0), _finer_ball, _cost, _bearing])


def _pressures(nodes: float) -> list[Row]:
    mesh, bound = MESHES[nodes]
    out, rest = [], []
    for load in LOADS:
        found = solve(load, nodes, **mesh)
        expected = float(HERTZ.peak_pressure(load))
        where = f"{load:g} N, {nodes:g} elements per semi-axis"
        note = f"{found.cells} elements, {found.newton} + {found.linear} iterations, {found.cpu:.1f} CPU-s"
        out.append(near(f"peak pressure at points, {where}, Pa", found.peak_points, expected, bound, COMMAND, note))
        out.append(near(f"peak pressure at nodes, {where}, Pa", found.peak_nodes, expected, bound, COMMAND))
        out.append(below(f"share of the approach that is penalty, {where}", found.penalty_share, 0.01, COMMAND))
        rest.append(1e9 * (found.approach - float(HERTZ.approach(load))) / load)
    told = "it is " + ", ".join(f"{value:.3f}" for value in rest)
    quantity = f"spread of (approach - Hertz)/Q over three loads, {nodes:g} elements per semi-axis, nm/N"
    return [*out, below(quantity, max(rest) - min(rest), 0.1, COMMAND, told)]


def _finer_ball() -> list[Row]:
    approach = float(HERTZ.approach(300.0)) - 0.55e-9 * 300.0
    one, other = (pressed(300.0, 4.0, approach, ball_finer=finer, **QUICK).reaction for finer in (1.0, 1.3))
    change = abs(other / one - 1.0)
    return [below("change of the reaction where the ball's rows are 1.3 times finer", change, 0.02, COMMAND)]


def _cost() -> list[Row]:
    if calculix.installed() is None:
        return [Row("CPU time against CalculiX", "not measured", "a tenth", False, COMPARE, "ccx is not installed")]
    found = against_calculix.compare(300.0, 4.0)
    mine, other = found["rows"]
    told = (
        f"{found['elements']} elements: {mine['cpu_s']:.1f} and {other['cpu_s']:.1f} CPU-s, {mine['memory_bytes'] / 2**20:.0f} and "
        f"{other['memory_bytes'] / 2**20:.0f} MiB; peak pressure {100 * mine['pressure_deviation']:+.1f} %"
    )
    if other["pressure_deviation"] is not None:
        told += f" and {100 * other['pressure_deviation']:+.1f} %, reaction {100 * other['reaction_deviation']:+.1f} %"
    told += f". {other['failure']}" if other["failure"] else ""
    return [below("CPU time over CalculiX's, ball on groove", mine["cpu_s"] / other["cpu_s"], 0.1, COMPARE, told)]


def _bearing() -> list[Row]:
    from raceway import load_scene
    from raceway.run import run

    begin = time.process_time()
    result = run(load_scene(ROOT / SCENE)).as_dict()
    cpu = time.process_time() - begin
    found, balls = result["equilibrium"], result["equilibrium"]["balls"]
    inner = np.array([ball["load_inner_n"] for ball in balls])
    mirror = float(np.abs(inner[1:] / inner[:0:-1] - 1.0).max())
    typed = f"raceway run {SCENE} --json"
    model = result["model"]
    solver = model["linear_solver"]
    cost = (
        f"CalculiX with facets: {CALCULIX_BEARING:g} CPU-s; {found['iterations']} + {solver['iterations']} iterations, "
        f"{solver['setups']} set-ups, with the 5 x 5 stiffness"
    )
    cells = model["mesh"]["cells"]
    return [
        Row("elements of the bearing", cells, "at least 60000", cells >= 60_000, typed),
        below("largest difference of balls that are mirror images", mirror, 1e-3, typed),
        near("largest ball load, N", float(inner.max()), EXPECTED["largest"], 0.02, typed),
        near("smallest ball load, N", float(inner.min()), EXPECTED["smallest"], 0.02, typed),
        near("axial displacement, m", found["displacement"]["x"], EXPECTED["x"], 0.05, typed),
        near("radial displacement, m", found["displacement"]["y"], EXPECTED["y"], 0.05, typed),
        Row("CPU-s of the whole run", cpu, "told", True, typed, cost),
    ]
