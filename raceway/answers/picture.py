"""Figures of matplotlib: their look, curves over axes with their differences, a caller's axes, files.

Every answer over axes is drawn alike: the axis with most numbers is x, the next are curves, which differ in colour, line and marker,
the rest are panels with equal axes, with the intervals of the curves; below each stands by how many per cent they differ from the first,
with the intervals of these differences.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import attrs
import numpy as np

from raceway.answers.page import svg
from raceway.answers.table import lines_of
from raceway.errors import RacewayError, extra
from raceway.framework.doors import door, reader
from raceway.framework.shown import interval_percents
from raceway.storage.files import write_whole

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Colours of curves, neighbours of which differ in grey and for the colour-blind, that of secondary marks, and that of the grid.
COLOURS = ("#0b4f8a", "#d9621e", "#4b2a6b", "#3fa7d6", "#1d6b4a", "#e0a100", "#7a1f3d", "#8d99a6")
GREY, GRID = "#555f6b", "#e3e7eb"
MARKERS = "os^DvPX*"
#: Beside the colours: curves are told apart in grey, too.
_LINES: Sequence[Any] = ("-", "--", ":", "-.", (0, (6, 1, 1, 1, 1, 1)))
#: Points of a curve from which on it has no markers.
_DENSE = 40
#: Part of a common axis that each panel's curves fill at least: else every panel has its own limits.
_SEEN = 1.0 / 6.0
#: Intervals within so many times what curves span set the limits; wider ones are cut.  Part of the limits up to which a band has no edges.
_NEAR, _THIN = 15.0, 0.01
#: Least size of letters over the figure's width [pt/inch], which are 9 pixels of 600, up to a size; panels in a row at most.
_READABLE, _LARGEST = 1.05, 11.0
#: Endings of files of figures.
FORMATS = (".png", ".svg", ".pdf")
MOST_COLUMNS = 3


def dress(axes: Axes) -> None:
    """A grid below the curves, and no frame above and to the right."""
    axes.grid(True, color=GRID, linewidth=0.8)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)


def new_figure(width: float, height: float) -> Figure:
    """An empty figure [inch] that belongs to no window.

    RacewayError: Where matplotlib is not installed.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise RacewayError(f"matplotlib is not installed: {extra('pictures')}, or leave out --pictures") from None
    return Figure(figsize=(width, height), layout="constrained")


_AXES = reader("axes of matplotlib", lambda v: hasattr(v, "plot") and hasattr(v, "figure"))


@door
def given_axes(ax: Annotated[Axes | None, _AXES], width: float = 6.4, height: float = 4.8) -> Axes:
    """The axes that a caller gave, or new ones of a figure [inch] that notebooks and ``pyplot.show`` display.

    RacewayError: Where matplotlib is not installed, or of what are no axes.
    """
    if ax is not None:
        return ax
    try:
        from matplotlib import pyplot
    except ImportError:
        raise RacewayError(f"plots need matplotlib, which is not installed: {extra('pictures')}") from None
    return pyplot.subplots(figsize=(width, height), layout="constrained")[1]


def label_axes(axes: Axes, title: str, x: str, y: str, size: float = 11.0) -> None:
    """Title, labels of a font size [pt] and grid; numbers along axes without an offset."""
    for axis in (axes.xaxis, axes.yaxis):
        if hasattr(formatter := axis.get_major_formatter(), "set_useOffset"):
            formatter.set_useOffset(False)
    axes.set_title(title, fontsize=size + 1.0)
    axes.set_xlabel(x, fontsize=size)
    axes.set_ylabel(y, fontsize=size)
    axes.tick_params(labelsize=size - 1.0)
    dress(axes)


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


def save_figure(figure: Figure, path: Path, dots_per_inch: int = 300) -> Path:
    """Write a figure as PNG, SVG or PDF, by the ending, whole or not at all; the same figure gives the same file.

    RacewayError: Another ending, or a folder or disk that cannot be written.
    """
    if path.suffix.lower() not in FORMATS:
        words = f"`{path}`: pictures are written as {', '.join(FORMATS[:-1])} or {FORMATS[-1]}: choose such a name"
        raise RacewayError(words)
    if path.suffix.lower() == ".svg":
        return write_whole(svg(readable(figure)), path)
    if path.suffix.lower() == ".png":
        return write_whole(figure_png(figure, dots_per_inch), path)
    from matplotlib import rc_context

    with rc_context({"pdf.fonttype": 42}):  # letters that publishers take: TrueType
        readable(figure).savefig(memory := io.BytesIO(), format="pdf", metadata={"CreationDate": None})
    return write_whole(memory.getvalue(), path)


