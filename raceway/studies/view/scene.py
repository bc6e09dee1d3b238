"""The bearing as a picture, drawn by pyvista without a display."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from raceway.errors import RacewayError, extra
from raceway.plugins.system_libraries import refuse_pictures
from raceway.storage.tables import Tables
from raceway.studies.view.bearing import Bearing, Part, State
from raceway.studies.view.labels import LETTERS, ball_labels

if TYPE_CHECKING:
    from types import ModuleType

T = TypeVar("T")
LOADS, PRESSURES = "viridis", "inferno"
_INK = "#20262c"
_BAR: Tables = {
    "color": _INK,
    "title_font_size": 28,
    "label_font_size": 26,
    "n_labels": 5,
    "fmt": "%.0f",
    "vertical": True,
}


def pyvista_of(otherwise: str) -> ModuleType:
    """The package.

    Raises
    ------
    RacewayError
        It or its system libraries are missing; names what installs them.
    """
    try:
        import pyvista
    except ImportError:
        raise RacewayError(f"this picture needs pyvista: {extra('view')}{otherwise}") from None
    refuse_pictures(otherwise)
    return pyvista


def quietly(pyvista: ModuleType, draw: Callable[..., T], *given: object) -> T:
    """Draw; without a display VTK says so on standard error, and then draws in memory as it was asked to.

    Raises
    ------
    RacewayError
        VTK cannot draw here.
    """
    try:
        with pyvista.vtk_verbosity("off"):
            return draw(*given)
    except (RuntimeError, OSError) as error:
        raise RacewayError(f"the picture cannot be drawn: {error}") from None


def new_plotter(pyvista: ModuleType, size: tuple[int, int]) -> Any:
    plotter = pyvista.Plotter(off_screen=True, window_size=list(size))
    plotter.background_color = "white"
    return plotter


def add_parts(pyvista: ModuleType, plotter: Any, parts: Sequence[Part], top_load: float, top_pressure: float) -> None:
    """Put parts into a scene; colours of loads and pressures reach from 0 to the given ends [N, MPa]."""
    for part in parts:
        mesh = pyvista.PolyData.from_regular_faces(part.surface.points, part.surface.triangles)
        mesh.point_data["Normals"] = part.surface.normals
        mesh.point_data.active_normals_name = "Normals"
        # Loads are equal all over a part: as a field, so that all parts share one colour bar.
        look: Tables = {
            "smooth_shading": True,
            "split_sharp_edges": False,
            "opacity": part.opacity,
            "show_scalar_bar": False,
        }
        if part.colour is not None:
            ambient = 0.65 if "cut face" in part.name else 0.25
            plotter.add_mesh(mesh, color=part.colour, ambient=ambient, diffuse=1.0 - ambient, specular=0.1, **look)
        elif part.scale == "pressure":
            mesh.point_data["pressure"] = part.surface.values
            plotter.add_mesh(mesh, scalars="pressure", cmap=PRESSURES, clim=(0.0, top_pressure), lighting=False, **look)
        else:
            mesh.point_data["load"] = np.full(len(part.surface.points), part.load)
            plotter.add_mesh(mesh, scalars="load", cmap=LOADS, clim=(0.0, top_load), ambient=0.3, **look)


def screen_points(plotter: Any) -> Callable[[np.ndarray], np.ndarray]:
    """Where points (n, 3) [mm] of the scene are seen: (n, 2) pixels from the lower left corner."""
    width, height = plotter.window_size
    matrix = plotter.camera.GetCompositeProjectionTransformMatrix(width / height, -1.0, 1.0)
    project = np.array([[matrix.GetElement(i, j) for j in range(4)] for i in range(4)])

    def seen(points: np.ndarray) -> np.ndarray:
        at = np.column_stack([points, np.ones(len(points))]) @ project.T
        return np.asarray(0.5 * (at[:, :2] / at[:, 3:] + 1.0) * [width, height])

    return seen


def colour_bar(pyvista: ModuleType, plotter: Any, title: str, colours: str, top: float, place: tuple[float, float]) -> None:
    """A colour bar of its own, from 0 to ``top``."""
    table = pyvista.LookupTable(colours, scalar_range=(0.0, top))
    hidden = pyvista.PolyData(np.zeros((1, 3)))
    hidden.point_data["bar"] = np.zeros(1)
    actor = plotter.add_mesh(hidden, scalars="bar", cmap=table, show_scalar_bar=False, opacity=0.0, reset_camera=False)
    small = plotter.window_size[0] / 1600.0  # letters are given in pixels
    sizes = {name: max(int(_BAR[name] * small), 12) for name in ("title_font_size", "label_font_size")}
    bar = {**_BAR, **sizes, "position_x": place[0], "position_y": place[1], "height": 0.34, "width": 0.05}
    plotter.add_scalar_bar(title=title, mapper=actor.mapper, **bar)


def overview(bearing: Bearing, state: State, heading: str, size: tuple[int, int] = (1600, 1200)) -> np.ndarray:
    """The bearing cut open, seen from the gap: (rows, columns, 3) bytes."""
    pyvista = pyvista_of("")
    z = len(state.azimuth)
    top = max(float(state.load[:z].max()), 1e-12)

    def draw() -> np.ndarray:
        plotter = new_plotter(pyvista, size)
        patches = bearing.patches(state)
        peak = max((float(part.surface.values.max()) for part in patches if part.surface.values is not None), default=1.0)
        parts = [*bearing.rings(), *bearing.balls(state), *bearing.arrows(state, top), *patches]
        add_parts(pyvista, plotter, parts, top, peak)
        # VTK draws square brackets as round ones.
        colour_bar(pyvista, plotter, "ball load, N", LOADS, top, (0.045, 0.54))
        colour_bar(pyvista, plotter, "pressure, MPa", PRESSURES, peak, (0.045, 0.06))
        plotter.add_text(heading, position="upper_edge", font_size=13, color=_INK)
        plotter.add_axes(xlabel="x", ylabel="y", zlabel="z", line_width=3, color=_INK, viewport=(0.85, 0.0, 1.0, 0.2))
        plotter.enable_anti_aliasing("ssaa")
        plotter.camera_position = [(1.7, 0.75, 0.85), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)]
        plotter.reset_camera()
        plotter.camera.zoom(1.08)
        for text, place in ball_labels(bearing, state, top, screen_points(plotter)):
            plotter.add_text(text, position=place, font_size=LETTERS // 2, color=_INK)
        image = np.asarray(plotter.screenshot(return_img=True))
        plotter.close()
        return image

    return np.asarray(quietly(pyvista, draw))
