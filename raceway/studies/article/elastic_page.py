"""The page of the study: what the numbers say, pressures, bodies against each other, the motions, stresses and cost."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from rich.console import Group, RenderableType

from raceway.out.page import Cell, Page
from raceway.out.table import rows_table, written
from raceway.out.wrapping import Words
from raceway.pipeline.result import write_json
from raceway.storage.tables import ReadTables, Tables
from raceway.studies.article.elastic import RACES
from raceway.studies.article.figures import Panel, Picture, finish
from raceway.studies.article.page import save_pictures, write_csv

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from raceway.studies.article.elastic import ElasticArticle


def per_cent(part: float | None) -> str:
    """A relative difference; a dash where there is none."""
    return "-" if part is None else f"{100.0 * part:+.2f} %"


def gib(cost: ReadTables) -> str:
    """Memory at the peak of a row [GiB]."""
    peak = cost["peak_memory_bytes"]
    return "-" if peak is None else f"{peak / 2**30:.2f}"


#: The article's largest deviation of a peak pressure from exact Hertz, section 3.2.
ARTICLE_DEVIATION = 0.0242
LOOKS = {"elastic": ("#c8501e", "o"), "condensed": ("#0b5fa5", "s"), "rigid": ("#5b6570", "^")}


def drawings(content: ReadTables) -> list[Picture]:
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


def elastic_screen(content: ReadTables, files: Sequence[str]) -> RenderableType:
    """Pressures, differences from condensed bodies, balance of energy and cost of every run.

    Parameters
    ----------
    content : what ``--json`` prints;  files : what was written
    """
    rows = content["rows"]
    at_rest = [_rest_cells(row) for row in rows if row["phase"] == "static"]
    moving = [_motion_cells(row) for row in rows if row["phase"] == "motion"]
    cost = content["cost"]
    lines = [
        f"{row['phase']} {row['case']}, {row['bodies']} bodies: {row['status']}: {row['reason']}"
        for row in rows
        if row["reason"]
    ]
    lines += [f"elements of elastic bodies: {content['elements']}"] if content["elements"] else []
    end = f"{content['runs']} runs, {content['failed']} failed; {cost['wall_s']:.0f} s, {cost['cpu_s']:.0f} s of processor time"
    end += f"; {cost['reused']} rows taken from earlier" if cost["reused"] else ""
    return Group(
        Words(content["title"], "bold"),
        rows_table(at_rest, f"at rest: nodal peak pressure of the most loaded ball from Hertz's; Q (ball loads), x, y, kyy from {content['reference']} bodies"),
        rows_table(moving, f"{content['speed_rpm']:g} r/min, {content['turns']} turn{'s' if content['turns'] > 1 else ''} of {content['steps_per_turn']} steps; K, |Z| and w C over |Z| from {content['reference']} bodies"),
        *(Words(line, "magenta") for line in lines),
        Words(end, "dim"),
        *written(files),
    )  # fmt: skip


def _rest_cells(row: ReadTables) -> Tables:
    hertz, other = row.get("from_hertz") or {}, row.get("from_condensed") or {}
    return {
        "load N": f"{row['axial_n']:g}" + (f" + {row['radial_n']:g}" if row["radial_n"] else ""),
        "bodies": row["bodies"],
        "p in %": _percent((hertz.get("inner") or {}).get("most_loaded")),
        "p out %": _percent((hertz.get("outer") or {}).get("most_loaded")),
        "Q %": _percent(other.get("ball_loads")),
        "x %": _percent(other.get("x")),
        "y %": _percent(other.get("y")),
        "kyy %": _percent(other.get("kyy")),
        **_cost_cells(row),
    }


def _motion_cells(row: ReadTables) -> Tables:
    found, other = row.get("identified") or {}, row.get("from_condensed") or {}
    balance = row.get("energy_balance")
    return {
        "force": row["case"].split()[0],
        "bodies": row["bodies"],
        "K N/µm": "-" if not found else f"{1e-6 * found['k']:.2f}",
        "C N s/m": "-" if not found else f"{found['c']:.0f}",
        "|Z| N/µm": "-" if not found else f"{1e-6 * found['abs_z']:.2f}",
        "K %": _percent(other.get("k")),
        "wC %": _percent(other.get("wc")),
        "|Z| %": _percent(other.get("abs_z")),
        "energy": "-" if balance is None else f"{balance:.1e}",
        **_cost_cells(row),
    }


def _cost_cells(row: ReadTables) -> Tables:
    cost = row["cost"]
    return {"CPU s": f"{cost['cpu_s']:.1f}", "GiB": gib(cost)}


def _percent(part: float | None) -> str:
    """Per cent without the sign, which the head has."""
    return per_cent(part).removesuffix(" %")


def page(content: ReadTables, pictures: Sequence[Picture], section: bytes | None, command: str) -> Page:
    """The page.

    Parameters
    ----------
    content : article-elastic.json;  section : PNG of the section through the most loaded contact, if it was drawn
    command : what makes the page again
    """
    from raceway import __version__

    cost = content["cost"]
    footer = f"Made by `{command}`, Raceway {__version__}; its runs took {cost['rows_cpu_s']:.0f} s of processor time. "
    footer += "All numbers: article-elastic.json and article-elastic.csv beside this page."
    out = Page("The article’s own model: elastic rings and balls", content["title"], footer)
    drawn = {one.name: one for one in pictures}
    rest = [row for row in content["rows"] if row["phase"] == "static"]
    moving = [row for row in content["rows"] if row["phase"] == "motion"]
    _opening(out, content)
    _pressures(out, rest, drawn)
    _at_rest(out, rest, content["reference"], drawn)
    _motion(out, moving, content, drawn)
    _stresses(out, rest, section)
    _cost(out, content)
    _differences(out, content)
    return out


def _opening(out: Page, content: ReadTables) -> None:
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


def in_short(content: ReadTables) -> list[str]:
    """What the numbers say, as far as runs came to an end."""
    elastic = [row for row in content["rows"] if row["bodies"] == "elastic" and row["status"] == "completed"]
    found = []
    off = [
        row["from_hertz"][race]["largest"]
        for row in elastic
        if row["phase"] == "static"
        for race in RACES
        if row["from_hertz"][race]
    ]
    if off:
        found.append(
            f"Peak pressures of elastic bodies differ from Hertz at the same ball load by at most {per_cent(max(off, key=abs))} "
            f"(the article’s own largest: {100.0 * ARTICLE_DEVIATION:.2f} %)."
        )
    held = [(row, row[f"from_{content['reference']}"]) for row in elastic]
    for phase, names in (("static", ("ball_loads", "x", "y", "kyy")), ("motion", ("k", "abs_z"))):
        parts = [
            (name, other[name])
            for row, other in held
            if other and row["phase"] == phase
            for name in names
            if other[name] is not None
        ]
        if parts:
            name, value = max(parts, key=lambda part: abs(part[1]))
            words = "at rest (ball loads, x, y, kyy)" if phase == "static" else "in motion (K, |Z|)"
            found.append(
                f"Elastic from {content['reference']} bodies {words}: at most {per_cent(value)}, in {_NAMES[name]}."
            )
    balance = [row["energy_balance"] for row in elastic if row["phase"] == "motion" and row["energy_balance"] is not None]
    if balance:
        found.append(f"The energy of the motions of elastic bodies is balanced to {max(balance):.1e} of what was exchanged.")
    if content["failed"]:
        found.append(
            f"{content['failed']} of {content['runs']} runs failed or were refused: the reasons stand under “Cost”."
        )
    return found


_NAMES = {"ball_loads": "a ball load, over the largest", "x": "x", "y": "y", "kyy": "kyy", "k": "K", "abs_z": "|Z|"}


def _pressures(out: Page, rows: list[Tables], drawn: dict[str, Picture]) -> None:
    out.section("Peak pressures")
    out.text(
        "Largest nodal pressure, force over the area around a node, over Hertz’s at the load that the same ball carries, less 1: of the "
        "most loaded ball, and the largest of any ball that carries more than 5 % of it. Rigid bodies have no points: theirs is Hertz’s."
    )
    lines = []
    for row in rows:
        for race in RACES:
            found = (row.get("from_hertz") or {}).get(race)
            if found is not None:
                lines.append([_case(row), row["bodies"], race, f"{found['load_n']:.1f}", f"{1e-6 * found['peak_pressure_pa']:.1f}",
                              f"{1e-6 * found['hertz_peak_pressure_pa']:.1f}", per_cent(found["most_loaded"]), _judged(found["largest"])])  # fmt: skip
    columns = ["load", "bodies", "race", "ball load N", "peak MPa", "Hertz MPa", "off Hertz", "most off, any ball"]
    out.table(columns, lines, "Peak pressures against exact Hertz at the most loaded ball; last column: of all loaded balls")
    _picture(out, drawn, "article-elastic-pressures")


def _case(row: ReadTables) -> str:
    """The load case, broken between two loads or words of a force only: a narrow screen has a line for each."""
    return str(row["case"]).replace(" N ", "\u00a0N\u00a0")


def _judged(off: float) -> Cell:
    within = abs(off) <= ARTICLE_DEVIATION
    return Cell(per_cent(off), "good" if within else "bad", "" if within else "beyond the article’s 2.42 %")


def _at_rest(out: Page, rows: list[Tables], reference: str, drawn: dict[str, Picture]) -> None:
    out.section("Bodies against each other, at rest")
    lines = []
    for row in rows:
        if row["status"] == "completed":
            where, other = row["displacement"], row[f"from_{reference}"] or {}
            lines.append([_case(row), row["bodies"], f"{1e6 * where['x']:.4f}", f"{1e6 * where['y']:.4f}".replace("-0.0000", "0.0000"), f"{1e-6 * row['kyy_n_per_m']:.2f}",
                          *(per_cent(other.get(name)) for name in ("ball_loads", "x", "y", "kyy"))])  # fmt: skip
    columns = ["load", "bodies", "x µm", "y µm", "kyy N/µm", "ball loads", "x", "y", "kyy"]
    out.table(columns, lines, f"Displacements and stiffness; the last four columns are differences from {reference} bodies, ball loads over the largest")  # fmt: skip
    _picture(out, drawn, "article-elastic-ball-loads")


def _motion(out: Page, rows: list[Tables], content: ReadTables, drawn: dict[str, Picture]) -> None:
    out.section("In motion")
    out.text(
        f"{content['speed_rpm']:g} r/min, {content['scene']['load']['axial']:g} N, tilt locked, balls with inertia, friction "
        f"{content['friction']:g}; integrator `newmark`, {content['turns']} turn{'s' if content['turns'] > 1 else ''} of "
        f"{content['steps_per_turn']} steps, the same start and "
        "identifier for all bodies. Unidirectional: a force of constant amplitude along one line. Bidirectional: m e w² of the rig’s "
        "unbalance, turning with the rotor. The balance of energy is its drift over what was exchanged; stability is what result.json "
        "states: Floquet multipliers belong to steady orbits, which friction does not have."
    )
    if content["turns"] == 1:
        out.text(
            "One turn only: how much of K and C is the transient of the start is not known, and C may be little else. Take `--turns 2`.",
            kind="note",
        )
    lines = []
    for row in rows:
        if row["status"] == "completed":
            found, other, state = row["identified"], row[f"from_{content['reference']}"] or {}, row["stability"]
            lines.append([_case(row), row["bodies"], f"{1e-6 * found['k']:.3f}", f"{found['c']:.0f}", f"{1e-6 * found['abs_z']:.3f}",
                          *(per_cent(other.get(name)) for name in ("k", "c", "wc", "abs_z")),
                          _small(row["energy_balance"]), _small(row["error"]["transient"]), state["status"]])  # fmt: skip
    columns = [
        "force",
        "bodies",
        "K N/µm",
        "C N s/m",
        "|Z| N/µm",
        "K",
        "C",
        "wC over |Z|",
        "|Z|",
        "energy balance",
        "transient",
        "stability",
    ]
    out.table(columns, lines, f"Identified at the operating point; K, C, |Z| without unit: differences from {content['reference']} bodies; transient: part of |Z| by which turns differ")  # fmt: skip
    _picture(out, drawn, "article-elastic-stiffness")


def _stresses(out: Page, rows: list[Tables], section: bytes | None) -> None:
    out.section("Stresses below the most loaded contact")
    out.text(
        "The largest shear stress on the contact’s normal, in ball and ring, and its depth, beside Hertz’s at the same load. Not resolved: "
        "fewer than four elements down to Hertz’s depth or along a semi-axis of the ellipse."
    )
    lines = []
    for row in rows:
        for one in row.get("below_contact") or []:
            found = [
                f"{1e-6 * one['largest_shear_pa']:.1f}",
                per_cent(one["shear_deviation"]),
                f"{1e6 * one['depth_m']:.1f}",
                per_cent(one["depth_deviation"]),
            ]
            shear, more, depth, deeper = found if one["resolved"] else ("not resolved", "", "", "")
            lines.append([_case(row), one["race"], one["body"], shear, f"{1e-6 * one['hertz_largest_shear_pa']:.1f}", more,
                          depth, f"{1e6 * one['hertz_depth_m']:.1f}", deeper, f"{one['cells_to_hertz_depth']:.1f}"])  # fmt: skip
    columns = ["load", "race", "body", "shear MPa", "Hertz MPa", "off", "depth µm", "Hertz µm", "off", "elements down to it"]
    out.table(columns, lines, "Elastic bodies: largest shear stress and its depth")
    if section is not None:
        alternative = (
            "Sections through ball and races at the most loaded contact of each race under the heaviest load: von Mises stress, largest shear "
            "stress, and both along the contact’s normal beside Hertz’s."
        )
        out.figures([(section, alternative, "elastic bodies under the heaviest axial load")], wide=True)
        return
    why = next(
        (row["no_picture"] for row in rows if row.get("no_picture")),
        "no run of elastic bodies under the heaviest load was drawn",
    )
    out.text(f"No section is drawn: {why}.", kind="note")


def _cost(out: Page, content: ReadTables) -> None:
    out.section("Cost")
    lines = []
    for row in content["rows"]:
        cost = row["cost"]
        state = Cell("completed", "good") if row["status"] == "completed" else Cell(row["status"], "failed", row["reason"])
        lines.append([_case(row), row["bodies"], _count(cost["elements"]), f"{cost['cpu_s']:.1f}", f"{cost['compile_s']:.1f}", f"{cost['wall_s']:.1f}",
                      gib(cost), _count(cost["steps"]), _count(cost["newton_iterations"]), state])  # fmt: skip
    columns = ["run", "bodies", "elements", "CPU s", "and compiling s", "wall s", "peak GiB", "steps", "iterations", ""]
    out.table(columns, lines, "Every run; elements of condensed bodies are none of the run")
    out.text(
        "Runs go one at a time. What elastic bodies are factored into is kept on disk: later load cases and runs read it.",
        kind="note",
    )


def _differences(out: Page, content: ReadTables) -> None:
    out.section("What differs between the bodies")
    out.listing(content["what_differs"])
    warned = [[_case(row), row["bodies"], words] for row in content["rows"] for words in row.get("warnings") or []]
    if warned:
        out.table(["run", "bodies", "warning"], warned, "Warnings of the runs")


def _picture(out: Page, drawn: dict[str, Picture], name: str) -> None:
    if name in drawn:
        out.heading(drawn[name].title)
        out.figures([(panel.figure(), panel.alternative, panel.caption) for panel in drawn[name].panels])


def _small(value: float | None) -> str:
    return "–" if value is None else f"{value:.1e}"


def _count(value: int | None) -> str:
    return "–" if value is None else str(value)


def write(study: ElasticArticle, folder: Path, pictures: bool, command: str) -> list[Path]:
    """Write everything; the files, the page first.

    Raises
    ------
    RacewayError
        matplotlib is missing, or a folder or disk that cannot be written.
    """
    content = study.to_dict()
    files = [write_json(content, folder / "article-elastic.json")]
    files.append(write_csv(_columns(content["rows"]), folder / "article-elastic.csv"))
    if pictures:
        drawn = drawings(content)
        files += save_pictures(drawn, folder)
        stress = [
            folder / name for row in content["rows"] for name in row.get("pictures") or [] if (folder / name).is_file()
        ]
        files += stress
        section = next((file.read_bytes() for file in stress if file.suffix == ".png"), None)
        files.insert(0, page(content, drawn, section, command).write(folder / "article-elastic.html"))
    return files


def _columns(rows: Sequence[ReadTables]) -> list[Tables]:
    """Flat rows without what is a table in other rows: its own columns stay empty where there is none."""
    found = [flat(row) for row in rows]
    inner = {name.rpartition(".")[0] for row in found for name in row}
    return [{name: value for name, value in row.items() if name not in inner} for row in found]


def flat(table: ReadTables, before: str = "") -> Tables:
    """Numbers and words of nested tables, with their names joined by dots; lists are left to the JSON file."""
    out: Tables = {}
    for name, value in table.items():
        if isinstance(value, dict):
            out |= flat(value, f"{before}{name}.")
        elif not isinstance(value, list):
            out[f"{before}{name}"] = value
    return out
