"""Panels of the article's figures: axes with their words, and how several stand side by side."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from raceway.plugins.pictures import new_figure
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_WIDTH, _HEIGHT = 4.7, 3.8
GRID = "#d8dee4"


@attrs.frozen
class Panel:
    """One pair of axes: how it is drawn, what is seen, and a caption; ``solid`` for three axes."""

    draw: Callable[[Axes], None]
    alternative: str
    caption: str
    solid: bool = False

    def figure(self) -> Figure:
        figure = new_figure(_WIDTH, _HEIGHT)
        self.draw(_axes(figure, 111, self.solid))
        return figure


@attrs.frozen
class Picture:
    """A figure of several panels, three in a row."""

    name: str
    title: str
    panels: tuple[Panel, ...]

    def figure(self) -> Figure:
        rows = -(-len(self.panels) // 3)
        columns = min(3, len(self.panels))
        figure = new_figure(_WIDTH * columns, _HEIGHT * rows + 0.4)
        for place, panel in enumerate(self.panels, start=1):
            panel.draw(_axes(figure, (rows, columns, place), panel.solid))
        figure.suptitle(self.title, fontsize=13)
        return figure


def _axes(figure: Figure, place: int | tuple[int, int, int], solid: bool) -> Any:
    words: Tables = {"projection": "3d"} if solid else {}
    return figure.add_subplot(*place, **words) if isinstance(place, tuple) else figure.add_subplot(place, **words)


def finish(axes: Axes, title: str, x: str, y: str, legend: int = 0) -> None:
    axes.set_title(title, fontsize=11)
    axes.set_xlabel(x, fontsize=10)
    axes.set_ylabel(y, fontsize=10)
    axes.tick_params(labelsize=9)
    axes.grid(color=GRID, linewidth=0.7)
    axes.set_axisbelow(True)
    axes.ticklabel_format(useOffset=False)
    if legend:
        axes.legend(fontsize=8.5, frameon=False, ncols=legend, loc="upper center", bbox_to_anchor=(0.5, -0.17))


def ends(values: np.ndarray) -> str:
    return f"{values[0]:.4g} to {values[-1]:.4g}" if np.isfinite(values[[0, -1]]).all() else "not computed to the end"


def cut(axes: Axes, lines: list[np.ndarray]) -> None:
    """Limits by the steady motions: an unstable one far away must not flatten them."""
    values = np.concatenate(lines)
    values = values[np.isfinite(values)]
    if values.size:
        low, high = values.min(), values.max()
        room = 0.07 * max(high - low, 0.01 * abs(high))
        axes.set_ylim(low - room, high + room)


def colours(count: int) -> list[Any]:
    from matplotlib import colormaps

    return [colormaps["viridis"](x) for x in np.linspace(0.0, 0.72, count)]


def end_labels(axes: Axes, x: float, labels: list[tuple[float, str, Any]]) -> None:
    """Names at the right ends of curves, pushed apart where they would cover each other."""
    known = sorted((label for label in labels if np.isfinite(label[0])), key=lambda label: label[0])
    low, high = axes.get_ylim()
    gap = 0.062 * (high - low)
    places: list[float] = []
    for y, *_ in known:
        places.append(max(y, places[-1] + gap) if places else y)
    top = high + 0.5 * gap
    for k in reversed(range(len(places))):  # what was pushed out at the top pushes back
        places[k] = top = min(places[k], top - gap)
    for place, (_, text, colour) in zip(places, known, strict=True):
        axes.annotate(text, (x, place), xytext=(5, 0), textcoords="offset points", fontsize=8.5, color=colour, va="center",
                      annotation_clip=False)  # fmt: skip
