"""Inferred bearings on the screen."""

from __future__ import annotations

from typing import NamedTuple

import click
from rich.console import Group, RenderableType

from raceway.cli.frame import common, record, show, show_progress
from raceway.errors import SceneError
from raceway.out.table import Row, number, rows_table, sections
from raceway.out.wrapping import Words
from raceway.storage.tables import ReadTables


def infer_screen(title: str, content: ReadTables) -> RenderableType:
    """One bearing: numbers with scatter and reason, what is printed against what they give."""
    rows: list[Row] = [
        (
            f"Inferred by the maker's {content['practice']}"
            if content["practice"] == "grooves"
            else "Inferred by the tables of ISO 281 and ISO 76",
            "",
            "",
        )
    ]
    for key, found in content["numbers"].items():
        value = number(1e3 * found["value"], "mm") if key.endswith("diameter") else f"{found['value']:.5g}"
        scatter = "" if key == "ball_count" else f"+- {100.0 * found['scatter']:.2g} %; "
        rows.append((key.replace("_", " "), value, scatter + found["reason"]))
    other = content["other"]
    if other is not None and other["share"] > 1e-3:
        next_best = f"{other['ball_count']} of {1e3 * other['ball_diameter']:.4g} mm"
        rows.append(("next likely", next_best, f"{100.0 * other['share']:.2g} %"))
    rows.append(("What is printed", "", ""))
    for one in content["checks"]:
        stiff = one["quantity"] == "pair stiffness"
        shown = number(1e-6 * one["printed"], "N/µm") if stiff else number(1e-3 * one["printed"], "kN")
        rows.append(
            (f"{one['quantity']}, {one['contact_angle_deg']:g} deg", shown, f"met with {100.0 * one['error']:+.2f} %")
        )
    error = Words(f"geometry inferred: axial stiffness known to about {100.0 * content['stiffness_error']:.0f} %")
    return Group(Words(title, "bold"), sections(rows), error)


def table_screen(content: ReadTables) -> RenderableType:
    """Many bearings: a line each, and the summary."""
    rows = [_line(row) for row in content["rows"] if "refused" not in row]
    refused = [Words(f"refused: {row['refused']}", "yellow") for row in content["rows"] if "refused" in row]
    return Group(rows_table(rows, f"Inferred from {content['table']}"), *refused, *map(Words, _told(content["summary"])))


def _line(row: ReadTables) -> dict[str, object]:
    name = row["name"]
    line: dict[str, object] = {
        "name": name if len(name) < 20 else name.partition(",")[0] + " ...",
        "Z": str(row["ball_count"]),
        "D mm": f"{1e3 * row['ball_diameter']:.3f}",
        "d_m mm": f"{1e3 * row['pitch_diameter']:.4g}",
        "f_i": f"{row['conformity_inner']:.4f}",
    }
    for word, key in (("C %", "dynamic_rating"), ("C0 %", "static_rating"), ("pairs %", "pair_stiffness")):
        error = row[f"{key}_error"]
        line[word] = "-" if error is None else f"{100.0 * error:.2f}"
    if "printed_ball_count" in row:
        line["printed Z"] = str(row["printed_ball_count"])
        line["D mm "] = f"{1e3 * row['printed_ball_diameter']:.3f}"
    return line


def _told(found: ReadTables) -> list[str]:
    said = [
        f"{found['inferred']} of {found['sizes']} sizes, {found['designations']} designations; printed C met within "
        f"{100.0 * found['dynamic_rating_error_max']:.2f} %, C0 within {100.0 * found['static_rating_error_max']:.2f} %"
    ]
    if found["pair_stiffnesses"]:
        said.append(
            f"{found['pair_stiffnesses']} axial stiffnesses of pairs: median error {100.0 * found['pair_stiffness_error_median']:.2f} %, "
            f"90 % within {100.0 * found['pair_stiffness_error_90']:.1f} %"
        )
    if found["internals_printed"]:
        shares = [
            found[key] for key in ("ball_count_right", "ball_diameter_within_1_percent", "pitch_diameter_within_1_percent")
        ]
        said.append(
            f"{found['internals_printed']} with printed balls, each inferred from the others: Z right in {100.0 * shares[0]:.1f} %, "
            f"D within 1 % in {100.0 * shares[1]:.1f} %, d_m in {100.0 * shares[2]:.1f} %"
        )
    return said


