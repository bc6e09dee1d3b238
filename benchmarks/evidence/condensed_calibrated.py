"""Condensed bodies with resultants: structural compliances, whole bearings, rigid limit, cost."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from functools import cache
from typing import Any

import attrs
import numpy as np

from benchmarks.evidence import Row, below, near
from benchmarks.evidence._files import ROOT
from benchmarks.evidence.condensed_patches import NAMES, held_poles, solved_points
from validation.scenes import model_of, rotating, settled

TITLE = "Condensed bodies: the calibrated law"
COMMAND = "python -m benchmarks.evidence condensed_calibrated"
#: 1000 N axial, 500 N towards ball 0, no centrifugal forces; notes/condensed.md, section 3, both columns from an own program:
#: compliances as there (-0.62, -0.64, ball -0.304 and 0.167 nm/N), and pressures at surface points, 8 per semi-axis.
CALIBRATED = {
    "locked": {"x": 28.691, "y": 1.957, "kxx": 65.00, "kyy": 254.8, "kzz": 255.5, "k tilt_y": 17.51, "k tilt_z": 17.48},
    "free": {"x": 26.921, "y": 13.676, "tilt_z": 1.5447, "kxx": 65.60, "kyy": 267.5, "kzz": 253.8},
}
POINTS = {
    "locked": {"x": 28.837, "y": 1.972, "kxx": 65.52, "kyy": 256.0, "kzz": 257.3},
    "free": {"x": 27.064, "y": 13.701, "tilt_z": 1.5465, "kxx": 66.08, "kyy": 269.6, "kzz": 256.2},
}
BED = {"x": 32.191, "y": 2.598, "kxx": 55.48, "kyy": 191.7}
UNITS = {"x": "um", "y": "um", "tilt_z": "mrad"}
#: Sizes of elements [m] with elements along a semi-axis of the contact, and how near their limit they must come.
LADDER = ((2e-3, 1, 0.02), (1e-3, 1, 0.02), (0.5e-3, 2, 0.01), (0.25e-3, 4, 0.003))
LIMIT = (0.125e-3, 8)


def rows() -> list[Row]:
    return [*structural(), *bearing(), *points(), *ladder(), *bed(), *zero(), *step(), *set_up()]


def tables(tilt: str = "locked", size: tuple[float, int] | None = None, **more: Any) -> dict[str, Any]:
    """The scene of every row; ``size`` of the elements [m] and how many along a semi-axis."""
    mesh = {} if size is None else {"mesh": {"kind": "structured", "element_size": size[0], "nodes_per_semi_axis": size[1]}}
    supports = {"tilt": tilt, **more.pop("supports", {})}
    plain = {
        "title": "condensed", "bearing": {"preset": "B7206C"}, "bodies": {"kind": "condensed"}, "supports": supports,
        "load": {"axial": 1000.0, "radial": [500.0, 0.0]}, "kinematics": {"ball_inertia": False},
    }  # fmt: skip
    return {**plain, **mesh, **more}


def quantities(equilibrium: Any) -> dict[str, float]:
    """Displacements [um, mrad] and diagonal stiffness [N/um, N m/mrad]."""
    q, k = equilibrium.displacement, equilibrium.stiffness
    return {
        "x": 1e6 * q[0], "y": 1e6 * q[1], "tilt_z": 1e3 * q[4], "kxx": 1e-6 * k[0, 0], "kyy": 1e-6 * k[1, 1],
        "kzz": 1e-6 * k[2, 2], "k tilt_y": 1e-3 * k[3, 3], "k tilt_z": 1e-3 * k[4, 4],
    }  # fmt: skip


def structural() -> list[Row]:
    """Against the published split of one contact; 0.03 nm/N is what two ways of splitting differ by there."""
    bodies = settled(tables())[0].bearing.compliances
    angle = np.radians(18.65)
    found = {
        "inner ring, 18.65 deg": (float(np.interp(angle, bodies.inner.angles, bodies.inner.own)), -0.60e-9),
        "outer ring, 18.65 deg": (float(np.interp(angle, bodies.outer.angles, bodies.outer.own)), -0.62e-9),
        "ball, its own contact": (bodies.ball_own, -0.304e-9),
        "ball, the opposite contact": (bodies.ball_opposite, 0.167e-9),
    }
    return [
        Row(f"structural compliance, {name}, nm/N", 1e9 * value, f"{1e9 * want:g} within 0.03", abs(value - want) < 0.03e-9,
            COMMAND)
        for name, (value, want) in found.items()
    ]  # fmt: skip


def bearing() -> list[Row]:
    """Both tilt boundaries against both columns of the notes, whose tangents of points hold the load on a ball's other pole."""
    out = []
    for tilt in ("locked", "free"):
        found = quantities(settled(tables(tilt))[1])
        model, nodal = solved_points(8, tilt)
        ratio = dict(zip(NAMES, np.diag(nodal.stiffness) / np.diag(held_poles(model, nodal)), strict=True))
        for word, column in (("the same law", CALIBRATED), ("8 points per semi-axis", POINTS)):
            for name, want in column[tilt].items():
                unit = UNITS.get(name, "N m/mrad" if "tilt" in name else "N/um")
                what = f"tilt {tilt}: {name}, {unit}, against {word} (notes)"
                note = ""
                if column is POINTS and name.startswith("k"):
                    note = (
                        f"{100 * (found[name] / want - 1):+.2f} %; tangents there hold the load on a ball's other pole, which makes "
                        f"them {100 * (1 / ratio[name] - 1):.2f} % stiffer by this program's points, and are those of one place of "
                        "the points, which ripple; the same quantity: over own 8 points, below"
                    )
                out.append(near(what, found[name], want, 0.01, COMMAND, note))
    return out


