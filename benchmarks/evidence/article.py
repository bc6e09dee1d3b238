"""``raceway study article`` from cold: its cost, its page, the trends of an independent solver, and every verdict."""

from __future__ import annotations

import json
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import attrs

from benchmarks.evidence import Row, below
from raceway.framework.registry import default_registry
from raceway.pipeline.run import run
from raceway.scene.reading import scene_from_dict
from raceway.studies.article.curves import ROTATING
from raceway.studies.article.design import (
    FRICTION_ERROR,
    FRICTION_STEPS,
    FRICTION_TURNS,
    FRICTION_WORDS,
    FRICTIONS,
    Setting,
    article_tables,
    design,
)

TITLE = "The article's claims, computed again"
COMMAND = "raceway study article"
PICTURES = Path(__file__).resolve().parents[2] / "docs" / "pictures" / "article"
_KEPT = ("figure-9", "figure-10", "figure-11", "figure-12", "tilt-stiffness", "friction")
#: What is typed one after the other: each goes on in the folder of those before, which costs nothing twice.
_WORDS = {"rigid": ("--bodies", "rigid", "--friction", "0"), "friction": ("--bodies", "rigid"), "both": ()}
_TYPED = {name: f"{COMMAND} {' '.join(words)} --out DIR".replace("  ", " ") for name, words in _WORDS.items()}
#: Of the first alone, of what friction adds, and of all three [s].
_LIMITS = {"rigid": 120.0, "friction": 120.0, "both": 300.0}
#: Tilt, axial load [N], speed [r/min] of the runs with friction that are repeated with twice the turns of twice the steps.
_REPEATED = (
    ("free", 2000.0, 10980.0), ("free", 2000.0, 15000.0), ("locked", 2000.0, 15000.0), ("free", 400.0, 12990.0),
    ("shaft", 1200.0, 12990.0),
)  # fmt: skip
_FETCHES = re.compile(r"https?://|url\(|@import|<script|srcset")


@attrs.frozen
class _Cold:
    """A study that began without a compiled kernel or a kept curve: what it printed, its page, and its cost since then [s].

    Attributes
    ----------
    path : processor time of the command's own process and of half the two that work for it, one after the other
    """

    content: dict[str, Any]
    page: str
    wall: float
    path: float


def rows() -> list[Row]:
    with tempfile.TemporaryDirectory() as place:
        rigid, friction, both = (_study(name, Path(place)) for name in _WORDS)
        before = (rigid, friction)
        both = attrs.evolve(
            both, wall=both.wall + sum(one.wall for one in before), path=both.path + sum(one.path for one in before)
        )
        PICTURES.mkdir(parents=True, exist_ok=True)
        for name in _KEPT:
            shutil.copy(Path(place) / "study" / f"{name}.png", PICTURES)
    return [
        *_cost({"rigid": rigid, "friction": friction, "both": both}), *_friction(both.content), *_page(both), *_trends(both.content), *_static(both.content),
        *_verdicts(both.content), *_causes(both.content), *_rig(both.content),
    ]  # fmt: skip


def _study(name: str, place: Path) -> _Cold:
    """Run the command in a folder with kernels and rows of its own."""
    folder = place / "study"
    words = [sys.executable, "-m", "raceway", "study", "article", *_WORDS[name], "--out", str(folder), "--json"]
    before, begun = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    environment = {**os.environ, "RACEWAY_CACHE_DIR": str(place / "cache")}
    done = subprocess.run(words, capture_output=True, text=True, env=environment, check=True)
    after, wall = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter() - begun
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    content = json.loads(done.stdout)
    workers = content["cost"]["cpu_s"] - content["cost"]["own_cpu_s"]
    page = (folder / "article.html").read_text(encoding="utf-8")
    return _Cold(content, page, wall, used - 0.5 * workers)


def _cost(runs: dict[str, _Cold]) -> list[Row]:
    out = []
    names = {
        "rigid": "from cold to the written page, rigid bodies without friction",
        "friction": "that friction adds, with another page",
        "both": "from cold to the written page, with friction and condensed bodies: the two above, and the rest",
    }
    for name, cold in runs.items():
        note = f"{cold.content['runs']} motions; wall time {cold.wall:.0f} s beside what else the cores did"
        words = f"processor time {names[name]}: of the first process and of half the two others [s]"
        out.append(below(words, cold.path, _LIMITS[name], _TYPED[name], note))
        failed = cold.content["failed"]
        out.append(Row(f"runs that failed, {name}", failed, "reported", True, _TYPED[name]))
        unstable = sum(row["status"] == "unstable" for row in cold.content["rows"])
        out.append(Row(f"steady orbits that are unstable, {name}", unstable, "reported", True, _TYPED[name]))
    return out


