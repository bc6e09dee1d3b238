"""Nodal contacts of condensed bodies: single contacts against Hertz, whole bearings, resultants beside them, cost."""

from __future__ import annotations

import json
import subprocess
import sys
from typing import Any

import numpy as np

from benchmarks.evidence import Row, below, near
from benchmarks.evidence._files import ROOT

TITLE = "Condensed bodies: pressures at surface points"
COMMAND = "python -m benchmarks.evidence condensed_patches"
#: A program of its own (560 lines, incompatible elements, 8 points along a semi-axis at 300 N) on the same bearing, 1000 N axial and 500 N on a
#: ball: x, y [um], tilt [mrad], largest and smallest ball load [N], largest pressures [MPa].
PROTOTYPE: dict[str, dict[str, float]] = {
    "locked": {"x": 28.837, "y": 1.972, "load, largest": 350.3, "load, smallest": 174.7, "inner": 1656.0, "outer": 1383.0},
    "free": {
        "x": 27.064, "y": 13.701, "tilt": 1.5465, "load, largest": 398.6, "load, smallest": 214.2, "inner": 1736.0,
        "outer": 1443.0,
    },
}  # fmt: skip
#: Its stiffness [N/um, N m/mrad]: tangents at one place of the points, each contact's with the load of the ball's other contact
#: held, although its forces have that load (``held_poles``): 1 to 1.7 % above the derivative of the forces.
TANGENTS = {"locked": (65.52, 256.0, 257.3, 17.61, 17.67), "free": (66.08, 269.6, 256.2)}
UNIT = np.array([1e-6, 1e-6, 1e-6, 1e-3, 1e-3])
NAMES = ("kxx", "kyy", "kzz", "k tilt_y", "k tilt_z")


def rows() -> list[Row]:
    return [*_single(), *_bearing(), *_cost()]


def _single() -> list[Row]:
    from validation.single import single

    out, typed = [], "pytest tests/patches/test_contact.py"
    for load, within in ((100.0, 0.01), (300.0, 0.01), (1000.0, 0.015)):
        peaks = []
        for points in (4, 12):
            case = single(points, load)
            peaks.append(case.peak(case.at_load(load)[1]))
        hertz, word = float(case.ellipse.peak_pressure(load)), f"single contact, {load:g} N, 4 points per semi-axis"
        note = "the groove's torus is no paraboloid: 12 points give 1.5 % more than Hertz" if load > 500.0 else ""
        out.append(near(f"{word}: peak pressure over Hertz's", peaks[0] / hertz, 1.0, within, typed, note))
        out.append(near(f"{word}: peak pressure over that of 12 points", peaks[0] / peaks[1], 1.0, 0.005, COMMAND))
    case = single(8, 300.0, room=1.9)
    rest = []
    for load in (100.0, 300.0, 1000.0):
        rest.append(1e9 * (case.at_load(load)[0] - float(case.ellipse.approach(load))) / load)
    words = ", ".join(f"{value:.3f}" for value in rest)
    what = "single contact, 8 points at 300 N: (approach - Hertz)/Q at 100, 300, 1000 N, spread, nm/N"
    out.append(below(what, max(rest) - min(rest), 0.05, COMMAND, f"{words}: a structural compliance, whatever the load"))
    return out


def tables(points: int | None, tilt: str) -> dict[str, Any]:
    """B7206C under 1000 N axial and 500 N on a ball; resultants where no points are given."""
    out: dict[str, Any] = {
        "title": "condensed",
        "bearing": {"preset": "B7206C"},
        "bodies": {"kind": "condensed"},
        "supports": {"tilt": tilt},
        "load": {"axial": 1000.0, "radial": [500.0, 0.0]},
    }
    if points is not None:
        out["contact"] = {"kind": "unilateral", "discretisation": "nodal"}
        out["mesh"] = {"kind": "structured", "nodes_per_semi_axis": points, "element_size": 0.8e-3}
    return out


def solved_points(points: int | None, tilt: str) -> tuple[Any, Any]:
    from raceway import build_model, make_plan, scene_from_dict
    from raceway.pipeline.settle import settle

    scene = scene_from_dict(tables(points, tilt))
    model = build_model(scene, make_plan(scene))
    return model, settle(model)


def _bearing() -> list[Row]:
    out = []
    for tilt, given in PROTOTYPE.items():
        model, found = solved_points(8, tilt)
        columns = model.bearing.ball_columns(model, found)
        q, load = found.displacement, found.contact_force[: model.system.ball_count]
        mine = {
            "x": 1e6 * q[0], "y": 1e6 * q[1], "tilt": 1e3 * q[4], "load, largest": load.max(), "load, smallest": load.min(),
            "inner": 1e-6 * columns["peak_pressure_nodal_inner_pa"].max(),
            "outer": 1e-6 * columns["peak_pressure_nodal_outer_pa"].max(),
        }  # fmt: skip
        units = {"x": "um", "y": "um", "tilt": "mrad", "inner": "peak pressure, MPa", "outer": "peak pressure, MPa"}
        word = f"bearing, tilt {tilt}, 8 points"
        for name, expected in given.items():
            what = f"{word}: {name}, {units.get(name, 'N')}"
            out.append(near(what, float(mine[name]), expected, 0.01, COMMAND, "another program, notes on condensation"))
        diagonal, held = np.diag(found.stiffness) * UNIT, np.diag(held_poles(model, found)) * UNIT
        for k, expected in enumerate(TANGENTS[tilt]):
            note = f"as there, the load on the ball's other pole held; the derivative of the forces is {diagonal[k]:.5g}"
            what = f"{word}: {NAMES[k]}, {'N/um' if k < 3 else 'N m/mrad'}, other poles' loads held"
            out.append(near(what, float(held[k]), expected, 0.01, COMMAND, note))
        if tilt == "locked":
            out.append(_quotient(model, found))
        out += _beside(tilt, found)
    return out


