"""The study on page, screen and disk: verdicts first, then figures, causes, and everything that they were checked with."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import attrs

from raceway.extend import Cell, Page, ReadTables, Tables, csv_text, save_figure, write_json, write_whole
from raceway_article.design import FRICTION_STEPS, FRICTION_TURNS, FRICTION_WORDS, SOLVER_SPEEDS, TILT_WORDS, Setting
from raceway_article.figures import Picture, named
from raceway_article.rules import KINDS

ARTICLE = "“Dynamic Stiffness Characteristics of Bearings Under Combined Loads with Rotor Excitation” (Lubricants 2026, 14(3), 128)"


def write_tables(
    name: str,
    content: ReadTables,
    tables: dict[str, list[Tables]],
    pictures: Iterable[Picture],
    folder: Path,
    form: bool | str,
) -> list[Path]:
    """JSON of a study, a CSV file of each table and a PNG file of each picture, of a ``form`` with a name this, too."""
    files = [write_json(content, folder / f"{name}.json")]
    files += [write_whole(csv_text(rows).encode(), folder / f"{title}.csv") for title, rows in tables.items()]
    drawn, forms = ((one.name, one.figure()) for one in pictures), ["png", *([form] if isinstance(form, str) else [])]
    return files + [save_figure(figure, folder / f"{name}.{ending}") for name, figure in drawn for ending in forms]


def page(
    content: ReadTables, load: float, scan: Mapping[float, list[Tables]], pictures: Sequence[Picture], command: str
) -> Page:
    """The page of article.json's content; ``load``: the scene's axial load [N]."""
    from raceway import __version__

    by_name = {picture.name: picture for picture in pictures}
    footer = f"Made by `{command}`, Raceway {__version__}, in {content['cost']['cpu_s']:.0f} s of processor time. "
    footer += "Numbers of all runs: article.json and curves.csv beside this page."
    out = Page("The article’s claims, computed again", content["title"], footer)
    first, *points = lead(content, load)
    out.text(
        f"{first} The claims are those of {ARTICLE}, each in every reading that its words allow; each verdict follows from a rule that is "
        "printed beside it, and no claim is fitted.",
        kind="lead",
    )
    out.listing(points)
    _swaps(out, content, load)
    _friction(out, content, by_name)
    _verdicts(out, content)
    scene, speeds, loads = content["scene"], content["speeds_rpm"], content["axial_n"]
    excitation = scene["excitation"]
    force, speed = excitation.get("force"), excitation.get("reference_speed_rpm")
    constant = f"that at {speed:g} r/min" if force is None else f"{force:g} N"
    out.section("What is computed")
    out.text(
        f"Without friction the steady orbit of the inner ring is solved for directly (integrator `periodic`) at {len(speeds)} speeds from "
        f"{speeds[0]:g} to {speeds[-1]:g} r/min and {len(loads)} axial loads from {loads[0]:g} to "
        f"{loads[-1]:g} N. Its synchronous (1x) component gives Z = F / x = K − m w² + j w C. k is K = Re Z + m w² unless something else is "
        f"said; the mass m is the ring’s and {scene.get('rotor', {}).get('mass', 0.0):g} kg of the rotor. w* = (w − w_min) / (w_max − w_min), k* = k / k(w_min).",
        "Rotating: a force that turns with the rotor (the article’s bidirectional model). Unidirectional: a force along one fixed "
        f"line. Its amplitude is m e w², or constant: {constant}. The article changes both at once; here each is varied alone, "
        f"too, at the lightest, the scene's own and the heaviest axial load ({content['bodies'][0]} bodies).",
        f"Tilt of the inner ring: locked, free, or against the shaft with {_round(content['shaft_tilt_stiffness'])} N m/rad (2 E I / L of a shaft of "
        "30 mm between bearings 175 mm apart, unless the scene or `--shaft` says otherwise). Ball inertia: the centrifugal force "
        "of the balls. Rigid: only the contacts deform. Condensed: finite-element rings and balls, condensed exactly onto the "
        "contacts.",
    )
    out.text(
        "The article’s Table 1 is lost: the geometry of B7206C is inferred from makers’ load ratings. Oil film, cage and heat are "
        "not modelled, neither here nor in the article.",
        kind="note",
    )
    _figures(out, content, by_name, load)
    _static(out, content)
    _trends(out, content)
    _rig(out, content)
    _faults(out, content, [row for rows in scan.values() for row in rows])
    return out


def lead(content: ReadTables, load: float) -> list[str]:
    """What of the article stands, and what decides it: friction, the tilt boundary, the shaft's stiffness."""
    verdicts, motions = content["verdicts"], len(content["rows"])
    counts = Counter(verdict["kind"] for verdict in verdicts)
    parts = ", ".join(f"{counts[kind]} {words}" for kind, (_, words, _) in KINDS.items() if counts[kind])
    first = next(iter(content["causes"][f"{load:g}"].values()))
    changes = ", ".join(f"{percent(first[tilt])} ({words})" for tilt, words in TILT_WORDS.items())
    points = [
        f"Of {len(verdicts)} readings of the article's claims {parts}, by {motions} motions.",
        _friction_in_short(content),
        f"Under the rotating force m e w² at {load:g} N, without friction, K changes from the lowest to the highest speed by {changes}.",
    ]
    turns = [(line["turning_point"], line["axial_n"]) for line in content["tilt_stiffness"]]
    if ends := [f"{_round(stiffness)} N m/rad at {axial:g} N" for stiffness, axial in turns if stiffness is not None]:
        points.append(
            f"What turns hardening into softening is the tilt stiffness of the shaft: K stops rising with speed above "
            f"{', '.join(ends)}. The shaft is taken with {_round(content['shaft_tilt_stiffness'])} N m/rad."
        )
    return points


