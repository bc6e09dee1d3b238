"""The pictures of a bearing, for Python and the command line alike: ``raceway.view``."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from raceway.bodies.meshing import mesh_scene
from raceway.errors import RacewayError, extra
from raceway.framework.doors import door
from raceway.framework.duties import traits_of
from raceway.framework.registry import registry_with
from raceway.out.progress import ShowProgress, telling
from raceway.pipeline.result import Result
from raceway.pipeline.run import run
from raceway.plugins.system_libraries import refuse_pictures
from raceway.scene.given import as_scene
from raceway.storage.files import writable
from raceway.studies.view.mesh_picture import draw as draw_mesh
from raceway.studies.view.study import draw
from raceway.studies.view.view import View


@door
def view(
    scene: Any,
    out: str | Path | None = None,
    *,
    page: bool = False,
    plugins: Iterable[str | Path] = (),
    progress: ShowProgress = None,
) -> View:
    """Draw a bearing: cut open with its ball loads, contact ellipses, ball loads by azimuth, the orbit, the mesh.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict of tables, which is run first; or the Result of a run
    out : folder of the pictures; None: they are kept in memory
    page : also view.html, the bearing to turn about with all pictures, which opens without a network
    plugins : files of one-off plug-ins that the scene uses
    progress : True for a bar on a terminal, or called as ``progress(what, done, total)``

    Returns
    -------
    View
        ``pictures`` by name, the ``files`` where a folder is given; a notebook shows the bearing

    Raises
    ------
    SceneError
        A mistake in the scene.
    RacewayError
        pyvista or matplotlib is missing, or a system library of theirs; a folder that cannot be written.

    Examples
    --------
    >>> import raceway as rw
    >>> found = rw.view({"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}})
    >>> sorted(found.pictures)
    ['ball-loads.png', 'bearing.png', 'contacts.png']
    """
    given = scene if isinstance(scene, Result) else as_scene(scene, plugins=plugins)
    read = given.model.scene if isinstance(given, Result) else given
    folder = None if out is None else writable(Path(out))
    for package in ("pyvista", "matplotlib"):
        if find_spec(package) is None:
            raise RacewayError(f"pictures need {package}: {extra('view')}")
    refuse_pictures()
    with tempfile.TemporaryDirectory(prefix="raceway-view-") as temporary, telling(progress) as told:
        result = given if isinstance(given, Result) else run(given, registry_with(plugins), told)
        place = Path(temporary) if folder is None else folder
        mesh = None
        if traits_of(read).every_node:
            mesh = draw_mesh(mesh_scene(read), f"{read.title}\nthe mesh", place / "mesh.png")
        content = draw(result, place, page, mesh, told)
        pictures = {Path(name).name: Path(name).read_bytes() for name in content["files"]}
        return View(content if folder is not None else {**content, "files": []}, pictures)
