"""The picture of a comparison: its quantities as small multiples."""

from __future__ import annotations

import math
from collections.abc import Iterable
from itertools import product
from typing import TYPE_CHECKING

from raceway.out.picture import given_axes, new_figure
from raceway.out.quantities import KXX, K, Quantity
from raceway.points.axes import is_number
from raceway.points.axes import shown as _text
from raceway.points.effects import MOVING, STATIC, Row
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

_COLOURS = ("#0b5fa5", "#c8501e", "#2a8f5b", "#8a4fa3", "#b58a00", "#555f6b")
_LINES = ("-", "--", ":", "-.", (0, (6, 1, 1, 1, 1, 1)))
_MARKERS = ("o", "s", "^", "D", "v", "P")
_MOST_COLUMNS = 4


def draw(result: Tables) -> Figure:
    """K above |Z|, of static scenes kxx, kyy and x, over the axis of numbers with most values; without one, a dot for each run.

    Columns are the values of the axis that interacts with it most; colour, line and marker those of the next ones.
    """
    axes = {axis["key"]: axis["values"] for axis in result["axes"]}
    varied = [key for key, values in axes.items() if len(values) > 1]
    numeric = [key for key in varied if all(is_number(v) for v in axes[key])]
    along = max(numeric, key=lambda key: len(axes[key]), default=None)
    if along is None:
        return _dots(result, varied)
    styled = _by_interaction([key for key in varied if key != along], along, result["effects"])
    column = next((key for key in styled[:1] if len(axes[key]) <= _MOST_COLUMNS), None)
    styles = {key: [_text(v) for v in axes[key]] for key in styled if key != column}
    columns = [_text(v) for v in axes[column]] if column else [""]
    figure = new_figure(12.8, 7.6)
    quantities = _quantities_of(result)
    one_scale = len({about.unit for about in quantities.values()}) == 1
    panels = figure.subplots(len(quantities), len(columns), sharex=True, sharey="col" if one_scale else "row", squeeze=False)
    for column_number, value in enumerate(columns):
        rows = [row for row in result["rows"] if column is None or _text(row["point"][column]) == value]
        for (quantity, about), panel in zip(quantities.items(), panels[:, column_number], strict=True):
            limits = _limits(rows, quantities) if one_scale else _limits(result["rows"], [quantity])
            _curves(panel, rows, quantity, along, styles, limits)
            panel.set_ylabel(about.axis if column_number == 0 else "")
        panels[0, column_number].set_title(f"{column} = {value}" if column else "", fontsize=12)
        panels[-1, column_number].set_xlabel(along)
    figure.suptitle(f"{_named(quantities)} over {along}: {result['title']}", fontsize=13)
    _legend(figure, styles, any(map(_in_doubt, result["rows"])))
    return figure


def draw_on(result: Tables, quantity: str, axes: Axes | None) -> Axes:
    """One quantity of a comparison on axes."""
    values_of = {axis["key"]: axis["values"] for axis in result["axes"]}
    varied = [key for key, values in values_of.items() if len(values) > 1]
    along = max(
        (key for key in varied if all(map(is_number, values_of[key]))), key=lambda key: len(values_of[key]), default=None
    )
    panel = given_axes(axes, 8.0, 5.0)
    if along is None:
        _dots_on(panel, result["rows"], quantity)
        panel.set_yticks(range(len(result["rows"])), _names(result["rows"], varied))
        panel.set_ylim(len(result["rows"]) - 0.5, -0.5)
        return panel
    styles = {key: [_text(value) for value in values_of[key]] for key in varied if key != along}
    quantities = _quantities_of(result)
    limits = _limits(result["rows"], quantities if quantity in MOVING else [quantity])
    _curves(panel, result["rows"], quantity, along, styles, limits)
    panel.set_xlabel(along)
    panel.set_ylabel(quantities[quantity].axis)
    if handles := _handles(styles, any(map(_in_doubt, result["rows"]))):
        panel.legend(handles=handles, frameon=False, fontsize=9)
    return panel


def _quantities_of(result: Tables) -> dict[str, Quantity]:
    """What was compared."""
    rows = (Row(row["point"], row["result"]) for row in result["rows"])
    return next((row.quantities for row in rows if not row.failed), MOVING)


def _named(quantities: Iterable[str]) -> str:
    *labels, last = ((MOVING | STATIC)[name].symbol for name in quantities)
    return f"{', '.join(labels)} and {last}"


def _value_of(row: Tables, quantity: str) -> float | None:
    """A quantity of a row on the screen's scale; None where the run gave none."""
    value = Row(row["point"], row["result"]).value(quantity)
    return None if value is None else (MOVING | STATIC)[quantity].read(value)


def _in_doubt(row: Tables) -> bool:
    """Whether a row with a number is left out of the explanation."""
    return row.get("doubt") is not None and "reason" not in row["result"]


