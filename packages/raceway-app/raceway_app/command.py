"""``raceway app``: a page of a scene.  Part of ``raceway.cli.main``."""

from __future__ import annotations

import webbrowser
from pathlib import Path

import click

from raceway.extend import FILE, as_scene, common, plugin_files, print_json, registry_with, set_keys


@click.command("app", short_help="A page to look at a scene and change it, on this machine.")
@click.argument("scene", type=FILE, required=False)
@set_keys
@click.option("--out", type=FILE, metavar="DIR", help="Folder in which the page writes, and nowhere else [raceway-out/app].")
@click.option("--port", type=click.IntRange(0, 65535), default=0, metavar="N", help="On 127.0.0.1 [any that is free].")
@click.option("--browser/--no-browser", default=True, help="Open the page (default).")
@plugin_files
@common
def app(
    scene: Path | None,
    changes: tuple[str, ...],
    out: Path | None,
    port: int,
    browser: bool,
    plugins: tuple[Path, ...],
    as_json: bool,
) -> int:
    """A scene as a form beside its bearing, ball loads, K, C and life over speed and load; each change is computed at once.

    Without SCENE the two excitation models of an example stand side by side.  The page is served to this machine alone, at an address
    with a token, until Ctrl-C; it writes into one folder only.

    \b
    Example:
      raceway app examples/b7206.toml
      raceway app examples/duplex_db.toml --out spindle --no-browser
    """
    from raceway_app.server import app as serve

    registry_with(plugins)
    opened = as_scene(scene, *changes) if scene is not None and changes else scene

    def ready(address: str) -> None:
        if as_json:
            print_json({"address": address})
        else:
            click.echo(f"{address}\n  the page; Ctrl-C here ends it")
        if browser:
            webbrowser.open(address)

    serve(opened, out=out, port=port, ready=ready, plugins=plugins)
    return 0
