"""A comparison on the screen."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Group, RenderableType

from raceway.commands.screen import Words, rows_table, written
from raceway.storage.tables import ReadTables
from raceway.studies.compare.causes import IN_SHORT


def compare_screen(
    title: str, rows: Sequence[ReadTables], words: Sequence[str], files: Sequence[str], more: bool = False
) -> RenderableType:
    """What decides, a line for each point, and what causes what in words; without one that decides, all words first.

    Parameters
    ----------
    more : whether there are more words than these
    """
    first = [text for text in words if text.startswith(IN_SHORT)] or words
    rest = [text for text in words if text not in first]
    parts: list[RenderableType] = [Words(title, "bold"), *map(Words, first)]
    parts += [rows_table(rows), *map(Words, rest)]
    if more:
        parts.append(Words("interactions, |Z| and inertia in words: raceway compare ... --explain, or compare.json", "dim"))
    return Group(*parts, *written(files))
