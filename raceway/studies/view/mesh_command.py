"""The command about meshes.  Part of ``raceway.cli.main``."""

from __future__ import annotations

import time
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import attrs
import click

from raceway.cli.frame import (
    RESULTS,
    attempt,
    common,
    load,
    on_scene,
    out_folder,
    plugin_files,
    show,
    slug,
    tell_faults,
)
from raceway.errors import RacewayError, SceneError, extra
from raceway.framework.registry import registry_with
from raceway.framework.sources import blamed
from raceway.out.progress import ProgressBar
from raceway.plugins.system_libraries import refuse_pictures
from raceway.storage.files import writable
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from rich.console import RenderableType

    from raceway.framework.contracts import Format
    from raceway.framework.registry import Entry, Registry


@click.command(short_help="Mesh the bodies of a scene: counts, quality, files.")
@on_scene
@out_folder
@click.option(
    "--format",
    "form",
    default="vtu",
    show_default=True,
    metavar="NAME",
    help="Format of the files by its name or ending: vtu, abaqus or inp; plug-ins bring more.",
)
@click.option("--picture", is_flag=True, help="Also draw the bearing, cut open, as mesh.png; needs no display.")
@plugin_files
@common
def mesh(
    scene: Path,
    changes: tuple[str, ...],
    out: Path | None,
    form: str,
    picture: bool,
    plugins: tuple[Path, ...],
    as_json: bool,
) -> int:
    """Build the meshes of a scene; say their counts, quality, memory and time; write a file for each ring, one for all balls.

    A scene without a table [mesh] gets the mesher `structured` with its defaults.

    \b
    Example:
      raceway mesh examples/b7206_article_mesh.toml --picture
    """
    registry = registry_with(plugins)
    loaded = load(scene, changes, registry)
    folder = writable(out or RESULTS / slug(loaded.title))
    tell_faults(registry)
    written = _format(registry, form)
    if picture and find_spec("pyvista"):
        refuse_pictures(", or leave out --picture")
    with ProgressBar("meshing") as progress:
        from raceway.bodies.meshing import mesh_scene

        start = time.perf_counter()
        if loaded.mesh is None:
            loaded = attrs.evolve(loaded, mesh=registry.find("mesher", "structured").plugin())
        try:
            meshes = mesh_scene(loaded)
        except MemoryError:
            raise SceneError.at("mesh", None, "needs more memory than there is: choose larger elements") from None
        seconds = time.perf_counter() - start
        from raceway.core.mesh.summary import summary

        progress("judging the cells", 0, 0)
        content: Tables = {"title": loaded.title, "mesher": loaded.mesh.name, "seconds": seconds, **summary(meshes)}
        files: list[str] = []
        failed = attempt(lambda: _write(written, meshes, folder, progress), files)
        if picture and failed is None:
            progress("drawing", 0, 0)
            failed = attempt(lambda: [_draw(meshes, content, folder)], files)
    content["files"] = files

    def screen() -> RenderableType:
        from raceway.studies.view.mesh_screen import mesh_screen

        return mesh_screen(content)

    show(content, as_json, failed, screen)
    return 0


def _format(registry: Registry, word: str) -> Entry:
    """The format of a name, or of the ending of its files; refused where it needs a package that is missing."""
    names = [name for name in registry.names("format") if hasattr(registry.find("format", name).plugin, "write")]
    of_ending = [name for name in names if f".{word}" in registry.find("format", name).plugin.suffixes]
    found = registry.find("format", of_ending[0] if word not in names and len(of_ending) == 1 else word)
    if found.name not in names:
        raise RacewayError(f"`--format {word}`: '{found.name}' only reads; files are written as {', '.join(names)}")
    if found.plugin.__module__ == "raceway.plugins.formats" and find_spec("meshio") is None:
        raise RacewayError(f"files of meshes in the format '{found.name}' need the package meshio: {extra('mesh')}")
    return found


def _write(form: Entry, meshes: Tables, folder: Path, progress: ProgressBar) -> list[Path]:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise RacewayError(f"`{folder}` cannot be made: {error.strerror}. Choose another with --out.") from None
    paths = []
    parts = _together(meshes)
    for done, (name, body) in enumerate(parts.items()):
        progress(f"writing {name}", done, len(parts))
        with blamed(str(form), "write()"):
            writer: Format = form.plugin()
            path = folder / f"{slug(name)}{writer.suffixes[0]}"
            writer.write(path, body)
        paths.append(path)
    return paths


def _together(meshes: Tables) -> Tables:
    """Bodies by the name of their file: all balls are one mesh, in which each is a set of nodes of its own name."""
    from raceway.core.mesh.hex_mesh import merged

    balls = {name: body for name, body in meshes.items() if name.startswith("ball")}
    if len(balls) < 2:
        return meshes
    return {**{name: body for name, body in meshes.items() if name not in balls}, "balls": merged(balls)}


def _draw(meshes: Tables, content: Tables, folder: Path) -> Path:
    from raceway.studies.view.mesh_picture import draw

    size = f"{content['elements']} hexahedra, {content['nodes']} nodes, {len(meshes)} bodies"
    return draw(meshes, f"{content['title']}\n{size}", folder / "mesh.png")
