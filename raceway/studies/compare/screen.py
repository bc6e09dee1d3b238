"""A comparison on the screen."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Group, RenderableType

from raceway.commands.screen import Words, rows_table, written
from raceway.storage.tables import ReadTables


def compare_screen(
    title: str, rows: Sequence[ReadTables], words: Sequence[str], files: Sequence[str], more: bool = False
) -> RenderableType:
    """The effects, the largest first, a line for each point, and the other words.

    Parameters
    ----------
    more : whether there are more words than these
    """
    parts: list[RenderableType] = [Words(title, "bold"), *map(Words, words[:1]), rows_table(rows), *map(Words, words[1:])]
    if more:
        parts.append(
            Words("all quantities, courses and inertia in words: raceway compare ... --explain, or compare.json", "dim")
        )
    return Group(*parts, *written(files))
