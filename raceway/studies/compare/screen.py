"""A comparison on the screen."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Group, RenderableType
from rich.text import Text

from raceway.commands.screen.text import rows_table, written
from raceway.storage.tables import ReadTables


def compare_screen(title: str, rows: Sequence[ReadTables], words: Sequence[str], files: Sequence[str]) -> RenderableType:
    """A line for each point, and what causes what in words."""
    parts: list[RenderableType] = [Text(title, style="bold"), rows_table(rows)]
    parts += [Text(text) for text in words]
    parts += written(files)
    return Group(*parts)
