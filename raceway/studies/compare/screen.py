"""A comparison on the screen."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Group, RenderableType

from raceway.out.table import rows_table, written
from raceway.out.wrapping import Words
from raceway.storage.tables import ReadTables


def compare_screen(title: str, rows: Sequence[ReadTables], words: Sequence[str], files: Sequence[str]) -> RenderableType:
    """The effects, the largest first, a line for each point, and the other words."""
    parts: list[RenderableType] = [Words(title, "bold"), *map(Words, words[:1]), rows_table(rows), *map(Words, words[1:])]
    parts.append(Words("all quantities, courses and inertia in words: compare.json", "dim"))
    return Group(*parts, *written(files))
