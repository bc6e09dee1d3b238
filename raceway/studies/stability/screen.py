"""The catalogue of stability on the screen."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Group, RenderableType

from raceway.out.table import micro, rows_table, written
from raceway.out.wrapping import Words
from raceway.storage.tables import ReadTables


def stability_screen(content: ReadTables, every_row: bool, files: Sequence[str]) -> RenderableType:
    """A line for each case, or for each row; what is not as expected in full."""
    rows = content["rows"]
    bad = [row for row in rows if row["verdict"] == "failed"]
    parts: list[RenderableType] = [Words(content["title"], "bold")]
    parts.append(rows_table(list(map(_row, rows)) if every_row else _cases(rows)))
    for row in bad:
        told = ", ".join(cell for name, cell in _row(row).items() if cell and name != "verdict")
        parts.append(Words(f"failed: {told}. {row['note'] or row['reason']}", "red"))
    kept = f", {content['reused']} kept from before" if content["reused"] else ""
    good = len(rows) - len(bad)
    parts.append(
        Words(f"{good} of {len(rows)} rows as expected, {content['cases']} cases{kept}, {content['seconds']:.0f} s")
    )
    if content["left_out"] and not every_row:
        parts.append(Words(f"left out: {content['left_out']} cases that take longer; --all runs them"))
    return Group(*parts, *written(files))


def _cases(rows: Sequence[ReadTables]) -> list[dict[str, str]]:
    """A row for each case: how many rows it has, and how many of them are as expected."""
    found = []
    for case in dict.fromkeys(row["case"] for row in rows):
        own = [row for row in rows if row["case"] == case]
        good = sum(row["verdict"] == "as expected" for row in own)
        found.append({"case": micro(case), "rows": str(len(own)), "as expected": str(good)})
    return found


def _row(row: ReadTables) -> dict[str, str]:
    setting = ", ".join(micro(f"{key} {value}") for key, value in row["setting"].items())
    numbers = {name: "" if row[name] is None else f"{row[name]:.6g}" for name in ("predicted", "observed")}
    told = {"case": micro(row["case"]), "setting": setting, "quantity": row["quantity"], "expected": row["expected"]}
    return {**told, **numbers, "verdict": row["verdict"]}
