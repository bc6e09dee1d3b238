"""Static equilibria of random and of extreme scenes: none unsolved that has a solution, and how long they take."""

from __future__ import annotations

import numpy as np

from benchmarks.evidence import Row, below
from validation.equilibria import EXTREME_RESIDUAL, RESIDUAL, families, random_scenes, solve

TITLE = "Equilibria of random and extreme scenes"
COMMAND = "python -m benchmarks.evidence equilibria"
SCENES = 2000


def rows() -> list[Row]:
    found = []
    for law, seed in (("hertz", 2026), ("penalty", 2027)):
        tally = solve(random_scenes(law, seed, SCENES))
        name = f"{SCENES} random scenes, {law}"
        note = f"{tally.free} refused by name: the loaded balls leave a motion free" if tally.free else ""
        if tally.unsolved:
            note = "; ".join([note, *sorted(set(tally.unsolved))[:3]]).strip("; ")
        found.append(Row(f"{name}: unsolved", len(tally.unsolved), "0", not tally.unsolved, COMMAND, note))
        found.append(below(f"{name}: median time [ms]", 1e3 * float(np.median(tally.seconds)), 5.0, COMMAND))
        longest = 1e3 * max(tally.seconds)
        found.append(Row(f"{name}: longest time [ms]", longest, "reported", True, COMMAND))
        found.append(Row(f"{name}: most iterations", max(tally.iterations), "reported", True, COMMAND))
        found.append(below(f"{name}: largest residual over the sum of forces", max(tally.residuals), RESIDUAL, COMMAND))
    for law in ("hertz", "penalty"):
        for name, scenes in families(law).items():
            tally = solve(scenes, EXTREME_RESIDUAL)
            parts = [
                f"residual at most {max(tally.residuals, default=0.0):.0e}",
                f"longest {1e3 * max(tally.seconds):.1f} ms",
            ]
            if tally.free:
                parts.append(f"{tally.free} refused by name, as many have a free motion")
            if tally.impossible:
                parts.append(
                    f"{tally.impossible} solved and refused: contact ellipses of more than half a ball's circumference"
                )
            note = "; ".join([*parts, *sorted(set(tally.unsolved))[:3]])
            title = f"{tally.count} scenes, {name}, {law}: unsolved"
            found.append(Row(title, len(tally.unsolved), "0", not tally.unsolved, COMMAND, note))
    return found
