"""The page of the study: verdicts first, then figures, causes, and everything that they were checked with."""

from __future__ import annotations

import csv
import io
from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import attrs
from rich.box import SIMPLE_HEAD
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from raceway.out.page import Cell, Page
from raceway.out.table import written
from raceway.out.wrapping import Words
from raceway.pipeline.result import without_nan, write_json
from raceway.plugins.pictures import save_figure
from raceway.storage.files import write_whole
from raceway.storage.tables import ReadTables, Tables
from raceway.studies.article import runs
from raceway.studies.article.design import FRICTION_STEPS, FRICTION_TURNS, FRICTION_WORDS, FRICTIONS, TILT_WORDS, TILTS
from raceway.studies.article.figures import Picture, drawings, named
from raceway.studies.article.rules import FAILED, HOLDS, NOT, PARTLY, UNTESTED, Verdict

if TYPE_CHECKING:
    from raceway.studies.article.study import Article


TONES = {HOLDS: "good", PARTLY: "partly", NOT: "bad", FAILED: "failed", UNTESTED: "partly"}
ARTICLE = "“Dynamic Stiffness Characteristics of Bearings Under Combined Loads with Rotor Excitation” (Lubricants 2026, 14(3), 128)"


def page(study: Article, pictures: Sequence[Picture], command: str) -> Page:
    """The page; ``command`` is what makes it again."""
    from raceway import __version__

    footer = f"Made by `{command}`, Raceway {__version__}, in {study.cpu_s:.0f} s of processor time. "
    footer += "Numbers of all runs: article.json and curves.csv beside this page."
    out = Page("The article’s claims, computed again", study.title, footer)
    _opening(out, study)
    _friction(out, study, {one.name: one for one in pictures})
    _verdicts(out, study)
    _setting(out, study)
    _figures(out, study, {one.name: one for one in pictures})
    _static(out, study)
    _trends(out, study)
    _rig(out, study)
    _faults(out, study)
    return out


def _opening(out: Page, study: Article) -> None:
    counts = {kind: sum(one.kind == kind for one in study.verdicts) for kind in TONES}
    words = {
        HOLDS: "hold",
        PARTLY: "hold only in a region",
        NOT: "do not hold",
        FAILED: "failed",
        UNTESTED: "cannot be tested",
    }
    told_counts = ", ".join(f"{count} {words[kind]}" for kind, count in counts.items() if count)
    out.text(
        f"The claims of {ARTICLE} are put to {sum(len(rows) for rows in study.curves.rows.values())} motions of this "
        f"program, each claim in every reading that its words allow. Of {len(study.verdicts)} readings {told_counts}. No claim "
        "is fitted: each verdict follows from a rule that is printed beside it.",
        kind="lead",
    )
    out.listing(in_short(study))
    _swaps(out, study, study.curves.design.own_load)


def in_short(study: Article) -> list[str]:
    """What the numbers say, in two sentences."""
    load = study.curves.design.own_load
    row = runs.one_at_a_time(study.curves, load)[0][1]
    out = [
        _friction_in_short(study),
        f"Under the rotating force m e w² at {load:g} N, without friction, K changes from the lowest to the highest speed by {_each(row)}.",
    ]
    turns = {load: runs.turning_point(runs.hardening(rows)) for load, rows in study.scan.items()}
    known = [f"{_round(value)} N m/rad at {load:g} N" for load, value in turns.items() if value is not None]
    if known:
        out.append(
            f"What turns hardening into softening is the tilt stiffness of the shaft: K stops rising with speed above "
            f"{', '.join(known)}. The shaft is taken with {_round(study.curves.design.shaft)} N m/rad."
        )
    return out


