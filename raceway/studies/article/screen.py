"""Table of ``raceway study article``.  Prints nothing by itself."""

from __future__ import annotations

from collections.abc import Sequence

from rich.box import SIMPLE_HEAD
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from raceway.commands.screen import Words, written
from raceway.storage.tables import ReadTables

_COLOURS = {"holds": "green", "holds only for": "yellow", "does not hold": "red"}


def article_screen(content: ReadTables, files: Sequence[str]) -> RenderableType:
    """Verdicts, the check against an independent solver, failures and cost.

    Parameters
    ----------
    content : what ``--json`` prints;  files : what was written
    """
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for name in ("", "claim", "verdict"):
        table.add_column(name)
    for one in content["verdicts"]:
        words = Text(one["kind"], style=_COLOURS.get(one["kind"], "magenta"))
        if one["region"]:
            words.append(f" {one['region']}", style="default")
        if one["failed"]:
            words.append("; some runs failed or are unstable", style="magenta")
        table.add_row(one["number"], Words(one["claim"]), words)
    trends = content["quasi_static"]
    good = sum(row["holds"] for row in trends)
    cost = content["cost"]
    lines = [
        f"quasi-static trends equal to an independent solver's printed digits: {good} of {len(trends)}",
        f"{content['runs']} points, {content['failed']} failed; {cost['wall_s']:.0f} s, "
        f"{cost['cpu_s']:.0f} s of processor time"
        + (f"; {cost['reused']} of {cost['tasks']} pieces taken from earlier" if cost["reused"] else ""),
    ]
    return Group(Words(content["title"], "bold"), table, *(Words(line, "dim") for line in lines), *written(files))