def points() -> list[Row]:
    """Against this program's own pressures at surface points, five loads a little apart."""
    out = []
    for tilt in ("locked", "free"):
        found: dict[str, list[float]] = {}
        for part in (0.97, 0.985, 1.0, 1.015, 1.03):
            load = {"axial": 1000.0 * part, "radial": [500.0 * part, 0.0]}
            nodal = {"contact": {"kind": "unilateral", "discretisation": "nodal"}}
            mesh = {"mesh": {"kind": "structured", "nodes_per_semi_axis": 8}}
            theirs = quantities(settled({**tables(tilt, load=load), **nodal, **mesh})[1])
            ours = quantities(settled(tables(tilt, load=load))[1])
            for name in ("x", "y", "tilt_z", "kxx", "kyy", "kzz", "k tilt_y", "k tilt_z"):
                if abs(theirs[name]) > 1e-9:
                    found.setdefault(name, []).append(ours[name] / theirs[name] - 1.0)
        note = "mean of five loads from 970 to 1030 N axial; largest difference of one of them: "
        for name, apart in found.items():
            mean, most = float(np.mean(apart)), max(np.abs(apart))
            what = f"tilt {tilt}: {name}, calibrated over own 8 points per semi-axis, less 1"
            out.append(Row(what, mean, "-0.01 to 0.01", abs(mean) <= 0.01, COMMAND, f"{note}{100 * most:.2f} %"))
    return out


def ladder() -> list[Row]:
    limit = quantities(settled(tables(size=LIMIT))[1])
    out = []
    for size, along, tolerance in LADDER:
        found = quantities(settled(tables(size=(size, along)))[1])
        worst = max((abs(found[name] / limit[name] - 1.0), name) for name in CALIBRATED["locked"])
        what = f"elements of {1e3 * size:g} mm: largest difference from 0.125 mm in displacement or diagonal stiffness"
        out.append(below(what, worst[0], tolerance, COMMAND, f"in {worst[1]}"))
    return out


def bed() -> list[Row]:
    found = quantities(settled(tables(supports={"outer_seat": 500e9}))[1])
    out = []
    for name, want in BED.items():
        what = f"outer ring on a bed of 500 N/mm3: {name}, {UNITS.get(name, 'N/um')}"
        note = f"{100 * (found[name] / want - 1):+.2f} %; that program sees displacements along normals only: see condensed_seats"
        out.append(near(what, found[name], want, 0.01, COMMAND, note))
    return out


def zero() -> list[Row]:
    """All structural compliances zero: the rigid bearing, in every kernel."""
    from raceway.core.condensed.elastic_bodies import ElasticBodies, elastic_system

    out = []
    for word, more in {
        "weightless balls": {},
        "centrifugal forces": {"kinematics": {"spin_speed_rpm": 15000.0}},
        "gyroscopic moments": {"kinematics": {"spin_speed_rpm": 15000.0, "gyroscopic": "outer_race"}},
    }.items():
        model = model_of(tables("free", **more))
        rings = [attrs.evolve(r, own=0.0 * r.own, across=0.0 * r.across) for r in _rings(model)]
        rigid = model.bearing.rigid
        soft = elastic_system(rigid.system, ElasticBodies(rings[0], rings[1], 0.0, 0.0), np.full(12, 0.3))
        (q, ball, _), (p, place, _) = rigid.system.settle(rigid.guess), soft.settle(rigid.guess)
        one, two = rigid.system.evaluate(q, ball=ball).stiffness, soft.evaluate(p, ball=place).stiffness
        scale = np.array([1.0, 1.0, 1.0, soft.arm, soft.arm])
        weight = np.outer(1.0 / scale, 1.0 / scale)
        apart = max(
            np.abs((p - q) * scale).max() / np.abs(q * scale).max(),
            np.abs((two - one) * weight).max() / np.abs(one * weight).max(),
        )
        out.append(below(f"compliances zero, {word}: difference from rigid bodies", float(apart), 1e-7, COMMAND))
    return out