def _friction_in_short(study: Article) -> str:
    """What the article's friction does where it does most."""
    made = study.curves.design
    if len(made.frictions) < 2:
        return "All runs are without friction, of which the article has a coefficient of 0.03."
    known = [one for one in runs.friction_trends(study.curves) if not any(isinstance(one[kind], str) for kind in FRICTIONS)]
    if not known:
        return f"No run with the article's friction of {made.friction:g} came to an end: every verdict is without it."
    most = max(known, key=lambda one: abs(one["standing"] - one["none"]))
    told = ", ".join(f"{_percent(most[kind])} {FRICTION_WORDS[kind]}" for kind in FRICTIONS)
    return (
        f"Friction, {made.friction:g} in the article, comes first: where it does most ({TILT_WORDS[most['tilt']]}, "
        f"{most['axial_n']:g} N, rotating force m e w²) K changes from the lowest to the highest speed by {told}."
    )


def _friction(out: Page, study: Article, pictures: dict[str, Picture]) -> None:
    made = study.curves.design
    out.section("Friction")
    if len(made.frictions) < 2:
        out.text(
            "Nothing was run with friction: `--friction 0`, or no rigid bodies. Every verdict is without it.", kind="note"
        )
        return
    out.text(
        f"The article's contacts have a Coulomb coefficient of {made.friction:g} between balls and rings, so that every claim is "
        "judged without and with it. It acts in the plane of axis and ball, in which balls do not roll: a contact that sticks holds ball "
        "and ring together along the groove, which is a tangential stiffness. A turning bearing renews its contacts within a small part "
        "of a turn, and keeps little of it. Balls that stand keep what sticks for as long as the motion repeats itself; on balls that "
        "orbit at cage speed each contact meets the force at another frequency, so that what sticks changes all the time. "
        "The two are told apart because the article does not say how its balls move.",
        f"With friction there is no steady orbit to solve for: where contacts stick depends on how the motion began. Those runs go "
        f"through time (integrator `newmark`, {FRICTION_TURNS} turns of {FRICTION_STEPS} steps, the force grows over two thirds of them "
        "and the last third counts) at every other speed and axial load, with rigid bodies and ball inertia.",
    )
    columns = ["", *(FRICTION_WORDS[one] for one in made.frictions)]
    rows = [
        [f"{TILT_WORDS[one['tilt']]}, {one['axial_n']:g} N", *(_percent(one[kind]) for kind in made.frictions)]
        for one in runs.friction_trends(study.curves)
    ]
    out.table(columns, rows, "Change of K from the lowest to the highest speed, k*(1) − 1, rotating force m e w²")
    _picture(out, pictures["friction"])


def _swaps(out: Page, study: Article, load: float) -> None:
    columns = ["one choice swapped at a time", *(TILT_WORDS[tilt] for tilt in TILTS)]
    rows = [[name, *(_percent(row[tilt]) for tilt in TILTS)] for name, row in runs.one_at_a_time(study.curves, load)]
    out.table(columns, rows, f"Change of K from the lowest to the highest speed, k*(1) − 1, at {load:g} N")


def _each(row: dict[str, float | str]) -> str:
    return ", ".join(f"{_percent(row[tilt])} ({TILT_WORDS[tilt]})" for tilt in TILTS)


def _round(value: float) -> str:
    """Three significant digits without an exponent."""
    return f"{float(f'{value:.3g}'):,.0f}".replace(",", "\u202f")


def _percent(change: float | str) -> str:
    return change if isinstance(change, str) else f"{100.0 * change:+.2f}\u202f%".replace("-", "−")


def _verdicts(out: Page, study: Article) -> None:
    out.section("Verdicts")
    rows = [[one.number, one.claim, Cell(one.kind, TONES[one.kind], one.region)] for one in study.verdicts]
    out.table(["", "claim", "verdict"], rows, "The article’s claims; how each was decided stands below")
    for one in study.verdicts:
        parts = [("Rule", one.rule), ("Computed", one.computed)]
        if one.failed:
            parts.append(("Failed", f"runs failed or have no stable motion: {one.failed}"))
        out.card(f"{one.number}  {one.claim}", _badge(one), parts)


def _badge(one: Verdict) -> Cell:
    return Cell(one.kind, TONES[one.kind], one.region)


