"""``python -m benchmarks.checks [NAME...]``: the rows of these checks, or of all; exit code 1 where one does not hold."""

from __future__ import annotations

import sys
from importlib import import_module

from benchmarks.checks import Row, names, show


def rows_of(name: str) -> list[Row]:
    rows: list[Row] = import_module(f"benchmarks.checks.{name}").rows()
    return rows


sys.exit(show(sys.argv[1:], names(), rows_of))
