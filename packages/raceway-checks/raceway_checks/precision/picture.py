"""A precision study on disk: JSON, a Markdown page, and the picture of error against run time."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from raceway.extend import (
    COLOURS, GREY, GRID, K, MARKERS, P0, PEAK_BALL_LOAD, Tables, dress, new_figure, wrapped,
)  # fmt: skip

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from raceway_checks.precision.settings import Judged

#: Text, the point that it belongs to in the axes' data, its colour.
_Label = tuple[str, tuple[float, float], str]

_SIZE = 9.0
#: Mean width of a letter and height of a line over the size of the letters.
_WIDE, _HIGH = 0.56, 1.15
#: Half the width of a marker, and from a point to its label, near and further away [points of 1/72 inch].
_MARKER, _AWAY = 4.0, (6.0, 15.0, 26.0)
#: Where labels are tried, from their point: the right above first.
_DIRECTIONS = np.array([(1, 1), (1, -1), (-1, 1), (-1, -1), (0, 1), (0, -1), (1, 0), (-1, 0)], dtype=float)


def put_beside(axes: Axes, labels: Sequence[_Label]) -> None:
    """Write each label at the first place that is free, with a thin line where that is not beside its point.

    A label without a free place is left out.
    """
    figure = axes.figure.figure  # the whole one, of which the axes may have a part
    figure.draw_without_rendering()  # only then axes and limits have their places
    scale = 72.0 / figure.dpi
    points = [scale * axes.transData.transform(point) for _, point, _ in labels]
    low, high = scale * axes.bbox.get_points()
    boxes = [(point, np.full(2, _MARKER)) for point in points]
    for (text, at, tone), point in zip(labels, points, strict=True):
        half = 0.5 * _SIZE * np.array([_WIDE * len(text), _HIGH])
        ways = ((direction, away) for away in _AWAY for direction in _DIRECTIONS)  # near ones first
        for direction, away in ways:
            middle = point + direction * half + away * direction / np.linalg.norm(direction)
            inside = (middle - half >= low).all() and (middle + half <= high).all()
            if inside and not any((np.abs(middle - centre) < half + size).all() for centre, size in boxes):
                boxes.append((middle, half))
                line = {"arrowstyle": "-", "color": tone, "linewidth": 0.5, "shrinkB": 3.0} if away > _AWAY[0] else None
                axes.annotate(
                    text, at, tuple(middle - point), textcoords="offset points", fontsize=_SIZE, color=tone, ha="center", va="center",
                    arrowprops=line, in_layout=False,
                )  # fmt: skip
                break


#: Errors below are drawn here: a logarithm has no zero.
_LEAST = 1e-16


def page(result: Tables, picture: bool = False) -> str:
    """The study as Markdown."""
    lines = [f"# Error against run time: {result['title']}", ""]
    lines += ["![error against run time](precision.png)", ""] if picture else []
    lines += [*(f"- {text}" for text in result["words"]), "", _table(result), ""]
    lines += ["Errors of each quantity, each relative to its own reference:", "", _quantities(result), ""]
    models = [model for model in result["models"] if not model["base"]]
    if models:
        rows = []
        for model in models:
            parts, difference = model["differences"], model["difference"]
            changes = [difference and abs(difference), *(parts.get(name) for name in (K.name, PEAK_BALL_LOAD.name, P0.name))]
            signs = ("", "+", "+", "+")
            cells = [
                "" if part is None else f"{100.0 * part:{sign}.3g} %" for part, sign in zip(changes, signs, strict=True)
            ]
            rows.append([_setting_words(model["model"]), *cells, _digits(model["reference"]["error"], 2)])
        table = _markdown(("model", "difference", "of K", "of peak load", "of p0", "reference's bound"), rows)
        lines += ["Differences between models, each by its own reference:", "", table, ""]
    if result["left_out"]:
        lines += ["Left out:", ""]
        lines += [f"- {_setting_words(item['setting'])} ({item['family']}): {item['why']}" for item in result["left_out"]]
        lines.append("")
    return "\n".join(lines)


def _table(result: Tables) -> str:
    times = "wall ms", "spread", "cpu ms", "compile s"
    head = ("", "setting", "error", "own estimate", "order", *times, "steps", "iterations", "MiB", "status")
    lines = list[list[str]]()
    for number, row in enumerate(result["rows"]):
        cost: Mapping[str, Any] = row["cost"] or {}
        memory = cost.get("peak_memory_bytes")
        cells = [
            "\\*" if number in result["front"] else "",
            _setting_words(row["setting"]),
            ("~" if row["at_bound"] else "") + _digits(row["error"], 2),
            _digits(row["own_error"], 2),
            "" if row["order"] is None else f"{row['order']:.2f}",
            _digits(cost.get("wall_s"), 3, 1e3),
            _digits(cost.get("wall_spread_s"), 2, 1e3),
            _digits(cost.get("cpu_s"), 3, 1e3),
            _digits(cost.get("compile_s"), 2),
            str(cost.get("steps", "")),
            str(cost.get("iterations", "")),
            "" if memory is None else f"{memory / 2**20:.0f}",
            row["status"] + (f": {row['reason']}" if row["reason"] else ""),
        ]
        lines.append(cells)
    notes = "\\* on the front; ~ the reference is not ten times more accurate than this row: its error is known to the bound only."
    return "\n".join([_markdown(head, lines), "", notes])


def _quantities(result: Tables) -> str:
    """Errors of all quantities, those of Z's parts relative to |Z|."""
    rows = [row for row in result["rows"] if row["errors"]]
    names = list(dict.fromkeys(name for row in rows for name in row["errors"]))
    lines = [(_setting_words(row["setting"]), *(_digits(row["errors"].get(name), 2) for name in names)) for row in rows]
    table = _markdown(("setting", *(name.replace("_", " ") for name in names)), lines)
    return f"{table}\n\nz real and z imag: relative to the size of Z."


