"""Picture of the page on stability, drawn from its report."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path

_GOOD, _BAD, _WITHOUT, _LIMIT = "#2f6f9f", "#b3261e", "#c9d3dd", "#1f2933"
_SETTINGS = {"svg.hashsalt": "raceway", "svg.fonttype": "path", "font.size": 9.5, "font.family": "DejaVu Sans"}


def draw_stability(report: dict[str, Any], path: Path) -> None:
    """What chatter and a million steps come to, beside their limits."""
    panels = (
        ("contact chatter, ", "rms error of the force / load", "Fall onto a stiff contact"),
        ("energy's trend in a million steps, ", "trend of the energy, relative", "A million undamped steps"),
    )
    with _figure((11.5, 4.8), path) as figure:
        for axes, (start, label, title) in zip(figure.subplots(1, 2), panels, strict=True):
            rows = [row for row in report["rows"] if row["quantity"].startswith(start)][::-1]
            least = min(abs(number) for row in rows for number in (row["value"], row["low"], row["high"]) if number) / 3.0
            for place, row in enumerate(rows):
                color = _BAD if row["misses"] else _WITHOUT if row["value"] < 0.0 else _GOOD
                axes.barh(place, abs(row["value"]) - least, left=least, color=color)
                limit, sign = (row["low"], "\u2265") if row["high"] is None else (row["high"], "\u2264")
                axes.plot([limit] * 2, [place - 0.4, place + 0.4], color=_LIMIT)
                axes.annotate(sign, (limit, place), (3, 0), textcoords="offset points", va="center")
            axes.set_yticks(range(len(rows)), [row["quantity"].removeprefix(start) for row in rows], fontsize=8)
            axes.set(xscale="log", xlabel=label, title=title)
            axes.set_xlim(left=least)
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
