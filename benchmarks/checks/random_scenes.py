"""Random scenes, valid and invalid: each ends in a result without NaN, or in a message with exit code 1 or 2."""

from __future__ import annotations

import os
import time
from collections import Counter

from benchmarks.checks._random_scenes import FAILED, FINISHED, PLANNED, REFUSED, try_scenes
from benchmarks.evidence import Row

TITLE = "Random scenes"
COMMAND = "python -m benchmarks.checks random_scenes"
#: Scenes of a whole run; the environment may ask for fewer, and the report says how many there were.
COUNT = int(os.environ.get("RACEWAY_RANDOM_SCENES", "10000"))
WANTED = 10_000


def rows() -> list[Row]:
    found: Counter[str] = Counter()

    def note(outcome: str) -> None:
        found[outcome] += 1

    begin, why = time.process_time(), ""
    try:
        try_scenes(COUNT, note)
    except Exception as error:  # whatever leaves the program is what the report is about
        notes = " ".join(getattr(error, "__notes__", []))
        why = f"{type(error).__name__}: {error}; {notes}"[:1500]
    tried = sum(found.values())
    spent = time.process_time() - begin
    out = [
        Row("random scenes tried", tried, f"at least {WANTED}", tried >= WANTED, COMMAND, f"{spent:.0f} s of processor time"),
        Row("scenes that end in anything but a result without NaN or a message with exit code 1 or 2", why or "none", "none",
            not why, COMMAND),
    ]  # fmt: skip
    return out + [Row(word, found[word], "reported", True, COMMAND) for word in (FINISHED, REFUSED, FAILED, PLANNED)]
