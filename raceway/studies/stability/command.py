"""``raceway stability``.  Part of ``raceway.cli.main``."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import click

from raceway.cli.frame import (
    RESULTS,
    attempt,
    changed_tables,
    common,
    keeping,
    out_option,
    plugin_files,
    processes_at_a_time,
    record,
    scene_if_any,
    set_keys,
    show,
    show_progress,
    slug,
    tell_faults,
)
from raceway.errors import SceneError
from raceway.framework.registry import registry_with
from raceway.storage.files import writable


class StabilityOptions(NamedTuple):
    """What ``raceway stability`` is given."""

    scene: Path | None
    only: str | None
    processes: int
    every: bool
    changes: tuple[str, ...]
    out: Path | None
    plugins: tuple[Path, ...]
    as_json: bool


@click.command(short_help="Stiff and extreme cases: what must hold, holds.")
@scene_if_any
@click.option("--only", metavar="WORDS", help="Cases whose name holds these words, row by row.")
@processes_at_a_time
@click.option("--all", "every", is_flag=True, help="All cases, not only those of a minute: some ten minutes.")
@set_keys
@out_option(f"{RESULTS}/stability")
@plugin_files
@common
@record(StabilityOptions)
def stability(given: StabilityOptions) -> int:
    """Put every law and transient integrator through stiff and extreme cases; exit code 1 when one is not as expected.

    Without --only or --all a set of quick cases is run. With SCENE, that scene is put through the cases that suit any scene. Writes stability.json and stability.md. Finished
    cases are kept in DIR/stability-rows.jsonl and reused.

    \b
    Example:
      raceway stability --only chatter
    """
    registry = registry_with(given.plugins)
    tables = None
    if given.scene is not None:
        from raceway.scene.reading import scene_from_dict

        tables, mistakes = changed_tables(given.scene, given.changes, registry)
        if mistakes:
            raise SceneError(mistakes)
        scene_from_dict(tables, registry)
    elif given.changes:
        raise SceneError.at("--set", given.changes[0], "changes a scene, and none is given: name one, or leave it out")
    name = "stability" if tables is None else f"{slug(str(tables['title']))}-stability"
    folder = writable(given.out or RESULTS / name)
    tell_faults(registry)
    kept = folder / "stability-rows.jsonl"
    with keeping("cases", kept), show_progress() as progress:
        from raceway.studies.stability.study import stability as study

        found = study(tables, given.only, given.every, given.processes, kept, registry, given.plugins, progress)
    content, files = found.to_dict(), list[str]()
    failed = attempt(lambda: found.write(folder), files) or found.fault
    from raceway.studies.stability.screen import stability_screen

    show(content, given.as_json, failed, lambda: stability_screen(content, given.only is not None, files))
    return 1 if found.failed else 0
