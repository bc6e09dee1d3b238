"""The map of hardening and softening: 1020 points over axial load, speed, tilt boundary and contact angle."""

from __future__ import annotations

import resource
from pathlib import Path
from typing import Any

from benchmarks.evidence import Row, below, near
from raceway.framework.registry import default_registry
from raceway.scene.file import read_toml
from raceway.studies.map.design import ANGLE, AXIAL, SPEED, TILT, design
from raceway.studies.map.page import write_data, write_pictures
from raceway.studies.map.study import Map, study_map

TITLE = "Hardening or softening of k(speed): axial load, speed, tilt, contact angle"
ROOT = Path(__file__).resolve().parents[2]
PICTURES = ROOT / "docs" / "pictures" / "map"
COMMAND = "raceway study map"
CONSTANT = f"{COMMAND} --set excitation.amplitude=constant --set excitation.force=100"
#: physics: k / k(10 980 r/min) at 15 000 r/min and k(10 980) [N/um], fixed balls, centrifugal force, no ring growth.
SOLVER = {
    ("locked", 400.0): (163.0, 0.668), ("locked", 1000.0): (235.3, 0.962), ("locked", 2000.0): (285.8, 0.993),
    ("free", 400.0): (24.32, 1.356), ("free", 1000.0): (34.30, 1.167), ("free", 2000.0): (48.37, 1.063),
}  # fmt: skip


def rows() -> list[Row]:
    registry, tables = default_registry(), read_toml(ROOT / "raceway" / "data" / "map.toml")
    before = _cpu()
    found = study_map(design(tables, (), "quasi_static", registry), 2, registry=registry)
    seconds = _cpu() - before
    done = sum(row["status"] == "completed" for row in found.rows)
    out = [
        Row(
            "points with a number",
            f"{done} of {len(found.rows)}",
            "reported",
            True,
            COMMAND,
            "failed points stand in map.html",
        ),
        below("processor time of the whole map, both processes, s", round(seconds, 1), 60.0, COMMAND),
    ]
    out += _against_the_solver(tables)
    out += _inertia(tables)
    out += [Row("in words", words, "reported", True, COMMAND) for words in found.words]
    out += _boundaries(found, COMMAND)
    PICTURES.mkdir(parents=True, exist_ok=True)
    written = write_pictures(found, PICTURES)
    write_data(found, PICTURES)
    page = next(path for path in written if path.suffix == ".html")
    out.append(below("size of map.html, MB", page.stat().st_size / 1e6, 5.0, COMMAND))
    for path in PICTURES.iterdir():  # documents show the pictures; the rest is written by the command
        if path.name not in ("map-change.png", "map-curves.png"):
            path.unlink()
    constant = {**tables, "excitation": {**tables["excitation"], "amplitude": "constant", "force": 100.0}}
    small = study_map(design(constant, (f"{ANGLE}=15",), "quasi_static", registry), 2, registry=registry)
    out += [Row("constant 100 N, in words", words, "reported", True, CONSTANT) for words in small.words]
    return out


def _against_the_solver(tables: dict[str, Any]) -> list[Row]:
    """The published trend of an independent rigid-ring solver, which takes the load towards ball 0."""
    registry = default_registry()
    plain = {**tables, "kinematics": {"ball_inertia": True}}
    vary = (f"{AXIAL}=400,1000,2000", f"{SPEED}=10980,15000", f"{ANGLE}=15")
    found = study_map(design(plain, vary, "quasi_static", registry), registry=registry)
    command = f"{COMMAND} --set kinematics.ring_growth=false --vary {' --vary '.join(vary)}"
    out = []
    for curve in found.curves:
        first, last = SOLVER[curve["tilt"], float(curve["axial"])]
        name = f"tilt {curve['tilt']}, {curve['axial']:g} N"
        note = "the solver loads towards ball 0 and prints three or four digits; the map turns the force over all azimuths"
        out.append(near(f"{name}: k at 10 980 r/min, N/um", 1e-6 * curve["first_stiffness"], first, 0.003, command, note))
        out.append(near(f"{name}: k(15 000) / k(10 980)", 1.0 + curve["last_change"], last, 0.0015, command))
    return out


def _inertia(tables: dict[str, Any]) -> list[Row]:
    """What the ring's own inertia changes, where no rotor is carried."""
    registry, vary = default_registry(), (f"{AXIAL}=400,2000", f"{SPEED}=10980,15000", f"{ANGLE}=15")
    both = [study_map(design(tables, vary, method, registry), registry=registry) for method in ("quasi_static", "periodic")]
    worst = max(
        abs(b["stiffness"] / a["stiffness"] - 1.0)
        for a, b in zip(both[0].rows, both[1].rows, strict=True)
        if "stiffness" in b
    )
    command = f"{COMMAND} --method periodic --vary {' --vary '.join(vary)}"
    note = "the contacts carry m w^2 r of the ring's own 61 g besides the force, and with tilt free the ring's tilt inertia acts"
    return [below("largest difference of k, periodic from quasi_static, no rotor carried", worst, 0.02, command, note)]


def _boundaries(found: Map, command: str) -> list[Row]:
    """Where contact is lost, the edge reached, hardening steepest and saturated, over the axial loads."""
    out = []
    axes = found.design.axes
    for angle in axes[ANGLE]:
        for tilt in axes[TILT]:
            curves = [c for c in found.curves if (c["contact_angle_deg"], c["tilt"]) == (angle, tilt)]
            for key, words in (
                ("contact_lost_from_rpm", "balls lose contact from"), ("edge_from_rpm", "an ellipse runs over the groove's edge from"),
                ("unseats_from_rpm", "the bearing unseats from"), ("steepest_at_rpm", "hardening is steepest at"),
                ("saturates_at_rpm", "hardening has saturated at"),
            ):  # fmt: skip
                there = [f"{c['axial']:g} N {c[key]:.0f}" for c in curves if c[key] is not None]
                text = ", ".join(there) if there else f"nowhere up to {max(axes[SPEED]):.0f}"
                out.append(Row(f"{angle:g} deg, tilt {tilt}: {words}, r/min", text, "reported", True, command))
    return out


def _cpu() -> float:
    """Processor time of this process and of those that have ended [s]."""
    return sum(u.ru_utime + u.ru_stime for u in map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)))
