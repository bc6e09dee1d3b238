"""``raceway verify``.  Part of ``raceway.cli.main``."""

from __future__ import annotations

import click

from raceway.cli.frame import (
    common,
    show,
    show_progress,
)


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
    content = verification.to_dict()
    from raceway.studies.verify.screen import verify_screen

    show(content, as_json, None, lambda: verify_screen(content, verification.passed, every))
    return 0 if verification.passed else 1
