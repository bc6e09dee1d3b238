"""Finished parts of a long report on disk: a run that was cut off goes on where it stopped.

A part counts as finished for the sources that it was computed with: package, benchmarks and tests.
"""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable, Iterable
from functools import cache
from typing import Any

import attrs

from benchmarks.evidence import Row
from benchmarks.evidence._files import ROOT
from raceway.storage.cache_folder import cache_root
from raceway.studies.many.row_store import RowStore

#: Seconds that parts read from disk took when they were computed, by report.
EARLIER: dict[str, float] = {}


def kept(report: str, parts: Iterable[Callable[..., list[Row]] | tuple[Any, ...]]) -> list[Row]:
    """Rows of all parts, each a function or a tuple of one and its arguments; those on disk are not computed again."""
    store = RowStore(cache_root() / "evidence" / f"{report}.jsonl")
    rows: list[Row] = []
    entry: dict[str, Any] | None
    for part in parts:
        function, *arguments = part if isinstance(part, tuple) else (part,)
        key = f"{_sources()} {function.__name__} {arguments}"
        entry = store.get(key)
        if entry is None:
            begun = time.perf_counter()
            entry = {"rows": [attrs.asdict(row) for row in function(*arguments)]}
            entry["seconds"] = time.perf_counter() - begun
            store.put(key, entry)
        else:
            EARLIER[report] = EARLIER.get(report, 0.0) + entry["seconds"]
        rows += [Row(**row) for row in entry["rows"]]
    return rows


@cache
def _sources() -> str:
    digest = hashlib.sha256()
    for folder in ("raceway", "benchmarks", "tests", "validation"):
        for path in sorted((ROOT / folder).rglob("*.py")):
            digest.update(path.relative_to(ROOT).as_posix().encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]