def _friction(content: dict[str, Any]) -> list[Row]:
    """What the runs with friction are known to, and what friction does to the trend."""
    registry, made = default_registry(), design(article_tables())
    changes = []
    for friction in FRICTIONS[1:]:
        for tilt, load, speed in _REPEATED:
            setting = Setting(**ROTATING, tilt=tilt, inertia=True, bodies="rigid", friction=friction)
            tables = made.point(setting, load, speed, registry)
            twice = {"turns": 2 * FRICTION_TURNS, "steps_per_turn": 2 * FRICTION_STEPS}
            finer = {**tables, "integrator": {**tables["integrator"], **twice}}
            k = [
                run(scene_from_dict(one, registry), registry).identification.equivalent_stiffness for one in (tables, finer)
            ]
            changes.append(abs(k[1] / k[0] - 1.0))
    words = f"largest change of K with friction by twice the turns of twice the steps, {len(changes)} points"
    out = [below(words, max(changes), FRICTION_ERROR, COMMAND, "what the verdicts take for the error of K with friction")]
    for one in content["friction_trends"]:
        name = f"change of K from 10 980 to 15 000 r/min, rotating force m e w², tilt {one['tilt']}, {one['axial_n']:g} N"
        value = ", ".join(
            f"{FRICTION_WORDS[kind]} {one[kind] if isinstance(one[kind], str) else f'{100.0 * one[kind]:+.2f} %'}"
            for kind in FRICTIONS
        )
        out.append(Row(name, value, "reported", True, COMMAND))
    return out


def _page(run: _Cold) -> list[Row]:
    found = _FETCHES.findall(re.sub(r'src="data:[^"]*"', "", run.page))
    images = re.findall(r'<img alt="([^"]*)" src="data:', run.page)
    return [
        below("size of the page [MB]", len(run.page.encode()) / 1e6, 5.0, COMMAND),
        Row("what the page fetches or runs", ", ".join(found) or "nothing", "nothing", not found, COMMAND),
        Row("pictures in the page, each with words for those who do not see it", len(images), "70, none without words",
            len(images) == 70 and all(images), COMMAND),
    ]  # fmt: skip


def _trends(content: dict[str, Any]) -> list[Row]:
    out = []
    for one in content["quasi_static"]:
        balls = "with" if one["inertia"] else "without"
        where = f"tilt {one['tilt']}, {one['load']:g} N, {balls} ball inertia"
        value = " ".join(f"{x:.5g}" for x in one["computed"] or [])
        limit = " ".join(f"{x:.4g}" for x in one["expected"]) + ", printed digits"
        note = "" if one["off_in_last_digits"] is None else f"off by {one['off_in_last_digits']:.2f} of the last digit"
        out.append(Row(f"{where}: k(10 980) [N/um], k* to 15 000 r/min", value, limit, one["holds"], COMMAND, note))
    return out


def _static(content: dict[str, Any]) -> list[Row]:
    return [
        below(f"{one['quantity']}: computed over exact Hertz, less 1", one["error"], one["tolerance"], COMMAND)
        for one in content["static"]
    ]


def _verdicts(content: dict[str, Any]) -> list[Row]:
    return [
        Row(f"claim {one['number']}: {one['claim']}", one["verdict"], "reported", True, COMMAND,
            one["computed"] + (f". Failed or unstable: {one['failed'].partition(' (the first reason')[0]}" if one["failed"] else ""))
        for one in content["verdicts"]
    ]  # fmt: skip


def _causes(content: dict[str, Any]) -> list[Row]:
    out = []
    for load in (400.0, 1000.0, 2000.0):
        for name, tilts in content["causes"][f"{load:g}"].items():
            value = ", ".join(
                f"{tilt} {found if isinstance(found, str) else f'{100.0 * found:+.2f} %'}" for tilt, found in tilts.items()
            )
            out.append(
                Row(f"change of K from 10 980 to 15 000 r/min at {load:g} N, {name}", value, "reported", True, COMMAND)
            )
    for one in content["tilt_stiffness"]:
        words = f"tilt stiffness above which K falls with speed, {one['axial_n']:g} N [N m/rad]"
        value = "none" if one["turning_point"] is None else f"{one['turning_point']:.4g}"
        out.append(Row(words, value, "reported", True, COMMAND))
    return out


def _rig(content: dict[str, Any]) -> list[Row]:
    return [
        Row(f"K at {row['speed_rpm']:g} r/min, {row['axial_n']:g} N, tilt {row['tilt']}, {row['bodies']} bodies [N/um]",
            f"{row['k'] / 1e6:.4g}" if "k" in row else row["status"], "reported", True, COMMAND)
        for row in content["rig"]
    ]  # fmt: skip
