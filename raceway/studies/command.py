"""``raceway study ...``: studies that end in a page.  A sub-command's module is loaded when it is asked for."""

from __future__ import annotations

from importlib import import_module
from typing import Any

import click

from raceway.commands.console import Commands

#: Name of a sub-command -> where it is, as "module:object".
STUDIES = {
    "article": "raceway.studies.article.command:article",
    "rig": "raceway.studies.rig.command:rig",
    "map": "raceway.studies.map.command:study_map",
}


class Studies(Commands):
    """Sub-commands by name, each imported when it is asked for."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(STUDIES)

    def get_command(self, ctx: click.Context, cmd_name: str) -> Any:
        if cmd_name not in STUDIES:
            return None
        module, _, name = STUDIES[cmd_name].partition(":")
        return getattr(import_module(module), name)


@click.group(cls=Studies, short_help="Whole studies that end in a page.")
def study() -> None:
    """Whole studies: many runs, figures, and one HTML page that opens without a network.

    \b
    Example:
      raceway study article
    """
