"""Figures of matplotlib: their look, new ones without a window, a caller's axes, PNG files."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from raceway.answers.table import lines_of
from raceway.errors import RacewayError, extra
from raceway.framework.doors import door, reader
from raceway.storage.files import write_whole

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


#: Colours of curves, that of secondary marks, and that of the grid.
COLOURS = ("#0b5fa5", "#c8501e", "#2a8f5b", "#8a4fa3", "#b58a00", "#555f6b", "#3aa6b9", "#b0457b")
GREY, GRID = "#555f6b", "#e3e7eb"
MARKERS = "os^DvPX*"
#: Least size of letters over the figure's width [pt/inch], which are 9 pixels of 600, up to a size; panels in a row at most.
_READABLE, _LARGEST = 1.05, 11.0
MOST_COLUMNS = 3


def dress(axes: Axes) -> None:
    """A grid below the curves, and no frame above and to the right."""
    axes.grid(True, color=GRID, linewidth=0.8)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)


def new_figure(width: float, height: float) -> Figure:
    """An empty figure [inch] that belongs to no window.

    Raises
    ------
    RacewayError
        Where matplotlib is not installed.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise RacewayError(
            f"pictures need matplotlib, which is not installed: {extra('pictures')}, or leave out --pictures"
        ) from None
    return Figure(figsize=(width, height), layout="constrained")


_AXES = reader("axes of matplotlib", lambda v: hasattr(v, "plot") and hasattr(v, "figure"))


@door
def given_axes(ax: Annotated[Axes | None, _AXES], width: float = 6.4, height: float = 4.8) -> Axes:
    """The axes that a caller gave, or new ones of a figure [inch] that notebooks and ``pyplot.show`` display.

    Raises
    ------
    RacewayError
        Where matplotlib is not installed, or of what are no axes.
    """
    if ax is not None:
        return ax
    try:
        from matplotlib import pyplot
    except ImportError:
        raise RacewayError(f"plots need matplotlib, which is not installed: {extra('pictures')}") from None
    return pyplot.subplots(figsize=(width, height), layout="constrained")[1]


def label_axes(axes: Axes, title: str, x: str, y: str, size: float = 11.0) -> None:
    """Title, labels of a font size [pt] and grid."""
    axes.set_title(title, fontsize=size + 1.0)
    axes.set_xlabel(x, fontsize=size)
    axes.set_ylabel(y, fontsize=size)
    axes.tick_params(labelsize=size - 1.0)
    axes.grid(color="#d8dee4", linewidth=0.7)
    axes.set_axisbelow(True)


def wrapped(title: str, width: int = 80) -> str:
    """A title in lines of so many signs at most, each of its own lines apart."""
    return "\n".join(lines_of(title, width))


def readable(figure: Figure) -> Figure:
    """The figure with letters of at least 9 pixels where it is shown 600 pixels wide."""
    from matplotlib.text import Text

    least = min(_READABLE * figure.get_figwidth(), _LARGEST)
    for axes in figure.axes:
        for side in axes.xaxis, axes.yaxis:
            side.set_tick_params(labelsize=max([least, *(label.get_fontsize() for label in side.get_ticklabels()[:1])]))
    for text in figure.findobj(Text):
        text.set_fontsize(max(text.get_fontsize(), least))
    return figure


def save_figure(figure: Figure, path: Path, dots_per_inch: int = 150) -> Path:
    """Write a figure as PNG, whole or not at all.

    Raises
    ------
    RacewayError
        A folder or disk that cannot be written.
    """
    return write_whole(figure_png(figure, dots_per_inch), path)


def figure_png(figure: Figure, dots_per_inch: int) -> bytes:
    """A figure as the content of a PNG file."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    readable(figure).set_dpi(dots_per_inch)
    memory = io.BytesIO()
    FigureCanvasAgg(figure).print_png(memory)
    return memory.getvalue()
