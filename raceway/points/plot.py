"""Layout of a sweep's pictures: the quantity, the axes for x, colour and panels, the kind of picture."""

from __future__ import annotations

import io
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from raceway.answers.picture import COLOURS, MARKERS, dress, new_figure, wrapped
from raceway.answers.quantities import AXIAL_DISPLACEMENT, COLUMNS, STIFFNESS, Z_REAL, K, entry_unit, read_in
from raceway.errors import Mistake, RacewayError, SceneError
from raceway.framework.options import nearest
from raceway.points.axes import is_number, shown
from raceway.points.selection import LIST, Selection, listed
from raceway.storage.files import write_whole

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import Collection
    from matplotlib.figure import Figure
    from xarray import DataArray, Dataset


_NO_RESULT = "#c3cad1"
_FORMATS = (".png", ".svg")
_DOTS_PER_INCH = 150


def draw(layout: _Layout) -> Figure:
    """The picture of a layout.

    Raises
    ------
    RacewayError
        matplotlib is missing.
    """
    data, kind, x, y, panels = layout.data, layout.kind, layout.x, layout.y, layout.panels
    factor, unit = read_in(1.0, str(data.attrs.get("units", "")))
    name = str(data.name).replace("_", " ").replace(":", " ")
    words = str(data.attrs.get("description", ""))
    label = name if unit in ("", "1") else f"{name} [{unit}]"
    data = data.copy(data=data.values * factor).assign_coords({key: data[key] for key in data.coords})
    parts = (
        [(None, data)] if panels is None else [(value, data.sel({panels: value})) for value in data[panels].values.tolist()]
    )
    columns = min(len(parts), 3)
    rows = -(-len(parts) // columns)
    size = (2.0 + 4.0 * columns, 1.2 + (3.9 if kind != "surface" else 4.2) * rows) if len(parts) > 1 else (8.6, 5.6)
    figure = new_figure(*size)
    projection = {"projection": "3d"} if kind == "surface" else {}
    grid = figure.subplots(
        rows, columns, squeeze=False, sharex=kind != "surface", sharey=kind != "surface", subplot_kw=projection
    )
    low, high = float(np.nanmin(data.values)), float(np.nanmax(data.values))
    if high - low <= 1e-9 * abs(high):
        low, high = low - 0.01 * abs(low or 1.0), high + 0.01 * abs(high or 1.0)
    for panel, (value, part) in enumerate(parts):
        axes = grid.flat[panel]
        axes.set_title("" if panels is None else f"{panels} = {shown(value)}{_unit(data, panels)}", fontsize=10.5)
        first = panel % columns == 0
        if kind == "curves":
            _curves(axes, part, x, y, label if first else "")
        elif kind == "map":
            mappable = _map(axes, part, x, y or "", (low, high), first)
        else:
            mappable = _surface(axes, part, x, y or "", (low, high), label)
    for axes in grid.flat[len(parts) :]:
        axes.set_visible(False)
    if kind == "map":
        bar = figure.colorbar(mappable, ax=grid, shrink=0.95, pad=0.015)
        bar.set_label(label, fontsize=11)
        bar.outline.set_visible(False)
    if kind == "curves" and y is not None:
        handles, labels = grid.flat[0].get_legend_handles_labels()
        figure.legend(
            handles, labels, loc="outside right center", frameon=False, fontsize=10, title=_axis(data, y), title_fontsize=10
        )
    heading = name if words in ("", name) else f"{name}: {words}"
    figure.suptitle(wrapped("\n".join((heading, layout.title, layout.remark)), 84), fontsize=11.5)
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


def _curves(axes: Axes, data: DataArray, x: str, y: str | None, label: str) -> None:
    """A curve for each value of y; the points of a list without lines, since they may have no order."""
    from matplotlib import colormaps

    as_list = LIST in data.dims
    values: list[Any] = [None] if y is None else list(dict.fromkeys(np.atleast_1d(data[y].values).tolist()))
    values = sorted(values) if y is not None and _numeric(values) else values
    # Numbers stand at themselves, in ordered colours; words at 0, 1, 2, ... in distinct ones.
    plain, ordered = data[x].values.tolist(), _numeric(values) and len(values) > 1
    names = [] if _numeric(plain) else list(dict.fromkeys(map(shown, plain)))
    places = np.array([names.index(shown(value)) for value in plain] if names else plain, dtype=float)
    for k, value in enumerate(values):
        if y is None:
            series, at = data, places
        elif as_list:
            keep = np.array([coordinate == value for coordinate in data[y].values.tolist()])
            series, at = data.isel({LIST: np.flatnonzero(keep)}), places[keep]
        else:
            series, at = data.sel({y: value}), places
        colour = colormaps["viridis"](0.88 * k / (len(values) - 1)) if ordered else COLOURS[k % len(COLOURS)]
        axes.plot(
            at, series.values, label=shown(value), color=colour, marker=MARKERS[k % len(MARKERS)],
            markersize=4.5 if len(at) <= 40 else 0.0, linewidth=0.0 if as_list or names else 1.6,
        )  # fmt: skip
        if as_list and len(at) > 40:
            axes.lines[-1].set_markersize(3.0)
    if names:
        axes.set_xticks(range(len(names)), names)
    axes.set_ylabel(label, fontsize=11)
    _dress(axes, data, x)


def _map(axes: Axes, data: DataArray, x: str, y: str, limits: tuple[float, float], first: bool) -> Collection:
    """A cell round each point; contours where every point has a result."""
    low, high = limits
    axes.set_ylabel(_axis(data, y) if first else "", fontsize=11)
    if LIST in data.dims:
        points = axes.scatter(data[x].values, data[y].values, c=data.values, s=42, cmap="viridis", vmin=low, vmax=high)
        _dress(axes, data, x)
        return points
    at_x, at_y = data[x].values, data[y].values
    values = data.transpose(y, x).values
    axes.set_facecolor(_NO_RESULT)
    cells = axes.pcolormesh(at_x, at_y, np.ma.masked_invalid(values), shading="nearest", cmap="viridis", vmin=low, vmax=high)
    if np.isfinite(values).all() and min(values.shape) >= 4:
        lines = axes.contour(at_x, at_y, values, levels=8, colors="white", linewidths=0.8, alpha=0.85)
        axes.clabel(lines, fontsize=8.5, fmt="%.4g")
    _dress(axes, data, x)
    axes.grid(False)
    return cells


def _surface(axes: Any, data: DataArray, x: str, y: str, limits: tuple[float, float], label: str) -> Collection:
    across, along = np.meshgrid(data[x].values, data[y].values)
    values = data.transpose(y, x).values
    surface = axes.plot_surface(
        across, along, values, cmap="viridis", vmin=limits[0], vmax=limits[1], rcount=200, ccount=200,
        linewidth=0.3, edgecolor="#ffffff55", antialiased=True,
    )  # fmt: skip
    axes.set_xlabel(_axis(data, x), fontsize=9.5, labelpad=9)
    axes.set_ylabel(_axis(data, y), fontsize=9.5, labelpad=9)
    axes.set_zlabel(label, fontsize=9.5, labelpad=7)
    axes.tick_params(labelsize=8.5)
    axes.view_init(elev=26.0, azim=-128.0)
    axes.set_box_aspect((1.25, 1.1, 0.8), zoom=1.0)
    return surface


def _dress(axes: Axes, data: DataArray, x: str) -> None:
    axes.set_xlabel(_axis(data, x), fontsize=11)
    axes.tick_params(labelsize=10)
    dress(axes)
    for axis in (axes.xaxis, axes.yaxis):
        formatter = axis.get_major_formatter()
        if hasattr(formatter, "set_useOffset"):
            formatter.set_useOffset(False)
    if _numeric(np.atleast_1d(data[x].values).tolist()):
        axes.locator_params(axis="x", nbins=7)


def _axis(data: DataArray, key: str) -> str:
    return f"{key}{_unit(data, key, brackets=True)}"


def _unit(data: DataArray, key: str, brackets: bool = False) -> str:
    unit = str(data[key].attrs.get("units", ""))
    if unit in ("", "1", "-"):
        return ""
    return f" [{unit}]" if brackets else f" {unit}"


def _numeric(values: Iterable[object]) -> bool:
    return all(map(is_number, values))


#: First that is there: what a sweep is made for, then what a static scene has.
_DEFAULTS = (K.name, Z_REAL.name, f"{STIFFNESS.name}:y,y", AXIAL_DISPLACEMENT.name)
_FIRST_X = ("excitation.speed_rpm", "kinematics.spin_speed_rpm")
_MOST_COLOURS = 8
_MOST_PANELS = 6


@attrs.frozen(eq=False)
class _Layout:
    """A picture of one quantity.

    data : dimensions among ``x``, ``y`` and ``panels``, or ``point``; nan where there is no result; units and description in its
        attributes
    x, y : keys; in curves y is what the colours stand for and may be None
    panels : key of one panel a value, or None;  title, remark : first line over the picture, and a second, smaller one
    """

    data: DataArray
    name: str
    kind: str
    x: str
    y: str | None
    panels: str | None
    title: str
    remark: str

    def write(self, path: Path) -> Path:
        """Draw it.

        RacewayError: matplotlib is missing, or the file cannot be written.
        """
        return write(draw(self), path)


def layout(
    selection: Selection, value: str | None = None, kind: str | None = None, x: str | None = None, y: str | None = None
) -> _Layout:
    """Choose what was left open.

    Parameters
    ----------
    value : variable, with labels of its other dimensions after a colon: ``p0``, ``stiffness:y,y``, ``displacement:x``
    kind : "curves", "map" or "surface"

    Raises
    ------
    SceneError
        Unknown names, axes that do not vary or have no numbers, and axes left over, each with what to type.
    RacewayError
        Nothing varies, or nothing is finished.
    """
    if not names(selection.dataset):
        raise RacewayError("no point is done yet: compute them with raceway sweep ... --resume")
    data, name = quantity(selection.dataset, value)
    axes = selection.axes
    if not axes:
        raise RacewayError("nothing varies in this part of the sweep: leave out an --at, or see the values with --json")
    if not bool(data.notnull().any()):
        raise RacewayError(f"no selected point has a {name}: {selection.gaps or 'none was finished'}")
    mistakes, varying = list[Mistake](), list(axes)
    for option, key in (("--x", x), ("--y", y)):
        if key is None or key in varying:
            continue
        why = f"is not an axis of this sweep{nearest(key, varying)}"
        if key in selection.fixed:
            why = f"has the one value {shown(selection.fixed[key])} here"
        mistakes.append(Mistake(option, key, f"{why}; axes that vary: {', '.join(varying)}"))
    if x is not None and x == y:
        mistakes.append(Mistake("--y", y, "is the axis of --x already: choose another, or leave one out"))
    if mistakes:
        raise SceneError(mistakes)
    numeric = [key for key, values in axes.items() if _numeric(values)]
    both = len(axes) == 2 and len(numeric) == 2
    kind = kind or ("map" if both and min(len(values) for values in axes.values()) > _MOST_COLOURS else "curves")
    if not x and not (others := [key for key in numeric or axes if key != y]):
        raise RacewayError(f"{kind}: no axis is left for x: leave out --y, or an --at")
    x = x or min(others, key=lambda key: (key not in _FIRST_X, -len(axes[key])))
    other_axes = [key for key in axes if key != x]
    if kind != "curves":
        y = y or next(iter(sorted((key for key in other_axes if key in numeric), key=lambda key: -len(axes[key]))), None)
        if y is None:
            raise SceneError.at("--kind", kind, f"takes two axes with numbers, and only {x} varies: choose --kind curves")
        for option, key in (("--x", x), ("--y", y)):
            if key not in numeric:
                raise SceneError.at(option, key, f"has words as values, a {kind} needs numbers: choose --kind curves")
    else:
        apart = [key for key in other_axes if len(axes[key]) <= _MOST_COLOURS]  # can be told apart by their colours
        y = y or max(apart or other_axes, key=lambda key: len(axes[key]), default=None)
    over = [key for key in other_axes if key != y]
    panels = over[0] if len(over) == 1 and len(axes[over[0]]) <= _MOST_PANELS and LIST not in data.dims else None
    if rest := [key for key in over if key != panels]:
        words = "varies, too ({}), and {} cannot show it: choose one with --at {}={}"
        raise SceneError(
            [Mistake(key, None, words.format(listed(axes[key]), kind, key, shown(axes[key][0]))) for key in rest]
        )
    if kind == "surface" and LIST in data.dims:
        raise RacewayError("the points of this sweep fill no grid, which a surface needs: choose --kind map or curves")
    constants = ", ".join(f"{key} = {shown(v)}" for key, v in selection.fixed.items())
    remark = "; ".join(part for part in (constants, f"without result: {selection.gaps}" if selection.gaps else "") if part)
    return _Layout(data, name, kind, x, y, panels, selection.title, remark)


#: Symbol -> name.
_NAMES = {number.symbol: number.name for number in COLUMNS.values()} | {"kxx": "stiffness:x,x", "kyy": "stiffness:y,y"}


def quantity(dataset: Dataset, text: str | None) -> tuple[DataArray, str]:
    """A variable by its name or symbol, with the labels of its other dimensions chosen.

    Raises
    ------
    SceneError
        A name that is not there, or labels that do not fit.
    """
    if text is None:
        text = next((name for name in _DEFAULTS if name.partition(":")[0] in dataset), None)
        if text is None:
            raise RacewayError(f"choose what to draw with --plot: {', '.join(names(dataset))}")
    text = _NAMES.get(text, text)
    name, _, labels = text.partition(":")
    if name not in dataset or dataset[name].dtype.kind not in "fiu":
        variables = names(dataset)
        raise SceneError.at(
            "--plot", text, f"is not a quantity of this sweep{nearest(name, variables)}; there are {', '.join(variables)}"
        )
    data = dataset[name]
    dimensions = [str(dim) for dim in data.dims if "." not in str(dim) and dim != LIST]
    entry = [label.strip() for label in labels.split(",") if label.strip()]
    if len(entry) != len(dimensions):
        choices = [[str(label) for label in data[dim].values] for dim in dimensions]
        example = ",".join(options[min(1, len(options) - 1)] for options in choices)
        message = f"takes {len(dimensions)} labels after a colon{f', for instance {name}:{example}' if dimensions else ''}; {len(entry)} given"
        raise SceneError.at("--plot", text, message)
    for dim, label in zip(dimensions, entry, strict=True):
        coordinates = [str(coordinate) for coordinate in data[dim].values]
        if label not in coordinates:
            why = f"has no '{label}'{nearest(label, coordinates)}; there are {', '.join(coordinates)}"
            raise SceneError.at("--plot", text, why)
        data = data.isel({dim: coordinates.index(label)})
    data = data.copy()  # its attributes change
    if dimensions:
        data.name = text
        data.attrs["units"] = entry_unit(str(data.attrs.get("units", "")), entry)
    return data, text


def names(dataset: Dataset) -> list[str]:
    """Variables with numbers."""
    return [str(name) for name, data in dataset.data_vars.items() if data.dtype.kind in "fiu"]
