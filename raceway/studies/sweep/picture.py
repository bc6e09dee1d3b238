"""Pictures of a sweep: curves, maps and surfaces of one quantity over named axes."""

from __future__ import annotations

import io
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import numpy as np

from raceway.errors import RacewayError
from raceway.framework.shown import read_in
from raceway.plugins.pictures import new_figure
from raceway.storage.files import write_whole
from raceway.studies.many.axes import is_number
from raceway.studies.many.axes import shown as _text

if TYPE_CHECKING:
    from collections.abc import Iterable

    from matplotlib.axes import Axes
    from matplotlib.collections import Collection
    from matplotlib.figure import Figure
    from xarray import DataArray

_WORDS = ("#0b5fa5", "#c8501e", "#2a8f5b", "#8a4fa3", "#b58a00", "#555f6b", "#3aa6b9", "#b0457b")
_MARKERS = "os^DvPX*"
_GRID = "#e3e7eb"
_NO_RESULT = "#c3cad1"
_LIST = "point"
_FORMATS = (".png", ".svg")
_DOTS_PER_INCH = 150


def draw(data: DataArray, kind: str, x: str, y: str | None, panels: str | None, title: str, remark: str) -> Figure:
    """One quantity.

    Parameters
    ----------
    data : over ``x``, ``y``, ``panels`` or over ``point``; nan where there is no result; attrs units, description
    kind : "curves", "map" or "surface"
    title, remark : the first line over the picture, and a second, smaller one

    Raises
    ------
    RacewayError
        matplotlib is missing.
    """
    factor, unit = read_in(1.0, str(data.attrs.get("units", "")))
    name = str(data.name).replace("_", " ").replace(":", " ")
    words = str(data.attrs.get("description", ""))
    label = name if unit in ("", "1") else f"{name} [{unit}]"
    data = data.copy(data=data.values * factor).assign_coords({key: data[key] for key in data.coords})
    parts = (
        [(None, data)] if panels is None else [(value, data.sel({panels: value})) for value in data[panels].values.tolist()]
    )
    figure = _figure(kind, len(parts))
    columns = min(len(parts), 3)
    rows = -(-len(parts) // columns)
    projection = {"projection": "3d"} if kind == "surface" else {}
    grid = figure.subplots(
        rows, columns, squeeze=False, sharex=kind != "surface", sharey=kind != "surface", subplot_kw=projection
    )
    low, high = float(np.nanmin(data.values)), float(np.nanmax(data.values))
    if high - low <= 1e-9 * abs(high):
        low, high = low - 0.01 * abs(low or 1.0), high + 0.01 * abs(high or 1.0)
    for place, (value, part) in enumerate(parts):
        axes = grid.flat[place]
        axes.set_title("" if panels is None else f"{panels} = {_text(value)}{_unit(data, panels)}", fontsize=10.5)
        first = place % columns == 0
        if kind == "curves":
            _curves(axes, part, x, y, label if first else "")
        elif kind == "map":
            shown = _map(axes, part, x, y or "", (low, high), first)
        else:
            shown = _surface(axes, part, x, y or "", (low, high), label)
    for axes in grid.flat[len(parts) :]:
        axes.set_visible(False)
    if kind == "map":
        bar = figure.colorbar(shown, ax=grid, shrink=0.95, pad=0.015)
        bar.set_label(label, fontsize=11)
        bar.outline.set_visible(False)
    if kind == "curves" and y is not None:
        handles, labels = grid.flat[0].get_legend_handles_labels()
        figure.legend(
            handles, labels, loc="outside right center", frameon=False, fontsize=10, title=_axis(data, y), title_fontsize=10
        )
    heading = name if words in ("", name) else f"{name}: {words}"
    figure.suptitle(
        "\n".join(line for text in (heading, *title.splitlines(), remark) for line in wrap(text, 84)), fontsize=11.5
    )
    return figure


def write(figure: Figure, path: Path) -> Path:
    """Write a figure as PNG or SVG, by the ending, whole or not at all.

    Raises
    ------
    RacewayError
        Another ending, or a folder that cannot be written.
    """
    if path.suffix.lower() not in _FORMATS:
        raise RacewayError(f"`{path}`: pictures are written as {' or '.join(_FORMATS)}: choose such a name with --out")
    from matplotlib import rc_context

    memory = io.BytesIO()
    # Neither a date nor names at random: the same results give the same file.
    with rc_context({"svg.hashsalt": "raceway"}):
        vector = path.suffix.lower() == ".svg"
        figure.savefig(
            memory, format=path.suffix.lower()[1:], dpi=_DOTS_PER_INCH, metadata={"Date": None} if vector else None
        )
    return write_whole(memory.getvalue(), path)


def _figure(kind: str, count: int) -> Figure:
    columns, rows = min(count, 3), -(-count // 3)
    if count == 1:
        return new_figure(8.6, 5.6)
    return new_figure(2.0 + 4.0 * columns, 1.2 + (3.9 if kind != "surface" else 4.2) * rows)


def _curves(axes: Axes, data: DataArray, x: str, y: str | None, label: str) -> None:
    """A curve for each value of y; the points of a list without lines, since they may have no order."""
    scattered = _LIST in data.dims
    values: list[Any] = [None] if y is None else list(dict.fromkeys(np.atleast_1d(data[y].values).tolist()))
    values = sorted(values) if y is not None and _numeric(values) else values
    places, names = _places(data[x].values)
    for k, value in enumerate(values):
        if y is None:
            chosen, at = data, places
        elif scattered:
            keep = np.array([one == value for one in data[y].values.tolist()])
            chosen, at = data.isel({_LIST: np.flatnonzero(keep)}), places[keep]
        else:
            chosen, at = data.sel({y: value}), places
        axes.plot(
            at, chosen.values, label=_text(value), color=_colour(k, values), marker=_MARKERS[k % len(_MARKERS)],
            markersize=4.5 if len(at) <= 40 else 0.0, linewidth=0.0 if scattered or names else 1.6,
        )  # fmt: skip
        if scattered and len(at) > 40:
            axes.lines[-1].set_markersize(3.0)
    if names:
        axes.set_xticks(range(len(names)), names)
    axes.set_ylabel(label, fontsize=11)
    _dress(axes, data, x)


def _map(axes: Axes, data: DataArray, x: str, y: str, limits: tuple[float, float], first: bool) -> Collection:
    """A cell round each point; contours where every point has a result."""
    low, high = limits
    axes.set_ylabel(_axis(data, y) if first else "", fontsize=11)
    if _LIST in data.dims:
        found = axes.scatter(data[x].values, data[y].values, c=data.values, s=42, cmap="viridis", vmin=low, vmax=high)
        _dress(axes, data, x)
        return found
    at_x, at_y = data[x].values, data[y].values
    values = data.transpose(y, x).values
    axes.set_facecolor(_NO_RESULT)
    shown = axes.pcolormesh(at_x, at_y, np.ma.masked_invalid(values), shading="nearest", cmap="viridis", vmin=low, vmax=high)
    if np.isfinite(values).all() and min(values.shape) >= 4:
        lines = axes.contour(at_x, at_y, values, levels=8, colors="white", linewidths=0.8, alpha=0.85)
        axes.clabel(lines, fontsize=8.5, fmt="%.4g")
    _dress(axes, data, x)
    axes.grid(False)
    return shown


def _surface(axes: Any, data: DataArray, x: str, y: str, limits: tuple[float, float], label: str) -> Collection:
    across, along = np.meshgrid(data[x].values, data[y].values)
    values = data.transpose(y, x).values
    shown = axes.plot_surface(
        across, along, values, cmap="viridis", vmin=limits[0], vmax=limits[1], rcount=200, ccount=200,
        linewidth=0.3, edgecolor="#ffffff55", antialiased=True,
    )  # fmt: skip
    axes.set_xlabel(_axis(data, x), fontsize=9.5, labelpad=9)
    axes.set_ylabel(_axis(data, y), fontsize=9.5, labelpad=9)
    axes.set_zlabel(label, fontsize=9.5, labelpad=7)
    axes.tick_params(labelsize=8.5)
    axes.view_init(elev=26.0, azim=-128.0)
    axes.set_box_aspect((1.25, 1.1, 0.8), zoom=1.0)
    return shown


def _dress(axes: Axes, data: DataArray, x: str) -> None:
    axes.set_xlabel(_axis(data, x), fontsize=11)
    axes.tick_params(labelsize=10)
    axes.grid(True, color=_GRID, linewidth=0.8)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    for axis in (axes.xaxis, axes.yaxis):
        formatter = axis.get_major_formatter()
        if hasattr(formatter, "set_useOffset"):
            formatter.set_useOffset(False)
    if _numeric(np.atleast_1d(data[x].values).tolist()):
        axes.locator_params(axis="x", nbins=7)


def _places(values: np.ndarray) -> tuple[np.ndarray, list[str]]:
    """Numbers as they are; words at 0, 1, 2, ... with their names."""
    plain = values.tolist()
    if _numeric(plain):
        return np.asarray(values, dtype=float), []
    names = list(dict.fromkeys(_text(value) for value in plain))
    return np.array([names.index(_text(value)) for value in plain], dtype=float), names


def _colour(place: int, values: list[Any]) -> str | tuple[float, float, float, float]:
    """Ordered colours for numbers, distinct ones for words."""
    if not _numeric(values) or len(values) == 1:
        return _WORDS[place % len(_WORDS)]
    from matplotlib import colormaps

    return colormaps["viridis"](0.88 * place / (len(values) - 1))


def _axis(data: DataArray, key: str) -> str:
    return f"{key}{_unit(data, key, brackets=True)}"


def _unit(data: DataArray, key: str, brackets: bool = False) -> str:
    unit = str(data[key].attrs.get("units", ""))
    if unit in ("", "1", "-"):
        return ""
    return f" [{unit}]" if brackets else f" {unit}"


def _numeric(values: Iterable[object]) -> bool:
    return all(map(is_number, values))
