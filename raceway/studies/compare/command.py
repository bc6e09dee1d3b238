"""``raceway compare``.  Part of ``raceway.cli.main``."""

from __future__ import annotations

from pathlib import Path

import click

from raceway.cli.frame import (
    RESULTS,
    attempt,
    changed_tables,
    common,
    has_matplotlib,
    keeping,
    on_scene,
    out_folder,
    plugin_files,
    show,
    show_progress,
    slug,
    tell_faults,
)
from raceway.errors import SceneError
from raceway.framework.registry import registry_with
from raceway.storage.files import writable


@click.command(short_help="One scene, some keys varied, everything else the same.")
@on_scene
@click.option("--vary", multiple=True, required=True, metavar="A.B=X,Y", help="Values x,y,z or a range start:stop:count.")
@out_folder
@click.option("--pictures/--no-pictures", default=True, help="Write the curves as PNG (default).")
@plugin_files
@common
def compare(
    scene: Path,
    vary: tuple[str, ...],
    changes: tuple[str, ...],
    out: Path | None,
    pictures: bool,
    plugins: tuple[Path, ...],
    as_json: bool,
) -> int:
    """Vary some keys of a scene and say which of them causes what: main effects and interactions.

    Writes compare.json and compare.png. Finished runs are kept in DIR/compare-rows.jsonl and reused.

    \b
    Example:
      raceway compare examples/b7206.toml --set integrator.kind=periodic \\
          --vary excitation.kind=unidirectional,bidirectional \\
          --vary excitation.speed_rpm=10980:15000:5
    """
    registry = registry_with(plugins)
    tables, mistakes = changed_tables(scene, changes, registry)
    if mistakes:
        raise SceneError(mistakes)
    title = str(tables["title"])
    folder = writable(out or RESULTS / f"{slug(title)}-compare")
    pictures = pictures and has_matplotlib()
    tell_faults(registry)
    kept = folder / "compare-rows.jsonl"
    with show_progress() as progress:
        from raceway.pipeline.result import write_json
        from raceway.studies.compare.front import compare as study
        from raceway.studies.compare.study import StudyInterrupt

        stopped = None
        try:
            comparison = study(tables, vary, kept=kept, progress=progress)
        except StudyInterrupt as stop:
            if not stop.partial.rows:
                raise
            comparison, stopped = stop.partial, stop  # what is finished is shown and written first
    content = comparison.to_dict()
    files: list[str] = []
    failed = attempt(lambda: [write_json(content, folder / "compare.json")], files) or comparison.fault
    if pictures and failed is None and stopped is None:
        failed = attempt(lambda: comparison.picture(folder), files)
    from raceway.studies.compare.screen import compare_screen

    show(content, as_json, failed, lambda: compare_screen(title, comparison.table(), comparison.short_words, files))
    with keeping("runs", kept):
        if stopped is not None:
            raise stopped
    return 0
