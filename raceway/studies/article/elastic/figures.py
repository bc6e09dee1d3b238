"""Pictures of the study: deviation of the peak pressures, ball loads around the ring, K and |Z|."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from raceway.storage.tables import ReadTables, Tables
from raceway.studies.article.elastic.deviations import RACES
from raceway.studies.article.panel import Panel, Picture, finish

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: The article's largest deviation of a peak pressure from exact Hertz, section 3.2.
ARTICLE_DEVIATION = 0.0242
LOOKS = {"elastic": ("#c8501e", "o"), "condensed": ("#0b5fa5", "s"), "rigid": ("#5b6570", "^")}


def pictures(content: ReadTables) -> list[Picture]:
    """All that there are completed runs for."""
    rows = [row for row in content["rows"] if row["status"] == "completed"]
    rest = [row for row in rows if row["phase"] == "static"]
    moving = [row for row in rows if row["phase"] == "motion"]
    found = []
    with_points = [row for row in rest if row["from_hertz"]["inner"] is not None or row["from_hertz"]["outer"] is not None]
    if with_points:
        found.append(_pressure_picture(with_points))
    if rest:
        found.append(_load_picture(rest))
    if moving:
        found.append(_stiffness_picture(moving))
    return found


def _cases(rows: list[Tables]) -> dict[str, list[Tables]]:
    """Rows by case, in their order."""
    out: dict[str, list[Tables]] = {}
    for row in rows:
        out.setdefault(row["case"], []).append(row)
    return out


def _pressure_picture(rows: list[Tables]) -> Picture:
    panels = []
    for race in RACES:
        shown = [row for row in rows if row["from_hertz"][race] is not None]
        told = "; ".join(
            f"{row['case']}, {row['bodies']} {100.0 * row['from_hertz'][race]['most_loaded']:+.2f} %" for row in shown
        )
        panels.append(Panel(partial(_draw_pressures, shown, race), f"Deviation of the nodal peak pressure on the {race} race from Hertz's at the same ball load, "
                            f"most loaded ball: {told}.", f"{race} race; whiskers: the largest deviation of any loaded ball"))  # fmt: skip
    return Picture("article-elastic-pressures", "Peak pressure against Hertz at the same ball load", tuple(panels))


def _draw_pressures(rows: list[Tables], race: str, axes: Axes) -> None:
    cases = list(_cases(rows))
    kinds = list(dict.fromkeys(row["bodies"] for row in rows))
    for row in rows:
        colour, _ = LOOKS[row["bodies"]]
        found = row["from_hertz"][race]
        x = cases.index(row["case"]) + 0.34 * (kinds.index(row["bodies"]) - 0.5 * (len(kinds) - 1))
        axes.bar(x, 100.0 * found["most_loaded"], 0.3, color=colour, label=_first(axes, row))
        axes.plot(
            [x, x], [100.0 * found["most_loaded"], 100.0 * found["largest"]], color="#20262c", linewidth=1.2, marker="_"
        )
    for sign in (1.0, -1.0):
        axes.axhline(sign * 100.0 * ARTICLE_DEVIATION, color="#20262c", linewidth=0.9, linestyle="--",
                     label="the article's largest, 2.42 %" if sign > 0.0 else None)  # fmt: skip
    finish(axes, f"{race} race", "", "deviation [%]", 3)
    axes.set_xticks(range(len(cases)), [case.replace(" + ", "\n+ ").replace(" axial", "\naxial", 1) for case in cases])
    axes.axhline(0.0, color="#20262c", linewidth=0.6)


def _first(axes: Axes, row: Tables) -> str | None:
    """The kind of bodies where it has no name in the legend yet."""
    return None if row["bodies"] in axes.get_legend_handles_labels()[1] else row["bodies"]


def _load_picture(rows: list[Tables]) -> Picture:
    panels = []
    for case, some in _cases(rows).items():
        told = "; ".join(f"{row['bodies']} {min(_loads(row)):.0f} to {max(_loads(row)):.0f} N" for row in some)
        panels.append(Panel(partial(_draw_loads, case, some), f"Ball loads on the inner race around the ring under {case}: {told}.", case))  # fmt: skip
    return Picture("article-elastic-ball-loads", "Ball loads on the inner race", tuple(panels))


def _loads(row: Tables) -> list[float]:
    return [ball["load_inner_n"] for ball in row["balls"]]


def _draw_loads(case: str, rows: list[Tables], axes: Axes) -> None:
    for row in rows:
        colour, mark = LOOKS[row["bodies"]]
        azimuth = np.array([ball["azimuth_deg"] for ball in row["balls"]])
        order = np.argsort(azimuth)
        axes.plot(azimuth[order], np.array(_loads(row))[order], mark, color=colour, fillstyle="none", markersize=6,
                  linestyle="-", linewidth=0.8, label=row["bodies"])  # fmt: skip
    axes.set_ylim(0.0, 1.08 * max(max(_loads(row)) for row in rows))
    finish(axes, case, "azimuth [deg]", "ball load [N]", 3)


def _stiffness_picture(rows: list[Tables]) -> Picture:
    parts = (("k", "K", 1e-6, "N/µm"), ("abs_z", "|Z|", 1e-6, "N/µm"), ("c", "C", 1.0, "N s/m"))
    panels = []
    for key, name, unit, word in parts:
        told = "; ".join(f"{row['case']}, {row['bodies']} {unit * row['identified'][key]:.4g}" for row in rows)
        panels.append(Panel(partial(_draw_bars, rows, key, unit, f"{name} [{word}]"), f"{name} in {word}: {told}.", name))
    return Picture("article-elastic-stiffness", "K, |Z| and C of the operating point", tuple(panels))


def _draw_bars(rows: list[Tables], key: str, unit: float, label: str, axes: Axes) -> None:
    cases = list(_cases(rows))
    for row in rows:
        place = list(LOOKS).index(row["bodies"])
        x, y = cases.index(row["case"]) + 0.27 * (place - 1), unit * row["identified"][key]
        axes.bar(x, y, 0.24, color=LOOKS[row["bodies"]][0], label=_first(axes, row))
        axes.annotate(f"{y:.4g}", (x, y), xytext=(0, 2), textcoords="offset points", ha="center", fontsize=8)
    finish(axes, label.split(" [")[0], "", label, 3)
    axes.set_xticks(range(len(cases)), [case.replace(" ", "\n", 1) for case in cases])
    axes.margins(y=0.12)
