"""The page of the study: what the numbers say, pressures, bodies against each other, the motions, stresses and cost."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from raceway.storage.tables import ReadTables, Tables
from raceway.studies.article.elastic.deviations import RACES
from raceway.studies.article.elastic.figures import ARTICLE_DEVIATION
from raceway.studies.article.elastic.words import gib, per_cent
from raceway.studies.many.page import Cell, Page

if TYPE_CHECKING:
    from raceway.studies.article.panel import Picture


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