def _rings(model: Any) -> list[Any]:
    return [model.bearing.compliances.inner, model.bearing.compliances.outer]


def step() -> list[Row]:
    """CPU time of an equilibrium and of a Newmark step, the least of several repeats, 12 balls."""
    from raceway.core.ring.orbit import steady_orbit
    from raceway.core.ring.start import from_orbit
    from raceway.core.schemes.drivers import integrate
    from raceway.core.stepping.record import Schedule

    out = []
    soft_seat = {"supports": {"tilt": "locked", "outer_seat": 500e9}}
    for word, inertia, more in (
        ("weightless balls", False, {}), ("centrifugal forces", True, {}), ("on a bed of 500 N/mm3", True, soft_seat)
    ):  # fmt: skip
        model = model_of(
            {**rotating(1000.0, "locked", 12000.0, inertia, "newmark"), "bodies": {"kind": "condensed"}, **more}
        )
        times = []
        for _ in range(20):
            begin = time.process_time()
            q, ball, _ = model.system.settle(model.guess)
            model.system.evaluate(q, ball=ball)
            times.append(time.process_time() - begin)
        out.append(below(f"{word}: equilibrium with tangent, ms", 1e3 * min(times), 5.0, COMMAND))
        period = model.excitation.period_s
        schedule = Schedule(period / 360, 360, 12)
        start = from_orbit(model.system, steady_orbit(model.system, period, q), schedule.dt)
        times = []
        for _ in range(7):
            begin = time.process_time()
            integrate(model.scene.integrator.method, model.system, start, schedule, None)
            times.append(time.process_time() - begin)
        out.append(below(f"{word}: Newmark step, microseconds", 1e6 * min(times) / schedule.steps, 60.0, COMMAND))
    return out


#: In a process of its own with an empty cache of compliances and compiled kernels.
BUILD = """
import json, sys, time
from pathlib import Path
from raceway.core.schemes.drivers import integrate
from raceway.storage import array_cache
array_cache.folder = lambda: Path(sys.argv[1])
from validation.scenes import settled
from benchmarks.evidence.condensed_calibrated import peak_bytes, tables

from raceway.bodies.condensed import compliances

rigid = {**tables(), "bodies": {"kind": "rigid"}}
settled(rigid)
calibrated, spent = compliances.calibrated, []

def timed(*given):
    begin = time.process_time()
    found = calibrated(*given)
    spent.append(time.process_time() - begin)
    return found

compliances.calibrated = timed
before = peak_bytes()
found = []
for _ in range(2):
    begin = time.process_time()
    model, _ = settled(tables())
    found.append(time.process_time() - begin)
found[0] -= sum(spent[:2])
bodies = model.bearing.compliances
print(json.dumps({"times": found, "calibration": sum(spent[:2]), "elements": bodies.inner.elements + bodies.outer.elements,
                  "memory": peak_bytes(), "before": before}))
"""


def peak_bytes() -> int:
    """Largest memory of this program alone (ru_maxrss hands on what its parent took)."""
    with open("/proc/self/status") as file:
        line = next(line for line in file if line.startswith("VmHWM"))
    return 1024 * int(line.split()[1])


@cache
def fresh() -> dict[str, Any]:
    """CPU seconds of a first and a second build, and memory, in a process that knows nothing."""
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([sys.executable, "-c", BUILD, folder], cwd=ROOT, capture_output=True, text=True, check=True)
    content: dict[str, Any] = json.loads(done.stdout)
    return content


def set_up() -> list[Row]:
    done = fresh()
    note = f"{done['elements']} hexahedra's worth; kernels compiled before"
    return [
        below("rings and ball of a scene, equilibrium included: CPU seconds", done["times"][0], 3.0, COMMAND, note),
        below(
            "their calibration on one contact of each race: CPU seconds",
            done["calibration"],
            10.0,
            COMMAND,
            "contacts at surface points, once a geometry; kept",
        ),
        below("the same again from the cache: CPU seconds", done["times"][1], 0.3, COMMAND),
        below("memory beyond that of rigid bodies, MiB", (done["memory"] - done["before"]) / 2**20, 100.0, COMMAND),
    ]