def _setting(out: Page, study: Article) -> None:
    made = study.curves.design
    tables: ReadTables = made.tables
    mass = tables.get("rotor", {}).get("mass", 0.0)
    given = tables["excitation"]
    constant = f"{given['force']:g} N" if "force" in given else f"that at {given['reference_speed_rpm']:g} r/min"
    out.section("What is computed")
    out.text(
        f"Without friction the steady orbit of the inner ring is solved for directly (integrator `periodic`) at {len(made.speeds)} speeds from "
        f"{made.speeds[0]:g} to {made.speeds[-1]:g} r/min and {len(made.loads)} axial loads from {made.loads[0]:g} to "
        f"{made.loads[-1]:g} N. Its 1x line gives Z = F / x = K − m w² + j w C. k is K = Re Z + m w² unless something else is "
        f"said; the mass m is the ring’s and {mass:g} kg of the rotor. w* = (w − w_min) / (w_max − w_min), k* = k / k(w_min).",
        "Rotating: a force that turns with the rotor (the article’s bidirectional model). Unidirectional: a force along one fixed "
        f"line. Its amplitude is m e w², or constant: {constant}. The article changes both at once; here each is varied alone, "
        f"too, at the lightest, the scene's own and the heaviest axial load ({made.bodies[0]} bodies).",
        f"Tilt of the inner ring: locked, free, or against the shaft with {_round(made.shaft)} N m/rad (2 E I / L of a shaft of "
        "30 mm between bearings 175 mm apart, unless the scene or `--shaft` says otherwise). Ball inertia: the centrifugal force "
        "of the balls. Rigid: only the contacts deform. Condensed: finite-element rings and balls, condensed exactly onto the "
        "contacts.",
    )
    out.text(
        "The article’s Table 1 is lost: the geometry of B7206C is inferred from makers’ load ratings. Oil film, cage and heat are "
        "not modelled, neither here nor in the article.",
        kind="note",
    )


def _figures(out: Page, study: Article, pictures: dict[str, Picture]) -> None:
    parts = (
        ("Figure 9: excitation", ("figure-9", "figure-9-newton-per-metre", "figure-9-with-inertia")),
        ("Figure 10: speed", ("figure-10", "figure-10-newton-per-metre")),
        ("Figure 11: axial load", ("figure-11", "figure-11-newton-per-metre")),
        ("Figure 12: both", ("figure-12", "figure-12-weightless-balls", "figure-12-newton-per-metre")),
    )
    bodies = study.curves.design.bodies
    for kind in bodies:
        for heading, names in parts:
            out.section(heading if kind == bodies[0] else f"{heading}, {kind} bodies")
            for name in names:
                _picture(out, pictures[named(name, bodies, kind)])
    out.section("What causes the trend")
    out.text("One choice is swapped at a time; everything else stays.")
    curves = study.curves
    for load in dict.fromkeys((curves.design.loads[0], curves.design.own_load, curves.design.loads[-1])):
        _swaps(out, study, load)
    _picture(out, pictures["tilt-stiffness"])
    if "bodies" in pictures:
        out.section("Rigid and condensed bodies")
        _picture(out, pictures["bodies"])


def _picture(out: Page, picture: Picture) -> None:
    out.heading(picture.title)
    out.figures([(panel.figure(), panel.alternative, panel.caption) for panel in picture.panels])


def _static(out: Page, study: Article) -> None:
    out.section("Static verification")
    out.text(
        "Claims 1a and 1b cannot be tested: the article’s load cases are lost. Section 3.2 of it compares peak pressures of its finite-element model with exact Hertz in the rigid equilibrium. "
        "Reported here: nodal contact on condensed bodies, the pressure at surface points, no penalty, in four load cases of our own "
        "that span its range. The bearing is the article’s, whatever scene the study is given."
    )
    rows = [
        [one["quantity"], _digits(one["reference"]), _digits(one["computed"]), _share(one["error"]), _share(one["tolerance"]),
         _kept(one["ok"], one["note"])]
        for one in study.static
    ]  # fmt: skip
    out.table(["quantity", "exact Hertz", "computed", "deviation", "at most", ""], rows)


