"""Deliberate faults of one line: which of them the tests catch."""

from __future__ import annotations

from benchmarks.evidence import Row, below
from benchmarks.mutants.faults import read_faults
from benchmarks.mutants.kept import tried

TITLE = "Deliberate faults of one line: caught or survived"
COMMAND = "make mutants"
#: Asked for.
LEAST_FAULTS, LEAST_SHARE, MOST_MINUTES = 60, 0.95, 40.0


def rows() -> list[Row]:
    faults = read_faults()
    failing, found = tried(faults)
    minutes = sum(one.seconds for one in found) / 60.0
    caught = sum(one.caught for one in found)
    share, note = caught / len(faults), f"{caught} of {len(faults)}"
    out = [
        Row("tests of the faults that fail without any", failing or "none", "none", not failing, COMMAND),
        Row("faults tried", len(found), f"at least {LEAST_FAULTS}", len(found) >= LEAST_FAULTS, COMMAND),
        Row("share of them that is caught", share, f"at least {LEAST_SHARE:g}", share >= LEAST_SHARE, COMMAND, note),
        below("processor time of all trials [min]", minutes, MOST_MINUTES, COMMAND),
    ]
    for one in found:
        name = f"`{one.fault.file}`: {one.fault.does}"
        out.append(Row(name, "caught" if one.caught else "survived", "caught", one.caught, COMMAND, f"`{one.how}`"))
    return out
