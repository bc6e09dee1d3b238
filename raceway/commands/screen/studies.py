"""What comparisons, sweeps, studies of precision and of stability print."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Group, RenderableType
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from raceway.commands.screen.text import rows_table, written

#: Points of a sweep that a screen shows one by one.
_MOST_ROWS, _MOST_REASONS = 30, 5
#: Numbers in a warning, which differ from point to point.
_NUMBER = re.compile(r"\d+(\.\d+)?(e[+-]?\d+)?")


def compare_screen(
    title: str, rows: Sequence[Mapping[str, Any]], words: Sequence[str], files: Sequence[str]
) -> RenderableType:
    """A line for each point, and what causes what in words."""
    parts: list[RenderableType] = [Text(title, style="bold"), rows_table(rows)]
    parts += [Text(text) for text in words]
    parts += written(files)
    return Group(*parts)


def sweep_screen(content: Mapping[str, Any], rows: Iterable[Mapping[str, Any]], files: Sequence[str]) -> RenderableType:
    """How many points are in each state, the first of them with their stiffness, why points failed, and what they warn of."""
    from raceway.studies.sweep.design import point_words

    shown: list[dict[str, str]] = []
    reasons: list[str] = []
    told: dict[str, list[Any]] = {}  # warning without its numbers -> count, its words and the point that has it first
    for row in rows:
        for text in row["warnings"]:
            told.setdefault(_NUMBER.sub("#", text), [0, text, row["point"]])[0] += 1
        if len(shown) < _MOST_ROWS:
            shown.append(_sweep_row(row))
        if row["status"] == "failed" and len(reasons) < _MOST_REASONS:
            reasons.append(f"{point_words(row['point'])}: {row['reason'].splitlines()[0]}")
    states, total = content["states"], content["states"]["total"]
    counted = ", ".join(f"{states[name]} {name}" for name in ("done", "failed", "running", "waiting") if states[name])
    parts: list[RenderableType] = [Text(content["title"], style="bold"), rows_table(shown)]
    if total > len(shown):
        parts.append(Text(f"and {total - len(shown)} more points in {content['store']}", style="dim"))
    parts.append(Text(f"{total} points: {counted}"))
    parts += [Text(f"failed: {reason}") for reason in reasons]
    for count, text, point in told.values():
        parts.append(Text(f"{count} point{'s warn' if count > 1 else ' warns'}: {text} (first at {point_words(point)})"))
    return Group(*parts, *written(files))


def _sweep_row(row: Mapping[str, Any]) -> dict[str, str]:
    from raceway.studies.axes import shown

    values = row["values"]
    last = [key.rpartition(".")[2] for key in row["point"]]
    short = {key: name if last.count(name) == 1 else key for key, name in zip(row["point"], last, strict=True)}
    text = {short[key]: shown(value) for key, value in row["point"].items()}
    k, z, kyy = values.get("equivalent_stiffness"), values.get("z_real"), values.get("stiffness")
    if k is not None and z is not None:
        text |= {"K N/um": f"{k / 1e6:.3f}", "Re Z N/um": f"{z / 1e6:.3f}"}
    else:
        text |= {"K N/um": "", "Re Z N/um": ""}
    text["kyy N/um"] = "" if kyy is None else f"{kyy[1][1] / 1e6:.3f}"
    error = values.get("error_total")
    return {**text, "error %": "" if error is None else f"{100.0 * error:.2g}", "status": row["status"]}


def precision_screen(
    title: str, rows: Sequence[Mapping[str, Any]], words: Sequence[str], files: Sequence[str]
) -> RenderableType:
    """A line for each setting, and what they come to in words."""
    table = Table(header_style="bold", box=SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    # A column of blanks would cost the settings their room.
    names = [name for name in rows[0] if any(row[name] for row in rows)]
    for name in names:
        text = name in ("setting", "status")
        table.add_column(name, justify="left" if text else "right", overflow="fold", min_width=0 if text else 6)
    for row in rows:
        table.add_row(*(escape(row[name]) for name in names))
    parts: list[RenderableType] = [Text(title, style="bold"), table]
    parts.append(Text("* on the front; ~ known to the reference's bound only", style="dim"))
    parts += [Text(text) for text in words]
    parts += written(files)
    return Group(*parts)


def stability_screen(content: Mapping[str, Any], every: bool, files: Sequence[str]) -> RenderableType:
    """A line for each case, or for each row; what is not as expected in full."""
    rows = content["rows"]
    bad = [row for row in rows if row["verdict"] == "failed"]
    table = Table(header_style="bold", box=SIMPLE_HEAD, pad_edge=False, padding=(0, 1))
    if every:
        for name in ("case", "setting", "quantity", "expected", "predicted", "observed", "verdict"):
            table.add_column(name, overflow="fold")
        for row in rows:
            table.add_row(*(escape(cell) for cell in _stability_cells(row)))
    else:
        for name in ("case", "rows", "as expected"):
            table.add_column(name, justify="left" if name == "case" else "right")
        for case in dict.fromkeys(row["case"] for row in rows):
            own = [row for row in rows if row["case"] == case]
            good = sum(row["verdict"] == "as expected" for row in own)
            table.add_row(escape(case), str(len(own)), str(good) if good == len(own) else f"[red]{good}[/red]")
    parts: list[RenderableType] = [Text(content["title"], style="bold"), table]
    for row in bad:
        cells = _stability_cells(row)
        parts.append(
            Text(f"failed: {', '.join(cell for cell in cells[:6] if cell)}. {row['note'] or row['reason']}", style="red")
        )
    kept = f", {content['reused']} kept from before" if content["reused"] else ""
    words = (
        f"{len(rows) - len(bad)} of {len(rows)} rows as expected, {content['cases']} cases{kept}, {content['seconds']:.0f} s"
    )
    parts.append(Text(words))
    parts += written(files)
    return Group(*parts)


def _stability_cells(row: Mapping[str, Any]) -> list[str]:
    setting = ", ".join(f"{key} {value}" for key, value in row["setting"].items())
    numbers = ("" if row[name] is None else f"{row[name]:.6g}" for name in ("predicted", "observed"))
    return [row["case"], setting, row["quantity"], row["expected"], *numbers, row["verdict"]]
