"""The picture of a comparison: its quantities as small multiples."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Sequence
from itertools import product
from typing import TYPE_CHECKING

from raceway.answers.picture import COLOURS, GREY, MARKERS, dress, given_axes, new_figure, wrapped
from raceway.answers.quantities import KXX, K, Quantity
from raceway.points.axes import shown
from raceway.points.effects import MOVING, Findings, Row
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

_LINES = ("-", "--", ":", "-.", (0, (6, 1, 1, 1, 1, 1)))
_MOST_COLUMNS = 4


def draw(comparison: Findings) -> Figure:
    """K above |Z|, of static scenes kxx, kyy and x, over the axis of numbers with most values; without one, a dot for each run.

    Columns are the values of the axis that interacts with it most; colour, line and marker those of the next ones.
    """
    along, quantities = _along(comparison), list(comparison.quantities.values())
    if along is None:
        figure = new_figure(9.0, 2.2 + 0.32 * len(comparison.rows))
        panels = figure.subplots(1, len(quantities), sharey=True)
        for quantity, panel in zip(quantities, panels, strict=True):
            _dots_on(panel, comparison.rows, quantity)
        _name_lines(panels[0], comparison)
        figure.suptitle(wrapped(f"{_title(quantities)}: {comparison.title}"), fontsize=12)
        return figure
    texts = {key: [shown(value) for value in comparison.axis(key).values] for key in _by_interaction(comparison, along)}
    column = next((key for key in list(texts)[:1] if len(texts[key]) <= _MOST_COLUMNS), None)
    styles = {key: values for key, values in texts.items() if key != column}
    columns = texts[column] if column else [""]
    figure = new_figure(9.0, 6.4)
    one_scale = len({quantity.unit for quantity in quantities}) == 1
    panels = figure.subplots(len(quantities), len(columns), sharex=True, sharey="col" if one_scale else "row", squeeze=False)
    for column_number, value in enumerate(columns):
        rows = [row for row in comparison.rows if column is None or shown(row.point[column]) == value]
        for quantity, panel in zip(quantities, panels[:, column_number], strict=True):
            limits = _limits(rows, quantities) if one_scale else _limits(comparison.rows, [quantity])
            _curves(panel, rows, quantity, along, styles, limits)
            panel.set_ylabel(quantity.axis if column_number == 0 else "")
        panels[0, column_number].set_title(f"{column} = {value}" if column else "", fontsize=12)
        panels[-1, column_number].set_xlabel(along)
        panels[-1, column_number].locator_params(axis="x", nbins=5)
    figure.suptitle(wrapped(f"{_title(quantities)} over {along}: {comparison.title}"), fontsize=12)
    if handles := _handles(styles, any(map(_in_doubt, comparison.rows))):
        figure.legend(handles=handles, loc="outside lower center", ncols=min(4, len(handles)), frameon=False, fontsize=10.5)
    return figure


def draw_on(comparison: Findings, name: str, axes: Axes | None) -> Axes:
    """One quantity of a comparison on axes."""
    along, quantities, rows = _along(comparison), comparison.quantities, comparison.rows
    panel, quantity = given_axes(axes, 8.0, 5.0), quantities[name]
    if along is None:
        _dots_on(panel, rows, quantity)
        _name_lines(panel, comparison)
        return panel
    styles = {axis.key: [shown(value) for value in axis.values] for axis in comparison.varied if axis.key != along}
    limits = _limits(rows, quantities.values() if name in MOVING else [quantity])
    _curves(panel, rows, quantity, along, styles, limits)
    panel.set_xlabel(along)
    panel.set_ylabel(quantity.axis)
    if handles := _handles(styles, any(map(_in_doubt, rows))):
        panel.legend(handles=handles, frameon=False, fontsize=9)
    return panel


def _along(comparison: Findings) -> str | None:
    """Key of the axis of numbers with most values."""
    numeric = [axis for axis in comparison.varied if axis.numeric]
    return max(numeric, key=lambda axis: len(axis.values)).key if numeric else None


def _title(quantities: Iterable[Quantity]) -> str:
    *symbols, last = (quantity.symbol for quantity in quantities)
    return f"{', '.join(symbols)} and {last}"


def _value_of(row: Row, quantity: Quantity) -> float | None:
    """In the unit that people read it in; None where the run gave none."""
    value = row.value(quantity.name)
    return None if value is None else quantity.read(value)


def _in_doubt(row: Row) -> bool:
    """Whether a row with a number is left out of the explanation."""
    return row.doubt is not None and not row.failed


def _curves(
    panel: Axes,
    rows: Sequence[Row],
    quantity: Quantity,
    along: str,
    styles: dict[str, list[str]],
    limits: tuple[float, float],
) -> None:
    """One curve for each combination of the styled axes, broken where a run failed or is unreliable; those are crosses, at the edge
    where they lie outside."""
    for combination in product(*styles.values()):
        series = [row for row in rows if all(shown(row.point[k]) == v for k, v in zip(styles, combination, strict=True))]
        series = sorted(series, key=lambda row: row.point[along])
        look = _look([values.index(text) for values, text in zip(styles.values(), combination, strict=True)])
        bad = [row for row in series if _in_doubt(row)]
        good = [math.nan if row.doubt or (v := _value_of(row, quantity)) is None else v for row in series]
        panel.plot([row.point[along] for row in series], good, **look)
        edge = [min(max(_value_of(row, quantity) or 0.0, limits[0]), limits[1]) for row in bad]
        (cross,) = panel.plot([row.point[along] for row in bad], edge, "x", color=look["color"], clip_on=False)
        cross.set_in_layout(False)  # an artist that is not clipped would count for the layout, wherever it lies
    panel.set_ylim(limits)
    dress(panel)


def _limits(rows: Sequence[Row], quantities: Collection[Quantity]) -> tuple[float, float]:
    """Range of quantities together, so that panels of a column have one scale; unreliable runs do not count."""
    sound = [row for row in rows if not _in_doubt(row)] or rows
    values = [v for row in sound for quantity in quantities if (v := _value_of(row, quantity)) is not None] or [0.0, 1.0]
    margin = 0.06 * (max(values) - min(values)) or 0.01 * abs(max(values)) or 1.0
    return min(values) - margin, max(values) + margin


def _look(places: list[int]) -> Tables:
    """Line style of a combination: the first styled axis sets the colour, the second the line, the third the marker."""
    colour, line, marker = (*places[:3], *[0] * (3 - len(places[:3])))
    tone = COLOURS[colour % len(COLOURS)]
    return {
        "color": tone,
        "linestyle": _LINES[line % len(_LINES)],
        "marker": MARKERS[marker % len(MARKERS)],
        "markerfacecolor": tone if marker % 2 == 0 else "white",
        "markersize": 5.5 if marker % 2 == 0 else 7.5,
        "linewidth": 1.6,
    }


def _handles(styles: dict[str, list[str]], doubt: bool) -> list[Line2D]:
    """An entry for each value of each styled axis, in the trait that shows it."""
    from matplotlib.lines import Line2D

    handles = []
    for trait, (key, values) in enumerate(list(styles.items())[:3]):
        for k, value in enumerate(values):
            look = _look([k if n == trait else 0 for n in range(3)])
            if trait > 0:
                look |= {"color": GREY, "markerfacecolor": GREY if look["markerfacecolor"] != "white" else "white"}
            look |= {"marker": ""} if trait < 2 else {"linestyle": ""}
            handles.append(Line2D([], [], label=f"{key} = {value}", **look))
    if doubt:
        handles.append(Line2D([], [], linestyle="", marker="x", color=GREY, label="unreliable: not in the effects"))
    return handles


def _dots_on(panel: Axes, rows: Sequence[Row], quantity: Quantity) -> None:
    for line, row in enumerate(rows):
        value = _value_of(row, quantity)
        if value is not None:
            panel.plot([value], [line], "x" if _in_doubt(row) else "o", color=COLOURS[0], markersize=8)
        else:
            words = row.result.get("status", "no value")
            panel.annotate(words, (0.02, line), xycoords=("axes fraction", "data"), va="center")
    panel.set_xlabel(quantity.axis)
    panel.locator_params(axis="x", nbins=5)
    dress(panel)


def _name_lines(panel: Axes, comparison: Findings) -> None:
    keys = [axis.key for axis in comparison.varied]
    words = [", ".join(f"{key.rpartition('.')[2]} = {shown(row.point[key])}" for key in keys) for row in comparison.rows]
    panel.set_yticks(range(len(words)), [word or "the scene" for word in words])
    panel.set_ylim(len(words) - 0.5, -0.5)


def _by_interaction(comparison: Findings, along: str) -> list[str]:
    """The other varied axes, those first that change the effect of ``along`` on K most."""

    def strength(key: str) -> float:
        changes = [
            abs(effect.log_change)
            for name, effect in comparison.terms
            if name in (K.name, KXX.name) and set(effect.term) == {key, along}
        ]
        return max(changes, default=0.0)

    return sorted((axis.key for axis in comparison.varied if axis.key != along), key=lambda key: -strength(key))
