"""A study of precision on the screen."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Group, RenderableType

from raceway.out.table import rows_table, written
from raceway.out.wrapping import Words
from raceway.storage.tables import ReadTables


def precision_screen(title: str, rows: Sequence[ReadTables], words: Sequence[str], files: Sequence[str]) -> RenderableType:
    """A line for each setting, and what they come to in words."""
    # A column of blanks would cost the settings their room.
    names = [name for name in rows[0] if any(row[name] for row in rows)]
    parts: list[RenderableType] = [Words(title, "bold")]
    parts.append(rows_table([{name: row[name] for name in names} for row in rows]))
    parts.append(Words("* on the front; ~ known to the reference's bound only", "dim"))
    return Group(*parts, *map(Words, words), *written(files))
