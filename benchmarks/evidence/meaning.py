"""What answers mean: defaults that decide, names, states and warnings, each against whole runs or a rule of its own."""

from __future__ import annotations

from benchmarks.evidence import Row
from benchmarks.meaning import names, rows_of

TITLE = "What answers mean: defaults, names, states, warnings"


def rows() -> list[Row]:
    return [row for name in names() for row in rows_of(name)]
