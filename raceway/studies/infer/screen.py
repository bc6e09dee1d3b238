"""Inferred bearings on the screen."""

from __future__ import annotations

from rich.console import Group, RenderableType

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