def held_poles(model: Any, found: Any) -> np.ndarray:
    """(5, 5) mean tangent in which no contact feels what the load on the ball's other pole does: contacts two by two in series."""
    system = model.system
    system.evaluate(found.displacement, ball=found.ball)
    row = system.pool.row(system.table)
    stiff = [contact.mean_stiffness(seen) for contact, seen in zip(row.balls.contacts, row.last.seen, strict=True)]
    z = system.ball_count
    both = np.zeros((2 * z, 2 * z))
    for k, (inner, outer) in enumerate(zip(stiff[:z], stiff[z:], strict=True)):
        both[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] = inner - inner @ np.linalg.solve(inner + outer, inner)
    jacobian = system._groove(found.displacement, np.zeros(5), 0.0)[1]
    return np.asarray(jacobian.T @ both @ jacobian)


def _quotient(model: Any, found: Any) -> Row:
    """The stiffness against equilibria under loads that differ by 3 % of the axial one."""
    import attrs

    part, columns = 30.0, []
    for way in np.eye(5)[:3]:
        ends = [
            attrs.evolve(model.system, load=model.system.load + sign * part * way).settle(found.displacement, found.ball)[0]
            for sign in (1.0, -1.0)
        ]
        columns.append((ends[0] - ends[1])[:3] / (2.0 * part))
    whole = np.linalg.inv(np.array(columns).T)
    apart = float(np.abs(np.diag(found.stiffness)[:3] / np.diag(whole) - 1.0).max())
    words = ", ".join(f"{1e-6 * k:.5g}" for k in np.diag(whole))
    what = "bearing, tilt locked, 8 points: kxx, kyy, kzz against difference quotients of equilibria over 60 N"
    return below(what, apart, 0.005, COMMAND, f"quotients {words} N/um: what the forces say, with no tangent in it")


def _beside(tilt: str, nodal: Any) -> list[Row]:
    """Resultants of the same bodies, and four points, against eight points."""
    out = []
    for points, word in ((None, "resultants"), (4, "4 points")):
        model, other = solved_points(points, tilt)
        chosen = np.abs(nodal.displacement) > 1e-9
        moved = np.abs(other.displacement[chosen] / nodal.displacement[chosen] - 1.0).max()
        stiff = np.abs(np.diag(other.stiffness) / np.diag(nodal.stiffness) - 1.0).max()
        out.append(below(f"{word} against 8 points, tilt {tilt}: displacements", moved, 0.01, COMMAND))
        out.append(below(f"{word} against 8 points, tilt {tilt}: diagonal stiffness", stiff, 0.01, COMMAND))
        couplings = [(0, 1)] if tilt == "locked" else [(0, 1), (0, 4), (1, 4)]
        worst = max(abs(other.stiffness[i] / nodal.stiffness[i] - 1.0) for i in couplings)
        note = "couplings of a point tangent are off by 20 % with 4 points; these are means over all places of the points"
        out.append(below(f"{word} against 8 points, tilt {tilt}: couplings", worst, 0.05, COMMAND, note))
    return out


#: In a process of its own with an empty cache of compliances: CPU seconds and memory; the last equilibrium is cold.
BUILD = """
import json, sys, time
from pathlib import Path
from raceway.storage import array_cache
array_cache.folder = lambda: Path(sys.argv[2])
from raceway import build_model, make_plan, scene_from_dict
from raceway.pipeline.settle import settle
from benchmarks.evidence.condensed_patches import tables

def peak():  # of this program alone: ru_maxrss would hand on what its parent took
    line = next(line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmHWM"))
    return 1024 * int(line.split()[1])

def once(points):
    scene = scene_from_dict(tables(points, "free"))
    plan = make_plan(scene)
    begin = time.process_time()
    model = build_model(scene, plan)
    middle = time.process_time()
    settle(model)
    end = time.process_time()
    q, ball, _ = model.system.settle(model.guess)
    warm = time.process_time()
    return model, middle - begin, end - middle, warm - end

once(2)
before = peak()
_, first, _, _ = once(int(sys.argv[1]))
model, second, cold, warm = once(int(sys.argv[1]))
print(json.dumps({"first": first, "second": second, "cold": cold, "warm": warm, "memory": peak(), "before": before}))
"""


def _cost() -> list[Row]:
    import tempfile

    out = []
    for points, set_up, cold in ((4, 5.0, 0.3), (8, 20.0, 1.5)):
        with tempfile.TemporaryDirectory() as folder:
            command = [sys.executable, "-c", BUILD, str(points), folder]
            done = json.loads(subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout)
        word = f"{points} points per semi-axis"
        note = f"with the stiffness without ripple; {done['warm']:.2f} s without it and from known sets of points"
        out += [
            below(f"{word}: set-up of both rings and the ball, CPU seconds", done["first"], set_up, COMMAND),
            below(f"{word}: again from the cache, CPU seconds", done["second"], 0.3, COMMAND),
            below(f"{word}: equilibrium from rigid bodies, CPU seconds", done["cold"], cold, COMMAND, note),
            below(
                f"{word}: peak memory, GiB", done["memory"] / 2**30, 0.8, COMMAND,
                f"{done['before'] / 2**30:.2f} GiB of it are Python, its packages and a first small bearing",
            ),
        ]  # fmt: skip
    return out
