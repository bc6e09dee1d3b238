"""Predicted against measured time of whole runs."""

from __future__ import annotations

from benchmarks.evidence import Row
from benchmarks.plan_time import LEAST, MOST, SCENES, compare

TITLE = "Predicted time of runs"
COMMAND = "python -m benchmarks.plan_time"


def rows() -> list[Row]:
    out = []
    for name, changes in SCENES.items():
        time = compare(changes)
        note = f"{time.predicted:.2f} s of a processor predicted, {time.measured:.2f} s measured"
        limit = f"{LEAST:g} to {MOST:g}"
        out.append(Row(f"predicted over measured time: {name}", round(time.ratio, 3), limit, time.holds, COMMAND, note))
    return out
