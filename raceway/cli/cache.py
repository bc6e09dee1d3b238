"""The command about what is kept between runs.  Part of ``raceway.cli.main``."""

from __future__ import annotations

from collections import Counter
from datetime import datetime

import click

from raceway.answers.table import sections
from raceway.cli.frame import common, show, show_progress

#: Compliances that are listed one by one; a study keeps thousands.
_SHOWN = 10


@click.command(short_help="List or clear the caches.")
@click.option("--clear", is_flag=True, help="Delete both; the next run compiles and condenses again.")
@common
def cache(clear: bool, as_json: bool) -> int:
    """List the caches of compiled kernels and of body compliances with size and last use, or clear them.  RACEWAY_CACHE_DIR moves them.

    \b
    Example:
      raceway dev cache --clear
    """
    import attrs

    from raceway.storage import array_cache
    from raceway.storage import kernel_cache as cache_folder

    with show_progress(waiting="looking through the caches"):
        if clear:
            cache_folder.clear()
            array_cache.clear()
        folders = [attrs.asdict(folder) for folder in cache_folder.kernel_folders()]
        arrays = [attrs.asdict(entry) for entry in array_cache.entries()]
    content = {
        "root": str(cache_folder.cache_root() / "kernels"),
        "current": cache_folder.source_key(),
        "folders": folders,
        "kernels": sum(f["kernels"] for f in folders),
        "bytes": sum(f["bytes"] for f in folders),
        "arrays_root": str(array_cache.folder()),
        "arrays": arrays,
        "arrays_bytes": sum(entry["bytes"] for entry in arrays),
        "arrays_limit_bytes": array_cache.LIMIT,
        "cleared": clear,
    }

    rows = [("Compiled kernels", "", f"in {content['root']}")]
    for folder in content["folders"]:
        extent = f"{folder['bytes'] / 2**20:.1f} MiB"
        rows.append((folder["name"], extent, f"{folder['kernels']} kernels{', current' if folder['current'] else ''}"))
    if not any(folder["current"] for folder in content["folders"]):
        rows.append((content["current"], "empty", "current: the next run compiles, which takes some 20 s of a processor"))
    total, most = content["arrays_bytes"] / 2**20, content["arrays_limit_bytes"] / 2**20
    rows.append(("Compliances of bodies", "", f"{total:.1f} of at most {most:.0f} MiB, in {content['arrays_root']}"))
    by_use = sorted(content["arrays"], key=lambda entry: -entry["used"])
    for entry in by_use[:_SHOWN]:
        last_use = datetime.fromtimestamp(entry["used"]).strftime("%Y-%m-%d %H:%M")
        remark = f"{entry['what']}; made in {entry['made_in_s']:.1f} CPU-s, used {last_use}"
        rows.append((entry["kind"], f"{entry['bytes'] / 2**20:.2f} MiB", remark))
    if len(by_use) > _SHOWN:
        rows.append(("", "", f"the {_SHOWN} last used of {len(by_use)}; all: raceway dev cache --json; by sort:"))
        for kind, count in sorted(Counter(entry["kind"] for entry in by_use).items()):
            extent = sum(entry["bytes"] for entry in by_use if entry["kind"] == kind) / 2**20
            rows.append((kind, f"{extent:.2f} MiB", f"{count} in all"))
    if not by_use:
        rows.append(("none", "empty", "a condensed bearing makes them in seconds"))
    show(content, as_json, None, lambda: sections(rows))
    return 0
