"""The section of a bearing in proportion: the whole of it with its main dimensions, and one ball between its grooves."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from raceway.core.mesh.ring_mesh import ring_shape
from raceway.errors import MeshError, SceneError
from raceway.out.picture import new_figure, save_figure
from raceway.scene.bearing import Bearing

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_INK, _RACE, _BALL, _MARK = "#1c2733", "#d5dde5", "#f4f6f8", "#c8501e"
_MM = 1e3
#: Points along a groove.
_POINTS = 60


def draw_section(name: str, bearing: Bearing, path: Path) -> Path:
    """Write the section as PNG.

    Raises
    ------
    SceneError
        A bearing without bore, outer diameter or width.
    RacewayError
        matplotlib is missing, or the file cannot be written.
    """
    return save_figure(_section(name, bearing), path, 150)


def _section(name: str, bearing: Bearing) -> Figure:
    """The figure: left the whole bearing, right one ball."""
    try:
        rings = [_outline(bearing, inner) for inner in (True, False)]
    except MeshError as why:
        raise SceneError.at("bearing", name, f"cannot be drawn: {why}") from None
    figure = new_figure(9.0, 5.2)
    full, close = figure.subplots(1, 2, width_ratios=(1.0, 1.25))
    for axes in (full, close):
        for outline in rings:
            for sign in (1.0, -1.0) if axes is full else (1.0,):
                axes.fill(_MM * outline[:, 0], sign * _MM * outline[:, 1], facecolor=_RACE, edgecolor=_INK, lw=0.9)
        axes.set_aspect("equal")
        axes.axis("off")
    _draw_bearing(full, bearing)
    _draw_ball_in_grooves(close, bearing)
    figure.suptitle(f"{name}, dimensions in mm")
    return figure


def _outline(b: Bearing, inner: bool) -> np.ndarray:
    """Places (n, 2) [m] along the outline of a ring, axial and radial, with its groove and shoulders."""
    shape = ring_shape(b, inner)
    side = 0.5 * shape.width
    reach = np.sqrt(max(shape.groove**2 - (shape.land - shape.centre_r) ** 2, 0.0))
    x = np.linspace(max(shape.centre_x - reach, -side), min(shape.centre_x + reach, side), _POINTS)
    bottom = np.sqrt(shape.groove**2 - np.clip((x - shape.centre_x) ** 2, 0.0, shape.groove**2))
    r = shape.centre_r - bottom if inner else shape.centre_r + bottom
    corners = [(-side, shape.seat), (-side, shape.land)]
    return np.array([*corners, *zip(x, r, strict=True), (side, shape.land), (side, shape.seat)])


def _ball(axes: Axes, b: Bearing, sign: float = 1.0) -> None:
    from matplotlib.patches import Circle

    centre = 0.0, sign * 0.5 * _MM * b.pitch_diameter
    axes.add_patch(Circle(centre, 0.5 * _MM * b.ball_diameter, facecolor=_BALL, edgecolor=_INK, lw=0.9))


def _draw_bearing(axes: Axes, b: Bearing) -> None:
    """Both halves of the section with bore, outer and pitch diameter, and width."""
    bore, outer, width = b.bore or 0.0, b.outer_diameter or 0.0, b.width or 0.0
    for sign in (1.0, -1.0):
        _ball(axes, b, sign)
    half, step = 0.5 * _MM * width, 0.09 * _MM * outer
    axes.plot([-half - step, half + step], [0.0, 0.0], color=_INK, lw=0.8, ls="-.")
    for k, (value, word) in enumerate(((bore, "d"), (b.pitch_diameter, "$d_m$"), (outer, "D")), 1):
        x, r = half + k * step, 0.5 * _MM * value
        axes.annotate("", (x, -r), (x, r), arrowprops={"arrowstyle": "<->", "color": _INK, "lw": 0.8})
        for sign in (1.0, -1.0):
            axes.plot([0.0 if word == "$d_m$" else half, x], [sign * r] * 2, color=_INK, lw=0.4)
        axes.text(x, 0.2 * _MM * bore, f"{word} {_MM * value:.5g}", fontsize=8, rotation=90, va="center", ha="right")
    top = 0.5 * _MM * outer + 0.5 * step
    axes.annotate("", (-half, top), (half, top), arrowprops={"arrowstyle": "<->", "color": _INK, "lw": 0.8})
    axes.text(0.0, top, f"B {_MM * width:.5g}", fontsize=8, ha="center", va="bottom")


def _draw_ball_in_grooves(axes: Axes, b: Bearing) -> None:
    """One ball with its diameter, the line of contact and the grooves."""
    _ball(axes, b)
    r, radius = 0.5 * _MM * b.pitch_diameter, 0.5 * _MM * b.ball_diameter
    # A positive axial load seats the inner ring along +x: its contact lies at -x below the ball.
    along = np.array([np.sin(b.contact_angle), np.cos(b.contact_angle)])
    ends = np.array([0.0, r]) + np.outer([-1.45, 1.45], along) * radius
    axes.plot(*ends.T, color=_MARK, lw=1.0, ls="-.")
    axes.plot([0.0, 0.0], [r - 1.45 * radius, r + 1.45 * radius], color=_INK, lw=0.6, ls="-.")
    axes.annotate(
        "", (-radius, r), (radius, r), arrowprops={"arrowstyle": "<->", "color": _INK, "lw": 0.8, "shrinkA": 0, "shrinkB": 0}
    )
    axes.text(0.0, r, f"{_MM * b.ball_diameter:.5g}", fontsize=9, ha="center", va="bottom")
    words = (
        f"{b.ball_count} balls of {_MM * b.ball_diameter:.5g}\ncontact angle {np.degrees(b.contact_angle):.4g} deg\n"
        f"grooves {b.conformity_inner:.4g} D inner, {b.conformity_outer:.4g} D outer"
    )
    axes.text(0.5, -0.02, words, transform=axes.transAxes, fontsize=9, ha="center", va="top", color=_INK)
    axes.text(ends[1, 0], ends[1, 1], f" {np.degrees(b.contact_angle):.4g} deg", fontsize=9, color=_MARK)
