"""Coefficients for rotor programs on the screen: no number broken, no column that says nothing."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Group, RenderableType

from raceway.out.table import rows_table, written
from raceway.out.wrapping import Words
from raceway.storage.tables import ReadTables
from raceway.studies.ross.points import point_rows

#: Characters of a line, and of the blanks between two columns.
_WIDTH, _BLANKS = 80, 3


def export_screen(content: ReadTables, files: Sequence[str]) -> RenderableType:
    """The points, what is the same at all of them, what was written, what their reader has to know."""
    rows, constant = point_rows(content)
    parts: list[RenderableType] = [
        Words(f"{content['tag']}, coefficients for {', '.join(content['programs'])}", "bold"),
        *(rows_table(part) for part in _fitting(rows)),
        *map(Words, constant),
    ]
    return Group(*parts, *(Words(f"note: {note}") for note in content["notes"]), *written(files))


def _fitting(rows: list[dict[str, str]]) -> list[list[dict[str, str]]]:
    """The rows as tables that fit the width, each with the axes."""
    axes = [name for name in rows[0] if name.endswith("r/min")]
    width = {
        name: max(len(word) for word in (*name.split("\n"), *(row[name] for row in rows))) + _BLANKS for name in rows[0]
    }
    room = _WIDTH - sum(width[name] for name in axes)
    parts: list[list[str]] = [[]]
    for name in (name for name in rows[0] if name not in axes):
        if parts[-1] and sum(width[one] for one in parts[-1]) + width[name] > room:
            parts.append([])
        parts[-1].append(name)
    return [[{name: row[name] for name in (*axes, *part)} for row in rows] for part in parts]
