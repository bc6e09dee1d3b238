"""The bearing as a picture, drawn by pyvista without a display."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

import numpy as np

from raceway import RacewayError
from raceway.extend import Tables, new_figure
from raceway_view.bodies import INNER, OUTER, BearingSolids, Snapshot
from raceway_view.system_libraries import refuse_pictures
from types import ModuleType

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable
    from matplotlib.figure import Figure

T = TypeVar("T")
#: pyvista's: its stubs refuse calls that it takes.
Plotter: TypeAlias = Any
Grid: TypeAlias = Any

#: Height of the letters, and the mean width of one [pixels].
LETTERS, _LETTER = 26, 14.5
#: Between a label and what it must not touch [pixels].
_GAP = 9.0


def ball_labels(
    bearing: BearingSolids, state: Snapshot, top: float, project: Callable[[np.ndarray], np.ndarray]
) -> list[tuple[str, tuple[float, float]]]:
    """Texts and their lower left corners [pixels].

    top : the load whose arrow is longest [N];  project : points (n, 3) [mm] -> (n, 2) [pixels]
    """
    texts = [f"{k}: {load:.3g} N" for k, load in enumerate(state.load[: len(state.azimuth)])]
    half = np.array([[0.5 * _LETTER * len(text), 0.5 * LETTERS] for text in texts])
    tails, heads = (project(points) for points in bearing.arrow_ends(state, top))
    along = heads - tails
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
    # As far beyond the tip as the arrow would go on through the label.
    through = ((half + 1.2 * _GAP) / np.maximum(np.abs(along), 1e-9)).min(axis=1, keepdims=True)
    middle = heads + along * through
    share = np.linspace(0.0, 1.0, 25)[:, None, None]
    arrows = ((1.0 - share) * tails + share * heads).reshape(-1, 2)
    return [(texts[k], (float(middle[k, 0] - half[k, 0]), float(middle[k, 1] - half[k, 1])))
            for k in _label_choice(middle, half, arrows, bearing.shape.ball_count)]  # fmt: skip


def _label_choice(middle: np.ndarray, half: np.ndarray, arrows: np.ndarray, per_row: int) -> list[int]:
    """Every nth ball of each row, n as small as leaves room; those that have room where no n does."""
    touching = (np.abs(middle[:, None] - middle) < half[:, None] + half + _GAP).all(axis=2)
    np.fill_diagonal(touching, False)
    free = ~(np.abs(middle[:, None] - arrows) < half[:, None] + _GAP).all(axis=2).any(axis=1)

    def clear(balls: Sequence[int]) -> bool:
        return bool(free[balls].all()) and not touching[np.ix_(balls, balls)].any()

    for every in range(1, per_row + 1):
        balls = [k for k in range(len(middle)) if k % per_row % every == 0]
        if clear(balls):
            return balls
    chosen_labels: list[int] = []
    for k in range(len(middle)):
        if clear([*chosen_labels, k]):
            chosen_labels.append(k)
    return chosen_labels


LOADS, PRESSURES, INK = "viridis", "inferno", "#20262c"
_BAR: Tables = {"color": INK, "n_labels": 5, "fmt": "%.0f", "vertical": True}


def pyvista_of(otherwise: str = "") -> ModuleType:
    """The package; RacewayError, which names what installs it, where it or its system libraries are missing."""
    import pyvista

    refuse_pictures(otherwise)
    return pyvista


def quietly(pyvista: ModuleType, draw: Callable[[], T], otherwise: str = "") -> T:
    """Draw; without a display VTK says so on standard error, and then draws in memory as it was asked to.

    RacewayError: VTK cannot draw here.
    """
    try:
        with pyvista.vtk_verbosity("off"):
            return draw()
    except (RuntimeError, OSError) as error:
        raise RacewayError(f"the picture cannot be drawn: {error}{otherwise}") from None


def rendered(
    draw: Callable[[ModuleType, Plotter], None], size: tuple[int, int] = (1600, 1200), otherwise: str = ""
) -> bytes:
    """PNG of what ``draw(pyvista, plotter)`` puts into a scene.

    otherwise : what a message adds about how to do without the picture

    RacewayError: pyvista or its system libraries are missing, or VTK cannot draw here.
    """
    pyvista = pyvista_of(otherwise)

    def image() -> np.ndarray:
        plotter = pyvista.Plotter(off_screen=True, window_size=list(size))
        plotter.background_color = "white"
        draw(pyvista, plotter)
        pixels = np.asarray(plotter.screenshot(return_img=True))
        plotter.close()
        return pixels

    from PIL import Image

    memory = io.BytesIO()
    Image.fromarray(quietly(pyvista, image, otherwise)).save(memory, "PNG")
    return memory.getvalue()


def look_from(plotter: Plotter, camera: Sequence[Sequence[float]], zoom: float) -> None:
    """All that is in the scene, from a camera: its place, the point that it looks at, the direction upwards."""
    plotter.camera_position = camera
    plotter.reset_camera()
    plotter.camera.zoom(zoom)


def _colour_bar(
    pyvista: ModuleType, plotter: Plotter, title: str, colours: str, top: float, corner: tuple[float, float]
) -> None:
    """A colour bar of its own, from 0 to ``top``."""
    table = pyvista.LookupTable(colours, scalar_range=(0.0, top))
    carrier = pyvista.PolyData(np.zeros((1, 3)))
    carrier.point_data["bar"] = np.zeros(1)
    actor = plotter.add_mesh(carrier, scalars="bar", cmap=table, show_scalar_bar=False, opacity=0.0, reset_camera=False)
    small = plotter.window_size[0] / 1600.0  # letters are given in pixels
    sizes = {name: max(int(size * small), 12) for name, size in (("title_font_size", 28), ("label_font_size", 26))}
    bar = {**_BAR, **sizes, "position_x": corner[0], "position_y": corner[1], "height": 0.34, "width": 0.05}
    plotter.add_scalar_bar(title=title, mapper=actor.mapper, **bar)


def overview(bearing: BearingSolids, state: Snapshot, heading: str, size: tuple[int, int] = (1600, 1200)) -> bytes:
    """The bearing cut open, seen from the gap, as PNG."""
    top = max(float(state.load[: len(state.azimuth)].max()), 1e-12)

    def draw(pyvista: ModuleType, plotter: Plotter) -> None:
        patches = bearing.patches(state)
        peak = max((float(part.surface.values.max()) for part in patches if part.surface.values is not None), default=1.0)
        parts = [*bearing.rings(), *bearing.balls(state), *bearing.arrows(state, top), *patches]
        # Put parts into a scene; colours of loads and pressures reach from 0 to the given ends [N, MPa].
        for part in parts:
            mesh = pyvista.PolyData.from_regular_faces(part.surface.points, part.surface.triangles)
            mesh.point_data["Normals"] = part.surface.normals
            mesh.point_data.active_normals_name = "Normals"
            # Loads are equal all over a part: as a field, so that all parts share one colour bar.
            look: Tables = {"smooth_shading": True, "split_sharp_edges": False, "show_scalar_bar": False}
            look["opacity"] = part.opacity
            if part.colour is not None:
                ambient = 0.65 if "cut face" in part.name else 0.25
                plotter.add_mesh(mesh, color=part.colour, ambient=ambient, diffuse=1.0 - ambient, specular=0.1, **look)
            elif part.scale == "pressure":
                mesh.point_data["pressure"] = part.surface.values
                plotter.add_mesh(mesh, scalars="pressure", cmap=PRESSURES, clim=(0.0, peak), lighting=False, **look)
            else:
                mesh.point_data["load"] = np.full(len(part.surface.points), part.load)
                plotter.add_mesh(mesh, scalars="load", cmap=LOADS, clim=(0.0, top), ambient=0.3, **look)
        # VTK draws square brackets as round ones.
        _colour_bar(pyvista, plotter, "ball load, N", LOADS, top, (0.045, 0.54))
        _colour_bar(pyvista, plotter, "pressure, MPa", PRESSURES, peak, (0.045, 0.06))
        plotter.add_text(heading, position="upper_edge", font_size=13, color=INK)
        plotter.add_axes(xlabel="x", ylabel="y", zlabel="z", line_width=3, color=INK, viewport=(0.85, 0.0, 1.0, 0.2))
        plotter.enable_anti_aliasing("ssaa")
        look_from(plotter, [(1.7, 0.75, 0.85), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)], 1.08)
        # Where points (n, 3) [mm] of the scene are seen: (n, 2) pixels from the lower left corner
        width, height = plotter.window_size
        matrix = plotter.camera.GetCompositeProjectionTransformMatrix(width / height, -1.0, 1.0)
        project = np.array([[matrix.GetElement(i, j) for j in range(4)] for i in range(4)])

        def pixels(points: np.ndarray) -> np.ndarray:
            at = np.column_stack([points, np.ones(len(points))]) @ project.T
            return np.asarray(0.5 * (at[:, :2] / at[:, 3:] + 1.0) * [width, height])

        for text, corner in ball_labels(bearing, state, top, pixels):
            plotter.add_text(text, position=corner, font_size=LETTERS // 2, color=INK)

    return rendered(draw, size)


_MM = 1e3
_RACES = ("inner", "outer")


def contacts(bearing: BearingSolids, state: Snapshot, heading: str) -> Figure:
    """Section and ellipses of the ball with the largest load of both races."""
    z = len(state.azimuth)
    ball = int(np.argmax(state.load)) % z
    figure = new_figure(9.6, 5.4)
    grid = figure.add_gridspec(2, 2, width_ratios=(1.0, 1.25))
    _groove_section(figure.add_subplot(grid[:, 0]), bearing, state, ball)
    top = 1e-6 * float(max(state.peak[ball], state.peak[z + ball]))
    reach = 1.15 * _MM * float(max(state.half[ball, 0], state.half[z + ball, 0], 1e-9))
    panels = [figure.add_subplot(grid[lane, 1]) for lane in range(2)]
    ellipses = [_draw_ellipse(panel, state, k * z + ball, _RACES[k], top, reach) for k, panel in enumerate(panels)]
    figure.colorbar(ellipses[0], ax=panels, label="pressure [MPa], Hertz", shrink=0.9)
    figure.suptitle(f"{heading}\nmost loaded ball: {ball} at {np.degrees(state.azimuth[ball]) % 360.0:.4g} deg", fontsize=13)
    return figure


def _groove_section(axes: Axes, bearing: BearingSolids, state: Snapshot, ball: int) -> None:
    z = len(state.azimuth)
    side, axial = bearing.shape.rows[ball // bearing.shape.ball_count]
    for inner, colour in ((True, INNER), (False, OUTER)):
        race, seat = bearing.lines(inner, side, axial)
        axes.fill(*np.concatenate([race, seat[::-1]]).T, facecolor=colour, edgecolor=INK, linewidth=0.8, alpha=0.75)
        _mesh(axes, bearing, inner, side, axial)
    radius, middle = 0.5 * bearing.diameter, np.array([_MM * axial, 0.5 * _MM * bearing.shape.pitch_diameter])
    turn = np.linspace(0.0, 2.0 * np.pi, 181)
    circle = middle[0] + radius * np.cos(turn), middle[1] + radius * np.sin(turn)
    axes.fill(*circle, facecolor="#e8ebee", edgecolor=INK, linewidth=0.8)
    arrow = {"arrowstyle": "-|>", "color": "#c8501e", "linewidth": 1.8}
    for i, sign, word in ((ball, -1.0, "inner"), (z + ball, 1.0, "outer")):
        angle, load = state.angle[i], state.load[i]
        if not load > 0.0:
            x, y = middle + [0.0, 0.6 * sign * radius]
            axes.text(x, y, f"{word}: no contact", ha="center", va="center", fontsize=10)
            continue
        towards = middle + sign * radius * np.array([side * np.sin(angle), np.cos(angle)])
        axes.annotate("", (towards[0], towards[1]), (middle[0], middle[1]), arrowprops=arrow)
        words = f"{word}\n{load:.4g} N\n{np.degrees(angle):.2f}°"
        away = -sign * side  # from the arrow
        across, up = middle + radius * np.array([0.12 * away, 0.45 * sign])
        axes.text(across, up, words, ha="left" if away > 0.0 else "right", va="center", fontsize=10)
    axes.axhline(middle[1], color="#8a949e", linewidth=0.6, linestyle=(0, (6, 3, 1, 3)))
    axes.set_aspect("equal")
    axes.set_xlabel("x [mm]")
    axes.set_ylabel("radius [mm]")
    axes.set_title("section, rings unloaded", fontsize=11)
    axes.spines[["top", "right"]].set_visible(False)


def _mesh(axes: Axes, bearing: BearingSolids, inner: bool, side: float, axial: float) -> None:
    """The mesh that a condensed ring was computed on."""
    compute = getattr(bearing.result.model.bearing, "ring_section", None)
    if compute is None:
        return
    from matplotlib.collections import PolyCollection

    profile = compute(bearing.result.model, inner)
    corners = _MM * (profile.points[:, ::-1] * [side, 1.0] + [axial, 0.0])
    axes.add_collection(PolyCollection(corners[profile.quads], facecolor="none", edgecolor=INK, linewidth=0.25, alpha=0.7))


def _draw_ellipse(axes: Axes, state: Snapshot, i: int, race: str, top: float, reach: float) -> ScalarMappable:
    """One ellipse on a mesh of its own radii and angles, so that its edge is smooth."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    norm = Normalize(0.0, max(top, 1e-9))
    scale = ScalarMappable(norm, "inferno")
    a, b = _MM * state.half[i]
    words = "no contact"
    if state.load[i] > 0.0:
        part, turn = np.meshgrid(np.sin(np.linspace(0.0, 0.5 * np.pi, 61)), np.linspace(0.0, 2.0 * np.pi, 241))
        pressure = 1e-6 * state.peak[i] * np.sqrt(1.0 - part**2)
        across, along = a * part * np.cos(turn), b * part * np.sin(turn)
        axes.pcolormesh(across, along, pressure, cmap=scale.cmap, norm=norm, shading="gouraud", rasterized=True)
        words = f"{state.load[i]:.4g} N\n{1e-6 * state.peak[i]:.4g} MPa, {2.0 * a:.3g} x {2.0 * b:.3g} mm"
    axes.set_aspect("equal")
    axes.set_xlim(-reach, reach)
    axes.set_ylim(-0.35 * reach, 0.35 * reach)
    axes.set_facecolor("#f4f5f7")
    axes.set_xlabel("across the groove [mm]")
    axes.set_ylabel("rolling [mm]")
    axes.set_title(f"{race} race: {words}", fontsize=11)
    return scale
