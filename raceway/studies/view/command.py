"""The command that draws a bearing.  Part of ``raceway.cli.main``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import click

from raceway.cli.frame import (
    RESULTS,
    common,
    load,
    on_scene,
    out_folder,
    plugin_files,
    record,
    show,
    show_progress,
    slug,
    tell_faults,
)
from raceway.framework.registry import registry_with
from raceway.framework.shown import largest_facts
from raceway.storage.files import writable
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from rich.console import RenderableType


class ViewOptions(NamedTuple):
    """What ``raceway view`` is given."""

    scene: Path
    changes: tuple[str, ...]
    out: Path | None
    page: bool
    plugins: tuple[Path, ...]
    as_json: bool


@click.command(short_help="Draw a bearing: loads, contacts, mesh, orbit; pictures and a page.")
@on_scene
@out_folder
@click.option("--html", "page", is_flag=True, help="Also write view.html: the bearing to turn about, tables, all pictures.")
@plugin_files
@common
@record(ViewOptions)
def view(given: ViewOptions) -> int:
    """Compute one scene and draw it: the bearing cut open with its ball loads, contact ellipses with their pressure, ball
    loads by azimuth, the orbit, the mesh of elastic bodies. Needs no display.

    \b
    Example:
      raceway view examples/b7206.toml --html
    """
    registry = registry_with(given.plugins)
    loaded = load(given.scene, given.changes, registry)
    folder = writable(given.out or RESULTS / slug(loaded.title))
    tell_faults(registry)
    with show_progress() as progress:
        from raceway.studies.view.view import view as study

        found = study(loaded, folder, page=given.page, progress=progress)
    content = found.to_dict()
    show(content, given.as_json, None, lambda: _screen(content))
    return 0


def _screen(content: Tables) -> RenderableType:
    from rich.console import Group
    from rich.text import Text

    from raceway.out.table import sections, written

    rows = [(f"Pictures {content['shown']}", "", ""), *largest_facts(content, content["shown"])]
    if content["assumed"]:
        rows.append(("rings drawn with usual", "", f"{', '.join(content['assumed'])}: the scene does not say"))
    notes = [Text(f"note: {text}", style="yellow") for text in content["warnings"]]
    return Group(Text(content["title"], style="bold"), sections(rows), *notes, *written(content["files"]))
