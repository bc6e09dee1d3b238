"""A stability study on disk: JSON and a Markdown page."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path

from raceway.storage.files import write_whole
from raceway.storage.tables import Tables


def write(result: Tables, folder: Path) -> list[Path]:
    """stability.json and stability.md of the tables of ``raceway stability --json``; the folder is made when it is missing.

    Raises
    ------
    RacewayError
        The folder cannot be written.
    """
    text = json.dumps(result, indent=1, allow_nan=False) + "\n"
    return [
        write_whole(text.encode(), Path(folder) / "stability.json"),
        write_whole(page(result).encode(), Path(folder) / "stability.md"),
    ]


def page(result: Tables) -> str:
    """The study as Markdown: what failed first, then a table for each case."""
    rows = result["rows"]
    bad = [row for row in rows if row["verdict"] == "failed"]
    lines = [f"# {result['title']}", ""]
    lines.append(
        f"{len(rows) - len(bad)} of {len(rows)} rows as expected, {result['cases']} cases, {result['seconds']:.0f} s on "
        f"{result['processes']} processes ({result['reused']} cases kept from before); "
        f"{result['left_out']} cases not asked for."
    )
    lines += ["", "## Failed", "", *_table(bad)] if bad else []
    for name in dict.fromkeys(row["case"] for row in rows):
        lines += ["", f"## {name}", "", *_table(row for row in rows if row["case"] == name)]
    return "\n".join(lines) + "\n"


def _table(rows: Iterable[Tables]) -> list[str]:
    lines = ["| setting | quantity | expected | predicted | observed | energy drift | verdict | why |", "|---" * 8 + "|"]
    for row in rows:
        cells = [
            ", ".join(f"{key} {_number(value)}" for key, value in row["setting"].items()) or "-",
            row["quantity"],
            row["expected"],
            _number(row["predicted"]),
            _number(row["observed"]),
            _number(row["energy_drift"]),
            row["verdict"],
            "; ".join(text for text in (row["reason"], row["note"]) if text),
        ]
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return lines


def _number(value: object) -> str:
    if value is None:
        return ""
    return f"{value:.6g}" if isinstance(value, float) else str(value)
