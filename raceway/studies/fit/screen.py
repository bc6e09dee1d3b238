"""The table of ``raceway fit``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from raceway.commands.screen import Words, rows_table, written
from raceway.framework.shown import number, number_within
from raceway.storage.tables import ReadTables
from raceway.studies.fit.fitted import in_units

#: Part of a half-width below which a cause of it is not shown.
_SMALL = 0.02

if TYPE_CHECKING:
    from rich.console import RenderableType


def fit_screen(content: ReadTables, files: list[str]) -> RenderableType:
    """Free numbers with their intervals, what follows from them; below, how well the model meets the data, and warnings."""
    from rich.console import Group

    rows = []
    for one in content["free"]:
        start = "" if content["kind"] == "record" else number(one["start"], one["unit"], 6)
        value, half, unit = in_units(one["value"], one["error"] or 0.0, one["unit"])
        row = {"free": one["key"], "from": start, "found": number(value, unit, 4), "at 95 %": "not determined"}
        if one["determined"]:
            row |= {"found": number_within(value, half, unit), "at 95 %": f"± {number(half, unit, 2)}"}
            if len(one["parts"]) > 1:
                row["of which"] = _parts(one)
        rows.append(row)
    for one in content["derived"]:
        row = {"free": one["name"], "from": "", "found": "", "at 95 %": "not determined"}
        if one["half"] is not None:
            value, half, unit = in_units(one["value"], one["half"], one["unit"])
            row |= {"found": number_within(value, half, unit), "at 95 %": f"± {number(half, unit, 2)}"}
        rows.append(row)
    fit = content["fit"]
    words = f"{fit['data']} data, {len(content['free'])} free, {fit['evaluations']} evaluations"
    if fit["scatter"] is not None and content["kind"] != "record":
        words += f"; {_scatter(content)}"
    lines = [Words(words), *(Words(text, "yellow") for text in content["warnings"])]
    return Group(rows_table(rows, f"{content['title']}\nfitted to {content['file']}"), *lines, *written(files))


def _parts(one: ReadTables) -> str:
    """Half-widths by cause, the larger ones first."""
    parts = sorted(one["parts"].items(), key=lambda part: -part[1])
    shown = [(cause, in_units(0.0, half, one["unit"])) for cause, half in parts if half > _SMALL * one["error"]]
    return ", ".join(f"{cause} {number(half, unit, 2)}" for cause, (_, half, unit) in shown)


def _scatter(content: ReadTables) -> str:
    scatter, stated = content["fit"]["scatter"], content["stated"]
    return (
        f"residuals {scatter:.2g} of the stated errors"
        if stated
        else f"residuals scatter by {100.0 * scatter:.2g} % of the data"
    )
