"""``raceway view --mesh``: the meshes of a scene, their quality, files and picture."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar

import attrs
import numpy as np

from raceway import Answer, RacewayError, SceneError, door
from raceway.extend import (
    FACES, PATH, HexMesh, Part, Row, Tables, Words, blamed, boundary, grouped, number, of_results,
    registry_with, sections, slug, write_whole,
)  # fmt: skip
from raceway_view.pictures import INK, Plotter, look_from, rendered
from raceway_view.system_libraries import refuse_pictures
from types import ModuleType

if TYPE_CHECKING:
    from raceway import Scene
    from raceway.extend import Entry, Format, OnProgress

#: Inner ring, outer ring, everything else.
_COLOURS = {"inner": "#4f8fc0", "outer": "#c9a24d"}
_OTHER = "#b8bfc6"
#: What is cut away: azimuths [rad] from +y towards +z.
_CUT = (0.0, 0.5 * np.pi)
#: How to do without the picture, for messages.
_OTHERWISE = ", or leave out --picture"


def mesh_picture(meshes: Mapping[str, HexMesh], title: str) -> bytes:
    """PNG of all bodies with their edges, one colour a kind; RacewayError: pyvista is missing or cannot draw here."""

    def draw(pyvista: ModuleType, plotter: Plotter) -> None:
        outside: dict[int, np.ndarray] = {}  # balls share one array of cells
        for name, mesh in meshes.items():
            if name.startswith("ball"):
                if id(mesh.cells) not in outside:
                    outside[id(mesh.cells)] = _outside(mesh.cells)
                quads = outside[id(mesh.cells)]
            else:  # the outer faces of the cells that stay
                middle = mesh.points[mesh.cells].mean(axis=1)
                azimuth = np.arctan2(middle[:, 2], middle[:, 1])
                stays = (azimuth < _CUT[0]) | (azimuth > _CUT[1])
                quads = _outside(mesh.cells[stays]) if stays.any() else np.zeros((0, 4), dtype=np.int64)
            if len(quads):
                surface = pyvista.PolyData.from_regular_faces(mesh.points, quads)
                colour = next((value for word, value in _COLOURS.items() if name.startswith(word)), _OTHER)
                edges: Tables = {"show_edges": True, "edge_color": INK, "line_width": 0.6, "edge_opacity": 0.45}
                plotter.add_mesh(surface, color=colour, ambient=0.3, **edges)
        plotter.add_text(title, position="upper_edge", font_size=13, color=INK)
        plotter.enable_anti_aliasing("ssaa")
        # Seen from the side where the sector is missing, a little from the front.
        look_from(plotter, [(1.35, 1.0, 1.0), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)], 1.25)

    return rendered(draw, otherwise=_OTHERWISE)


def _outside(cells: np.ndarray) -> np.ndarray:
    """(k, 4) nodes of the outer faces of cells."""
    facets = boundary(cells)
    return np.asarray(cells[facets[:, :1], FACES[facets[:, 1]]])


@attrs.frozen(eq=False, repr=False, slots=False)
class _Meshes(Answer):
    """Meshes of the bodies of a scene."""

    stem: ClassVar[str] = "mesh"

    #: ``raceway_view.mesh_summary.summary`` with title, mesher, seconds, and the files that ``save`` wrote
    content: Tables
    meshes: dict[str, HexMesh]  # by name of the body
    form: Entry  # what writes them
    drawn: bool  # whether ``save`` also writes mesh.png

    def to_dict(self) -> Tables:
        return self.content

    @door
    def save(self, folder: Annotated[str | Path, PATH], pictures: bool | str = True) -> list[Path]:
        """Write a file for each ring, one for all balls, and the picture; RacewayError where that fails."""
        folder, files = Path(folder), self.content["files"]
        files.clear()
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise RacewayError(f"`{folder}` cannot be made: {error.strerror}. Choose another with --out.") from None
        for name, body in _together(self.meshes).items():
            with blamed(str(self.form), "write()"):
                writer: Format = self.form.plugin()
                path = folder / f"{slug(name)}{writer.suffixes[0]}"
                writer.write(path, body)
            files.append(str(path))
        if self.drawn:
            size = f"{self.content['elements']} hexahedra, {self.content['nodes']} nodes, {len(self.meshes)} bodies"
            picture = mesh_picture(self.meshes, f"{self.content['title']}\n{size}")
            files.append(str(write_whole(picture, folder / "mesh.png")))
        return [Path(file) for file in files]

    def _facts(self) -> tuple[str, list[Row]]:
        return self.content["title"], self._rows()

    def report(self) -> Iterator[Part]:
        """Numbers of all bodies, then a line a body."""
        yield Words(self.content["title"], "bold")
        yield sections(self._rows())

    def _rows(self) -> list[Row]:
        content = self.content
        count = len(content["bodies"])
        size, jacobian = content["element_size_m"], content["scaled_jacobian"]
        rows: list[Row] = [
            (f"Mesh by '{content['mesher']}'", "", ""),
            ("hexahedra", str(content["elements"]), "1 body" if count == 1 else f"{count} bodies"),
            ("nodes", str(content["nodes"]), f"{3 * content['nodes']} degrees of freedom"),
            (
                "element edges",
                f"{1e3 * size['mean']:.3g} mm",
                f"mean; {1e3 * size['min']:.3g} to {1e3 * size['max']:.3g} mm",
            ),
        ]
        for name, sizes in (content["patch_size_m"] or {}).items():
            low, high = (f"{1e3 * sizes[word]:.3g}" for word in ("min", "max"))
            rows.append((f"contact patch, {name}", f"{low} mm", f"to {high} mm, element edges"))
        rows += [
            ("scaled Jacobian", f"{jacobian['min']:.3g}", f"smallest; mean {jacobian['mean']:.3g}, 1 is a cube, 0 is flat"),
            ("aspect", f"{content['aspect']['max']:.3g}", f"largest; mean {content['aspect']['mean']:.3g}"),
            ("skew", f"{content['skew']['max']:.3g}", f"largest; mean {content['skew']['mean']:.3g}"),
            ("memory", f"{content['memory_bytes'] / 2**20:.1f} MiB", "points, cells and sets"),
            ("time", number(content["seconds"], "s", 3), "building the meshes; judging and writing them is apart"),
            ("Bodies", "", ""),
        ]
        bodies = {}
        for name, body in content["bodies"].items():
            words = f"hexahedra, {body['nodes']} nodes, scaled Jacobian {body['scaled_jacobian']['min']:.3g} and more"
            bodies[name] = str(body["elements"]), words
        for name, (cells, words) in grouped(bodies):
            rows.append((name, cells, f"each: {words}" if name.startswith("balls") else words))
        return rows


def mesh(
    scene: Scene, form: str = "vtu", picture: bool = False, *, plugins: Iterable[Path] = (), progress: OnProgress
) -> _Meshes:
    """Mesh the bodies of a scene; print counts, quality, memory and time; write one file per ring and one for all balls.

    A scene without a table [mesh] gets the mesher `structured` with its defaults.

    Parameters
    ----------
    scene : a scene
    form : file format: vtu, abaqus (inp), or a plug-in's
    picture : also draw the bearing, cut open, as mesh.png
    plugins : files of one-off plug-ins that the scene uses
    progress : called as ``progress(what, done, total)``

    Raises
    ------
    SceneError
        Meshes that need more memory than there is.
    RacewayError
        A format that only reads, or a package that is missing.
    """
    from raceway.extend import mesh_bodies, resolve
    from raceway_view.mesh_summary import summary

    registry = registry_with(plugins)
    # The format of a name, or of the ending of its files.
    formats = {entry.name: entry.plugin for entry in registry.of_kind("format")}
    names = [name for name, plugin in formats.items() if hasattr(plugin, "write") and not of_results(plugin)]
    of_ending = [name for name in names if f".{form}" in formats[name].suffixes]
    entry = registry.find("format", of_ending[0] if form not in names and len(of_ending) == 1 else form)
    if entry.name not in names:
        fault = "writes results" if of_results(entry.plugin) else "only reads"
        raise RacewayError(f"`--format {form}`: '{entry.name}' {fault}; files are written as {', '.join(names)}")
    if picture and find_spec("pyvista"):
        refuse_pictures(_OTHERWISE)
    progress("meshing", 0, 0)
    start = time.perf_counter()
    if scene.mesh is None:
        scene = attrs.evolve(scene, mesh=registry.find("mesher", "structured").plugin())
    try:
        meshes = mesh_bodies(resolve(scene))
    except MemoryError:
        raise SceneError.at("mesh", None, "needs more memory than available: choose larger elements") from None
    seconds = time.perf_counter() - start
    progress("judging the cells", 0, 0)
    content: Tables = {"title": scene.title, "mesher": scene.mesh.name, "seconds": seconds, **summary(meshes), "files": []}
    return _Meshes(content, meshes, entry, picture)


def _together(meshes: dict[str, HexMesh]) -> dict[str, HexMesh]:
    """Bodies by the name of their file: all balls are one mesh, in which each is a set of nodes of its own name."""
    from raceway.extend import merged

    balls = {name: body for name, body in meshes.items() if name.startswith("ball")}
    if len(balls) < 2:
        return meshes
    return {**{name: body for name, body in meshes.items() if name not in balls}, "balls": merged(balls)}
