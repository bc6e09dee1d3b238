"""``raceway infer``.  Part of ``raceway.cli.main``."""

from __future__ import annotations

from typing import NamedTuple

import click

from raceway.cli.frame import common, record, show, show_progress
from raceway.errors import SceneError


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
    from raceway.studies.infer.screen import infer_screen, table_screen

    if given.table is not None:
        from raceway.studies.infer.tables import infer_table

        if given.bore or given.outer_diameter or given.ratings or given.pairs:
            raise click.UsageError("give a TABLE, or --bore, --outer-diameter and --rating, not both")
        with show_progress(waiting="inferring"):
            content = infer_table(given.table, given.maker, given.conformity)
        show(content, given.as_json, None, lambda: table_screen(content))
        return 0
    from raceway.studies.infer.front import infer as from_printed

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