def _curves(
    panel: Axes,
    rows: list[Tables],
    quantity: str,
    along: str,
    styles: dict[str, list[str]],
    limits: tuple[float, float],
) -> None:
    """One curve for each combination of the styled axes, broken where a run failed or is in doubt; those are crosses, at the edge
    where they lie outside."""
    for combination in product(*styles.values()):
        series = [row for row in rows if all(_text(row["point"][k]) == v for k, v in zip(styles, combination, strict=True))]
        series = sorted(series, key=lambda row: row["point"][along])
        look = _look([values.index(text) for values, text in zip(styles.values(), combination, strict=True)])
        bad = [row for row in series if _in_doubt(row)]
        good = [math.nan if row.get("doubt") or (v := _value_of(row, quantity)) is None else v for row in series]
        panel.plot([row["point"][along] for row in series], good, **look)
        clipped = [min(max(_value_of(row, quantity) or 0.0, limits[0]), limits[1]) for row in bad]
        (cross,) = panel.plot([row["point"][along] for row in bad], clipped, "x", color=look["color"], clip_on=False)
        cross.set_in_layout(False)  # an artist that is not clipped would count for the layout, wherever it lies
    panel.set_ylim(limits)
    panel.grid(True, color="#e3e7eb", linewidth=0.8)
    panel.set_axisbelow(True)
    panel.spines[["top", "right"]].set_visible(False)


def _limits(rows: list[Tables], quantities: Iterable[str]) -> tuple[float, float]:
    """Range of quantities together, so that panels of a column have one scale; runs in doubt do not count."""
    counted = [row for row in rows if not _in_doubt(row)] or rows
    values = [v for row in counted for quantity in quantities if (v := _value_of(row, quantity)) is not None] or [0.0, 1.0]
    margin = 0.06 * (max(values) - min(values)) or 0.01 * abs(max(values)) or 1.0
    return min(values) - margin, max(values) + margin


def _look(places: list[int]) -> Tables:
    """Line style of a combination: the first styled axis sets the colour, the second the line, the third the marker."""
    colour, line, marker = (*places[:3], *[0] * (3 - len(places[:3])))
    tone = _COLOURS[colour % len(_COLOURS)]
    return {
        "color": tone,
        "linestyle": _LINES[line % len(_LINES)],
        "marker": _MARKERS[marker % len(_MARKERS)],
        "markerfacecolor": tone if marker % 2 == 0 else "white",
        "markersize": 5.5 if marker % 2 == 0 else 7.5,
        "linewidth": 1.6,
    }


def _legend(figure: Figure, styles: dict[str, list[str]], doubt: bool) -> None:
    """One legend for the figure."""
    if handles := _handles(styles, doubt):
        figure.legend(handles=handles, loc="outside lower center", ncols=min(4, len(handles)), frameon=False, fontsize=10.5)


def _handles(styles: dict[str, list[str]], doubt: bool) -> list[Line2D]:
    """An entry for each value of each styled axis, in the trait that shows it."""
    from matplotlib.lines import Line2D

    handles = []
    for trait, (key, values) in enumerate(list(styles.items())[:3]):
        for k, value in enumerate(values):
            look = _look([k if n == trait else 0 for n in range(3)])
            if trait > 0:
                look |= {"color": "#555f6b", "markerfacecolor": "#555f6b" if look["markerfacecolor"] != "white" else "white"}
            look |= {"marker": ""} if trait < 2 else {"linestyle": ""}
            handles.append(Line2D([], [], label=f"{key} = {value}", **look))
    if doubt:
        handles.append(Line2D([], [], linestyle="", marker="x", color="#555f6b", label="in doubt: not in the effects"))
    return handles


def _dots(result: Tables, varied: list[str]) -> Figure:
    """A dot for each run, where no axis has numbers: one line a combination, the quantities side by side."""
    rows, quantities = result["rows"], _quantities_of(result)
    figure = new_figure(12.8, 2.2 + 0.32 * len(rows))
    panels = figure.subplots(1, len(quantities), sharey=True)
    for quantity, panel in zip(quantities, panels, strict=True):
        _dots_on(panel, rows, quantity)
    panels[0].set_yticks(range(len(rows)), _names(rows, varied))
    panels[0].set_ylim(len(rows) - 0.5, -0.5)
    figure.suptitle(f"{_named(quantities)}: {result['title']}", fontsize=13)
    return figure


def _dots_on(panel: Axes, rows: list[Tables], quantity: str) -> None:
    for line, row in enumerate(rows):
        value = _value_of(row, quantity)
        if value is not None:
            panel.plot([value], [line], "x" if _in_doubt(row) else "o", color=_COLOURS[0], markersize=8)
        else:
            words = row["result"].get("status", "no value")
            panel.annotate(words, (0.02, line), xycoords=("axes fraction", "data"), va="center")
    panel.set_xlabel((MOVING | STATIC)[quantity].axis)
    panel.grid(True, color="#e3e7eb", linewidth=0.8)
    panel.spines[["top", "right"]].set_visible(False)


def _names(rows: list[Tables], varied: list[str]) -> list[str]:
    words = (", ".join(f"{key.rpartition('.')[2]} = {_text(row['point'][key])}" for key in varied) for row in rows)
    return [word or "the scene" for word in words]


def _by_interaction(keys: list[str], along: str, effects: list[Tables]) -> list[str]:
    """The axes, those first that change the effect of ``along`` on K most."""

    def strength(key: str) -> float:
        changes = [
            abs(e["log_change"]) for e in effects if e["quantity"] in (K.name, KXX.name) and set(e["term"]) == {key, along}
        ]
        return max(changes, default=0.0)

    return sorted(keys, key=lambda key: -strength(key))
