"""A study of precision on the screen."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Group, RenderableType

from raceway.commands.screen import Words, rows_table, written
from raceway.storage.tables import ReadTables

#: Beginning of the words that tell the reference.
_REFERENCE = "reference: "


def precision_screen(
    title: str, rows: Sequence[ReadTables], words: Sequence[str], files: Sequence[str], explain: bool = False
) -> RenderableType:
    """A line for each setting, and what they come to in words.

    Parameters
    ----------
    explain : how the reference was found and confirmed, whole, instead of what it is and how well it is known
    """
    # A column of blanks would cost the settings their room.
    names = [name for name in rows[0] if any(row[name] for row in rows)]
    parts: list[RenderableType] = [Words(title, "bold")]
    parts.append(rows_table([{name: row[name] for name in names} for row in rows]))
    parts.append(Words("* on the front; ~ known to the reference's bound only", "dim"))
    parts += [*(Words(text if explain else _brief(text)) for text in words), *written(files)]
    return Group(*parts)


def _brief(text: str) -> str:
    """Of the reference the first clause and the last, which is its bound; other words as they are."""
    first, *clauses = text.split("; ")
    return (
        f"{first}; {clauses[-1]} (--explain: how it was confirmed)" if text.startswith(_REFERENCE) and clauses[1:] else text
    )
