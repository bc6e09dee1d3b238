"""Elastic bodies in nodal contact at rest: a ball on a groove against Hertz, a whole bearing, and CalculiX beside them."""

from __future__ import annotations

import json
import subprocess
import sys
import time

import numpy as np

from benchmarks import calculix
from benchmarks.evidence import Row, below, near
from benchmarks.evidence._files import ROOT
from benchmarks.evidence._kept import kept
from validation.groove import HERTZ, pressed, solve

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
        return [Row("CPU time over CalculiX's", "not measured", "at most 0.1", False, COMPARE, "ccx is not installed")]
    # A process of its own: its peak memory is that of this case.
    words = [sys.executable, "-m", "benchmarks.against_calculix", "--json"]
    found = json.loads(subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True).stdout)
    mine, *others = found["rows"]
    solved = [row for row in others if not row["failure"]]
    if not solved:
        return [Row("CPU time over CalculiX's", "not measured", "at most 0.1", False, COMPARE, others[0]["failure"])]
    other = min(solved, key=lambda row: row["cpu_s"])
    told = (
        f"{found['elements']} elements: {mine['cpu_s']:.1f} CPU-s, peak pressure {100 * mine['pressure_deviation']:+.1f} %; "
    )
    told += "; ".join(
        f"{row['program']} {row['cpu_s']:.1f} CPU-s, {100 * row['pressure_deviation']:+.1f} %, reaction {100 * row['reaction_deviation']:+.1f} %"
        for row in solved
    )
    memory = f"{mine['memory_bytes'] / 2**20:.0f} and {other['memory_bytes'] / 2**20:.0f} MiB, all of Python and its libraries included"
    name = "over that of CalculiX's quickest deck, ball on groove"
    return [
        below(f"CPU time {name}", mine["cpu_s"] / other["cpu_s"], 0.1, COMPARE, told),
        below(f"memory {name}", mine["memory_bytes"] / other["memory_bytes"], 1.0, COMPARE, memory),
    ]


def _bearing() -> list[Row]:
    from raceway import load_scene
    from raceway.pipeline.run import run

    begin = time.process_time()
    result = run(load_scene(ROOT / SCENE)).to_dict()
    cpu = time.process_time() - begin
    found, balls = result["equilibrium"], result["equilibrium"]["balls"]
    inner = np.array([ball["load_inner_n"] for ball in balls])
    mirror = float(np.abs(inner[1:] / inner[:0:-1] - 1.0).max())
    typed = f"raceway run {SCENE} --json"
    model = result["model"]
    solver = model["linear_solver"]
    cost = (
        f"{cpu:.0f} and {CALCULIX_BEARING:g} CPU-s; {found['iterations']} + {solver['iterations']} iterations, "
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
        below("CPU time of the whole run over CalculiX's, with facets", cpu / CALCULIX_BEARING, 1.0, typed, cost),
    ]
