"""Pictures of the pages on stability and on what is left out, drawn from their reports."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from pathlib import Path

_GOOD, _BAD, _WITHOUT, _LIMIT = "#2f6f9f", "#b3261e", "#c9d3dd", "#1f2933"
_SETTINGS = {"svg.hashsalt": "raceway", "svg.fonttype": "path", "font.size": 9.5, "font.family": "DejaVu Sans"}
_SAVED = re.compile(r"difference ([\d.e+-]+); ([\d.e+]+) ms instead of ([\d.e+]+)")


def draw_leaving_out(report: dict[str, Any], path: Path) -> None:
    """The time of a run with and without each part that the plan leaves out."""
    rows = [(row["quantity"].removeprefix("left out: "), _SAVED.match(str(row["value"]))) for row in report["rows"]]
    found = [(name, float(match[2]), float(match[3])) for name, match in rows if match is not None]
    found.sort(key=lambda one: one[2] / one[1])
    names, left_out, kept = zip(*found, strict=True)
    with _figure((9.0, 5.2), path) as figure:
        axes, places = figure.add_subplot(), np.arange(len(names))
        axes.barh(places, kept, color=_WITHOUT, label="with the part")
        axes.barh(places, left_out, color=_GOOD, height=0.5, label="without, as the plan decides")
        axes.set(xscale="log", xlabel="time of the scene [ms]")
        axes.set_yticks(places, names)
        for place, quick, slow in zip(places, left_out, kept, strict=True):
            axes.annotate(f"{slow / quick:.3g}x", (max(quick, slow), place), (4, 0), textcoords="offset points", va="center")
        axes.legend(frameon=False, loc="lower right")
        axes.margins(x=0.12)
        figure.suptitle("Parts that a scene does not need: what leaving them out saves", fontsize=11)


def draw_stability(report: dict[str, Any], path: Path) -> None:
    """What chatter and a million steps come to, beside their limits."""
    panels = (
        ("contact chatter, ", "rms error of the force / load", "Fall onto a stiff contact"),
        ("energy's trend in a million steps, ", "trend of the energy, relative", "A million undamped steps"),
    )
    with _figure((11.5, 4.8), path) as figure:
        for axes, (start, label, title) in zip(figure.subplots(1, 2), panels, strict=True):
            rows = [row for row in report["rows"] if row["quantity"].startswith(start)][::-1]
            for place, row in enumerate(rows):
                loses = row["value"] < 0.0
                axes.barh(place, abs(row["value"]), color=_BAD if not row["ok"] else _WITHOUT if loses else _GOOD)
                sign, limit = row["limit"].rsplit(" ", 1)
                axes.plot([float(limit)] * 2, [place - 0.4, place + 0.4], color=_LIMIT)
                axes.annotate(
                    "\u2265" if "least" in sign else "\u2264",
                    (float(limit), place),
                    (3, 0),
                    textcoords="offset points",
                    va="center",
                )
            axes.set_yticks(range(len(rows)), [row["quantity"].removeprefix(start) for row in rows], fontsize=8)
            axes.set(xscale="log", xlabel=label, title=title)
        words = "Black lines: limits, set before. Pale: energy is lost, as that integrator is made to. Red would be: not as expected."
        figure.supxlabel(words, fontsize=9)


class _figure:
    """A figure that is written when its block ends."""

    def __init__(self, size: tuple[float, float], path: Path) -> None:
        self.size, self.path = size, path

    def __enter__(self) -> Any:
        import matplotlib as mpl
        from matplotlib.figure import Figure

        self.settings = mpl.rc_context(_SETTINGS)
        self.settings.__enter__()
        self.figure = Figure(figsize=self.size, facecolor="white", layout="constrained")
        return self.figure

    def __exit__(self, *error: Any) -> None:
        if error[0] is None:
            self.figure.savefig(self.path, metadata={"Date": None, "Creator": None} if self.path.suffix == ".svg" else None)
        self.settings.__exit__(*error)
