"""A followed branch on the screen."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Group, RenderableType

from raceway.out.table import rows_table, written
from raceway.out.wrapping import Words
from raceway.storage.tables import ReadTables

#: Special points and peaks that are shown at most; all are in the file.
_SHOWN = 24


def follow_screen(content: ReadTables, files: Sequence[str]) -> RenderableType:
    """What was followed, the special points and peaks, the stretches of unstable orbits, how it ends."""
    rows, labels = content["rows"], content["labels"]
    ends = [row["parameter"] for row in (rows[0], rows[-1])]
    head = f"{len(rows)} steady orbits over {content['key']}, {ends[0]:.6g} to {ends[1]:.6g}"
    parts: list[RenderableType] = [Words(head, "bold"), Words(content["title"], "dim")]
    told = [_line("begins", rows[0]), *(_line(x["kind"], x) for x in labels[:_SHOWN]), _line("ends", rows[-1])]
    parts.append(rows_table(told))
    if len(labels) > _SHOWN:
        parts.append(Words(f"{len(labels) - _SHOWN} more special points and peaks are in the file", "dim"))
    for one, two in content["unstable"]:
        parts.append(Words(f"unstable from {one:.6g} to {two:.6g} along the branch"))
    for k, other in enumerate(content["doubled"], 1):
        ends = [row["parameter"] for row in (other["rows"][0], other["rows"][-1])]
        parts.append(Words(f"branch {k} of twice the period: {len(other['rows'])} orbits, {ends[0]:.6g} to {ends[1]:.6g}"))
    for one in (x for branch in (content, *content["doubled"]) for x in branch["instead"]):
        parts.append(Words(f"beside the unstable orbit at {one['parameter']:.6g}: {one['words']}"))
    parts += [Words(text) for text in content["notes"]]
    if content["end"]:
        parts.append(Words(content["end"], "bold"))
    return Group(*parts, *written(files))


def _line(what: str, row: ReadTables) -> dict[str, str]:
    return {
        "": what,
        "value": f"{row['parameter']:.7g}",
        "K\nN/µm": f"{1e-6 * row['stiffness']:.4g}",
        "C\nN s/m": f"{row['damping']:.4g}",
        "1x\nµm": f"{1e6 * row['amplitude']:.4g}",
        "all harmonics\nµm": f"{1e6 * row['swing']:.4g}",
        "lag\ndeg": f"{row['phase_deg']:.4g}",
        "growth\na turn": f"{row['multiplier']:.4g}",
        "open\nballs": f"{row['lost']}" if row["lost"] else "",
    }
