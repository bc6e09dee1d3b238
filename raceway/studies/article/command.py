"""``raceway study article``.  Part of ``raceway.cli.main``."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import click
from click.core import ParameterSource

from raceway.cli.frame import (
    RESULTS,
    attempt,
    changed_tables,
    common,
    has_matplotlib,
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
from raceway.errors import ConvergenceError, Mistake, SceneError
from raceway.framework.registry import registry_with
from raceway.storage.files import writable
from raceway.storage.tables import Tables

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
    from raceway.studies.article.elastic import SCENE, TURNS, design

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
        from raceway.studies.article.elastic import elastic_article
        from raceway.studies.article.elastic_page import write

        found = elastic_article(made, folder if draw else None, kept, registry, plugins, progress)
        progress("writing", 0, 0)
        content, files = found.to_dict(), list[str]()
        failed = attempt(lambda: write(found, folder, draw, command), files) or found.fault
    if failed is None and found.failed == len(found.rows):
        failed = ConvergenceError(f"every run failed; the first reason: {found.rows[0]['reason']}")
    from raceway.studies.article.elastic_page import elastic_screen

    show(content, as_json, failed, lambda: elastic_screen(content, files))
    return 0


class ArticleOptions(NamedTuple):
    """What ``raceway study article`` is given."""

    scene: Path | None
    bodies: str
    speeds: str
    axial: str
    shaft: float | None
    friction: float | None
    turns: int | None
    processes: int
    changes: tuple[str, ...]
    out: Path | None
    pictures: bool
    plugins: tuple[Path, ...]
    as_json: bool


@click.command(short_help="The article's figures 9 to 12 and a verdict on each of its claims.")
@scene_if_any
@click.option(
    "--bodies",
    type=click.Choice(["rigid", "condensed", "both", "elastic"]),
    default="both",
    show_default=True,
    help="What deforms: only the contacts, or finite-element rings and balls, too; elastic: the article's own model at one operating "
    "point, beside the others.",
)
@click.option(
    "--speeds", default="10980:15000:9", show_default=True, metavar="LIST", help="r/min; a,b,c or start:stop:count."
)
@click.option("--axial", default="400:2000:9", show_default=True, metavar="LIST", help="Axial loads in N.")
@click.option("--shaft", type=float, metavar="N·M/RAD", help="Tilt stiffness of the shaft [the scene's, or the rig's].")
@click.option(
    "--friction",
    type=float,
    metavar="MU",
    help="Coulomb coefficient of the runs with friction [the scene's, or 0.03]; 0: none.",
)
@click.option("--turns", type=click.IntRange(1, 1000), metavar="N", help="Of a motion of elastic bodies, 40 steps each [2].")
@processes_at_a_time
@set_keys
@out_option(f"{RESULTS}/article")
@click.option("--pictures/--no-pictures", default=True, help="Draw figures and write the page (default).")
@plugin_files
@common
@record(ArticleOptions)
def article(given: ArticleOptions) -> int:
    """Compute the article's figures 9 to 12 and say which of its claims hold, and where.

    SCENE is the bearing; the article's B7206C without it. Excitation, speed, axial load, tilt, ball inertia, bodies,
    friction and integrator are set by the study. Writes article.html, which opens from a file without a network, its figures as PNG,
    article.json and CSV tables. Finished curves are kept in DIR/article-rows.jsonl and reused.

    With --bodies elastic every node of rings and balls moves, on the article's mesh without SCENE: four load cases at rest and one
    operating point under both excitations, beside condensed and rigid bodies. It takes gigabytes, and writes article-elastic.html;
    finished runs are kept in DIR/article-elastic-rows.jsonl.

    \b
    Example:
      raceway study article --bodies rigid --friction 0
      raceway study article examples/b7206.toml \\
          --set rotor.mass=1.5 --axial 400,1000,2000
      raceway study article --bodies elastic --set mesh.element_size=2e-3
    """  # fmt: skip
    elastic = given.bodies == "elastic"
    _refuse_unused(click.get_current_context(), elastic)
    registry = registry_with(given.plugins)
    if elastic:
        command = _command(click.get_current_context())
        return study_elastic(given.scene, given.changes, given.friction, given.turns, given.out, given.pictures, given.plugins,
                             given.as_json, command, registry)  # fmt: skip
    from raceway.studies.article.design import ARTICLE, article_tables, design

    tables: Tables | None = None
    if given.scene is not None or given.changes:
        tables, mistakes = changed_tables(given.scene or ARTICLE, given.changes, registry)
        if mistakes:
            raise SceneError(mistakes)
    kinds = ("rigid", "condensed") if given.bodies == "both" else (given.bodies,)
    made = design(tables or article_tables(), given.speeds, given.axial, given.shaft, kinds, given.friction)
    command = _command(click.get_current_context())
    name = "article" if given.scene is None else f"{slug(str((tables or {})['title']))}-article"
    folder = writable(given.out or RESULTS / name)
    pictures = given.pictures and has_matplotlib()
    tell_faults(registry)
    kept = folder / "article-rows.jsonl"
    with keeping("curves", kept), show_progress() as progress:
        from raceway.studies.article.page import write
        from raceway.studies.article.study import article as study

        found = study(made, given.processes, kept, registry, given.plugins, progress)
        progress("writing", 0, 0)
        content, files = found.to_dict(), list[str]()
        failed = attempt(lambda: write(found, folder, pictures, command), files) or found.fault
    if failed is None and all(row["status"] == "failed" for row in content["rows"]):
        failed = ConvergenceError(f"every run failed; the first reason: {content['rows'][0]['reason']}")
    from raceway.studies.article.page import article_screen

    show(content, given.as_json, failed, lambda: article_screen(content, files))
    return 0


#: Options that one choice of --bodies has no use for, with the reason.
_NOT_ELASTIC = {
    "speeds": "there is one operating point: --set excitation.speed_rpm=12000",
    "axial": "load cases at rest are fixed; that of the motions: --set load.axial=1000",
    "shaft": "the tilt is locked",
    "processes": "runs take gigabytes each and go one at a time",
}
_ELASTIC_ONLY = {"turns": "the study sets them, or has steady orbits"}


def _refuse_unused(context: click.Context, elastic: bool) -> None:
    """Refuse what was typed and would have no effect.

    Raises
    ------
    SceneError
        Naming each option.
    """
    unused = _NOT_ELASTIC if elastic else _ELASTIC_ONLY
    bodies = context.params["bodies"]
    mistakes = [
        Mistake(f"--{name}", context.params[name], f"has no effect with --bodies {bodies}: {why}; leave it out")
        for name, why in unused.items()
        if context.get_parameter_source(name) is ParameterSource.COMMANDLINE
    ]
    if mistakes:
        raise SceneError(mistakes)


def _command(context: click.Context) -> str:
    """What was typed, as far as it decides the numbers; of a path from the root only the name."""
    words = ["raceway", "study", "article"]
    for parameter in context.command.params:
        name = str(parameter.name)
        typed = context.get_parameter_source(name) is ParameterSource.COMMANDLINE
        if not typed or name not in context.params or name in ("out", "processes", "pictures", "as_json"):
            continue
        value = context.params[name]
        for one in value if parameter.multiple else (value,):
            text = one.name if isinstance(one, Path) and one.is_absolute() else str(one)
            words += [text] if isinstance(parameter, click.Argument) else [parameter.opts[0], text]
    return shlex.join(words)
