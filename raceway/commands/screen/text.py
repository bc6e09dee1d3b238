"""Parts that every screen is made of: sections, tables, numbers with units."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import TypeVar

from rich.console import Group, RenderableType
from rich.markup import escape
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from raceway.commands.screen.wrapping import Words
from raceway.framework.shown import number as number
from raceway.framework.shown import number_within as number_within
from raceway.framework.shown import tilt_words as tilt_words

Row = tuple[str, str, str]

T = TypeVar("T")

#: Widths of the first two columns of a section: the rest of 80 is left to the remark.
_QUANTITY, _VALUE = 22, 16


def sections(rows: Iterable[Row]) -> RenderableType:
    """Quantity, value, remark; a row without a value is a heading with its remark, or a remark alone where it has no quantity."""
    parts: list[RenderableType] = []
    table = _section()
    for quantity, value, remark in rows:
        if value:
            table.add_row(Words(quantity), escape(value), Words(remark, "dim"))
            continue
        if quantity:
            parts.append(Words(quantity, "bold"))
        if remark:
            parts.append(Words(remark, "dim", indent=2))
        table = _section()
        parts.append(Padding(table, (0, 0, 0, 2)))
    return Group(*parts)


def _section() -> Table:
    table = Table.grid(padding=(0, 2))
    table.add_column(width=_QUANTITY)
    table.add_column(justify="right", min_width=_VALUE, no_wrap=True)
    table.add_column()
    return table


def micro(text: str) -> str:
    """A text with the sign of micrometres that screens have, where what it comes from is written in ASCII."""
    return re.sub(r"\bum\b", "µm", text)


def written(files: Sequence[str]) -> list[RenderableType]:
    """The files' names, each unbroken on its line, so that it can be copied."""
    return [Text(f"written: {name}", no_wrap=True, overflow="ignore") for name in files]


def grouped(bodies: Mapping[str, T]) -> list[tuple[str, T]]:
    """Bodies with what is said of them; balls of which the same is said share a line, ``balls (12)``."""
    rows: list[tuple[str, T]] = []
    balls: list[tuple[T, int]] = []
    for name, said in bodies.items():
        if not name.startswith("ball"):
            rows.append((name, said))
            continue
        at = next((i for i, (other, _) in enumerate(balls) if other == said), None)
        if at is None:
            balls.append((said, 1))
        else:
            balls[at] = said, balls[at][1] + 1
    return rows + [(f"balls ({count})", said) for said, count in balls]
