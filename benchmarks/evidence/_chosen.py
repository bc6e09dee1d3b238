"""A few rows of the reports, chosen for a reader without time, in words that need no context."""

from __future__ import annotations

from typing import Any

#: Block -> (report, the row's quantity, what it says).
CHOSEN = {
    "readme": (
        (
            "published",
            "NSK 7206C, axial stiffness of a pair at 4 preloads: largest relative error",
            "axial stiffness of 7206C pairs against the maker's table, relative",
        ),
        (
            "rigid",
            "B7206C, 400, 1200, 2000 N axial: radial stiffness, tilt free: largest relative error",
            "radial stiffness of a B7206C, tilt free, against another solver of rigid rings, relative",
        ),
        (
            "published",
            "7-ball deep-groove bearing, three load cases: displacements and tilt: largest relative error",
            "displacements and tilt of a deep-groove bearing against MASTA, relative",
        ),
        (
            "rigid",
            "ball-pass frequency, 4, 7 and 12 balls, 300 N axial, 600 N radial, tilt locked and free: largest relative error",
            "ball-pass frequency of a simulated motion, relative",
        ),
        (
            "rigid",
            "2900 of 29 160 extreme scenes (1 mN to 1 MN, conformity 0.501 to 0.9, 1 kN m): neither solved nor a motion left free",
            "extreme scenes without an answer, of 2900",
        ),
    ),
}


def chosen(block: str, reports: dict[str, dict[str, Any]], links: str) -> str:
    """The rows of a block as a Markdown table; ``links`` is the folder of the reports as seen from the document.

    Raises
    ------
    KeyError
        A report or a row that is not there, or, for README, one that rests on ourselves.
    """
    from benchmarks.claims import BASES
    from benchmarks.evidence._files import holds, limits, shown

    lines = ["| what | number | limit | holds | report |", "|---|---|---|---|---|"]
    for name, quantity, words in CHOSEN[block]:
        rows = [row for row in reports[name]["rows"] if row["quantity"] == quantity]
        if len(rows) != 1:
            raise KeyError(f"the report '{name}' has {len(rows)} rows of {quantity!r}")
        (row,) = rows
        if block == "readme" and row["basis"] not in BASES[:3]:
            raise KeyError(f"README shows {', '.join(BASES[:3])}, and {quantity!r} is {row['basis']}")
        value = f"{row['value']:.6g}" if isinstance(row["value"], float) and row["value"] > 100 else shown(row["value"])
        note = row.get("note", "")
        value += f" {note.partition(';')[0]}" if note.startswith("of ") else ""
        limit = row["limit"] if "limit" in row else limits(row["low"], row["high"])
        cells = words, value, limit, "yes" if holds(row) else "**no**", f"[{name}]({links}{name}.md)"
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)