def _trends(out: Page, study: Article) -> None:
    out.section("Against an independent solver")
    out.text(
        "Quasi-static secant stiffness under the rig’s force as a radial load towards ball 0: numbers of an independent "
        "rigid-ring solver (docs/physics.md, section 7) and of this program. A row holds when every number rounds to the printed "
        "digits."
    )
    columns = ["", "", "k(10 980) N/µm", *(f"k* {speed:g}" for speed in runs.SPEEDS[1:]), "off, last digit", ""]
    rows: list[list[object]] = []
    for one in study.trends:
        balls = "ball inertia" if one.inertia else "weightless balls"
        rows.append([f"tilt {one.tilt}, {one.load:g} N, {balls}", "expected", f"{one.expected[0]:.4g}",
                     *(f"{ratio:.3f}" for ratio in one.expected[1:]), "", ""])  # fmt: skip
        found = one.computed or (None,) * len(one.expected)
        rows.append(
            ["", "computed", *(_digits(value, 5) for value in found), _digits(one.off, 2), _kept(one.holds, one.why)]
        )
    out.table(columns, rows)


def _rig(out: Page, study: Article) -> None:
    out.section("At the rig’s speeds and loads")
    out.text(
        "What claim 2 would be held against the rig with: K under the rotating force m e w² with ball inertia. The article’s "
        "measured values are lost, so nothing is compared."
    )
    speeds = list(dict.fromkeys(row["speed_rpm"] for row in study.rig))
    table: dict[tuple[str, ...], list[str]] = {}
    for row in study.rig:
        text = f"{row['k'] / 1e6:.4g}" if row["status"] == "completed" else row["status"]
        table.setdefault((row["axial_n"], row["tilt"], row["bodies"]), []).append(text)
    rows = [[f"{load:g} N, {TILT_WORDS[tilt]}, {bodies}", *found] for (load, tilt, bodies), found in table.items()]
    out.table(["", *(f"{speed:g} r/min" for speed in speeds)], rows, "K [N/µm]")


def _faults(out: Page, study: Article) -> None:
    out.section("Failed runs and unstable motions")
    every = [(setting.name, row) for (setting, _), rows in study.curves.rows.items() for row in rows]
    every += [("tilt stiffness of the shaft varied", row) for rows in study.scan.values() for row in rows]
    every += [(f"at the rig’s speeds, {TILT_WORDS[row['tilt']]}, {row['bodies']}", row) for row in study.rig]
    bad = [
        [name, f"{row['axial_n']:g}", f"{row['speed_rpm']:g}", row["status"], row["reason"]]
        for name, row in every
        if row["status"] != "completed"
    ]
    count = Counter(row["status"] for row in study.curves.faults())
    out.text(
        f"{len(study.failed)} of {study.runs} runs failed. {count['unstable']} steady motions of the curves are unstable: they satisfy the equations, but a "
        f"ring does not stay on them; they are crosses in the figures and count for no verdict. At {count['unsteady']} points no steady motion is found. "
        "What a ring does instead is integrated from beside the unstable motion, or from rest. Unidirectional forces meet resonances "
        "of the contacts’ higher harmonics with the ring’s vibrations (docs/periodic.md)."
    )
    if bad:
        out.table(["setting", "axial load N", "r/min", "", "what became of it"], bad)


def _digits(value: float | None, count: int = 5) -> str:
    return "–" if value is None else f"{value:.{count}g}"


def _share(value: float | None) -> str:
    return "–" if value is None else f"{100.0 * value:.2f} %"


def _kept(holds: bool, why: str) -> Cell:
    if why:
        return Cell("failed", "failed", why)
    return Cell("holds", "good") if holds else Cell("does not hold", "bad")


