"""Layout of a sweep's pictures: the quantity, the axes for x, colour and panels, the kind of picture; panels of a comparison."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

import attrs
import numpy as np

from raceway.answers.picture import Line, Plot, draw_panels, label_axes, new_figure, save_figure, wrapped
from raceway.answers.quantities import AXIAL_DISPLACEMENT, COLUMNS, STIFFNESS, Z_REAL, K, Quantity, entry_unit, read_in
from raceway.errors import Mistake, RacewayError, SceneError
from raceway.framework.options import nearest
from raceway.pipeline.uncertainty import of_ratio
from raceway.points.axes import Axis, is_number, places_of, shown
from raceway.points.effects import Findings, Row
from raceway.points.selection import LIST, Selection, listed
from raceway.scene.designation import GEOMETRY

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import Collection
    from matplotlib.figure import Figure
    from xarray import DataArray, Dataset

_NO_RESULT = "#c3cad1"


def draw(layout: _Layout) -> Figure:
    """The picture of a layout; RacewayError without matplotlib."""
    data, kind = layout.data, layout.kind
    factor, unit = read_in(1.0, str(data.attrs.get("units", "")))
    name = str(data.name).replace("_", " ").replace(":", " ")
    words = str(data.attrs.get("description", ""))
    label = name if unit in ("", "1") else f"{name} [{unit}]"
    heading = name if words in ("", name) else f"{name}: {words}"
    title = "\n".join((heading, layout.title, layout.remark)).strip()
    parts = layout.parts(factor)
    if kind == "curves":
        panels = [_curves(layout, part, label, words) for words, part in parts]
        columns = 3 if len(panels) == 3 else 2
        lines = [panels[k : k + columns] for k in range(0, len(panels), columns)]
        return draw_panels(lines, title, "" if layout.y is None else axis_of(data, layout.y).label)
    columns = min(len(parts), 3)
    rows, flat = -(-len(parts) // columns), kind == "map"
    figure = new_figure(*((2.0 + 4.0 * columns, 1.2 + 4.0 * rows) if len(parts) > 1 else (8.6, 5.6)))
    frame = {} if flat else {"projection": "3d"}
    grid = figure.subplots(rows, columns, squeeze=False, sharex=flat, sharey=flat, subplot_kw=frame)
    values = factor * data.values
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    if high - low <= 1e-9 * abs(high):
        low, high = low - 0.01 * abs(low or 1.0), high + 0.01 * abs(high or 1.0)
    x, y = axis_of(data, layout.x).label, axis_of(data, layout.y or layout.x).label
    for place, ((words, (part, *_)), axes) in enumerate(zip(parts, grid.flat, strict=False)):
        if flat:
            label_axes(axes, words, x, "" if place % columns else y)
            cells = _map(axes, part, layout.x, layout.y or "", (low, high))
        else:
            across = np.meshgrid(part[layout.x].values, part[layout.y].values)
            axes.plot_surface(*across, part.transpose(layout.y, layout.x).values, cmap="viridis", vmin=low, vmax=high, rcount=200,
                              ccount=200, linewidth=0.3, edgecolor="#ffffff55", antialiased=True)  # fmt: skip
            label_axes(axes, words, x, y, 9.5)
            axes.set_zlabel(label, fontsize=9.5, labelpad=7)
            axes.xaxis.labelpad = axes.yaxis.labelpad = 9
            axes.view_init(elev=26.0, azim=-128.0)
            axes.set_box_aspect((1.25, 1.1, 0.8), zoom=1.0)
    for axes in grid.flat[len(parts) :]:
        axes.set_visible(False)
    if flat:
        figure.colorbar(cells, ax=grid, shrink=0.95, pad=0.015, label=label).outline.set_visible(False)
    figure.suptitle(wrapped(title, 84), fontsize=11.5)
    return figure


def _curves(layout: _Layout, parts: Sequence[DataArray], label: str, title: str) -> Plot:
    """A curve for each value of y; the points of a list without lines, since they may have no order."""
    data, as_list = parts[0], LIST in parts[0].dims
    along = axis_of(data, layout.x)
    names = () if along.numeric else tuple(dict.fromkeys(map(shown, along.values)))
    own = () if layout.y is None else axis_of(data, layout.y).values
    values = tuple(sorted(own) if all(map(is_number, own)) else dict.fromkeys(own)) or (None,)
    curves = list[Line]()
    for place, value in enumerate(values):
        choice = {} if value is None else {LIST if as_list else layout.y: [one == value for one in own]}
        series = [part.isel({dim: np.flatnonzero(keep) for dim, keep in choice.items()}) for part in parts]
        x = [names.index(shown(one)) if names else one for one in np.atleast_1d(series[0][layout.x].values).tolist()]
        y, *ends = (np.atleast_1d(one.values).ravel() for one in series)
        low, high = ends or (None, None)
        style, base = {"linestyle": ""} if as_list or names else {}, curves[0] if curves and not as_list else None
        shade = place / (len(values) - 1) if len(values) > 1 and all(map(is_number, values)) else None
        words = "" if value is None else shown(value)
        curves.append(Line(np.array(x, dtype=float), y, words, place, low, high, None, base, None, shade, style))
    return Plot(tuple(curves), along.label, label, title, names)


def _map(axes: Axes, data: DataArray, x: str, y: str, limits: tuple[float, float]) -> Collection:
    """A cell round each point; contours where every point has a result."""
    low, high = limits
    if LIST in data.dims:
        return axes.scatter(data[x].values, data[y].values, c=data.values, s=42, cmap="viridis", vmin=low, vmax=high)
    at_x, at_y = data[x].values, data[y].values
    values = data.transpose(y, x).values
    axes.set_facecolor(_NO_RESULT)
    axes.grid(False)
    cells = axes.pcolormesh(at_x, at_y, np.ma.masked_invalid(values), shading="nearest", cmap="viridis", vmin=low, vmax=high)
    if np.isfinite(values).all() and min(values.shape) >= 4:
        lines = axes.contour(at_x, at_y, values, levels=8, colors="white", linewidths=0.8, alpha=0.85)
        axes.clabel(lines, fontsize=8.5, fmt="%.4g")
    return cells


def axis_of(data: DataArray, key: str) -> Axis:
    """The values of a key, point by point of a list, with their unit."""
    return Axis(key, tuple(np.atleast_1d(data[key].values).tolist()), str(data[key].attrs.get("units", "")))


#: First that is there: what a sweep is made for, then what a static scene has.
_DEFAULTS = (K.name, Z_REAL.name, f"{STIFFNESS.name}:y,y", AXIAL_DISPLACEMENT.name)
_MOST_COLOURS = 8
#: Panels of a sweep or a comparison at most.
MOST_PANELS = 6


@attrs.frozen(eq=False)
class _Layout:
    """A picture of one quantity."""

    #: dimensions among ``x``, ``y`` and ``panels``, or ``point``; nan where there is no result; units and description in its
    #: attributes
    data: DataArray
    name: str
    kind: str
    #: x, y : keys; in curves y is what the colours stand for and may be None
    x: str
    y: str | None
    panels: str | None  # key of one panel a value, or None
    #: title, remark : lines over the picture
    title: str
    remark: str
    ends: tuple[DataArray, ...]  # of the quantity's interval, or none

    def parts(self, factor: float) -> list[tuple[str, list[DataArray]]]:
        """Of each panel its words, and the numbers in a unit that people read, then the ends of their intervals."""
        arrays = [
            one.copy(data=factor * one.values).assign_coords({key: one[key] for key in one.coords})
            for one in (self.data, *self.ends)
        ]
        if self.panels is None:
            return [("", arrays)]
        axis = axis_of(self.data, self.panels)
        return [(axis.words(value), [one.isel({axis.key: k}) for one in arrays]) for k, value in enumerate(axis.values)]

    def write(self, path: Path) -> Path:
        """Draw it; RacewayError without matplotlib, or where the file cannot be written."""
        return save_figure(draw(self), path)


def layout(
    selection: Selection, value: str | None = None, kind: str | None = None, x: str | None = None, y: str | None = None
) -> _Layout:
    """Choose what was left open.

    value : variable, with labels of its other dimensions after a colon: ``p0``, ``stiffness:y,y``, ``displacement:x``
    kind : "curves", "map" or "surface"

    SceneError: Unknown names, axes that do not vary or have no numbers, and axes left over, each with what to type.
    RacewayError: Nothing varies, or nothing is finished.
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
    found = [Axis(key, tuple(values)) for key, values in axes.items()]
    numeric = [axis.key for axis in found if axis.numeric]
    both = len(axes) == 2 and len(numeric) == 2
    kind = kind or ("map" if both and min(len(values) for values in axes.values()) > _MOST_COLOURS else "curves")
    if not x and not (others := [axis for axis in found if axis.key != y]):
        raise RacewayError(f"{kind}: no axis is left for x: leave out --y, or an --at")
    x = x or places_of(others, 1)[0].key
    other_axes = [key for key in axes if key != x]
    if kind != "curves":
        y = y or max((key for key in other_axes if key in numeric), key=lambda key: len(axes[key]), default=None)
        if y is None:
            raise SceneError.at("--kind", kind, f"takes two axes with numbers, and only {x} varies: choose --kind curves")
        for option, key in (("--x", x), ("--y", y)):
            if key not in numeric:
                raise SceneError.at(option, key, f"has words as values, a {kind} needs numbers: choose --kind curves")
    else:  # words first, then most numbers that can be told apart
        y = y or min(
            other_axes, key=lambda key: (key in numeric, len(axes[key]) > _MOST_COLOURS, -len(axes[key])), default=None
        )
    over = [key for key in other_axes if key != y]
    panels = over[0] if len(over) == 1 and len(axes[over[0]]) <= MOST_PANELS and LIST not in data.dims else None
    if rest := [key for key in over if key != panels]:
        words = "varies, too ({}), and {} cannot show it: choose one with --at {}={}"
        raise SceneError(
            [Mistake(key, None, words.format(listed(axes[key]), kind, key, shown(axes[key][0]))) for key in rest]
        )
    if kind == "surface" and LIST in data.dims:
        raise RacewayError("the points of this sweep fill no grid, which a surface needs: choose --kind map or curves")
    constants = ", ".join(f"{key} = {shown(v)}" for key, v in selection.fixed.items())
    remark = "; ".join(part for part in (constants, f"without result: {selection.gaps}" if selection.gaps else "") if part)
    wanted = [f"{_SYMBOLS.get(name)}_{end}" for end in ("low", "high")]
    ends = tuple(selection.dataset[end] for end in wanted) if set(wanted) <= set(selection.dataset) else ()
    return _Layout(data, name, kind, x, y, panels, selection.title, remark, ends)


