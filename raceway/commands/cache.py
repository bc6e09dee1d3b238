"""The command about what is kept between runs.  Part of ``raceway.cli``."""

from __future__ import annotations

import click

from raceway.commands.frame import common, show, show_progress


@click.command(short_help="See or clear what is kept between runs.")
@click.option("--clear", is_flag=True, help="Remove all of it; the next run compiles and condenses again.")
@common
def cache(clear: bool, as_json: bool) -> int:
    """Say where compiled kernels and compliances of bodies are kept (RACEWAY_CACHE_DIR overrides it), how many, how large,
    what each is and when it was last used; and clear them.

    \b
    Example:
      raceway cache --clear
    """
    import attrs

    from raceway.storage import array_cache, cache_folder

    with show_progress(waiting="looking through what is kept"):
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
    from raceway.commands.screen.kept import cache_screen

    show(content, as_json, None, lambda: cache_screen(content))
    return 0
