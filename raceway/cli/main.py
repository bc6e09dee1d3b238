"""The commands.  This module, with ``console``, is the only place that prints or exits.

Whatever is heavy is imported inside the command that needs it: ``--help`` loads no command, ``check``, ``plan``, ``plugins``,
``schema`` and ``cache`` load no numba, scipy or matplotlib.
"""

import os
from pathlib import Path
from typing import ClassVar

import click

from raceway import __version__
from raceway.cli.command import Command
from raceway.cli.commands import DEVELOPERS, SECTIONS, Later, listed_commands
from raceway.cli.console import Commands
from raceway.framework.loading import missing_package, named


class _CommandsByName(Commands):
    """Commands of a table and of packages; only the one that is asked for is imported, none for ``--help``."""

    sections: ClassVar[dict[str, tuple[Command | Later, ...]]]

    def heading(self, word: str) -> str:
        """Of this group's help, under which a package's commands stand, by its word for them; "" where another group has them."""
        return "" if word == "dev" else word

    def _sections(self) -> dict[str, tuple[Command | Later, ...]]:
        from raceway.framework.loading.registry import default_registry

        sections = dict(self.sections)
        for word, commands in default_registry().mapping("raceway_commands").items():
            if heading := self.heading(word):
                sections[heading] = (*sections.get(heading, ()), *sorted(commands, key=lambda about: about.name))
        return sections

    def _table(self) -> dict[str, Command | Later]:
        return {about.name: about for commands in self._sections().values() for about in commands}

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(self._table())

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        # Matrices of some hundred rows: threads of the linear algebra only wait for each other, and halve the speed of a run
        # on busy cores.  Read when numpy is imported, which is later than this.
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
        about = next((about for about in self._table().values() if cmd_name in (about.name, *about.aliases)), None)
        name = cmd_name if about is None else about.name
        if isinstance(about, Command):
            about = about._replace(example=about.example.replace(f"raceway {name} ", f"raceway {cmd_name} "))
        return None if about is None else about.click()

    def resolve_command(self, ctx: click.Context, args: list[str]) -> tuple[str | None, click.Command | None, list[str]]:
        """Some commands are another one with a flag: ``catalogue --infer``."""
        table = self._table()
        for arg in args[1:]:
            if f"{args[0]} {arg}" not in table and (missing := missing_package(f"{args[0]} {arg}", "commands")):
                raise click.UsageError(f"`raceway {args[0]} {arg}` is {missing}", ctx)
        for name in table:
            word, _, flag = name.partition(" ")
            if flag and args[0] == word and flag in args:
                return super().resolve_command(ctx, [name, *(arg for arg in args[1:] if arg != flag)])
        return super().resolve_command(ctx, args)

    def elsewhere(self, word: str) -> str:
        return missing_package(word, "commands")

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        lines = {heading: [(about.name, about.summary) for about in own] for heading, own in self.sections.items()}
        for word, name, summary in sorted(listed_commands()):  # of packages, as these list them: none is imported
            if heading := self.heading(word):
                lines.setdefault(heading, []).append((name, summary))
        for heading, commands in lines.items():
            with formatter.section(heading):
                formatter.write_dl(commands)


class _AllCommands(_CommandsByName):
    """``raceway``."""

    sections: ClassVar[dict[str, tuple[Command | Later, ...]]] = SECTIONS

    def elsewhere(self, word: str) -> str:
        commands = [about for about in self._table().values() if isinstance(about, Command)]
        flags = {o.flag: f"{about.name} --{o.flag}" for about in commands for o in about.options.values() if o and o.flag}
        parts = {name.partition(" --")[2]: name for name in self._table() if " " in name}
        full_name = (flags | parts | {name: f"dev {name}" for name in dev.list_commands(click.Context(dev))}).get(word)
        return f"it is `raceway {full_name}`" if full_name else super().elsewhere(word)


class _DeveloperCommands(_CommandsByName):
    """``raceway dev``."""

    sections: ClassVar[dict[str, tuple[Command | Later, ...]]] = {"Commands": DEVELOPERS}

    def heading(self, word: str) -> str:
        return "Commands" if word == "dev" else ""


@click.group(cls=_DeveloperCommands, short_help="Plug-ins: templates, conformance, laws, schema, caches.")
def dev() -> None:
    """Tools for plug-in authors: templates, conformance tests, contact laws, caches, schema.

    \b
    Example:
      raceway dev new-plugin contact_law my_law
    """


class Studies(Commands):
    """Studies that are plug-ins, by name; a study's own modules are loaded when it is asked for."""

    def elsewhere(self, word: str) -> str:
        return missing_package(f"study:{word}", "plugins")

    def list_commands(self, ctx: click.Context) -> list[str]:
        from raceway.framework.loading.registry import default_registry

        return default_registry().names("study")

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in self.list_commands(ctx):
            return None
        from raceway.errors import PluginError
        from raceway.framework.loading.registry import default_registry
        from raceway.framework.loading.sources import blamed

        entry = default_registry().find("study", cmd_name)
        who = f"study '{cmd_name}' of {entry.distribution}"
        with blamed(who, "command()"):
            command = entry.plugin().command()
        if not isinstance(command, click.Command):
            raise PluginError(f"{who}: command() gives {type(command).__name__}, which is no click.Command")
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        from raceway.framework.loading.registry import default_registry

        registry = default_registry()
        entries = registry.of_kind("study")
        with formatter.section("Commands"):
            formatter.write_dl([(entry.name, entry.plugin.help) for entry in entries])
        for fault in registry.faults:
            formatter.write_text(f"not loaded: {fault}")


@click.group(cls=Studies, short_help="Whole studies that end in a page, and others' studies.")
@click.option(
    "--plugin", multiple=True, type=click.Path(path_type=Path), metavar="FILE.py", is_eager=True, expose_value=False,
    callback=lambda _context, _option, files: named("raceway.framework.loading.registry:registry_with")(files),
    help="A one-off plug-in file with a study; repeat for more.",
)  # fmt: skip
def study() -> None:
    """Whole studies: many runs, figures, and one HTML page that opens without a network; and studies of installed plug-ins.

    \b
    Example:
      raceway study article
    """


@click.group(cls=_AllCommands, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(__version__, prog_name="raceway")
@click.option("--debug", is_flag=True, expose_value=False, help="Show tracebacks.")
def main() -> None:
    """Dynamic stiffness of rolling bearings under axial load and rotor unbalance, with error and cost.

    Input is a scene: a TOML file of some ten lines in SI units.

    \b
      raceway plan examples/b7206.toml      validate; predict size, time, memory
      raceway run examples/b7206.toml       compute K and C with their errors
      raceway run examples/b7206.toml --set load.axial=400 --pictures

    Exit codes: 0 success, 1 numerical failure, 2 mistake in the scene or on the command line, 130 Ctrl-C, 143 SIGTERM,
    129 SIGHUP.
    """
