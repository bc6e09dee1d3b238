"""``raceway study rig``.  Part of ``raceway.cli.main``."""

from __future__ import annotations

from pathlib import Path

import click

from raceway.cli.frame import (
    RESULTS,
    attempt,
    common,
    has_matplotlib,
    keeping,
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


@click.command(short_help="A test rig's signals, and the bearing read back from them.")
@on_scene
@out_folder
@click.option("--signals/--no-signals", default=True, help="Write the signals as CSV (default).")
@click.option("--pictures/--no-pictures", default=True, help="Write figures as PNG and the page rig.html (default).")
@plugin_files
@common
def rig(
    scene: Path,
    changes: tuple[str, ...],
    out: Path | None,
    signals: bool,
    pictures: bool,
    plugins: tuple[Path, ...],
    as_json: bool,
) -> int:
    """Simulate a test rig, the table [rig] of SCENE: a shaft with a disc on two of its bearings, and a sensor beside one.

    The signals are read by the article's procedure as printed and by inverting the beam; the error is split into its causes.
    Writes rig.json, rig.html, figures and the signals, which `raceway identify` reads. Exit code 1 when a point has no motion.
    Finished points are kept in DIR/rig-rows.jsonl and reused.

    \b
    Example:
      raceway study rig examples/test_rig.toml --set rig.sensor_distance=0.03
    """
    from raceway.scene.reading import rig_of

    registry = registry_with(plugins)
    loaded = load(scene, changes, registry)
    inputs = rig_of(loaded)
    folder = writable(out or RESULTS / f"{slug(loaded.title)}-rig")
    pictures = pictures and has_matplotlib()
    tell_faults(registry)
    rows = folder / "rig-rows.jsonl"
    with keeping("points", rows):
        with show_progress() as progress:
            from raceway.pipeline.result import write_json
            from raceway.studies.rig.study import study

            result = study(loaded, inputs, registry, progress, rows)
        content, files = result.to_dict(), list[str]()
        failed = attempt(lambda: [write_json(content, folder / "rig.json")], files) or result.fault
        if pictures and failed is None:
            from raceway.studies.rig.page import write_page

            failed = attempt(lambda: write_page(result, folder), files)
        if signals and failed is None:
            records = list[str]()
            failed = attempt(lambda: result.write_signals(folder), records)
            files += [f"{len(records)} records, signals-*.csv and slow-roll-*.csv"] if records else []
    from raceway.studies.rig.page import rig_screen

    show(content, as_json, failed, lambda: rig_screen(content, files))
    return 1 if result.failed else 0
