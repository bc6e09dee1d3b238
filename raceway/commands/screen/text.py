"""Parts that every screen is made of: sections, tables, numbers with units."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TypeVar

from rich.box import SIMPLE_HEAD
from rich.console import Group, RenderableType
from rich.markup import escape
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from raceway.framework.shown import number as number
from raceway.framework.shown import number_within as number_within
from raceway.storage.tables import ReadTables

Row = tuple[str, str, str]

T = TypeVar("T")


def sections(rows: Iterable[Row]) -> RenderableType:
    """Quantity, value, remark; a row without a value is a heading with its remark."""
    parts: list[RenderableType] = []
    for quantity, value, remark in rows:
        if not value:
            parts.append(Text.assemble((quantity, "bold"), (f"  {remark}" if remark else "", "dim")))
            table = Table.grid(padding=(0, 2))
            table.add_column(width=24)
            table.add_column(justify="right", min_width=16, no_wrap=True)
            table.add_column(style="dim", overflow="fold")
            parts.append(Padding(table, (0, 0, 0, 2)))
        else:
            table.add_row(escape(quantity), escape(value), escape(remark))
    return Group(*parts)


def tilt_words(tilt: float | str) -> str:
    """The tilt boundary, which belongs to every stiffness."""
    return f"tilt {tilt}" if isinstance(tilt, str) else f"tilt against {tilt:g} N m/rad"


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


def rows_table(rows: Sequence[ReadTables], title: str = "") -> RenderableType:
    """A table of dictionaries with the same keys; underscores become blanks, numbers are aligned."""
    table = Table(title=title or None, title_justify="left", header_style="bold", box=SIMPLE_HEAD, pad_edge=False)
    keys = list(dict.fromkeys(key for row in rows for key in row))
    for key in keys:
        numeric = any(isinstance(row.get(key), float | int) for row in rows)
        table.add_column(
            key if "." in key else key.replace("_", " "), justify="right" if numeric else "left", overflow="fold"
        )
    for row in rows:
        table.add_row(*(_cell(row.get(key)) for key in keys))
    return table


def _cell(value: object) -> str:
    if isinstance(value, bool):
        return "[green]yes[/]" if value else "[red]no[/]"
    return escape(number(value) if isinstance(value, float) else "-" if value is None else str(value))
