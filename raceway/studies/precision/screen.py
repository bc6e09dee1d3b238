"""A study of precision on the screen."""

from __future__ import annotations

from collections.abc import Sequence

from rich.box import SIMPLE_HEAD
from rich.console import Group, RenderableType
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from raceway.commands.screen.text import written
from raceway.storage.tables import ReadTables


def precision_screen(title: str, rows: Sequence[ReadTables], words: Sequence[str], files: Sequence[str]) -> RenderableType:
    """A line for each setting, and what they come to in words."""
    table = Table(header_style="bold", box=SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    # A column of blanks would cost the settings their room.
    names = [name for name in rows[0] if any(row[name] for row in rows)]
    for name in names:
        text = name in ("setting", "status")
        table.add_column(name, justify="left" if text else "right", overflow="fold", min_width=0 if text else 6)
    for row in rows:
        table.add_row(*(escape(row[name]) for name in names))
    parts: list[RenderableType] = [Text(title, style="bold"), table]
    parts.append(Text("* on the front; ~ known to the reference's bound only", style="dim"))
    parts += [Text(text) for text in words]
    parts += written(files)
    return Group(*parts)
