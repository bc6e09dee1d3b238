"""Tables of ``raceway cache``."""

from __future__ import annotations

from collections import Counter
from datetime import datetime

from rich.console import RenderableType

from raceway.commands.screen.text import sections
from raceway.storage.tables import ReadTables

#: Compliances that are listed one by one; a study keeps thousands.
_SHOWN = 10


def cache_screen(found: ReadTables) -> RenderableType:
    rows = [("Compiled kernels", "", f"in {found['root']}")]
    for folder in found["folders"]:
        size = f"{folder['bytes'] / 2**20:.1f} MiB"
        rows.append((folder["name"], size, f"{folder['kernels']} kernels{', current' if folder['current'] else ''}"))
    if not any(folder["current"] for folder in found["folders"]):
        rows.append((found["current"], "empty", "current: the next run compiles, which takes some 20 s of a processor"))
    total, most = found["arrays_bytes"] / 2**20, found["arrays_limit_bytes"] / 2**20
    rows.append(("Compliances of bodies", "", f"{total:.1f} of at most {most:.0f} MiB, in {found['arrays_root']}"))
    arrays = sorted(found["arrays"], key=lambda entry: -entry["used"])
    for entry in arrays[:_SHOWN]:
        used = datetime.fromtimestamp(entry["used"]).strftime("%Y-%m-%d %H:%M")
        remark = f"{entry['what']}; made in {entry['made_in_s']:.1f} CPU-s, used {used}"
        rows.append((entry["kind"], f"{entry['bytes'] / 2**20:.2f} MiB", remark))
    if len(arrays) > _SHOWN:
        rows.append(("", "", f"the {_SHOWN} last used of {len(arrays)}; all: raceway cache --json; by sort:"))
        for kind, count in sorted(Counter(entry["kind"] for entry in arrays).items()):
            size = sum(entry["bytes"] for entry in arrays if entry["kind"] == kind) / 2**20
            rows.append((kind, f"{size:.2f} MiB", f"{count} in all"))
    if not arrays:
        rows.append(("none", "empty", "a condensed bearing makes them in seconds"))
    return sections(rows)
