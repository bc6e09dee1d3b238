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

TITLE = "The article's claims, computed again"
COMMAND = "raceway study article"
PICTURES = Path(__file__).resolve().parents[2] / "docs" / "pictures" / "article"
_KEPT = ("figure-9", "figure-10", "figure-11", "figure-12", "tilt-stiffness")
_LIMITS = {"rigid": 120.0, "both": 300.0}
#: What is typed for each of them: the second goes on in the first one's folder, which costs nothing twice.
_TYPED = {
    "rigid": f"{COMMAND} --bodies rigid --out DIR",
    "both": f"{COMMAND} --bodies rigid --out DIR; {COMMAND} --out DIR",
}
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
        rigid = _study("rigid", Path(place))
        both = _study("both", Path(place))
        both = attrs.evolve(both, wall=rigid.wall + both.wall, path=rigid.path + both.path)
        PICTURES.mkdir(parents=True, exist_ok=True)
        for name in _KEPT:
            shutil.copy(Path(place) / "study" / f"{name}.png", PICTURES)
    return [
        *_cost({"rigid": rigid, "both": both}), *_page(both), *_trends(both.content), *_static(both.content),
        *_verdicts(both.content), *_causes(both.content), *_rig(both.content),
    ]  # fmt: skip


def _study(bodies: str, place: Path) -> _Cold:
    """Run the command in a folder with kernels and rows of its own."""
    folder = place / "study"
    words = [sys.executable, "-m", "raceway", "study", "article", "--bodies", bodies, "--out", str(folder), "--json"]
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
    for bodies, run in runs.items():
        note = f"{run.content['runs']} steady orbits, compiling included; wall time {run.wall:.0f} s beside what else the cores did"
        if bodies == "both":
            note += "; rigid first, whose page is written besides, then the condensed bodies"
        words = (
            f"processor time from cold to the written page, {bodies}: of the first process and of half the two others [s]"
        )
        out.append(below(words, run.path, _LIMITS[bodies], _TYPED[bodies], note))
        failed = run.content["failed"]
        out.append(Row(f"runs that failed, {bodies}", failed, "reported", True, _TYPED[bodies]))
        unstable = sum(row["status"] == "unstable" for row in run.content["rows"])
        out.append(Row(f"steady orbits that are unstable, {bodies}", unstable, "reported", True, _TYPED[bodies]))
    return out


def _page(run: _Cold) -> list[Row]:
    found = _FETCHES.findall(re.sub(r'src="data:[^"]*"', "", run.page))
    images = re.findall(r'<img alt="([^"]*)" src="data:', run.page)
    return [
        below("size of the page [MB]", len(run.page.encode()) / 1e6, 5.0, COMMAND),
        Row("what the page fetches or runs", ", ".join(found) or "nothing", "nothing", not found, COMMAND),
        Row("pictures in the page, each with words for those who do not see it", len(images), "67, none without words",
            len(images) == 67 and all(images), COMMAND),
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
