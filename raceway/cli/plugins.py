"""The commands about plug-ins.  Part of ``raceway.cli.main``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click
from rich.console import Group, RenderableType
from rich.markup import escape
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from raceway.answers.table import file_lines
from raceway.answers.wrapping import Words
from raceway.cli.console import print_json
from raceway.cli.frame import common, faults, plugin_files, show, show_progress
from raceway.errors import RacewayError
from raceway.framework.contracts import KINDS, plural
from raceway.framework.registry import default_registry, registry_with
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    pass


@click.command(short_help="List installed plug-ins and their options.")
@plugin_files
@common
def plugins(plugins: tuple[Path, ...], as_json: bool) -> int:
    """List every plug-in with its options; broken or shadowed ones are named (exit code 2).

    RACEWAY_DISABLE=NAME,... leaves plug-ins out; RACEWAY_PLUGINS=NAME,... loads exactly these.

    \b
    Example:
      raceway dev plugins --json
      raceway dev plugins --plugin my_law.py
    """
    from raceway.scene.schema import key_schema, keys

    registry, rows = registry_with(plugins), list[Tables]()
    for entry in registry.of_kind(*KINDS):
        options = [
            {"name": field.name, "default": key_schema(field).get("default")}
            | {word: field.metadata.get(word, "") for word in ("unit", "rule", "help")}
            for field in keys(entry.plugin)
        ]
        head = {word: getattr(entry, word) for word in ("kind", "name", "distribution", "version")}
        rows.append({**head, "options": options})
    errors = faults(registry)
    if as_json:
        print_json({"plugins": rows, "errors": [{"path": None, "value": None, "message": text} for text in errors]})
        return 2 if errors else 0
    parts: list[RenderableType] = []
    for kind in dict.fromkeys(row["kind"] for row in rows):
        parts.append(Text(plural(kind), style="bold"))
        for row in (r for r in rows if r["kind"] == kind):
            table = Table.grid(padding=(0, 2))
            table.add_column(min_width=20, no_wrap=True)
            table.add_column(min_width=12)
            table.add_column()
            for option in row["options"]:
                default = "" if option["default"] is None else str(option["default"])
                unit = f" [{option['unit']}]" if option["unit"] else ""
                table.add_row(escape(option["name"]), Words(default), Words(option["help"] + unit, "dim"))
            parts.append(Text.assemble("  ", (row["name"], "cyan"), f"  {row['distribution']} {row['version']}"))
            if row["options"]:
                parts.append(Padding(table, (0, 0, 0, 6)))
    show(rows, False, None, lambda: Group(*parts))
    if errors:
        raise RacewayError("\n  ".join(errors))
    return 0


@click.command(short_help="JSON schema of a scene.")
@common
def schema(as_json: bool) -> int:
    """Print the JSON schema (draft 2020-12) of a scene, for editors, with the options of every installed plug-in.

    \b
    Example:
      raceway dev schema > scene.schema.json
    """
    from raceway.scene.schema import scene_schema

    del as_json  # it is JSON either way
    print_json(scene_schema(default_registry()))
    return 0


@click.command("check-plugin", short_help="Test a plug-in against its contract.")
@click.argument("name", metavar="[KIND:]NAME")
@plugin_files
@common
def check_plugin(name: str, plugins: tuple[Path, ...], as_json: bool) -> int:
    """Run the conformance suite of a plug-in's kind: exit code 0 conforms, 1 does not, 2 unknown or ambiguous.

    \b
    Example:
      raceway dev check-plugin hertz
      raceway dev check-plugin contact_law:hunt_crossley
      raceway dev check-plugin my_law --plugin my_law.py
    """
    from raceway.testing import check_named

    with show_progress(waiting=f"checking {name}"):
        conformity = check_named(name, registry_with(plugins))
    table = Table.grid(padding=(0, 2))
    table.add_column(no_wrap=True)
    table.add_column(no_wrap=True)
    table.add_column()
    for row in conformity.rows:
        status = Text(row.status, style="green" if row.good else "bold red")
        table.add_row(escape(row.name), status, Words(f"{row.duty}: {row.message}" if row.message else row.duty, "dim"))
    good = sum(row.good for row in conformity.rows)
    verdict = "conforms" if conformity.conforms else "does not conform"
    title = f"{conformity.kind.replace('_', ' ')} '{conformity.name}' {verdict}: {good} of {len(conformity.rows)} checks"
    show(conformity.to_dict(), as_json, None, lambda: Group(Text(title, style="bold"), Padding(table, (0, 0, 0, 2))))
    return 0 if conformity.conforms else 1


_NEW_PLUGIN = f"""Write an installable package with a working plug-in of a KIND and its tests.

KIND: {", ".join(KINDS)}.

\b
Example:
  raceway dev new-plugin contact_law my_law
"""


@click.command("new-plugin", short_help="Write a package for a new plug-in.", help=_NEW_PLUGIN)
@click.argument("kind")
@click.argument("name")
@click.option("--out", type=click.Path(path_type=Path), default=Path("."), metavar="DIR", help="Parent folder [here].")
@common
def new_plugin(kind: str, name: str, out: Path, as_json: bool) -> int:
    from raceway.testing.scaffold import new_plugin as write

    folder = write(kind, name, out, default_registry())
    files = sorted(str(path) for path in folder.rglob("*") if path.is_file())
    steps = Text(f"next: pip install -e {folder} && python -m pytest {folder}", no_wrap=True, overflow="ignore")
    show({"folder": str(folder), "files": files}, as_json, None, lambda: Group(*file_lines([str(folder), *files]), steps))
    return 0
