"""docs/command_line.md: what every command says of itself, with completion and what all commands share."""

import os
import re
from collections.abc import Iterator

import click
from click.testing import CliRunner

from raceway.cli.main import main

_HEAD = """# Command line

Made by `python -m checks.documents` from the commands.

## What all commands share

| option | |
|---|---|
| `--set table.key=value` | change a key of the scene, with or without unit; repeat for more |
| `--plugin FILE.py` | a one-off plug-in file; repeat for more |
| `--out DIR` | folder of the results; default: `raceway-out/TITLE`, with the name of the command after TITLE where it is not `run` or `view` |
| `--pictures`, `--no-pictures` | draw pictures as PNG, 300 dpi (studies: by default) |
| `--picture-format svg`, `pdf` | draw them as this, too |
| `--json` | print one JSON object only, errors too |
| `-v`, `--verbose` | report on stderr what is computed |
| `--debug` | show tracebacks |
| `-h`, `--help` | show the help |

- After a second a terminal shows progress on stderr.
- Exit codes: 0 success, 1 numerical failure, 2 a mistake in the scene or on the command line; 130 Ctrl-C, 143 SIGTERM, 129 SIGHUP.

## Completion

With one line in its start file the shell completes commands, options, keys of a scene after `--set` and their values:

| shell | line | file |
|---|---|---|
| bash 4.4 or later | `COMP_WORDBREAKS=${COMP_WORDBREAKS//=/}; eval "$(_RACEWAY_COMPLETE=bash_source raceway)"` | `~/.bashrc` |
| zsh | `eval "$(_RACEWAY_COMPLETE=zsh_source raceway)"` | `~/.zshrc` |
| fish | `_RACEWAY_COMPLETE=fish_source raceway \\| source` | `~/.config/fish/completions/raceway.fish` |
"""


def page() -> str:
    """The text of docs/command_line.md."""
    return "\n".join([_HEAD, "## Commands\n", *(section(name) for name, _ in walk(main, "raceway"))])


def walk(group: click.Group, path: str) -> Iterator[tuple[str, click.Command]]:
    """Every command with its name as typed, groups before what is in them."""
    context = click.Context(group)
    for name in sorted(group.list_commands(context)):
        command = group.get_command(context, name)
        assert command is not None
        yield f"{path} {name}", command
        if isinstance(command, click.Group):
            yield from walk(command, f"{path} {name}")


#: Options that all commands share, and the lines of a help that they take.
_SHARED = re.compile(
    r"^  (?:-\w, )?--(?:set A|plugin|pictures|picture-format|out DIR +Folder .raceway|json|verbose|debug|help)\b.*\n(?: {5,}.*\n)*",
    re.MULTILINE,
)


def section(name: str) -> str:
    """One command: its usage as heading and its help, 80 columns wide, without what all commands share."""
    text = CliRunner().invoke(main, [*name.split()[1:], "--help"], prog_name="raceway", terminal_width=80).output
    # The default of workers is the number of cores of the machine that writes the page.
    text = (
        _SHARED.sub("", text.replace(f"[{os.cpu_count()}]", "[cores]"))
        .removesuffix("Options:\n")
        .partition("\nCommands:")[0]
    )
    usage, _, text = text.partition("\n\n")
    heading = " ".join(usage.removeprefix("Usage: ").replace("[OPTIONS]", "").split())
    return f"### `{heading}`\n\n```text\n{text.rstrip()}\n```\n"
