"""The most loaded ball in the section of its rings, and its two contact ellipses to scale with their pressure."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from raceway.plugins.pictures import new_figure
from raceway.studies.view.bearing import INNER, OUTER, Bearing, State
from raceway.studies.view.scene import _INK

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable
    from matplotlib.figure import Figure

_MM = 1e3
_RACES = ("inner", "outer")


def contacts(bearing: Bearing, state: State, heading: str) -> Figure:
    """Section and ellipses of the ball with the largest load of both races."""
    z = len(state.azimuth)
    ball = int(np.argmax(state.load)) % z
    figure = new_figure(12.8, 6.2)
    grid = figure.add_gridspec(2, 2, width_ratios=(1.0, 1.25))
    _section(figure.add_subplot(grid[:, 0]), bearing, state, ball)
    top = 1e-6 * float(max(state.peak[ball], state.peak[z + ball]))
    reach = 1.15 * _MM * float(max(state.half[ball, 0], state.half[z + ball, 0], 1e-9))
    panels = [figure.add_subplot(grid[lane, 1]) for lane in range(2)]
    shown = [_ellipse(panel, state, k * z + ball, _RACES[k], top, reach) for k, panel in enumerate(panels)]
    figure.colorbar(shown[0], ax=panels, label="pressure [MPa], Hertz", shrink=0.9)
    figure.suptitle(f"{heading}\nmost loaded ball: {ball} at {np.degrees(state.azimuth[ball]) % 360.0:.4g} deg", fontsize=13)
    return figure


def _section(axes: Axes, bearing: Bearing, state: State, ball: int) -> None:
    z = len(state.azimuth)
    side, place = bearing.shape.rows[ball // bearing.shape.ball_count]
    for inner, colour in ((True, INNER), (False, OUTER)):
        race, seat = bearing.lines(inner, side, place)
        axes.fill(*np.concatenate([race, seat[::-1]]).T, facecolor=colour, edgecolor=_INK, linewidth=0.8, alpha=0.75)
        _mesh(axes, bearing, inner, side, place)
    radius, middle = 0.5 * bearing.diameter, np.array([_MM * place, 0.5 * _MM * bearing.shape.pitch_diameter])
    turn = np.linspace(0.0, 2.0 * np.pi, 181)
    axes.fill(
        middle[0] + radius * np.cos(turn),
        middle[1] + radius * np.sin(turn),
        facecolor="#e8ebee",
        edgecolor=_INK,
        linewidth=0.8,
    )
    arrow = {"arrowstyle": "-|>", "color": "#c8501e", "linewidth": 1.8}
    for i, sign, word in ((ball, -1.0, "inner"), (z + ball, 1.0, "outer")):
        angle, load = state.angle[i], state.load[i]
        if not load > 0.0:
            axes.text(
                middle[0], middle[1] + sign * 0.6 * radius, f"{word}: no contact", ha="center", va="center", fontsize=10
            )
            continue
        towards = middle + sign * radius * np.array([side * np.sin(angle), np.cos(angle)])
        axes.annotate("", (towards[0], towards[1]), (middle[0], middle[1]), arrowprops=arrow)
        words = f"{word}\n{load:.4g} N\n{np.degrees(angle):.2f}°"
        away = -sign * side  # from the arrow
        across, up = middle + radius * np.array([0.12 * away, 0.45 * sign])
        axes.text(across, up, words, ha="left" if away > 0.0 else "right", va="center", fontsize=10)
    axes.axhline(middle[1], color="#8a949e", linewidth=0.6, linestyle=(0, (6, 3, 1, 3)))
    axes.set_aspect("equal")
    axes.set_xlabel("along the axis, x [mm]")
    axes.set_ylabel("radius [mm]")
    axes.set_title("section, rings as they stand unloaded", fontsize=11)
    axes.spines[["top", "right"]].set_visible(False)


def _mesh(axes: Axes, bearing: Bearing, inner: bool, side: float, place: float) -> None:
    """The mesh that a condensed ring was computed on."""
    compute = getattr(bearing.result.model.bearing, "ring_section", None)
    if compute is None:
        return
    from matplotlib.collections import PolyCollection

    profile = compute(bearing.result.model, inner)
    corners = _MM * (profile.points[:, ::-1] * [side, 1.0] + [place, 0.0])
    axes.add_collection(PolyCollection(corners[profile.quads], facecolor="none", edgecolor=_INK, linewidth=0.25, alpha=0.7))


def _ellipse(axes: Axes, state: State, i: int, race: str, top: float, reach: float) -> ScalarMappable:
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
        place = a * part * np.cos(turn), b * part * np.sin(turn)
        axes.pcolormesh(*place, pressure, cmap=scale.cmap, norm=norm, shading="gouraud", rasterized=True)
        words = f"{state.load[i]:.4g} N, peak {1e-6 * state.peak[i]:.4g} MPa, {2.0 * a:.3g} x {2.0 * b:.3g} mm"
    axes.set_aspect("equal")
    axes.set_xlim(-reach, reach)
    axes.set_ylim(-0.35 * reach, 0.35 * reach)
    axes.set_facecolor("#f4f5f7")
    axes.set_xlabel("across the groove [mm]")
    axes.set_ylabel("rolling [mm]")
    axes.set_title(f"{race} race: {words}", fontsize=11)
    return scale
