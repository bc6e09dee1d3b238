"""``raceway catalogue``.  Part of ``raceway.cli.main``."""

from __future__ import annotations

from pathlib import Path

import click

from raceway.cli.frame import PATH, attempt, common, show
from raceway.storage.tables import Tables


@click.command(short_help="List, search and draw the bearings of the catalogue.")
@click.argument("pattern", default="*")
@click.option("--picture", type=PATH, metavar="FILE.png", help="Draw the section of the one bearing found, in proportion.")
@click.option("--materials", is_flag=True, help="List the materials of rings and balls instead.")
@common
def catalogue(pattern: str, picture: Path | None, materials: bool, as_json: bool) -> int:
    """List bearings whose name matches PATTERN; of a single one, all numbers with source and scatter, and its frequencies.

    \b
    Example:
      raceway catalogue "70*C"
      raceway catalogue 7014C --picture 7014C.png
    """
    from raceway.studies.catalogue.front import catalogue as search
    from raceway.studies.catalogue.screen import entry_screen, list_screen, materials_screen

    if materials:
        from raceway.studies.catalogue.entry import material_rows

        rows = material_rows()
        show({"materials": rows}, as_json, None, lambda: materials_screen(rows))
        return 0
    from raceway.studies.catalogue.entry import entry, line, scene_of

    found = search(pattern)
    if len(found) > 1:
        if picture is not None:
            raise click.UsageError(f"--picture draws one bearing, '{pattern}' finds {len(found)}")
        lines = [line(one) for one in found]
        show({"bearings": lines}, as_json, None, lambda: list_screen(lines))
        return 0
    content: Tables = entry(found[0])
    files: list[str] = []
    failed = None
    if picture is not None:
        from raceway.cli.frame import require_matplotlib
        from raceway.studies.catalogue.drawing import draw_section

        require_matplotlib("leave out --picture")
        if picture.suffix.lower() != ".png":
            raise click.UsageError(f"--picture {picture}: the file must end in .png")
        failed = attempt(lambda: [draw_section(found[0].name, scene_of(found[0]).bearing, picture)], files)
    show({**content, "files": files}, as_json, failed, lambda: entry_screen(content, files))
    return 0
