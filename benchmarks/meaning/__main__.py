"""``python -m benchmarks.meaning [NAME...]``: the rows of these modules, or of all, on the screen."""

from __future__ import annotations

import sys

from benchmarks.meaning import names, rows_of

for name in sys.argv[1:] or names():
    for row in rows_of(name):
        print(f"{'yes' if row.ok else 'NO':4}{name}: {row.quantity}: {row.value} ({row.limit}) {row.note}", flush=True)