def figure_png(figure: Figure, dots_per_inch: int = 300) -> bytes:
    """A figure as the content of a PNG file."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    readable(figure).set_dpi(dots_per_inch)
    memory = io.BytesIO()
    FigureCanvasAgg(figure).print_png(memory)
    return memory.getvalue()


@attrs.frozen(eq=False)
class Line:
    """A curve of a panel.

    x, y : (n,), broken where y is nan;  label : in the legend;  place : in the cycle of colours, lines and markers
    low, high : (n,) ends of its interval, nan where none is known;  doubt : (n,) numbers that are no part of it, crosses
    base : the curve that its difference is from, over the same x;  apart : (2, n) ends of the interval of y over the base's, relative
    shade : of curves of numbers, its colour, from 0 to 1 in their order
    style : options of ``Axes.plot`` that are its own
    """

    x: np.ndarray
    y: np.ndarray
    label: str = ""
    place: int = 0
    low: np.ndarray | None = None
    high: np.ndarray | None = None
    doubt: np.ndarray | None = None
    base: Line | None = None
    apart: np.ndarray | None = None
    shade: float | None = None
    style: dict[str, Any] = attrs.field(factory=dict)

    @property
    def look(self) -> dict[str, Any]:
        """Options of ``Axes.plot``."""
        from matplotlib import colormaps

        shaded = COLOURS[self.place % len(COLOURS)] if self.shade is None else colormaps["viridis"](0.85 * self.shade)
        tone, hollow = self.style.get("color", shaded), self.place % 2 == 1
        look = {"color": tone, "linestyle": _LINES[self.place % len(_LINES)], "marker": MARKERS[self.place % len(MARKERS)]}
        look |= {"markerfacecolor": "white" if hollow else tone, "linewidth": 1.7}
        return look | {"markersize": 5.0 if len(self.x) <= _DENSE else 0.0} | self.style

    def from_base(self) -> Line:
        """By how many per cent it differs from the curve ``base``, and the interval of that."""
        ratio = self.y / (self if self.base is None else self.base).y
        low, high = (None, None) if self.apart is None else 100.0 * (ratio * (1.0 + self.apart) - 1.0)
        return attrs.evolve(self, y=100.0 * (ratio - 1.0), label="", low=low, high=high, doubt=None)


@attrs.frozen(eq=False)
class Plot:
    """A pair of axes.

    curves : what it shows;  x, y : labels, quantities with units;  title : which part of the answer it is
    names : words that stand at 0, 1, 2, ... of x, where that has no numbers;  more : draws what is no curve, on axes with limits
    """

    curves: tuple[Line, ...]
    x: str
    y: str
    title: str = ""
    names: tuple[str, ...] = ()
    more: Callable[[Axes], None] | None = None

    def difference(self) -> Plot | None:
        """The differences of its curves from their bases; None where none has one."""
        if all(curve.base is None for curve in self.curves):
            return None
        shown = (one for one in self.curves if one.base is not None or any(one is curve.base for curve in self.curves))
        return attrs.evolve(self, curves=tuple(one.from_base() for one in shown), y="difference [%]", title="", more=None)

    def limits(self) -> tuple[float, float]:
        """Range of its curves, without margins; with their intervals where these are not far wider."""
        values = np.concatenate([curve.y for curve in self.curves] or [np.zeros(1)])
        values = values[np.isfinite(values)] if np.isfinite(values).any() else np.array([0.0, 1.0])
        low, high = float(values.min()), float(values.max())
        known = [end for curve in self.curves for end in (curve.low, curve.high) if end is not None]
        ends = np.concatenate([np.zeros(0), *known])
        wide = [low, high, *ends[np.isfinite(ends)]]
        return (min(wide), max(wide)) if np.ptp(wide) <= _NEAR * (high - low) else (low, high)

    def draw(self, axes: Axes, limits: tuple[float, float] | None = None) -> None:
        """Draw it; limits: of y, without margins, None: of its curves."""
        low, high = self.limits() if limits is None else limits
        margin = 0.07 * (high - low) or 0.01 * abs(high) or 1.0
        low, high = low - margin, high + margin
        for curve in self.curves:
            axes.plot(curve.x, curve.y, label=curve.label or "_", **curve.look)
            axes.update_datalim([(x, low) for x in curve.x], updatey=False)  # where there is no number, too
            tone = curve.look["color"]
            if curve.low is not None and curve.high is not None:
                ends = np.clip(curve.low, low, high), np.clip(curve.high, low, high)
                axes.fill_between(curve.x, *ends, color=tone, alpha=0.26 / len(self.curves), linewidth=0.0, zorder=0)
                wide = ends[1] - ends[0] > _THIN * (high - low)
                for end, own in zip(ends, (curve.low, curve.high), strict=True):  # an edge where it is neither cut nor thin
                    if (seen := wide & (end == own)).any():
                        edge = np.where(seen, end, np.nan)
                        axes.plot(curve.x, edge, color=tone, linestyle=curve.look["linestyle"], linewidth=0.8, zorder=1)
            if curve.doubt is not None and np.isfinite(curve.doubt).any():
                (cross,) = axes.plot(curve.x, np.clip(curve.doubt, low, high), "x", color=tone, markersize=6, clip_on=False)
                cross.set_in_layout(False)  # an artist that is not clipped would count for the layout, wherever it lies
        axes.set_ylim(low, high)
        if self.names:
            axes.set_xticks(range(len(self.names)), list(self.names))
        else:
            axes.locator_params(axis="x", nbins=6)
        label_axes(axes, self.title, self.x, self.y, 10.5)
        if self.more is not None:
            self.more(axes)

    def name_ends(self, axes: Axes) -> None:
        """Write the last number of each curve beside its end."""
        last = [(float(curve.y[np.isfinite(curve.y)][-1]), curve.look["color"]) for curve in self.curves
                if curve.base is not None and np.isfinite(curve.y).any()]  # fmt: skip
        name_ends(axes, [(y, f"{signed(y)} %", tone) for y, tone in last], 0.13)


def within(curves: Iterable[Line]) -> tuple[str, str]:
    """Words for the intervals of curves and of their differences, the widest of all points; empty where none is known."""
    own, apart = [np.zeros(0)], [np.zeros(0)]
    for curve in curves:
        own += [end / curve.y - 1.0 for end in (curve.low, curve.high) if end is not None]
        apart += [] if curve.apart is None else [curve.apart.ravel()]
    each = [ends[np.isfinite(ends)] for ends in map(np.concatenate, (own, apart))]
    first, second = (f"within {interval_percents(ends)}" if ends.size else "" for ends in each)
    return first, second and f"{second} by causes of one alone; of common ones (geometry, hypotheses) not estimated"


def signed(value: float) -> str:
    """A percentage with its sign and two digits, of large ones all before the point."""
    return f"{value:+.2g}" if abs(value) < 99.5 else f"{value:+.0f}"


def name_ends(axes: Axes, ends: Sequence[tuple[float, str, Any]], apart: float) -> None:
    """Texts in colours beside the right ends of curves, pushed apart where they would cover each other.

    ends : y, text and colour;  apart : least distance, part of the axis' height
    """
    ends = sorted((end for end in ends if np.isfinite(end[0])), key=lambda end: end[0])
    (low, high), right = axes.get_ylim(), axes.dataLim.x1
    gap, heights = apart * (high - low), list[float]()
    for y, *_ in ends:
        heights.append(max(y, heights[-1] + gap) if heights else y)
    top = high + 0.5 * gap
    for k in reversed(range(len(heights))):  # what was pushed out at the top pushes back
        heights[k] = top = min(heights[k], top - gap)
    for height, (_, text, tone) in zip(heights, ends, strict=True):
        axes.annotate(text, (right, height), xytext=(6, 0), textcoords="offset points", fontsize=9, color=tone, va="center", annotation_clip=False)  # fmt: skip


def draw_panels(rows: Sequence[Sequence[Plot]], title: str, legend: str = "") -> Figure:
    """Panels in rows, the differences of their curves below each.

    legend : what its entries are values of
    """
    lines, shaded = list[tuple[list[Plot], bool]](), list[str]()
    for row in rows:
        lines.append((list(row), False))
        if below := [panel for panel in (panel.difference() for panel in row) if panel is not None]:
            lines.append((below, True))
    named_curves = dict[str, list[Line]]()
    for panel in (panel for row in rows for panel in row):
        named_curves.setdefault(panel.y.partition(" [")[0], []).extend(panel.curves)
    for name, curves in named_curves.items():
        shaded += [f"{what} {words}" for what, words in zip((name, "difference"), within(curves), strict=True) if words]
    columns = max(len(row) for row, _ in lines)
    heights = [1.9 if bands else 3.1 for _, bands in lines]
    figure = new_figure(7.6 if columns == 1 else 1.6 + 3.7 * columns, 1.3 + sum(heights))
    grid = figure.subplots(len(lines), columns, squeeze=False, sharex=True, height_ratios=heights)
    for line, (row, bands) in enumerate(lines):
        own = [panel.limits() for panel in row]
        alike = len({panel.y for panel in row}) == 1
        common = min(low for low, _ in own), max(high for _, high in own)
        # A panel that is level says nothing about a scale.
        spans = [high - low for low, high in own if high - low > 1e-6 * max(abs(low), abs(high))]
        equal = alike and min(spans, default=1.0) >= _SEEN * (common[1] - common[0])
        for column, (panel, axes) in enumerate(zip(row, grid[line], strict=False)):
            last = line == len(lines) - 1
            panel = attrs.evolve(panel, x=panel.x if last else "", y="" if column and alike else panel.y)
            panel.draw(axes, common if equal else None)
            if bands:
                panel.name_ends(axes)
        for axes in grid[line, len(row) :]:
            axes.set_visible(False)
    entries = [axes.get_legend_handles_labels() for axes in grid.flat]
    named = {label: handle for handles, labels in entries for handle, label in zip(handles, labels, strict=True)}
    if named and any(len(line.x) > 1 for row, _ in lines for panel in row for line in panel.curves):
        across = max(1, int(9.0 * figure.get_figwidth() / (max(map(len, named)) + 7)))
        figure.legend(named.values(), named.keys(), loc="outside lower center", ncols=min(len(named), across), frameon=False, fontsize=10, title=legend or None, title_fontsize=10)  # fmt: skip
    title += f"\nshaded: {', '.join(shaded)}" if shaded else ""
    figure.suptitle(wrapped(title, int(9.0 * figure.get_figwidth())), fontsize=12)
    return figure