def _friction_in_short(content: ReadTables) -> str:
    """What the article's friction does where it does most."""
    if not content["friction"]:
        return "All runs are without friction, of which the article has a coefficient of 0.03."
    rows = [row for row in content["friction_trends"] if not any(isinstance(row[kind], str) for kind in FRICTION_WORDS)]
    if not rows:
        return f"No run with the article's friction of {content['friction']:g} came to an end: every verdict is without it."
    most = max(rows, key=lambda row: abs(row["standing"] - row["none"]))
    changes = ", ".join(f"{percent(most[kind])} {words}" for kind, words in FRICTION_WORDS.items())
    return (
        f"Friction, {content['friction']:g} in the article, comes first: where it does most ({TILT_WORDS[most['tilt']]}, "
        f"{most['axial_n']:g} N, rotating force m e w²) K changes from the lowest to the highest speed by {changes}."
    )


def _friction(out: Page, content: ReadTables, pictures: dict[str, Picture]) -> None:
    out.section("Friction")
    if not content["friction"]:
        words = "Nothing was run with friction: `--friction 0`, or no rigid bodies. Every verdict is without it."
        out.text(words, kind="note")
        return
    out.text(
        f"The article's contacts have a Coulomb coefficient of {content['friction']:g} between balls and rings, so that every claim is "
        "judged without and with it. It acts in the plane of axis and ball, in which balls do not roll: a contact that sticks holds ball "
        "and ring together along the groove, which is a tangential stiffness. A turning bearing renews its contacts within a small part "
        "of a turn, and keeps little of it. Balls that stand keep what sticks for as long as the motion repeats itself; on balls that "
        "orbit at cage speed each contact meets the force at another frequency, so that what sticks changes all the time. "
        "The two are distinguished because the article does not state how its balls move.",
        f"With friction there is no steady orbit to solve for: sticking depends on the start of the motion. Those runs go "
        f"through time (integrator `newmark`, {FRICTION_TURNS} turns of {FRICTION_STEPS} steps, the force grows over two thirds of them "
        "and the last third counts) at every other speed and axial load, with rigid bodies and ball inertia.",
    )
    rows = [
        [f"{TILT_WORDS[row['tilt']]}, {row['axial_n']:g} N", *(percent(row[kind]) for kind in FRICTION_WORDS)]
        for row in content["friction_trends"]
    ]
    caption = "Change of K from the lowest to the highest speed, k*(1) − 1, rotating force m e w²"
    out.table(["", *FRICTION_WORDS.values()], rows, caption)
    show_picture(out, pictures, "friction")


