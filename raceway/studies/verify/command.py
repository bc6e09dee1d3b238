"""``raceway verify``.  Part of ``raceway.cli.main``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from raceway.cli.frame import common, show, show_progress

if TYPE_CHECKING:
    from rich.console import RenderableType

    from raceway.studies.verify.study import Verification

#: Columns of numbers and their significant digits.
_DIGITS = {"reference": 5, "computed": 5, "error": 2, "tolerance": 2}
#: Cases of which every number is shown: the pressures of the article, load by load, with their mesh independence.
_IN_FULL = ("seed-static-pressures",)


@click.command(short_help="Compute the reference cases.")
@click.option("--only", metavar="CASE", help="One case instead of all.")
@click.option("--all", "every", is_flag=True, help="Show every number, not only the worst of each case.")
@common
def verify(only: str | None, every: bool, as_json: bool) -> int:
    """Compute reference cases; exit code 1 when a number misses its tolerance.

    Published numbers, closed forms, and this program by two ways are counted apart.

    \b
    Example:
      raceway verify --only harris-table-6.1 --all
    """
    with show_progress() as progress:
        from raceway.studies.verify.study import verify as study

        verification = study(only, progress)
    show(verification.to_dict(), as_json, None, lambda: _screen(verification, every))
    return 0 if verification.passed else 1


def _screen(verification: Verification, every: bool) -> RenderableType:
    """Reference cases, what was computed, and whether it agrees; of each case the worst number and all that are off, or ``every`` one."""
    from rich.box import SIMPLE_HEAD
    from rich.console import Group
    from rich.markup import escape
    from rich.table import Table
    from rich.text import Text

    from raceway.out.table import micro, number
    from raceway.studies.verify.reference import BASES

    table = Table(header_style="bold", box=SIMPLE_HEAD, pad_edge=False, padding=(0, 1))
    table.add_column("number" if every else "case: the worst of its numbers", min_width=28)
    for name in _DIGITS:
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("")
    before = None
    worst = verification.worst
    for row in verification.rows:
        if not every and row.ok and row.case not in _IN_FULL and row not in worst:
            continue
        if row.case != before:
            table.add_row(f"[bold]{escape(row.case)}[/]")
        numbers = [number(getattr(row, name), "", digits) for name, digits in _DIGITS.items()]
        verdict = "[green]ok[/]" if row.ok else f"[red]off[/] {escape(row.note)}"
        table.add_row(f"  {escape(micro(row.quantity))}", *numbers, verdict)
        before = row.case
    counts = [f"{count['within']} of {count['of']} {BASES[basis]}" for basis, count in verification.kept.items()]
    style = "green" if verification.passed else "red"
    return Group(table, Text(f"within their tolerance: {', '.join(counts)}", style=style))
