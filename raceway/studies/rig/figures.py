"""Figures of a rig's study: what the procedures make of K, and the error by its causes."""

from __future__ import annotations

from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np

from raceway.plugins.pictures import new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from raceway.studies.rig.study import RigStudy

_COLOURS = ("#0b5fa5", "#c8501e", "#2a8f5b", "#8a4fa3")
_KINDS = {"none": "#2a8f5b", "correction": "#c8501e", "noise": "#0b5fa5", "window": "#8a4fa3", "run-out": "#b58a00", "model": "#555f6b"}  # fmt: skip
#: Errors below this are drawn at the edge.
_LEAST_PERCENT = 1e-4


def procedures(study: RigStudy) -> Figure:
    """True K over speed, and what each correction makes of it."""
    figure = new_figure(9.2, 3.8)
    loads = list(dict.fromkeys(point.axial for point in study.points))
    for panel, axial in zip(np.atleast_1d(figure.subplots(1, len(loads), sharey=True)), loads, strict=True):
        points = [point for point in study.points if point.axial == axial]
        speeds = [30.0 / np.pi * point.state.speed for point in points]
        panel.plot(speeds, [1e-6 * p.state.stiffness for p in points], color="#1c2733", marker="o", label="true")
        found = [1e-6 * p.found.state.stiffness for p in points]
        panel.plot(speeds, found, color=_COLOURS[2], marker="x", markersize=9, linestyle="", label="beam inverted")
        for place, style in ((0, "--"), (3, ":"), (5, "-.")):
            name = points[0].readings[place].correction
            values = [1e-6 * p.readings[place].stiffness for p in points]
            label = {"none": "no correction"}.get(name, name)
            panel.plot(speeds, values, color=_COLOURS[1], linestyle=style, marker=".", label=label)
        panel.set_title(f"{axial:g} N axial", fontsize=11)
        panel.set_xlabel("speed [r/min]")
        panel.set_xticks(speeds)
        panel.grid(color="#d8dee4", linewidth=0.7)
    # One scale for all panels, and set when all are drawn: a limit that is set holds, whatever comes after it.
    figure.axes[0].set_ylim(bottom=0.0)
    figure.axes[0].set_ylabel("K [N/µm]")
    figure.legend(
        *figure.axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=3, frameon=False, fontsize=9
    )
    return figure


def causes(study: RigStudy) -> Figure:
    """Error of K by one cause at a time: a dot for each speed and load, on a logarithmic scale."""
    names = list(dict.fromkeys((cause.kind, cause.what) for point in study.points for cause in point.causes))
    figure = new_figure(9.2, 0.34 * len(names) + 1.1)
    axes: Axes = figure.subplots()
    for row, (kind, what) in enumerate(reversed(names)):
        errors = [100.0 * abs(c.error) for p in study.points for c in p.causes if (c.kind, c.what) == (kind, what)]
        sizes = np.maximum(errors, _LEAST_PERCENT)
        axes.plot(sizes, np.full(len(sizes), row), "o", color=_KINDS[kind], markersize=5, alpha=0.75)
    words = [fill(f"{kind}: {what}" if kind != "none" else what, 46) for kind, what in reversed(names)]
    axes.set_yticks(range(len(names)), words, fontsize=8)
    axes.set_xscale("log")
    largest = 100.0 * max(abs(cause.error) for point in study.points for cause in point.causes)
    axes.set_xlim(0.8 * _LEAST_PERCENT, max(200.0, 1.5 * largest))
    for limit in (1.0, 3.0):
        axes.axvline(limit, color="#1c2733", linewidth=0.8, linestyle="--")
        axes.annotate(
            f"{limit:g} %", (limit, 1.0), (0, 2), xycoords=("data", "axes fraction"), textcoords="offset points",
            ha="center", va="bottom", fontsize=8,
        )  # fmt: skip
    axes.set_xlabel("error of K by this cause alone [%]")
    axes.grid(color="#d8dee4", linewidth=0.7)
    axes.set_axisbelow(True)
    return figure
