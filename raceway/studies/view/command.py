"""The command that draws a bearing.  Part of ``raceway.cli``."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import click

from raceway.commands.frame import (
    RESULTS,
    common,
    on_scene,
    out_folder,
    plugin_files,
    record,
    show,
    show_progress,
)
from raceway.commands.inputs import load, slug, tell_faults
from raceway.errors import RacewayError, SceneError, extra
from raceway.framework.duties import traits_of
from raceway.framework.registry import registry_with
from raceway.plugins.system_libraries import refuse_pictures
from raceway.storage.files import writable
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from rich.console import RenderableType

    from raceway.scene.tables import Scene


class ViewOptions(NamedTuple):
    """What ``raceway view`` is given."""

    scene: Path
    changes: tuple[str, ...]
    out: Path | None
    page: bool
    animate: bool
    frames: int
    plugins: tuple[Path, ...]
    as_json: bool


@click.command(short_help="Draw a bearing: loads, contacts, mesh, orbit; pictures and a page.")
@on_scene
@out_folder
@click.option("--html", "page", is_flag=True, help="Also write view.html: the bearing to turn about, tables, all pictures.")
@click.option(
    "--animate", is_flag=True, help="Also write orbit.gif: one turn, motions exaggerated by a factor that it says."
)
@click.option(
    "--frames", type=click.IntRange(2, 720), default=36, show_default=True, help="Pictures of a turn, for --animate."
)
@plugin_files
@common
@record(ViewOptions)
def view(given: ViewOptions) -> int:
    """Compute one scene and draw it: the bearing cut open with its ball loads, contact ellipses with their pressure, ball
    loads by azimuth, the orbit, the mesh of elastic bodies. Needs no display.

    \b
    Example:
      raceway view examples/b7206.toml --html --animate
    """
    registry = registry_with(given.plugins)
    loaded = load(given.scene, given.changes, registry)
    folder = writable(given.out or RESULTS / slug(loaded.title))
    for package in ("pyvista", "matplotlib"):
        if find_spec(package) is None:
            raise RacewayError(f"pictures need {package}: {extra('view')}")
    refuse_pictures()
    if given.animate and loaded.excitation is None:
        raise SceneError.at("excitation", None, "is missing, so that nothing moves: add the table, or leave out --animate")
    tell_faults(registry)
    with show_progress() as progress:
        from raceway.pipeline.run import run
        from raceway.studies.view.study import Wanted, draw

        result = run(loaded, registry, progress)
        mesh = _mesh(loaded, folder) if traits_of(loaded).every_node else None
        content = draw(result, folder, Wanted(given.page, given.frames if given.animate else 0, mesh), progress)
    show(content, given.as_json, None, lambda: _screen(content))
    return 0


def _mesh(scene: Scene, folder: Path) -> Path:
    from raceway.bodies.meshing import mesh_scene
    from raceway.studies.view.mesh_picture import draw

    return draw(mesh_scene(scene), f"{scene.title}\nthe mesh", folder / "mesh.png")


def _screen(content: Tables) -> RenderableType:
    from rich.console import Group
    from rich.text import Text

    from raceway.commands.screen.text import sections, written

    rows = [
        (f"Pictures {content['shown']}", "", ""),
        ("largest ball load", f"{content['largest_ball_load_n']:.4g} N", "on the inner race"),
        ("largest pressure", f"{1e-6 * content['largest_pressure_pa']:.4g} MPa", "Hertz"),
    ]
    if content["exaggeration"] is not None:
        rows.append(("motions in orbit.gif", f"x {content['exaggeration']:g}", "times as large as they are"))
    if content["assumed"]:
        rows.append(("rings drawn with usual", "", f"{', '.join(content['assumed'])}: the scene does not say"))
    notes = [Text(f"note: {text}", style="yellow") for text in content["warnings"]]
    return Group(Text(content["title"], style="bold"), sections(rows), *notes, *written(content["files"]))