#: Of quantities whose intervals a sweep may state.
_SYMBOLS = {K.name: K.symbol, f"{STIFFNESS.name}:y,y": "kyy"}
#: Symbol -> name.
_NAMES = {number.symbol: number.name for number in COLUMNS.values()} | {"kxx": "stiffness:x,x", "kyy": "stiffness:y,y"}


def quantity(dataset: Dataset, text: str | None) -> tuple[DataArray, str]:
    """A variable by its name or symbol, with the labels of its other dimensions chosen.

    SceneError: A name that is not there, or labels that do not fit.
    """
    if text is None:
        text = next((name for name in _DEFAULTS if name.partition(":")[0] in dataset), None)
        if text is None:
            raise RacewayError(f"choose what to draw with --plot: {', '.join(names(dataset))}")
    text = _NAMES.get(text, text)
    name, _, labels = text.partition(":")
    if name not in dataset or dataset[name].dtype.kind not in "fiu":
        variables = names(dataset)
        reason = f"is not a quantity of this sweep{nearest(name, variables)}; there are {', '.join(variables)}"
        raise SceneError.at("--plot", text, reason)
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


def comparison_panels(comparison: Findings, about: Quantity, most: int = MOST_PANELS) -> tuple[list[Plot], Axis | None]:
    """Panels of a quantity, at most so many, and the axis whose values are their curves; None: each is one curve."""
    along, of_curves, of_panels = places_of(comparison.varied or comparison.axes, most)
    names = () if along.numeric else tuple(map(shown, along.values))
    values = sorted(along.values) if along.numeric else list(along.values)
    if alone := bool(names) and not of_curves:  # each value is a curve of one point
        of_curves = [along]
    axes = [*of_panels, *of_curves, *([] if alone else [along])]
    at = {tuple(repr(row.point[axis.key]) for axis in axes): row for row in comparison.rows}
    stride, panels = math.prod(len(axis.values) for axis in of_curves[1:]), list[Plot]()
    same = not any(axis.key.removeprefix("bearing.") in ("preset", *GEOMETRY) for axis in of_curves[:1])
    for setting in product(*(axis.values for axis in of_panels)):
        lines, drawn = list[Line](), list[list[Row | None]]()
        for place, chosen in enumerate(product(*(axis.values for axis in of_curves))):
            points_along = [(*setting, *chosen, *end) for end in ([()] if alone else [(value,) for value in values])]
            drawn.append([at.get(tuple(map(repr, point))) for point in points_along])
            y, low, high, doubt = np.array([_numbers(row, about) for row in drawn[-1]]).T
            x = np.array([place] if alone else range(len(values)) if names else values, dtype=float)
            first, *more = [axis.words(value) for axis, value in zip(of_curves, chosen, strict=True)] or [""]
            words = ", ".join([shown(chosen[0]) if chosen else first, *more])
            base, apart = None, None
            if place >= stride:
                base, first_rows = lines[place % stride], drawn[place % stride]
                apart = np.array([_apart(*pair, about, same) for pair in zip(first_rows, drawn[-1], strict=True)]).T
            shade = place / (len(of_curves[0].values) - 1) if len(of_curves) == 1 and of_curves[0].numeric else None
            lines.append(Line(x, y, words, place, low, high, doubt, base, apart, shade, {"linestyle": ""} if names else {}))
        title = ", ".join(axis.words(value) for axis, value in zip(of_panels, setting, strict=True))
        panels.append(Plot(tuple(lines), along.label, about.axis, title, names))
    return panels, next(iter(of_curves), None)


def _numbers(row: Row | None, about: Quantity) -> tuple[float, float, float, float]:
    """Value, ends of its interval, and the value of a row in doubt, in the unit that people read it in; nan for what is not there."""
    value = None if row is None or row.failed else row.value(about.name)
    if row is None or value is None or row.doubt is not None:
        return math.nan, math.nan, math.nan, math.nan if value is None else about.read(value)
    entry = (row.result.get("uncertainty") or {}).get(about.name)
    low, high = (about.read(entry[end]) if entry else math.nan for end in ("low", "high"))
    return about.read(value), low, high, math.nan


def _apart(base: Row | None, row: Row | None, about: Quantity, same: bool) -> tuple[float, float]:
    """Interval of the quantity of a row over that of another, relative; nan where it is not known."""
    first, other = (
        None if one is None or one.doubt is not None else (one.result.get("uncertainty") or {}).get(about.name)
        for one in (base, row)
    )
    return of_ratio(first, other, same) if first and other else (math.nan, math.nan)