def verdict_rows(study: Article) -> list[Tables]:
    """The verdicts as a flat table."""
    skip = ("findings",)
    return [
        {**attrs.asdict(one, filter=lambda field, _: field.name not in skip), "verdict": one.words} for one in study.verdicts
    ]


_COLOURS = {"holds": "green", "holds only for": "yellow", "does not hold": "red"}


def article_screen(content: ReadTables, files: Sequence[str]) -> RenderableType:
    """Verdicts, the check against an independent solver, failures and cost.

    Parameters
    ----------
    content : what ``--json`` prints;  files : what was written
    """
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for name in ("", "claim", "verdict"):
        table.add_column(name)
    for one in content["verdicts"]:
        words = Text(one["kind"], style=_COLOURS.get(one["kind"], "magenta"))
        if one["region"]:
            words.append(f" {one['region']}", style="default")
        if one["failed"]:
            words.append("; some runs failed or are unstable", style="magenta")
        table.add_row(one["number"], Words(one["claim"]), words)
    trends = content["quasi_static"]
    good = sum(row["holds"] for row in trends)
    cost = content["cost"]
    lines = [
        f"quasi-static trends equal to an independent solver's printed digits: {good} of {len(trends)}",
        f"{content['runs']} points, {content['failed']} failed; {cost['wall_s']:.0f} s, "
        f"{cost['cpu_s']:.0f} s of processor time"
        + (f"; {cost['reused']} of {cost['tasks']} pieces taken from earlier" if cost["reused"] else ""),
    ]
    return Group(Words(content["title"], "bold"), table, *(Words(line, "dim") for line in lines), *written(files))


_DOTS_PER_INCH = 110


def write(study: Article, folder: Path, pictures: bool = True, command: str = "raceway study article") -> list[Path]:
    """Write everything; the files, the page first.

    Raises
    ------
    RacewayError
        matplotlib is missing, or a folder or disk that cannot be written.
    """
    content = study.to_dict()
    files = [write_json(content, folder / "article.json")]
    files += [write_csv(rows, folder / f"{name}.csv") for name, rows in _tables(study, content).items()]
    if pictures:
        drawn = drawings(study)
        files += save_pictures(drawn, folder)
        files.insert(0, page(study, drawn, command).write(folder / "article.html"))
    return files


def save_pictures(drawn: Iterable[Picture], folder: Path) -> list[Path]:
    """Each as a PNG of its name."""
    return [save_figure(one.figure(), folder / f"{one.name}.png", _DOTS_PER_INCH) for one in drawn]


def _tables(study: Article, content: ReadTables) -> dict[str, list[Tables]]:
    scan = [
        {"axial_n": load, "tilt_stiffness": stiffness, "k_ratio": ratio}
        for load, rows in study.scan.items()
        for stiffness, ratio in zip(runs.STIFFNESSES, without_nan(runs.hardening(rows).tolist()), strict=True)
    ]
    trends = []
    for one in study.trends:
        flat = attrs.asdict(one, filter=lambda field, _: field.name not in ("expected", "computed"))
        for name in ("expected", "computed"):
            values: Sequence[object] = getattr(one, name) or ()
            flat |= {f"{name}_{place}": value for place, value in enumerate(values)}
        trends.append({**flat, "off_in_last_digits": one.off, "holds": one.holds})
    return {
        "curves": content["rows"],
        "verdicts": verdict_rows(study),
        "quasi-static": trends,
        "static": list(study.static),
        "rig": list(study.rig),
        "friction": content["friction_trends"],
        "tilt-stiffness": scan,
    }


def write_csv(rows: Iterable[ReadTables], path: Path) -> Path:
    """A table with every key of any row as a column."""
    found = list(rows)
    text = io.StringIO()
    writer = csv.DictWriter(text, list(dict.fromkeys(key for row in found for key in row)), lineterminator="\n")
    writer.writeheader()
    writer.writerows(found)
    return write_whole(text.getvalue().encode(), path)
