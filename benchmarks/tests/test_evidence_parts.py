"""Parts of a long report that are on disk are not computed again."""

from __future__ import annotations

from contextlib import suppress

from benchmarks.evidence import Row
from benchmarks.evidence._kept import kept


def test_a_finished_part_is_read_and_an_unfinished_one_computed(tmp_path, monkeypatch):
    monkeypatch.setenv("RACEWAY_CACHE_DIR", str(tmp_path))
    calls = []

    def part(x):
        calls.append(x)
        if len(calls) == 2:
            raise KeyboardInterrupt
        return [Row(f"row {x}", float(x), "none", True, "command")]

    with suppress(KeyboardInterrupt):
        kept("report", [(part, 1), (part, 2)])
    rows = kept("report", [(part, 1), (part, 2)])
    assert calls == [1, 2, 2] and [row.value for row in rows] == [1.0, 2.0]