def _swaps(out: Page, content: ReadTables, load: float) -> None:
    rows = [[name, *map(percent, changes.values())] for name, changes in content["causes"][f"{load:g}"].items()]
    caption = f"Change of K from the lowest to the highest speed, k*(1) − 1, at {load:g} N"
    out.table(["one choice swapped at a time", *TILT_WORDS.values()], rows, caption)


def _verdicts(out: Page, content: ReadTables) -> None:
    out.section("Verdicts")
    kinds = {kind: (word, tone) for kind, (tone, _, word) in KINDS.items()}
    rows = [[one["number"], one["claim"], Cell(*kinds[one["kind"]]), one["where"]] for one in content["verdicts"]]
    out.table(["", "claim", "verdict", "where"], rows, "The article’s claims; how each was decided stands below")
    for verdict in content["verdicts"]:
        badge = Cell(verdict["kind"], kinds[verdict["kind"]][1], verdict["region"])
        parts = [("Rule", verdict["rule"]), ("Computed", verdict["computed"])]
        if verdict["failed"]:
            parts.append(("Failed", f"runs failed or have no stable motion: {verdict['failed']}"))
        out.card(f"{verdict['number']}  {verdict['claim']}", badge, parts)


_FIGURES = {
    "Figure 9: excitation": ("figure-9", "figure-9-newton-per-metre", "figure-9-with-inertia"),
    "Figure 10: speed": ("figure-10", "figure-10-newton-per-metre"),
    "Figure 11: axial load": ("figure-11", "figure-11-newton-per-metre"),
    "Figure 12: both": ("figure-12", "figure-12-weightless-balls", "figure-12-newton-per-metre"),
}


def _figures(out: Page, content: ReadTables, pictures: dict[str, Picture], load: float) -> None:
    bodies, loads = content["bodies"], content["axial_n"]
    for kind in bodies:
        for heading, names in _FIGURES.items():
            out.section(heading if kind == bodies[0] else f"{heading}, {kind} bodies")
            for name in names:
                show_picture(out, pictures, named(name, bodies, kind))
    out.section("What causes the trend")
    out.text("One choice is swapped at a time; everything else stays.")
    for axial in dict.fromkeys((loads[0], load, loads[-1])):
        _swaps(out, content, axial)
    show_picture(out, pictures, "tilt-stiffness")
    if "bodies" in pictures:
        out.section("Rigid and condensed bodies")
        show_picture(out, pictures, "bodies")


def show_picture(out: Page, pictures: Mapping[str, Picture], name: str) -> None:
    """A picture's panels, each by itself, if it was drawn."""
    if name in pictures:
        out.heading(pictures[name].title)
        out.figures([(panel.figure(), panel.alternative, panel.caption) for panel in pictures[name].panels])


def _static(out: Page, content: ReadTables) -> None:
    out.section("Static verification")
    out.text(
        "Claims 1a and 1b cannot be tested: the article’s load cases are lost. Section 3.2 of it compares peak pressures of its finite-element model with exact Hertz in the rigid equilibrium. "
        "Reported here: nodal contact on condensed bodies, the pressure at surface points, no penalty, in four load cases of our own "
        "that span its range. The bearing is the article’s, whatever scene the study is given."
    )
    rows = [
        [row["quantity"], *(shown(row[name], ".5g") for name in ("reference", "computed")),
         *(shown(row[name], ".2%") for name in ("error", "tolerance")), _outcome(row["ok"], row["note"])]
        for row in content["static"]
    ]  # fmt: skip
    out.table(["quantity", "exact Hertz", "computed", "deviation", "at most", ""], rows)


