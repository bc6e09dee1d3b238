"""A sweep on the screen."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from rich.console import Group, RenderableType

from raceway.out.table import micro, rows_table, written
from raceway.out.wrapping import Words
from raceway.storage.tables import ReadTables

if TYPE_CHECKING:
    from raceway.storage.tables import Tables

#: Points of a sweep that a screen shows one by one.
_MOST_ROWS, _MOST_REASONS = 30, 5
#: Numbers in a warning, which differ from point to point.
_NUMBER = re.compile(r"\d+(\.\d+)?(e[+-]?\d+)?")


def sweep_screen(content: ReadTables, rows: Iterable[ReadTables], files: Sequence[str]) -> RenderableType:
    """How many points are in each state, the first of them with their stiffness, why points failed, and what they warn of."""
    from raceway.studies.sweep.design import point_words

    shown: list[dict[str, str]] = []
    reasons: list[str] = []
    told: dict[
        str, tuple[int, str, Tables]
    ] = {}  # warning without its numbers -> count, its words and the point that has it first
    for row in rows:
        for text in row["warnings"]:
            count, first, point = told.get(key := _NUMBER.sub("#", text), (0, text, row["point"]))
            told[key] = count + 1, first, point
        if len(shown) < _MOST_ROWS:
            shown.append(_sweep_row(row))
        if row["status"] == "failed" and len(reasons) < _MOST_REASONS:
            reasons.append(f"{point_words(row['point'])}: {row['reason'].splitlines()[0]}")
    states, total = content["states"], content["states"]["total"]
    counted = ", ".join(f"{states[name]} {name}" for name in ("done", "failed", "running", "waiting") if states[name])
    parts: list[RenderableType] = [Words(content["title"], "bold"), rows_table(shown)]
    if total > len(shown):
        parts.append(Words(f"and {total - len(shown)} more points in {content['store']}", "dim"))
    parts.append(Words(f"{total} points: {counted}"))
    parts += [Words(f"failed: {micro(reason)}") for reason in reasons]
    for count, text, point in told.values():
        parts.append(
            Words(f"{count} point{'s warn' if count > 1 else ' warns'}: {micro(text)} (first at {point_words(point)})")
        )
    return Group(*parts, *written(files))


def _sweep_row(row: ReadTables) -> dict[str, str]:
    from raceway.studies.many.axes import shown

    values = row["values"]
    last = [key.rpartition(".")[2] for key in row["point"]]
    short = {key: name if last.count(name) == 1 else key for key, name in zip(row["point"], last, strict=True)}
    text = {short[key]: shown(value) for key, value in row["point"].items()}
    k, z, kyy = values.get("equivalent_stiffness"), values.get("z_real"), values.get("stiffness")
    if k is not None and z is not None:
        text |= {"K N/µm": f"{k / 1e6:.3f}", "Re Z N/µm": f"{z / 1e6:.3f}"}
    else:
        text |= {"K N/µm": "", "Re Z N/µm": ""}
    text["kyy N/µm"] = "" if kyy is None else f"{kyy[1][1] / 1e6:.3f}"
    if "kyy_tilts_follow" in values:
        text["kyy tilts follow N/µm"] = f"{values['kyy_tilts_follow'] / 1e6:.3f}"
    error = values.get("error_total")
    return {**text, "error %": "" if error is None else f"{100.0 * error:.2g}", "status": row["status"]}
