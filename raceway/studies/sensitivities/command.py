"""``raceway sensitivities``.  Part of ``raceway.cli.main``."""

from __future__ import annotations

from pathlib import Path

import click

from raceway.cli.frame import (
    RESULTS,
    attempt,
    common,
    has_matplotlib,
    load,
    on_scene,
    out_folder,
    plugin_files,
    show,
    show_progress,
    slug,
    tell_faults,
)
from raceway.framework.registry import registry_with
from raceway.storage.files import writable


@click.command(short_help="How much each number of a scene changes the answer.")
@on_scene
@click.option(
    "--by", "keys", multiple=True, metavar="A.B", help="Only this key; repeat for more [every number of the scene]."
)
@out_folder
@click.option("--pictures/--no-pictures", default=True, help="Write the bars as PNG (default).")
@plugin_files
@common
def sensitivities(
    scene: Path,
    changes: tuple[str, ...],
    keys: tuple[str, ...],
    out: Path | None,
    pictures: bool,
    plugins: tuple[Path, ...],
    as_json: bool,
) -> int:
    """Derivatives of K, displacement and ball loads by every number of a scene, without solving it again.

    Writes sensitivities.json, sensitivities.csv and sensitivities.png. The motion is the steady orbit.

    \b
    Example:
      raceway sensitivities examples/b7206.toml
      raceway sensitivities examples/b7206.toml --by bearing.contact_angle_deg
    """
    registry = registry_with(plugins)
    loaded = load(scene, changes, registry)
    tell_faults(registry)
    folder = writable(out or RESULTS / f"{slug(loaded.title)}-sensitivities")
    with show_progress() as progress:
        from raceway.studies.sensitivities.front import sensitivities as compute

        found = compute(loaded, keys, progress=progress)
    content = found.to_dict()
    files: list[str] = []
    failed = attempt(lambda: found.save(folder), files)
    if failed is None and pictures and has_matplotlib() and found.rows:
        failed = attempt(lambda: found.picture(folder), files)
    from raceway.studies.sensitivities.screen import sensitivities_screen

    show(content, as_json, failed, lambda: sensitivities_screen(content, files))
    return 0