def _markdown(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table."""
    cells = [
        [cell if cell == "\\*" else cell.replace("|", "\\|") for cell in row] for row in (head, ["---"] * len(head), *rows)
    ]
    return "\n".join(f"| {' | '.join(row)} |" for row in cells)


def _digits(value: float | None, digits: int = 3, factor: float = 1.0) -> str:
    return "" if value is None else f"{factor * value:.{digits}g}"


def _setting_words(setting: Tables) -> str:
    return ", ".join("without inertia" if key == "inertia" else f"{key} = {value}" for key, value in setting.items()) or "-"


def draw(result: Tables) -> Figure:
    """The figure of a study."""
    figure = new_figure(8.4, 7.6)
    figure.suptitle(wrapped(f"Error against run time: {result['title']}", 70), fontsize=12)
    labels = draw_on(panel := figure.add_subplot(), result)
    figure.legend(*panel.get_legend_handles_labels(), loc="outside lower center", ncols=2, frameon=False, fontsize=9)
    put_beside(panel, labels)
    return figure


def draw_on(panel: Axes, result: Tables) -> list[_Label]:
    """Relative error of the main quantity over the run's time, both logarithmic, with the Pareto front; labels to be put."""
    bound = result["reference"]["error"]
    # What lies below the reference's bound is drawn at its lower edge: nobody knows how far below.
    least = bound / 10.0 if bound else _LEAST
    base = [k for k, row in enumerate(result["rows"]) if _has_place(row) and row["base"]]
    foreign = [k for k, row in enumerate(result["rows"]) if _has_place(row) and not row["base"]]
    series: dict[str, list[int]] = {}
    labels: list[_Label] = []
    for k in base:
        series.setdefault(_series(result["rows"][k]), []).append(k)
    for number, (name, members) in enumerate(series.items()):
        tone, mark = COLOURS[number % len(COLOURS)], MARKERS[(number // 2) % len(MARKERS)]
        xy = [_point(result["rows"][k], least) for k in members]
        panel.plot(*zip(*xy, strict=True), color=tone, marker=mark, linewidth=1.0, alpha=0.9, label=name)
        labels += [(_rung(result["rows"][k]), point, tone) for k, point in zip(members, xy, strict=True)]
    if foreign:
        xy = [_point(result["rows"][k], least) for k in foreign]
        label = "other models, against their own references"
        panel.plot(*zip(*xy, strict=True), linestyle="", marker="x", color=GREY, label=label)
        labels += [(_setting_words(result["rows"][k]["setting"]), point, GREY) for k, point in zip(foreign, xy, strict=True)]
    points = [_point(result["rows"][number], least) for number in result["front"]]
    if points:
        x, y = zip(*points, strict=True)
        label = "front: no setting is both faster and more accurate"
        panel.plot(x, y, color="black", linewidth=1.2, linestyle="--", drawstyle="steps-post", label=label)
        panel.plot(x, y, linestyle="", marker="o", markersize=13, markerfacecolor="none", markeredgecolor="black")
    if bound:
        panel.axhspan(bound / 30.0, bound, color=GRID, zorder=0)
        panel.axhline(bound, color=GREY, linewidth=0.8, linestyle=":", label="bound of the reference, grey below")
    panel.set_xscale("log")
    panel.set_yscale("log")
    panel.set_xlabel("least time of a run [s]")
    panel.set_ylabel("relative error against the reference")
    dress(panel)
    return labels


def _has_place(row: Judged) -> bool:
    return row["error"] is not None and row.get("time_s") is not None


def _point(row: Judged, least: float) -> tuple[float, float]:
    return row.get("time_s") or 0.0, max(row["error"] or 0.0, least)


_RUNGS = ("integrator.steps_per_turn", "integrator.turns", "integrator.tolerance", "mesh.element_size")


def _series(row: Judged) -> str:
    """Rows of one line: the same but for the family's ladder."""
    ladder = _ladder(row)
    values = {key: value for key, value in row["setting"].items() if key != ladder}
    short = {key.removeprefix("integrator."): value for key, value in values.items()}
    return f"{row['family']}: {_setting_words(short)}"


def _ladder(row: Judged) -> str | None:
    keys = ("integrator.turns",) if row["family"] == "turns and start" else _RUNGS
    return next((key for key in keys if key in row["setting"]), None)


def _rung(row: Judged) -> str:
    ladder = _ladder(row)
    value = row["setting"].get(ladder) if ladder else None
    return "" if value is None else f"{value:g}" if isinstance(value, float) else str(value)
