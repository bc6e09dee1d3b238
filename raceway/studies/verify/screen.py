"""Table of ``raceway verify``."""

from __future__ import annotations

from collections.abc import Sequence

from rich.box import SIMPLE_HEAD
from rich.console import Group, RenderableType
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from raceway.out.table import micro, number
from raceway.storage.tables import ReadTables
from raceway.studies.many.reference import BASES

#: Columns of numbers in the table of ``verify`` and their significant digits.
_VERIFIED = (("reference", 5), ("computed", 5), ("error", 2), ("tolerance", 2))
#: Cases of which every number is shown: the pressures of the article, load by load, with their mesh independence.
_IN_FULL = ("seed-static-pressures",)


def verify_screen(verification: ReadTables, passed: bool, every: bool = False) -> RenderableType:
    """Reference cases, what was computed, and whether it agrees.

    Parameters
    ----------
    every : a line for each number, not only the worst of each case and those that are off
    """
    table = Table(header_style="bold", box=SIMPLE_HEAD, pad_edge=False, padding=(0, 1))
    table.add_column("number" if every else "case: the worst of its numbers", min_width=28)
    for name, _ in _VERIFIED:
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("")
    before = None
    for row in verification["rows"] if every else _worst(verification["rows"]):
        if row["case"] != before:
            table.add_row(f"[bold]{escape(row['case'])}[/]")
        numbers = (
            number(row["reference"]),
            number(row["computed"]),
            number(row["error"], "", 2),
            number(row["tolerance"], "", 2),
        )
        verdict = "[green]ok[/]" if row["ok"] else f"[red]off[/] {escape(row.get('note') or '')}"
        quantity = escape(micro(row["quantity"]))
        table.add_row(f"  {quantity}", *numbers, verdict)
        before = row["case"]
    counts = [f"{kept['within']} of {kept['of']} {BASES[basis]}" for basis, kept in verification["kept"].items()]
    return Group(table, Text(f"within their tolerance: {', '.join(counts)}", style="green" if passed else "red"))


def _worst(rows: Sequence[ReadTables]) -> list[ReadTables]:
    """Of each case the number closest to its tolerance, all that are off and all of ``_IN_FULL``, in their order."""

    def strain(row: ReadTables) -> float:
        return float("inf") if row["error"] is None or not row["tolerance"] else row["error"] / row["tolerance"]

    closest = {case: max((r for r in rows if r["case"] == case), key=strain) for case in {r["case"] for r in rows}}
    return [row for row in rows if not row["ok"] or row["case"] in _IN_FULL or closest[row["case"]] is row]
