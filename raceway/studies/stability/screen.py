"""The catalogue of stability on the screen."""

from __future__ import annotations

from collections.abc import Sequence

from rich.box import SIMPLE_HEAD
from rich.console import Group, RenderableType
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from raceway.commands.screen.text import written
from raceway.storage.tables import ReadTables


def stability_screen(content: ReadTables, every: bool, files: Sequence[str]) -> RenderableType:
    """A line for each case, or for each row; what is not as expected in full."""
    rows = content["rows"]
    bad = [row for row in rows if row["verdict"] == "failed"]
    table = Table(header_style="bold", box=SIMPLE_HEAD, pad_edge=False, padding=(0, 1))
    if every:
        for name in ("case", "setting", "quantity", "expected", "predicted", "observed", "verdict"):
            table.add_column(name, overflow="fold")
        for row in rows:
            table.add_row(*(escape(cell) for cell in _stability_cells(row)))
    else:
        for name in ("case", "rows", "as expected"):
            table.add_column(name, justify="left" if name == "case" else "right")
        for case in dict.fromkeys(row["case"] for row in rows):
            own = [row for row in rows if row["case"] == case]
            good = sum(row["verdict"] == "as expected" for row in own)
            table.add_row(escape(case), str(len(own)), str(good) if good == len(own) else f"[red]{good}[/red]")
    parts: list[RenderableType] = [Text(content["title"], style="bold"), table]
    for row in bad:
        cells = _stability_cells(row)
        parts.append(
            Text(f"failed: {', '.join(cell for cell in cells[:6] if cell)}. {row['note'] or row['reason']}", style="red")
        )
    kept = f", {content['reused']} kept from before" if content["reused"] else ""
    words = (
        f"{len(rows) - len(bad)} of {len(rows)} rows as expected, {content['cases']} cases{kept}, {content['seconds']:.0f} s"
    )
    parts.append(Text(words))
    parts += written(files)
    return Group(*parts)


def _stability_cells(row: ReadTables) -> list[str]:
    setting = ", ".join(f"{key} {value}" for key, value in row["setting"].items())
    numbers = ("" if row[name] is None else f"{row[name]:.6g}" for name in ("predicted", "observed"))
    return [row["case"], setting, row["quantity"], row["expected"], *numbers, row["verdict"]]
