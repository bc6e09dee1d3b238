"""Ten thousand random scenes through check and plan, fifteen hundred of them through run, and calls of all fronts, each watched."""

import json
import os
import signal
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from checks.robustness import Row, above
from checks.robustness._doors import fronts
from checks.robustness._fuzz import ASLEEP_S, CALLS, CHECK_S, RUN_S
from checks.robustness._scenes import scene_keys

#: Scenes, runs and processes of a whole report; the environment may ask for fewer scenes, and the report says how many there were.
SCENES = int(os.environ.get("RACEWAY_FUZZ_SCENES", "10000"))
RUNS, PROCESSES = 3 * SCENES // 20, 2
WANTED_SCENES, WANTED_RUNS = 10_000, 1500
#: Faults by the word that a worker gives them.
_FAULTS = {
    "traceback": "tracebacks: anything but a result or a message with exit code 1 or 2",
    "hang": f"hangs: beyond {CHECK_S:g} s of processor time in check and plan, {RUN_S:g} s in run, or {ASLEEP_S:g} s in all",
    "died": "processes that ended by a signal",
    "nan": "NaN or infinity in a result, or a failure that tells them",
    "untold": "errors of Z, unknown or larger than it, without a warning",
    "memory": "memory above twice the plan's: what was there, the record, the meshes",
    "left": "files written and processes started by check and plan",
}


def tries(scenes: int = SCENES, runs: int = RUNS) -> list[dict[str, Any]]:
    """What became of every scene, by processes of which one goes on where another ended."""
    with tempfile.TemporaryDirectory() as folder:
        share = -(-scenes // PROCESSES)
        places = [(k * share, min((k + 1) * share, scenes), Path(folder) / f"{k}.jsonl") for k in range(PROCESSES)]
        workers = [_worker(first, last, runs // PROCESSES, out) for first, last, out in places]
        found: list[dict[str, Any]] = []
        for (_, last, out), worker in zip(places, workers, strict=True):
            code = worker.wait()
            while code:
                found.append({"seed": _begun(out), "faults": [[_word(code), "", f"exit code {code}"]]})
                quota = runs // PROCESSES - sum("run" in one for one in _done(out))
                code = _worker(_begun(out) + 1, last, quota, out).wait()
            found += _done(out)
    return found


def _worker(first: int, last: int, quota: int, out: Path) -> subprocess.Popen[bytes]:
    words = [sys.executable, "-m", "checks.robustness._fuzz", str(first), str(last), str(quota), str(out)]
    return subprocess.Popen(words, cwd=Path(__file__).parents[2], stdin=subprocess.DEVNULL)


def _lines(out: Path) -> Iterator[dict[str, Any]]:
    return map(json.loads, out.read_text().splitlines()) if out.is_file() else iter(())


def _done(out: Path) -> list[dict[str, Any]]:
    return [line for line in _lines(out) if "begun" not in line]


def _begun(out: Path) -> int:
    """The scene at which a process ended.  RuntimeError: it ended before the first one, or between two."""
    lines = list(_lines(out))
    if not lines or "begun" not in lines[-1]:
        raise RuntimeError("a process of the fuzz ended outside its scenes: see what it wrote on standard error")
    return int(lines[-1]["begun"])


def _word(code: int) -> str:
    return "hang" if -code in (signal.SIGPROF, signal.SIGALRM) else "died"


def rows() -> list[Row]:
    found = tries()
    checked, ran, called = (Counter(one[word] for one in found if word in one) for word in ("check", "run", "called"))
    fronts_met = {one["front"] for one in found if one.get("called") == "answered"}
    bodies = sorted({one["bodies"] for one in found if one.get("run") == "finished"})
    out = [
        above("scenes through check and plan", len(found), WANTED_SCENES),
        above("scenes through run", ran.total(), WANTED_RUNS),
        above("calls of Python fronts, some with wrong types", called.total(), WANTED_SCENES // CALLS),
        above("keys of the schema that are drawn", min(len(found), len(scene_keys())), len(scene_keys())),
        above("share of scenes that are planned", checked["planned"] / max(checked.total(), 1), 0.2),
        above("share of runs that finish", ran["finished"] / max(ran.total(), 1), 0.5, f"bodies: {', '.join(bodies)}"),
        above("fronts that answered at least once", len(fronts_met), len(fronts())),
    ]
    for word, quantity in _FAULTS.items():
        bad = [(one["seed"], fault) for one in found for fault in one["faults"] if fault[0] == word]
        told = [(seed, " ".join(fault[2].split())[-300:]) for seed, fault in bad[:3]]
        note = "; ".join(f"scene {seed}: {words}" for seed, words in told)
        out.append(Row(quantity, len(bad), "0", not bad, note))
    return out
