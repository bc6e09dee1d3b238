"""``raceway catalogue``.  Part of ``raceway.cli.main``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click
from rich.console import Group, RenderableType

from raceway.cli.frame import PATH, attempt, common, show
from raceway.out.table import Row, number, rows_table, sections, written
from raceway.out.wrapping import Words
from raceway.storage.tables import ReadTables, Tables

_NAMES = {
    "bore": "bore d",
    "outer_diameter": "outer diameter D",
    "width": "width B",
    "ball_diameter": "ball diameter",
    "pitch_diameter": "pitch diameter d_m",
}


def list_screen(rows: Sequence[ReadTables]) -> RenderableType:
    """A line a bearing, dimensions in mm."""
    lengths = {"bore": "d mm", "outer_diameter": "D mm", "width": "B mm"}
    lines = []
    for row in rows:
        line = {"name": row["name"]}
        line |= {word: _mm(row[key]) for key, word in lengths.items()}
        line |= {
            "angle deg": "-" if row["contact_angle_deg"] is None else f"{row['contact_angle_deg']:g}",
            "Z": str(row["ball_count"]),
        }
        line |= {"ball mm": _mm(row["ball_diameter"]), "d_m mm": _mm(row["pitch_diameter"])}
        lines.append(line)
    hint = 'raceway catalogue NAME shows one; preset = "NAME" in a scene takes it'
    return Group(rows_table(lines), Words(f"{len(rows)} bearings; {hint}", "dim"))


def _mm(metres: float | None) -> str:
    return "-" if metres is None else f"{1e3 * metres:.5g}"


def entry_screen(content: ReadTables, files: Sequence[str]) -> RenderableType:
    """One bearing: dimensions with scatter and source, ball-pass frequencies, what is inferred."""
    rows: list[Row] = [("Dimensions", "", "")]
    sources: dict[str, list[str]] = {}
    for fact in content["facts"]:
        key, value = fact["key"], fact["value"]
        name = _NAMES.get(key, key.replace("_", " ").replace(".", ", "))
        shown = number(1e3 * value, "mm") if key in _NAMES else f"{value:.6g}"
        if key.endswith(".young"):
            shown = number(1e-9 * value, "GPa")
        scatter = "" if fact["scatter"] is None or key == "ball_count" else f", +- {100.0 * fact['scatter']:.2g} %"
        rows.append((name, shown, f"inferred{scatter}" if fact["inferred"] else "stated"))
        sources.setdefault(fact["source"], []).append(name)
    found = content["ball_pass"]
    rows.append((f"Ball pass at {found['contact_angle_deg']:.4g} deg, times the shaft's speed", "", ""))
    rows.append(
        (
            "cage FTF, ball BSF",
            f"{found['ftf']:.4g}, {found['bsf']:.4g}",
            "at the free contact angle; a result has it loaded",
        )
    )
    rows.append(
        ("passes BPFO, BPFI", f"{found['bpfo']:.4g}, {found['bpfi']:.4g}", "a place of the outer, of the inner race")
    )
    parts: list[RenderableType] = [Words(content["title"], "bold"), sections(rows)]
    if content["printed"]:
        told = ", ".join(
            f"{key.replace('_error', '').replace('_', ' ')} {100.0 * error:+.2f} %"
            for key, error in content["printed"].items()
        )
        parts.append(Words(f"against what the maker prints: {told}"))
    if content["geometry"]:
        parts.append(Words(content["geometry"]["words"]))
    parts += [Words(f"{', '.join(names)}: {source}", "dim") for source, names in sources.items()]
    return Group(*parts, *written(files))


def materials_screen(rows: Sequence[ReadTables]) -> RenderableType:
    """Materials with their sources."""
    lines = [
        {
            "name": row["name"],
            "E GPa": f"{1e-9 * row['young']:g}",
            "nu": f"{row['poisson']:g}",
            "density kg/m3": f"{row['density']:g}",
            "expansion 1e-6/K": f"{1e6 * row['thermal_expansion']:g}",
            "what": row["title"],
        }
        for row in rows
    ]
    sources = [Words(f"{row['name']}: {row['source']}", "dim") for row in rows]
    return Group(rows_table(lines), *sources)


@click.command(short_help="List, search and draw the bearings of the catalogue.")
@click.argument("pattern", default="*")
@click.option("--picture", type=PATH, metavar="FILE.png", help="Draw the section of the one bearing found, in proportion.")
@click.option("--materials", is_flag=True, help="List the materials of rings and balls instead.")
@common
def catalogue(pattern: str, picture: Path | None, materials: bool, as_json: bool) -> int:
    """List bearings whose name matches PATTERN; of a single one, all numbers with source and scatter, and its frequencies.

    \b
    Example:
      raceway catalogue "70*C"
      raceway catalogue 7014C --picture 7014C.png
    """
    from raceway.studies.catalogue.catalogue import catalogue as search

    if materials:
        from raceway.studies.catalogue.catalogue import material_rows

        rows = material_rows()
        show({"materials": rows}, as_json, None, lambda: materials_screen(rows))
        return 0
    from raceway.studies.catalogue.catalogue import entry, line, scene_of

    found = search(pattern)
    if len(found) > 1:
        if picture is not None:
            raise click.UsageError(f"--picture draws one bearing, '{pattern}' finds {len(found)}")
        lines = [line(one) for one in found]
        show({"bearings": lines}, as_json, None, lambda: list_screen(lines))
        return 0
    content: Tables = entry(found[0])
    files: list[str] = []
    failed = None
    if picture is not None:
        from raceway.cli.frame import require_matplotlib
        from raceway.studies.catalogue.section import draw_section

        require_matplotlib("leave out --picture")
        if picture.suffix.lower() != ".png":
            raise click.UsageError(f"--picture {picture}: the file must end in .png")
        failed = attempt(lambda: [draw_section(found[0].name, scene_of(found[0]).bearing, picture)], files)
    show({**content, "files": files}, as_json, failed, lambda: entry_screen(content, files))
    return 0
