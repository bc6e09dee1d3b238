"""The elastic article on page, screen and disk: pressures, bodies compared, the motions, stresses and cost."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from raceway.extend import Cell, Page, ReadTables, Tables, leaves
from raceway_article.design import EXPLICIT, RACES
from raceway_article.figures import Panel, Picture, finish
from raceway_article.page import percent, show_picture, shown

if TYPE_CHECKING:
    from matplotlib.axes import Axes


#: The article's largest deviation of a peak pressure from exact Hertz, section 3.2.
_ARTICLE_DEVIATION = 0.0242
#: Bodies and steps -> colour and marker.
_LOOKS = {
    "elastic": ("#c8501e", "o"), "condensed": ("#0b5fa5", "s"), "rigid": ("#5b6570", "^"), "elastic, explicit": ("#7a2f8f", "D"),
}  # fmt: skip
_NAMES = {"ball_loads": "a ball load, over the largest", "x": "x", "y": "y", "kyy": "kyy", "k": "K", "abs_z": "|Z|"}


def columns(rows: Sequence[ReadTables]) -> list[Tables]:
    """Flat rows, lists left to the JSON file, without what is a table in other rows: its columns stay empty where there is none."""
    flat_rows = [{name: value for name, value in leaves(row) if not isinstance(value, list | dict)} for row in rows]
    inner = {name.rpartition(".")[0] for row in flat_rows for name in row}
    return [{name: value for name, value in row.items() if name not in inner} for row in flat_rows]


def drawings(content: ReadTables) -> list[Picture]:
    """All that there are completed runs for."""
    rows = [row for row in content["rows"] if row["status"] == "completed"]
    static, moving = ([row for row in rows if row["phase"] == phase] for phase in ("static", "motion"))
    pictures = []
    if any(row["from_hertz"][race] is not None for row in static for race in RACES):
        panels = [_pressures_panel(race, [row for row in static if row["from_hertz"][race] is not None]) for race in RACES]
        pictures.append(Picture("article-elastic-pressures", "Peak pressure against Hertz at the same load", tuple(panels)))
    if static:
        panels = [_loads_panel(case, of_case) for case, of_case in _by_case(static).items()]
        pictures.append(Picture("article-elastic-ball-loads", "Ball loads on the inner race", tuple(panels)))
    if moving:
        quantities = (("k", "K", 1e-6, "N/µm"), ("abs_z", "|Z|", 1e-6, "N/µm"), ("c", "C", 1.0, "N s/m"))
        panels = [_bars_panel(moving, *quantity) for quantity in quantities]
        pictures.append(Picture("article-elastic-stiffness", "K, |Z| and C of the operating point", tuple(panels)))
    if any(row["from_condensed"] for row in moving):
        panels = [_cost_panel(case, of_case) for case, of_case in _by_case(moving).items()]
        pictures.append(Picture("article-elastic-cost", "Z against run time, from condensed bodies", tuple(panels)))
    return pictures


def _by_case(rows: list[Tables]) -> dict[str, list[Tables]]:
    """Rows by case, in their order."""
    return {case: [row for row in rows if row["case"] == case] for case in dict.fromkeys(row["case"] for row in rows)}


def _way(row: ReadTables) -> str:
    """Bodies, and the steps where they are explicit."""
    return f"{row['bodies']}, explicit" if row["integrator"] == EXPLICIT else str(row["bodies"])


def _new(axes: Axes, row: Tables) -> str | None:
    """``_way`` where it has no name in the legend yet."""
    return None if _way(row) in axes.get_legend_handles_labels()[1] else _way(row)


def _pressures_panel(race: str, rows: list[Tables]) -> Panel:
    cases, kinds = list(_by_case(rows)), list(dict.fromkeys(row["bodies"] for row in rows))

    def draw(axes: Axes) -> None:
        for row in rows:
            most, largest = (100.0 * row["from_hertz"][race][name] for name in ("most_loaded", "largest"))
            x = cases.index(row["case"]) + 0.34 * (kinds.index(row["bodies"]) - 0.5 * (len(kinds) - 1))
            axes.bar(x, most, 0.3, color=_LOOKS[row["bodies"]][0], label=_new(axes, row))
            axes.plot([x, x], [most, largest], color="#20262c", linewidth=1.2, marker="_")
        for sign in (1.0, -1.0):
            axes.axhline(sign * 100.0 * _ARTICLE_DEVIATION, color="#20262c", linewidth=0.9, linestyle="--",
                         label="the article's largest, 2.42 %" if sign > 0.0 else None)  # fmt: skip
        finish(axes, f"{race} race", "", "deviation [%]", 3)
        axes.set_xticks(range(len(cases)), [case.replace(" + ", "\n+ ").replace(" axial", "\naxial", 1) for case in cases])
        axes.axhline(0.0, color="#20262c", linewidth=0.6)

    numbers = "; ".join(f"{row['case']}, {row['bodies']} {percent(row['from_hertz'][race]['most_loaded'])}" for row in rows)
    words = f"Deviation of the nodal peak pressure on the {race} race from Hertz's at the same ball load, most loaded ball: {numbers}."
    return Panel(draw, words, f"{race} race; whiskers: the largest deviation of any loaded ball")


def _loads_panel(case: str, rows: list[Tables]) -> Panel:
    loads = [np.array([ball["load_inner_n"] for ball in row["balls"]]) for row in rows]

    def draw(axes: Axes) -> None:
        for row, load in zip(rows, loads, strict=True):
            colour, mark = _LOOKS[row["bodies"]]
            azimuth = np.array([ball["azimuth_deg"] for ball in row["balls"]])
            order = np.argsort(azimuth)
            axes.plot(azimuth[order], load[order], mark, color=colour, fillstyle="none", markersize=6, linestyle="-",
                      linewidth=0.8, label=row["bodies"])  # fmt: skip
        axes.set_ylim(0.0, 1.08 * max(load.max() for load in loads))
        finish(axes, case, "azimuth [deg]", "ball load [N]", 3)

    ranges = (f"{row['bodies']} {load.min():.0f} to {load.max():.0f} N" for row, load in zip(rows, loads, strict=True))
    return Panel(draw, f"Ball loads on the inner race around the ring under {case}: {'; '.join(ranges)}.", case)


def _bars_panel(rows: list[Tables], key: str, name: str, scale: float, unit: str) -> Panel:
    cases = list(_by_case(rows))
    numbers = [scale * row["identified"][key] for row in rows]

    def draw(axes: Axes) -> None:
        for row, y in zip(rows, numbers, strict=True):
            x = cases.index(row["case"]) + 0.22 * (list(_LOOKS).index(_way(row)) - 1.5)
            axes.bar(x, y, 0.2, color=_LOOKS[_way(row)][0], label=_new(axes, row))
            axes.annotate(f"{y:.4g}", (x, y), xytext=(0, 2), textcoords="offset points", ha="center", fontsize=8)
        finish(axes, name, "", f"{name} [{unit}]", 3)
        axes.set_xticks(range(len(cases)), [case.replace(" ", "\n", 1) for case in cases])
        axes.margins(y=0.12)

    words = "; ".join(f"{row['case']}, {_way(row)} {y:.4g}" for row, y in zip(rows, numbers, strict=True))
    return Panel(draw, f"{name} in {unit}: {words}.", name)


def _cost_panel(case: str, rows: list[Tables]) -> Panel:
    """Distance of Z from that of the reference over processor time; of the reference the error that it states."""
    points = [(row, row["cost"]["cpu_s"], (row["from_condensed"] or {"z": row["error"]["total"]})["z"]) for row in rows]
    points = [point for point in points if point[2]]  # none, and no difference, have no place on a logarithmic axis

    def draw(axes: Axes) -> None:
        for row, seconds, error in points:
            colour, mark = _LOOKS[_way(row)]
            axes.loglog(seconds, error, mark, color=colour, fillstyle="none", markersize=8, label=_way(row))
        finish(axes, case, "processor time [s]", "difference of Z from condensed bodies", 2)

    words = "; ".join(f"{_way(row)} {error:.1e} in {seconds:.3g} s" for row, seconds, error in points)
    return Panel(draw, f"Difference of Z from condensed bodies, of these the error that they state: {words}.", case)


def page(content: ReadTables, pictures: Sequence[Picture], section: bytes | None, command: str) -> Page:
    """The page.

    content : article-elastic.json;  section : PNG of the section through the most loaded contact, if it was drawn
    command : what makes the page again
    """
    from raceway import __version__

    cost = content["cost"]
    footer = f"Made by `{command}`, Raceway {__version__}; its runs took {cost['rows_cpu_s']:.0f} s of processor time. "
    footer += "All numbers: article-elastic.json and article-elastic.csv beside this page."
    out = Page("The article’s own model: elastic rings and balls", content["title"], footer)
    by_name = {picture.name: picture for picture in pictures}
    static = [row for row in content["rows"] if row["phase"] == "static"]
    elements = {row["cost"]["elements"] for row in content["rows"] if row["bodies"] == "elastic"} - {None}
    size = f"{max(elements):,}".replace(",", "\u202f") + " hexahedra" if elements else "no run that came to an end"
    out.text(
        f"Rings and balls as finite elements of which every node moves ({size}), in contact at surface points with a penalty and a "
        f"coefficient of friction of {content['friction']:g} in motion: the model that the article computes with. It stands beside "
        "condensed bodies, exact compliances between the points of the contacts, and rigid bodies, of which the contacts "
        f"alone deform. Four load cases at rest; one operating point, {content['speed_rpm']:g} r/min, under both excitations.",
        kind="lead",
    )
    out.listing(in_short(content))
    out.section("Peak pressures")
    out.text(
        "Largest nodal pressure, force over the area around a node, over Hertz’s at the load that the same ball carries, less 1: of the "
        "most loaded ball, and the largest of any ball that carries more than 5 % of it. Rigid bodies have no points: theirs is Hertz’s."
    )
    caption = "Peak pressures against exact Hertz at the most loaded ball; last column: of all loaded balls"
    # A row for each race whose contacts have points.
    lines = []
    for row in static:
        for race, table in (row.get("from_hertz") or {}).items():
            if table is not None:
                within = abs(table["largest"]) <= _ARTICLE_DEVIATION
                tone, more = ("good", "") if within else ("bad", "beyond the article’s 2.42 %")
                lines.append({
                    "load": _case(row),
                    "bodies": row["bodies"],
                    "race": race,
                    "ball load N": f"{table['load_n']:.1f}",
                    "peak MPa": f"{1e-6 * table['peak_pressure_pa']:.1f}",
                    "Hertz MPa": f"{1e-6 * table['hertz_peak_pressure_pa']:.1f}",
                    "off Hertz": percent(table["most_loaded"]),
                    "most off, any ball": Cell(percent(table["largest"]), tone, more),
                })  # fmt: skip
    out.rows(lines, caption)
    show_picture(out, by_name, "article-elastic-pressures")
    out.section("Bodies against each other, at rest")
    at_rest, in_motion = tables(content).items()
    out.rows(at_rest[1], at_rest[0])
    show_picture(out, by_name, "article-elastic-ball-loads")
    _motion_section(out, content)
    out.rows(in_motion[1], in_motion[0])
    show_picture(out, by_name, "article-elastic-stiffness")
    show_picture(out, by_name, "article-elastic-cost")
    _stresses(out, static, section)
    out.section("Cost")
    out.rows([_cost_row(row) for row in content["rows"]], "Every run; elements of condensed bodies are none of the run")
    words = "What elastic bodies are factored into is stored on disk: later load cases and runs read it."
    out.text(f"Runs go one at a time. {words}", kind="note")
    out.section("What differs between the bodies")
    out.listing(content["what_differs"])
    warnings = [
        {"run": _case(row), "bodies": _way(row), "warning": words}
        for row in content["rows"]
        for words in row.get("warnings") or []
    ]
    out.rows(warnings, "Warnings of the runs")
    return out


def tables(content: ReadTables) -> dict[str, list[Tables]]:
    """Those of differences from the reference at rest and in motion, by their captions."""
    lines, moving_lines = list[Tables](), list[Tables]()
    for row in content["rows"]:
        if row["status"] != "completed":
            continue
        differences = row[f"from_{content['reference']}"] or {}
        if row["phase"] == "static":
            x, y = (f"{1e6 * row['displacement'][name]:.4f}".replace("-0.0000", "0.0000") for name in ("x", "y"))
            lines.append({
                "load": _case(row), "bodies": row["bodies"], "x µm": x, "y µm": y, "kyy N/µm": f"{1e-6 * row['kyy_n_per_m']:.2f}",
                "ball loads": percent(differences.get("ball_loads")),
                **{name: percent(differences.get(name)) for name in ("x", "y", "kyy")},
            })  # fmt: skip
            continue
        z = row["identified"]
        # At a node where contacts have points, by Hertz where they have none.
        peak = max(
            ball.get(f"peak_pressure_nodal_{race}_pa") or ball[f"peak_pressure_{race}_pa"]
            for ball in row["balls"]
            for race in RACES
        )
        moving_lines.append({
            "force": _case(row), "bodies": _way(row),
            "K N/µm": f"{1e-6 * z['k']:.2f}", "C N s/m": f"{z['c']:.0f}", "|Z| N/µm": f"{1e-6 * z['abs_z']:.2f}",
            "K": percent(differences.get("k")), "C": percent(differences.get("c")),
            "ωC/|Z|": percent(differences.get("wc")), "|Z|": percent(differences.get("abs_z")),
            "peak MPa": f"{1e-6 * peak:.0f}",
            "energy balance": shown(row["energy_balance"], ".1e"), "transient": shown(row["error"]["transient"], ".1e"),
            "stability": row["stability"]["status"],
        })  # fmt: skip
    return {_AT_REST.format(**content): lines, _IN_MOTION.format(**content): moving_lines}


_AT_REST = (
    "Displacements and stiffness; the last four columns are differences from {reference} bodies, ball loads over the largest"
)
_IN_MOTION = "Identified at the operating point; K, C, |Z| without unit: differences from {reference} bodies; transient: part of |Z| by which turns differ"


def in_short(content: ReadTables) -> list[str]:
    """What the numbers say, as far as runs came to an end."""
    rows, reference = content["rows"], content["reference"]
    elastic = [row for row in rows if row["bodies"] == "elastic" and row["status"] == "completed"]
    points = []
    hertz = [row["from_hertz"][race] for row in elastic if row["phase"] == "static" for race in RACES]
    largest = [table["largest"] for table in hertz if table]
    if largest:
        points.append(
            f"Peak pressures of elastic bodies differ from Hertz at the same ball load by at most {percent(max(largest, key=abs))} "
            f"(the article’s own largest: {100.0 * _ARTICLE_DEVIATION:.2f} %)."
        )
    for phase, names, words in (
        ("static", ("ball_loads", "x", "y", "kyy"), "at rest (ball loads, x, y, kyy)"),
        ("motion", ("k", "abs_z"), "in motion (K, |Z|)"),
    ):
        differences = [row[f"from_{reference}"] for row in elastic if row["phase"] == phase]
        parts = [(name, table[name]) for table in differences if table for name in names if table[name] is not None]
        if parts:
            name, value = max(parts, key=lambda part: abs(part[1]))
            points.append(f"Elastic from {reference} bodies {words}: at most {percent(value)}, in {_NAMES[name]}.")
    moving = [row for row in elastic if row["phase"] == "motion"]
    pairs = [(row, other) for row in moving for other in moving if row["case"] == other["case"]]
    pairs = [(row, other) for row, other in pairs if (row["integrator"], other["integrator"]) == (EXPLICIT, "newmark")]
    apart = [row["identified"][name] / other["identified"][name] - 1.0 for row, other in pairs for name in ("k", "abs_z")]
    if apart:
        points.append(f"Explicit from implicit steps of elastic bodies (K, |Z|): at most {percent(max(apart, key=abs))}.")
    balance = [row["energy_balance"] for row in elastic if row["phase"] == "motion" and row["energy_balance"] is not None]
    if balance:
        points.append(f"The energy of the motions of elastic bodies balances to {max(balance):.1e} of what was exchanged.")
    if content["failed"]:
        points.append(f"{content['failed']} of {content['runs']} runs failed or were refused: reasons stand under “Cost”.")
    return points


def _case(row: ReadTables) -> str:
    """The load case, broken between two loads or words of a force only: a narrow screen has a line for each."""
    return str(row["case"]).replace(" N ", "\u00a0N\u00a0")


def _motion_section(out: Page, content: ReadTables) -> None:
    out.section("In motion")
    out.text(
        f"{content['speed_rpm']:g} r/min, {content['scene']['load']['axial']:g} N, tilt locked, balls with inertia, friction "
        f"{content['friction']:g}; integrator `newmark`, {content['turns']} turn{'s' if content['turns'] > 1 else ''} of "
        f"{content['steps_per_turn']} steps, the same start and "
        "identifier for all bodies; explicit steps are as many as stability needs. Unidirectional: a force of constant amplitude along one line. Bidirectional: m e w² of the rig’s "
        "unbalance, turning with the rotor. The balance of energy is its drift over what was exchanged; stability is what result.json "
        "states: Floquet multipliers belong to steady orbits, which friction does not have."
    )
    if content["turns"] == 1:
        out.text(
            "One turn only: how much of K and C is the transient of the start is not known, and C may be little else. Use `--turns 2`.",
            kind="note",
        )


def _stresses(out: Page, rows: list[Tables], section: bytes | None) -> None:
    out.section("Stresses below the most loaded contact")
    out.text(
        "The largest shear stress on the contact’s normal, in ball and ring, and its depth, beside Hertz’s at the same load. Not resolved: "
        "fewer than four elements down to Hertz’s depth or along a semi-axis of the ellipse."
    )
    lines = []
    for row in rows:
        for side in row.get("below_contact") or []:
            shear, depth, off, deeper = "not resolved", "", "", ""
            if side["resolved"]:
                shear, depth = f"{1e-6 * side['largest_shear_pa']:.1f}", f"{1e6 * side['depth_m']:.1f}"
                off, deeper = (percent(side[name]) for name in ("shear_deviation", "depth_deviation"))
            lines.append({
                "load": _case(row), "race": side["race"], "body": side["body"],
                "shear MPa": shear, "Hertz MPa": f"{1e-6 * side['hertz_largest_shear_pa']:.1f}", "shear off": off,
                "depth µm": depth, "Hertz µm": f"{1e6 * side['hertz_depth_m']:.1f}", "depth off": deeper,
                "elements down to it": f"{side['cells_to_hertz_depth']:.1f}",
            })  # fmt: skip
    out.rows(lines, "Elastic bodies: largest shear stress and its depth")
    if section is not None:
        cuts = "Sections through ball and races at the most loaded contact of each race under the heaviest load"
        alternative = f"{cuts}: von Mises stress, largest shear stress, and both along the contact’s normal beside Hertz’s."
        out.figures([(section, alternative, "elastic bodies under the heaviest axial load")], wide=True)
        return
    reasons = [row["no_picture"] for row in rows if row.get("no_picture")]
    why = reasons[0] if reasons else "no run of elastic bodies under the heaviest load was drawn"
    out.text(f"No section is drawn: {why}.", kind="note")


def _cost_row(row: ReadTables) -> Tables:
    cost, state = row["cost"], Cell("completed", "good")
    if row["status"] != "completed":
        state = Cell(row["status"], "failed", row["reason"])
    memory = cost["peak_memory_bytes"]
    return {
        "run": _case(row), "bodies": _way(row), "elements": shown(cost["elements"]),
        "CPU s": f"{cost['cpu_s']:.1f}", "and compiling s": f"{cost['compile_s']:.1f}", "wall s": f"{cost['wall_s']:.1f}",
        "peak GiB": shown(None if memory is None else memory / 2**30, ".2f"),
        "steps": shown(cost["steps"]), "iterations": shown(cost["newton_iterations"]), "": state,
    }  # fmt: skip
