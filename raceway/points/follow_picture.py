"""Picture of a followed branch: amplitude and K over the key, stable and unstable, special points and peaks labelled."""

from __future__ import annotations

from typing import TYPE_CHECKING

from raceway.answers.picture import dress, new_figure, wrapped
from raceway.storage.tables import ReadTables

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_STABLE, _UNSTABLE, _OTHER, _FAINT = "#0b5fa5", "#c8501e", "#2a8f5b", "#b58a00"
#: Kind of a label -> mark.
_MARKS = {"fold": "s", "branch point": "D", "period doubling": "^", "Neimark-Sacker": "o", "contact opens": "x", "peak": "+"}
#: Quantities: column, factor, words.
_PANELS = (("swing", 1e6, "amplitude of all harmonics  [µm]"), ("stiffness", 1e-6, "K  [N/µm]"))
#: Poincaré sections at most.
_SECTIONS = 4
#: Peaks that are labelled at most, the highest.
_PEAKS = 6


def draw_branch(content: ReadTables) -> Figure:
    """Two panels over the key, of the tables of ``raceway follow --json``."""
    sections = [x for attractor in (content, *content["doubled"]) for x in attractor["instead"] if x["section"]][:_SECTIONS]
    figure = new_figure(9.6, 8.0 if not sections else 10.6)
    places = figure.add_gridspec(3 if sections else 2, max(len(sections), 1))
    panels = [figure.add_subplot(places[0, :])]
    panels.append(figure.add_subplot(places[1, :], sharex=panels[0]))
    for k, attractor in enumerate(sections):
        _section(figure.add_subplot(places[2, k]), attractor)
    for panel, (column, factor, words) in zip(panels, _PANELS, strict=True):
        for attractor in content["doubled"]:
            _curve(panel, attractor["rows"], column, factor, ", twice the period")
        _curve(panel, content["rows"], column, factor, "")
        labels = [x for attractor in (content, *content["doubled"]) for x in attractor["labels"]]
        for kind, mark in _MARKS.items():
            kind_labels = [label for label in labels if label["kind"] == kind]
            if kind_labels:
                panel.plot(
                    [x["parameter"] for x in kind_labels], [factor * x[column] for x in kind_labels], linestyle="", marker=mark,
                    markersize=6, color="black", markerfacecolor="white", label=kind,
                )  # fmt: skip
        panel.set_ylabel(words)
        dress(panel)
    panels[-1].set_xlabel(content["key"])
    peaks = sorted((x for x in content["labels"] if x["kind"] == "peak"), key=lambda x: -float(x["swing"]))[:_PEAKS]
    for peak in peaks:
        words = f"{peak['parameter']:.6g}\n{1e6 * peak['swing']:.4g} µm"
        at = (peak["parameter"], 1e6 * peak["swing"])
        panels[0].annotate(words, at, xytext=(0, 6), textcoords="offset points", ha="center", fontsize=8)
    handles = dict(zip(*reversed(panels[0].get_legend_handles_labels()), strict=True))
    figure.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=4, frameon=False, fontsize=9)
    figure.suptitle(wrapped(content["title"].partition("\n")[0]), fontsize=11)
    return figure


def _curve(panel: Axes, rows: Sequence[ReadTables], column: str, factor: float, words: str) -> None:
    """The branch in pieces of one verdict, each up to the first point of the next one."""
    first = 0
    for k in range(1, len(rows) + 1):
        if k < len(rows) and _unstable(rows[k]) == _unstable(rows[first]):
            continue
        piece = rows[first : k + 1]
        bad = _unstable(rows[first])
        panel.plot(
            [row["parameter"] for row in piece], [factor * row[column] for row in piece],
            color=(_FAINT if bad else _OTHER) if words else (_UNSTABLE if bad else _STABLE), linestyle="--" if bad else "-", linewidth=1.4,
            label=("unstable" if bad else "stable") + words,
        )  # fmt: skip
        first = k


def _unstable(row: ReadTables) -> bool:
    return bool(row["verdict"] == "unstable")


def _section(panel: Axes, attractor: ReadTables) -> None:
    """Once a turn: y and its velocity over w."""
    panel.plot(
        [1e6 * y for y, _ in attractor["section"]],
        [1e6 * v for _, v in attractor["section"]],
        ".",
        markersize=3,
        color=_OTHER,
    )
    panel.set_title(f"{attractor['parameter']:.6g}: {attractor['kind']}", fontsize=9)
    panel.set_xlabel("y once per turn  [µm]", fontsize=8)
    panel.set_ylabel("velocity / w  [µm]", fontsize=8)
    panel.tick_params(labelsize=8)