class InferOptions(NamedTuple):
    """What ``raceway infer`` is given."""

    table: str | None
    bore: str | None
    outer_diameter: str | None
    width: str | None
    ratings: tuple[str, ...]
    pairs: tuple[str, ...]
    maker: str | None
    conformity: float | None
    as_json: bool


@click.command(short_help="Balls and grooves of a bearing from what its maker prints.")
@click.argument("table", required=False)
@click.option("--bore", metavar="LENGTH", help='With a unit: "70 mm".')
@click.option("--outer-diameter", metavar="LENGTH", help='With a unit: "110 mm".')
@click.option("--width", metavar="LENGTH", help='With a unit: "20 mm".')
@click.option(
    "--rating", "ratings", multiple=True, metavar="ANGLE:C:C0",
    help='Contact angle [deg], dynamic and static rating: "15:47 kN:43 kN"; repeat for each angle that is printed.',
)  # fmt: skip
@click.option(
    "--pair", "pairs", multiple=True, metavar="ANGLE:PRELOAD:STIFFNESS",
    help='Axial stiffness of a preloaded pair: "15:145 N:51 N/µm"; repeat for more.',
)  # fmt: skip
@click.option("--maker", metavar="NAME", help="Whose practice of rating it is: NSK, GMN [what explains the numbers better].")
@click.option(
    "--conformity", type=click.FloatRange(0.5, 0.6, True), metavar="F", help="Of both grooves [from --pair, else 0.522]."
)
@common
@record(InferOptions)
def infer(given: InferOptions) -> int:
    """Infer ball count, ball diameter, pitch diameter and conformity, each with its scatter and reason.

    ISO 281 and ISO 76 say how ratings follow from balls; all angles of a size are met together, with a whole number of balls of a
    usual size. TABLE is a CSV file of many bearings with the columns name, bore_mm, outer_diameter_mm, width_mm,
    contact_angle_deg, dynamic_rating_n, static_rating_n, and if they are printed preload_1_n, stiffness_1_n_per_um,
    preload_2_n ... and ball_count, ball_diameter_mm, pitch_diameter_mm, which are not used but compared. "nsk" and "gmn" are
    tables that come with the package.

    \b
    Example:
      raceway infer --bore "70 mm" --outer-diameter "110 mm" \\
          --rating "15:47 kN:43 kN" --rating "25:44.5 kN:41 kN"
      raceway infer nsk --conformity 0.522
    """

    if given.table is not None:
        from raceway.studies.catalogue.infer import infer_table

        if given.bore or given.outer_diameter or given.ratings or given.pairs:
            raise click.UsageError("give a TABLE, or --bore, --outer-diameter and --rating, not both")
        with show_progress(waiting="inferring"):
            content = infer_table(given.table, given.maker, given.conformity)
        show(content, given.as_json, None, lambda: table_screen(content))
        return 0
    from raceway.studies.catalogue.infer import infer as from_printed

    missing = [word for word, value in (("--bore", given.bore), ("--outer-diameter", given.outer_diameter)) if not value]
    missing += [] if given.ratings else ["--rating"]
    if missing:
        raise click.UsageError(f"a TABLE is missing, or {', '.join(missing)}")
    pairs = [_three("--pair", one) for one in given.pairs]
    with show_progress(waiting="inferring"):
        found = from_printed(
            given.bore or "",
            given.outer_diameter or "",
            _ratings(given.ratings),
            width=given.width,
            pairs=pairs,
            maker=given.maker,
            conformity=given.conformity,
        )
    answer = found.to_dict()
    show(answer, given.as_json, None, lambda: infer_screen(found.printed.title, answer))
    return 0


def _ratings(given: tuple[str, ...]) -> dict[float, tuple[str, str]]:
    found: dict[float, tuple[str, str]] = {}
    for one in given:
        angle, dynamic, static = _three("--rating", one)
        if angle in found:
            raise SceneError.at("--rating", one, f"{angle:g} deg is given twice")
        found[angle] = dynamic, static
    return found


def _three(option: str, text: str) -> tuple[float, str, str]:
    parts = text.split(":")
    try:
        angle, first, second = parts
        return float(angle.removesuffix("deg")), first, second
    except ValueError:
        example = {"--rating": '"15:47 kN:43 kN"', "--pair": '"15:145 N:51 N/µm"'}[option]
        raise SceneError.at(
            option, text, f"must be three parts with colons between, the first an angle in deg: {example}"
        ) from None
