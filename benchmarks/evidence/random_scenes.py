"""Ten thousand random scenes, valid and invalid: how each ends."""

from __future__ import annotations

from benchmarks.evidence import Row
from tests.random_scenes import counted

TITLE = "Random scenes: a result without NaN, or a message"
COMMAND = "python -m benchmarks.evidence random_scenes"
SCENES = 10_000


def rows() -> list[Row]:
    found = counted(SCENES)  # anything but a result or a message ends it here, with the scene
    total = sum(found.values())
    words = ", ".join(f"{count} {way}" for way, count in sorted(found.items()))
    return [
        Row("scenes that end in a result or in one message", words, f"all of {SCENES}", total >= SCENES, COMMAND, "rigid bodies; short runs of every integrator, law and identifier"),
        Row("scenes with a result", float(found["result"]), "a tenth at least", found["result"] >= 0.1 * total, COMMAND),
    ]  # fmt: skip