def _trends(out: Page, content: ReadTables) -> None:
    out.section("Against an independent solver")
    out.text(
        "Quasi-static secant stiffness under the rig’s force as a radial load towards ball 0: numbers of an independent "
        "rigid-ring solver (docs/physics.md, section 7) and of this program. A row holds when every number rounds to the printed "
        "digits."
    )
    columns = ["", "", "k(10 980) N/µm", *(f"k* {speed:g}" for speed in SOLVER_SPEEDS[1:]), "off, last digit", ""]
    rows: list[list[object]] = []
    for trend in content["quasi_static"]:
        balls = "ball inertia" if trend["inertia"] else "weightless balls"
        first, *ratios = trend["expected"]
        answers = trend["computed"] or (None,) * len(trend["expected"])
        digits = [f"{first:.4g}", *(f"{ratio:.3f}" for ratio in ratios)]
        rows.append([f"tilt {trend['tilt']}, {trend['load']:g} N, {balls}", "expected", *digits, "", ""])
        off, outcome = shown(trend["off_in_last_digits"], ".2g"), _outcome(trend["holds"], trend["why"])
        rows.append(["", "computed", *(shown(value, ".5g") for value in answers), off, outcome])
    out.table(columns, rows)


def _rig(out: Page, content: ReadTables) -> None:
    out.section("At the rig’s speeds and loads")
    compared = "What claim 2 would be compared with at the rig: K under the rotating force m e w² with ball inertia"
    out.text(f"{compared}. The article’s measured values are lost, so nothing is compared.")
    speeds = dict.fromkeys(row["speed_rpm"] for row in content["rig"])
    cells: dict[str, list[str]] = {}
    for row in content["rig"]:
        text = f"{row['k'] / 1e6:.4g}" if row["status"] == "completed" else row["status"]
        cells.setdefault(f"{row['axial_n']:g} N, {TILT_WORDS[row['tilt']]}, {row['bodies']}", []).append(text)
    out.table(["", *(f"{speed:g} r/min" for speed in speeds)], [[name, *row] for name, row in cells.items()], "K [N/µm]")


def _faults(out: Page, content: ReadTables, scan: Iterable[ReadTables]) -> None:
    out.section("Failed runs and unstable motions")
    rows = [(Setting(*(row[field.name] for field in attrs.fields(Setting))).name, row) for row in content["rows"]]
    rows += [("tilt stiffness of the shaft varied", row) for row in scan]
    rows += [(f"at the rig’s speeds, {TILT_WORDS[row['tilt']]}, {row['bodies']}", row) for row in content["rig"]]
    cells = [
        [name, f"{row['axial_n']:g}", f"{row['speed_rpm']:g}", row["status"], row["reason"]]
        for name, row in rows
        if row["status"] != "completed"
    ]
    count = Counter(row["status"] for row in content["rows"])
    out.text(
        f"{content['failed']} of {content['runs']} runs failed. {count['unstable']} steady motions of the curves are unstable: they satisfy the equations, but a "
        f"ring does not stay on them; they are crosses in the figures and count for no verdict. At {count['unsteady']} points no steady motion is found. "
        "What a ring does instead is integrated from beside the unstable motion, or from rest. Unidirectional forces meet resonances "
        "of the contacts’ higher harmonics with the ring’s vibrations (docs/periodic.md)."
    )
    if cells:
        out.table(["setting", "axial load N", "r/min", "", "what became of it"], cells)


def _outcome(holds: bool, why: str) -> Cell:
    if why:
        return Cell("failed", "failed", why)
    return Cell("holds", "good") if holds else Cell("does not hold", "bad")


def shown(value: float | None, form: str = "") -> str:
    """A number; a dash where there is none."""
    return "–" if value is None else f"{value:{form}}"


def _round(value: float) -> str:
    """Three significant digits without an exponent."""
    return f"{float(f'{value:.3g}'):,.0f}".replace(",", "\u202f")


def percent(change: float | str | None) -> str:
    """A relative change with its sign; words instead of it as they are, a dash where there is none."""
    return f"{100.0 * change:+.2f}\u202f%".replace("-", "−") if isinstance(change, float) else change or "–"
