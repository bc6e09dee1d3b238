"""The picture of a band: samples of each quantity with the limits of 95 % of them, and below which tolerance causes their spread."""

from __future__ import annotations

from textwrap import wrap
from typing import TYPE_CHECKING

import numpy as np

from raceway.framework.shown import read_in
from raceway.plugins.pictures import new_figure
from raceway.storage.tables import ReadTables

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_SAMPLES, _LIMITS, _TOTAL, _FIRST = "#b9c9da", "#0b5fa5", "#b9c9da", "#0b5fa5"


def draw(content: ReadTables) -> Figure:
    """A column a quantity: histogram of its samples, and bars of Sobol indices where they are known."""
    quantities, keys = content["quantities"], [one["key"] for one in content["tolerances"]]
    known = any(one["total"] is not None for one in quantities.values())
    wide, high = 2.0 + 2.9 * len(quantities), 3.2 + (1.2 + 0.35 * len(keys) if known else 0.0)
    figure = new_figure(wide, high)
    rows = figure.subplots(
        2 if known else 1, len(quantities), squeeze=False, height_ratios=[2.2, 0.8 + 0.35 * len(keys)] if known else [1.0]
    )
    for k, (name, one) in enumerate(quantities.items()):
        _histogram(rows[0, k], name, one)
        if known:
            _indices(rows[1, k], one, keys, named=k == 0)
    if known:
        handles, labels = rows[1, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower right", ncols=2, fontsize=8, frameon=False)
    rows[0, 0].set_ylabel("samples", fontsize=9)
    figure.suptitle("\n".join(line for text in content["title"].splitlines() for line in wrap(text, 90)), fontsize=11)
    return figure


def _histogram(axes: Axes, name: str, one: ReadTables) -> None:
    (value, unit), (low, _), (high, _) = (read_in(one[end], one["unit"]) for end in ("value", "low", "high"))
    edges = [read_in(edge, one["unit"])[0] for edge in one["histogram"]["edges"]]
    axes.stairs(one["histogram"]["counts"], edges, fill=True, color=_SAMPLES)
    for end in (low, high):
        axes.axvline(end, color=_LIMITS, linewidth=1.2)
    axes.axvline(value, color="#555f6b", linewidth=1.0, linestyle="--")
    axes.set_title(f"{name.replace('_', ' ')}\n{low:.5g} to {high:.5g} {unit}", fontsize=10)
    axes.set_xlabel(unit, fontsize=9)
    axes.tick_params(labelsize=8)
    axes.locator_params(axis="x", nbins=4)


def _indices(axes: Axes, one: ReadTables, keys: list[str], named: bool) -> None:
    places = np.arange(len(keys))
    axes.set_xlim(0.0, 1.05)
    axes.set_ylim(len(keys) - 0.4, -0.6)
    axes.set_yticks(places, keys if named else [""] * len(keys), fontsize=8)
    axes.set_xlabel("Sobol' index", fontsize=9)
    axes.tick_params(axis="x", labelsize=8)
    # Estimates of small indices scatter about 0, those of a single cause about 1.
    total, first = (np.clip(one[what] or np.zeros(len(keys)), 0.0, 1.0) for what in ("total", "first_order"))
    axes.barh(places, total, color=_TOTAL, height=0.7, label="total")
    axes.barh(places, first, color=_FIRST, height=0.3, label="first order")
