"""docs/command_line.md: what every command says of itself, with completion and what all commands share."""

from __future__ import annotations

import os
from collections.abc import Iterator

import click
from click.testing import CliRunner

from raceway.cli.main import main

_HEAD = """# Command line

Made by `python -m benchmarks.documents` from the commands themselves; do not edit by hand.

## What all commands share

- `--set table.key=value` changes one key of the scene for one command; repeat it for more. Numbers may carry a unit, and are in the
  key's own without one.
- `--json` prints one JSON object and nothing else, errors too, for other programs.
- Results go to `raceway-out/TITLE`, or to the folder that `--out` names.
- A command that takes more than a second shows its progress on a terminal, on stderr, and nowhere else.
- Exit codes: 0 success, 1 a numerical failure, 2 a mistake in the scene or on the command line; 130 Ctrl-C, 143 SIGTERM,
  129 SIGHUP.

## Completion

The shell completes commands, options, keys of a scene after `--set` and their values after one line in its start file:

| shell | line | file |
|---|---|---|
| bash 4.4 or later | `COMP_WORDBREAKS=${COMP_WORDBREAKS//=/}; eval "$(_RACEWAY_COMPLETE=bash_source raceway)"` | `~/.bashrc` |
| zsh | `eval "$(_RACEWAY_COMPLETE=zsh_source raceway)"` | `~/.zshrc` |
| fish | `_RACEWAY_COMPLETE=fish_source raceway \\| source` | `~/.config/fish/completions/raceway.fish` |
"""


def page() -> str:
    """The text of docs/command_line.md."""
    commands = list(walk(main, "raceway"))
    table = ["## Commands", "", "| command | does |", "|---|---|"]
    table += [f"| [`{name}`](#{name.replace(' ', '-')}) | {command.get_short_help_str(200)} |" for name, command in commands]
    return "\n".join([_HEAD, *table, "", *(section(name) for name, _ in commands)])


def walk(group: click.Group, path: str) -> Iterator[tuple[str, click.Command]]:
    """Every command with its name as typed, groups before what is in them."""
    context = click.Context(group)
    for name in sorted(group.list_commands(context)):
        command = group.get_command(context, name)
        assert command is not None
        yield f"{path} {name}", command
        if isinstance(command, click.Group):
            yield from walk(command, f"{path} {name}")


def section(name: str) -> str:
    """One command: its help, 80 columns wide."""
    told = CliRunner().invoke(main, [*name.split()[1:], "--help"], prog_name="raceway", terminal_width=80).output
    # The default of workers is the number of cores of the machine that writes the page.
    return f"### {name}\n\n```text\n{told.replace(f'[{os.cpu_count()}]', '[cores]').rstrip()}\n```\n"
