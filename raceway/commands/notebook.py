"""How answers of many runs show themselves: a few lines in a console, one table in a notebook."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from textwrap import shorten

#: Lines of a repr, and characters of one.
_LINES, _WIDTH = 14, 100
#: Rows of a table that a notebook shows.
_MOST_ROWS = 60
_STYLE = "overflow-x:auto;max-width:100%"


def few_lines(head: str, lines: Sequence[str]) -> str:
    """At most 15 lines: what it is, then what it says; how much more there is."""
    told = [
        shorten(line.strip(), _WIDTH, placeholder=" ...") for text in lines for line in text.splitlines() if line.strip()
    ]
    if len(told) > _LINES:
        told = [*told[: _LINES - 1], f"... and {len(told) - _LINES + 1} more lines: to_dict()"]
    return "\n".join([head, *(f"  {line}" for line in told)])


def html_table(title: str, rows: Sequence[Mapping[str, object]], lines: Sequence[str] = ()) -> str:
    """A heading, one table that scrolls by itself on a narrow screen, and sentences below it."""
    parts = [f"<div><b>{_broken(title)}</b>"]
    if rows:
        names = list(dict.fromkeys(name for row in rows for name in row))
        head = "".join(f'<th style="text-align:left">{escape(name)}</th>' for name in names)
        body = "".join(
            "<tr>"
            + "".join(
                f'<td style="text-align:left;white-space:nowrap">{escape(str(row.get(name, "")))}</td>' for name in names
            )
            + "</tr>"
            for row in rows[:_MOST_ROWS]
        )
        parts.append(f'<div style="{_STYLE}"><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>')
    if len(rows) > _MOST_ROWS:
        lines = [f"and {len(rows) - _MOST_ROWS} more rows: to_dict()", *lines]
    parts += [f'<div style="max-width:70em">{_broken(line)}</div>' for line in lines]
    return "".join([*parts, "</div>"])


def _broken(text: str) -> str:
    return escape(text).replace("\n", "<br>")
