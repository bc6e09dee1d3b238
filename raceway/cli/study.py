"""``raceway study ...``: studies that are plug-ins.  A study's own modules are loaded when it is asked for."""

from __future__ import annotations

from pathlib import Path

import click

from raceway.cli.console import Commands
from raceway.errors import PluginError, RacewayError
from raceway.framework.packages import missing_package
from raceway.framework.registry import default_registry, registry_with
from raceway.framework.sources import foreign_words


class Studies(Commands):
    """Sub-commands by name, each imported when it is asked for."""

    def elsewhere(self, word: str) -> str:
        return missing_package(f"study:{word}", "plugins")

    def list_commands(self, ctx: click.Context) -> list[str]:
        return default_registry().names("study")

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in self.list_commands(ctx):
            return None
        entry = default_registry().find("study", cmd_name)
        who = f"study '{cmd_name}' of {entry.distribution}"
        try:
            with foreign_words():
                command = entry.plugin().command()
        except RacewayError:
            raise
        except Exception as why:  # a third party's own code
            raise PluginError(f"{who}: command() raises {type(why).__name__}: {why}") from why
        if not isinstance(command, click.Command):
            raise PluginError(f"{who}: command() gives {type(command).__name__}, which is no click.Command")
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        registry = default_registry()
        entries = registry.of_kind("study")
        with formatter.section("Commands"):
            formatter.write_dl([(entry.name, entry.plugin.help) for entry in entries])
        for fault in registry.faults:
            formatter.write_text(f"not loaded: {fault}")


def _load(_context: click.Context, _option: click.Parameter, files: tuple[Path, ...]) -> None:
    registry_with(files)


@click.group(cls=Studies, short_help="Whole studies that end in a page, and others' studies.")
@click.option(
    "--plugin", multiple=True, type=click.Path(path_type=Path), metavar="FILE.py", is_eager=True, expose_value=False,
    callback=_load, help="A one-off plug-in file with a study; repeat for more.",
)  # fmt: skip
def study() -> None:
    """Whole studies: many runs, figures, and one HTML page that opens without a network; and studies of installed plug-ins.

    \b
    Example:
      raceway study article
    """
