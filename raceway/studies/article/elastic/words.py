"""Numbers in words, for screen and page alike."""

from __future__ import annotations

from raceway.storage.tables import ReadTables


def per_cent(part: float | None) -> str:
    """A relative difference; a dash where there is none."""
    return "-" if part is None else f"{100.0 * part:+.2f} %"


def gib(cost: ReadTables) -> str:
    """Memory at the peak of a row [GiB]."""
    peak = cost["peak_memory_bytes"]
    return "-" if peak is None else f"{peak / 2**30:.2f}"
