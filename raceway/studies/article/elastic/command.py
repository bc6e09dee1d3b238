"""``raceway study article --bodies elastic``.  Part of ``raceway.cli``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from raceway.commands.frame import RESULTS, attempt, keeping, show, show_progress
from raceway.commands.inputs import changed_tables, has_matplotlib, slug, tell_faults
from raceway.errors import ConvergenceError, SceneError
from raceway.storage.files import writable

if TYPE_CHECKING:
    from raceway.framework.registry import Registry


def study_elastic(
    scene: Path | None,
    changes: tuple[str, ...],
    friction: float | None,
    turns: int | None,
    out: Path | None,
    pictures: bool,
    plugins: tuple[Path, ...],
    as_json: bool,
    command: str,
    registry: Registry,
) -> int:
    """Run it, write everything, show the table.

    Parameters
    ----------
    as given on the command line;  command : what was typed

    Raises
    ------
    RacewayError
        Mistakes of the scene, before anything is run; a folder that cannot be written; every run failed.
    """
    from raceway.studies.article.elastic.design import SCENE, TURNS, design

    tables, mistakes = changed_tables(scene or SCENE, changes, registry)
    if mistakes:
        raise SceneError(mistakes)
    made = design(tables, friction, TURNS if turns is None else turns)
    name = "article-elastic" if scene is None else f"{slug(str(tables['title']))}-article-elastic"
    folder = writable(out or RESULTS / name)
    draw = pictures and has_matplotlib()
    tell_faults(registry)
    kept = folder / "article-elastic-rows.jsonl"
    with keeping("runs", kept), show_progress() as progress:
        from raceway.studies.article.elastic.files import write
        from raceway.studies.article.elastic.study import elastic_article

        found = elastic_article(made, folder if draw else None, kept, registry, plugins, progress)
        progress("writing", 0, 0)
        content, files = found.to_dict(), list[str]()
        failed = attempt(lambda: write(found, folder, draw, command), files) or found.fault
    if failed is None and found.failed == len(found.rows):
        failed = ConvergenceError(f"every run failed; the first reason: {found.rows[0]['reason']}")
    from raceway.studies.article.elastic.screen import elastic_screen

    show(content, as_json, failed, lambda: elastic_screen(content, files))
    return 0
