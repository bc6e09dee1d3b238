"""``raceway precision``.  Part of ``raceway.cli.main``."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import click

from raceway.cli.frame import (
    RESULTS,
    attempt,
    changed_tables,
    common,
    has_matplotlib,
    keeping,
    out_option,
    plugin_files,
    record,
    scene_file,
    set_keys,
    show,
    show_progress,
    slug,
    tell_faults,
)
from raceway.errors import ConvergenceError, SceneError
from raceway.framework.registry import registry_with
from raceway.storage.files import writable


class PrecisionOptions(NamedTuple):
    """What ``raceway precision`` is given."""

    scene: Path
    vary: tuple[str, ...]
    reference: tuple[str, ...]
    repeats: int
    limit: float
    changes: tuple[str, ...]
    out: Path | None
    pictures: bool
    plugins: tuple[Path, ...]
    as_json: bool


@click.command(short_help="Error against run time: which setting is good enough.")
@scene_file
@click.option("--vary", multiple=True, metavar="A.B=X,Y", help="Axis; all combinations are run. Without: a default design.")
@click.option("--reference", multiple=True, metavar="A.B=C", help="Key of the reference; found by itself without.")
@click.option("--repeats", type=click.IntRange(1, 1000), default=3, show_default=True, help="Runs of each setting.")
@click.option(
    "--limit", type=click.FloatRange(min=0.0, min_open=True), default=30.0, show_default=True, metavar="SECONDS",
    help="Leave out what is predicted to take longer.",
)  # fmt: skip
@set_keys
@out_option(f"{RESULTS}/TITLE-precision")
@click.option("--pictures/--no-pictures", default=True, help="Draw error against run time as PNG (default).")
@plugin_files
@common
@record(PrecisionOptions)
def precision(given: PrecisionOptions) -> int:
    """Run a scene with many settings and say what each costs and how far it is from a reference with a known bound.

    Writes precision.json, precision.md and precision.png. Finished rows are kept in DIR/precision-rows.jsonl and reused.

    \b
    Example:
      raceway precision examples/b7206.toml \\
          --vary integrator.kind=newmark,central_difference \\
          --vary integrator.steps_per_turn=45,90,180,360
    """
    registry = registry_with(given.plugins)
    tables, mistakes = changed_tables(given.scene, given.changes, registry)
    if mistakes:
        raise SceneError(mistakes)
    folder = writable(given.out or RESULTS / f"{slug(str(tables['title']))}-precision")
    pictures = given.pictures and has_matplotlib()
    tell_faults(registry)
    kept = folder / "precision-rows.jsonl"
    with keeping("rows", kept), show_progress() as progress:
        from raceway.studies.precision.front import precision as study

        found = study(
            tables,
            given.vary,
            reference=given.reference,
            repeats=given.repeats,
            limit_s=given.limit,
            kept=kept,
            progress=progress,
        )
    content, files = found.to_dict(), list[str]()
    failed = attempt(lambda: found.write(folder, pictures), files) or found.fault
    if failed is None:
        failed = verdict(content, found.converged, bool(given.reference))
    from raceway.studies.precision.screen import precision_screen

    show(
        content,
        given.as_json,
        failed,
        lambda: precision_screen(content["title"], found.table(), content["words"], files),
    )
    return 0


def verdict(content: dict, converged: bool, given: bool) -> ConvergenceError | SceneError | None:
    """What makes a finished study worthless, after it has been shown."""
    rows = content["rows"]
    known = [row for row in rows if row["error"] is not None]
    if given and known and all(row["at_bound"] for row in known):
        message = "is not more accurate than the rows: make it finer, or leave it out and let the study find one"
        return SceneError.at("--reference", None, message)
    if not converged:
        reasons = [row["reason"] for row in rows if row["reason"]]
        why = f"; the first reason: {reasons[0]}" if reasons else ": all errors are above 1 %"
        return ConvergenceError(f"no setting converged{why}")
    return None
