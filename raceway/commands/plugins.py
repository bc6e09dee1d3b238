"""The commands about plug-ins.  Part of ``raceway.cli``."""

from __future__ import annotations

from pathlib import Path

import click

from raceway.commands.console import print_json
from raceway.commands.frame import common, plugin_files, show, show_progress
from raceway.commands.inputs import faults
from raceway.errors import RacewayError
from raceway.framework.registry import default_registry, registry_with


@click.command(short_help="List what is installed, with options.")
@plugin_files
@common
def plugins(plugins: tuple[Path, ...], as_json: bool) -> int:
    """List every plug-in with its options; broken or shadowed ones are named (exit code 2).

    RACEWAY_DISABLE=NAME,... leaves plug-ins out; RACEWAY_PLUGINS=NAME,... loads exactly these.

    \b
    Example:
      raceway plugins --json
      raceway plugins --plugin my_law.py
    """
    from raceway.commands import plugin_screen

    registry = registry_with(plugins)
    rows = plugin_screen.plugin_rows(registry.all())
    broken = faults(registry)
    if as_json:
        print_json({"plugins": rows, "errors": [{"path": None, "value": None, "message": text} for text in broken]})
        return 2 if broken else 0
    show(rows, False, None, lambda: plugin_screen.plugins_screen(rows))
    if broken:
        raise RacewayError("\n  ".join(broken))
    return 0


@click.command(short_help="JSON schema of a scene.")
@common
def schema(as_json: bool) -> int:
    """Print the JSON schema (draft 2020-12) of a scene, for editors, with the options of every installed plug-in.

    \b
    Example:
      raceway schema > scene.schema.json
    """
    from raceway.scene.schema import scene_schema

    del as_json  # it is JSON either way
    print_json(scene_schema(default_registry()))
    return 0


@click.command("check-plugin", short_help="Does a plug-in keep its contract?")
@click.argument("name", metavar="[KIND:]NAME")
@plugin_files
@common
def check_plugin(name: str, plugins: tuple[Path, ...], as_json: bool) -> int:
    """Run the conformance suite of a plug-in's kind: exit code 0 conforms, 1 does not, 2 unknown or ambiguous.

    \b
    Example:
      raceway check-plugin hertz
      raceway check-plugin contact_law:hunt_crossley
      raceway check-plugin my_law --plugin my_law.py
    """
    from raceway.commands import plugin_screen
    from raceway.testing import check_named

    with show_progress(waiting=f"checking {name}"):
        conformity = check_named(name, registry_with(plugins))
    show(conformity.to_dict(), as_json, None, lambda: plugin_screen.conformity_screen(conformity))
    return 0 if conformity.conforms else 1


@click.command("new-plugin", short_help="Write a package for a new plug-in.")
@click.argument("kind")
@click.argument("name")
@click.option("--out", type=click.Path(path_type=Path), default=Path("."), metavar="DIR", help="Where to put it [here].")
@common
def new_plugin(kind: str, name: str, out: Path, as_json: bool) -> int:
    """Write an installable package with a plug-in of a KIND that runs and passes its own tests at once.

    KIND: contact_law, excitation, integrator, identifier, mesher, format, report, executor or study.

    \b
    Example:
      raceway new-plugin contact_law my_law
    """
    from raceway.commands import plugin_screen
    from raceway.testing.scaffold import new_plugin as write

    folder = write(kind, name, out, default_registry())
    files = sorted(str(path) for path in folder.rglob("*") if path.is_file())
    show({"folder": str(folder), "files": files}, as_json, None, lambda: plugin_screen.new_plugin_screen(folder, files))
    return 0
