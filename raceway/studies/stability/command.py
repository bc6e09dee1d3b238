"""``raceway stability``.  Part of ``raceway.cli.main``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

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
from raceway.storage.tables import ReadTables

if TYPE_CHECKING:
    from rich.console import RenderableType


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
    store = folder / "stability-rows.jsonl"
    with keeping("cases", store), show_progress() as progress:
        from raceway.studies.stability.study import stability as study

        result = study(tables, given.only, given.every, given.processes, store, registry, given.plugins, progress)
    content, files = result.to_dict(), list[str]()
    failed = attempt(lambda: result.write(folder), files) or result.fault
    show(content, given.as_json, failed, lambda: _screen(content, given.only is not None, files))
    return 1 if result.failed else 0


def _screen(content: ReadTables, every_row: bool, files: Sequence[str]) -> RenderableType:
    """A line for each case, or for each row; what is not as expected in full."""
    from rich.console import Group

    from raceway.out.table import rows_table, written
    from raceway.out.wrapping import Words

    rows = content["rows"]
    shown, bad = [_shown(row) for row in rows], [row for row in rows if row["verdict"] == "failed"]
    counts = [
        {"case": case, "rows": str(len(verdicts)), "as expected": str(verdicts.count("as expected"))}
        for case in dict.fromkeys(row["case"] for row in shown)
        if (verdicts := [row["verdict"] for row in shown if row["case"] == case])
    ]
    parts: list[RenderableType] = [Words(content["title"], "bold"), rows_table(shown if every_row else counts)]
    for row in bad:
        cells = ", ".join(cell for name, cell in _shown(row).items() if cell and name != "verdict")
        parts.append(Words(f"failed: {cells}. {row['note'] or row['reason']}", "red"))
    reused = f", {content['reused']} kept from before" if content["reused"] else ""
    counted = f"{len(rows) - len(bad)} of {len(rows)} rows as expected, {content['cases']} cases{reused}"
    parts.append(Words(f"{counted}, {content['seconds']:.0f} s"))
    if content["left_out"] and not every_row:
        parts.append(Words(f"left out: {content['left_out']} cases that take longer; --all runs them"))
    return Group(*parts, *written(files))


def _shown(row: ReadTables) -> dict[str, str]:
    from raceway.out.table import micro

    setting = ", ".join(micro(f"{key} {value}") for key, value in row["setting"].items())
    numbers = {name: "" if row[name] is None else f"{row[name]:.6g}" for name in ("predicted", "observed")}
    words = {"case": micro(row["case"]), "setting": setting, "quantity": row["quantity"], "expected": row["expected"]}
    return {**words, **numbers, "verdict": row["verdict"]}
