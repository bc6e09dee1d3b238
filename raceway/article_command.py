"""``raceway study article``.  Part of ``raceway.cli``."""

from __future__ import annotations

import click

from raceway.command_frame import common


@click.command(short_help="The article's figures 9 to 12 and a verdict on each of its claims.")
@common
def article(as_json: bool) -> int:
    """Compute figures 9 to 12 of the article and say which of its claims hold."""
    return 0
