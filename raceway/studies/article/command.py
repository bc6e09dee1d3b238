"""``raceway study article``.  Part of ``raceway.cli.main``."""

from __future__ import annotations

import shlex
from collections.abc import Callable
from functools import partial
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
    tell_faults,
)
from raceway.errors import Mistake, SceneError
from raceway.framework.registry import registry_with
from raceway.storage.files import slug, writable

if TYPE_CHECKING:
    from raceway.out.answer import Answer


class _ArticleOptions(NamedTuple):
    """Arguments and options of ``raceway study article``."""

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
@record(_ArticleOptions)
def article(options: _ArticleOptions) -> int:
    """Compute the article's figures 9 to 12 and say which of its claims hold, and where.

    SCENE is the bearing; the article's B7206C without it. Excitation, speed, axial load, tilt, ball inertia, bodies,
    friction and integrator are set by the study. Writes article.html, which opens from a file without a network, its figures as PNG,
    article.json and CSV tables. Finished curves are stored in DIR/article-rows.jsonl and reused.

    With --bodies elastic every node of rings and balls moves, on the article's mesh without SCENE: four load cases at rest and one
    operating point under both excitations, beside condensed and rigid bodies. It takes gigabytes, and writes article-elastic.html;
    finished runs are stored in DIR/article-elastic-rows.jsonl.

    \b
    Example:
      raceway study article --bodies rigid --friction 0
      raceway study article examples/b7206.toml \\
          --set rotor.mass=1.5 --axial 400,1000,2000
      raceway study article --bodies elastic --set mesh.element_size=2e-3
    """  # fmt: skip
    context, elastic = click.get_current_context(), options.bodies == "elastic"
    _refuse_unused(context, elastic)
    registry = registry_with(options.plugins)
    scene = options.scene or Path(__file__).resolve().parents[2] / "data" / f"article{'_elastic' if elastic else ''}.toml"
    tables, mistakes = changed_tables(scene, options.changes, registry)
    if mistakes:
        raise SceneError(mistakes)
    name = "article-elastic" if elastic else "article"
    folder = writable(options.out or RESULTS / (name if options.scene is None else f"{slug(str(tables['title']))}-{name}"))
    pictures = options.pictures and has_matplotlib()
    tell_faults(registry)
    compute: Callable[..., Answer]
    if elastic:
        from raceway.studies.article.elastic import TURNS, elastic_article
        from raceway.studies.article.elastic import design as elastic_design

        runs = elastic_design(tables, options.friction, TURNS if options.turns is None else options.turns)
        compute = partial(elastic_article, runs, folder if pictures else None)
    else:
        from raceway.studies.article.design import design

        kinds = ("rigid", "condensed") if options.bodies == "both" else (options.bodies,)
        curves = design(tables, options.speeds, options.axial, options.shaft, kinds, options.friction)
        # Mistakes are refused before anything is loaded that computes.
        from raceway.studies.article.study import article as compute_curves

        compute = partial(compute_curves, curves, options.processes)
    rows = folder / f"{name}-rows.jsonl"
    with keeping(f"finished {'runs' if elastic else 'curves'} are kept in", rows), show_progress() as progress:
        answer = compute(rows, registry, options.plugins, progress, _command(context))
        progress("writing", 0, 0)
        files: list[str] = []
        failed = attempt(lambda: answer.save(folder, pictures), files) or answer.failure()
    show(answer.to_dict(), options.as_json, failed, lambda: answer.screen(files))
    return 0


#: Options that one choice of --bodies has no use for, with the reason.
_NOT_ELASTIC = {
    "speeds": "there is one operating point: --set excitation.speed_rpm=12000",
    "axial": "load cases at rest are fixed; that of the motions: --set load.axial=1000",
    "shaft": "the tilt is locked",
    "processes": "runs take gigabytes each and go one at a time",
}
_ELASTIC_ONLY = {"turns": "the study sets them, or has steady orbits"}


def _typed(context: click.Context, name: str) -> bool:
    return context.get_parameter_source(name) is ParameterSource.COMMANDLINE


def _refuse_unused(context: click.Context, elastic: bool) -> None:
    """Refuse what was typed and would have no effect.

    Raises
    ------
    SceneError
        Naming each option.
    """
    bodies = context.params["bodies"]
    mistakes = [
        Mistake(f"--{name}", context.params[name], f"has no effect with --bodies {bodies}: {why}; leave it out")
        for name, why in (_NOT_ELASTIC if elastic else _ELASTIC_ONLY).items()
        if _typed(context, name)
    ]
    if mistakes:
        raise SceneError(mistakes)


def _command(context: click.Context) -> str:
    """What was typed, as far as it decides the numbers; of a path from the root only the name."""
    words = ["raceway", "study", "article"]
    for parameter in context.command.params:
        name = str(parameter.name)
        if name not in context.params or name in ("out", "processes", "pictures", "as_json") or not _typed(context, name):
            continue
        values = context.params[name]
        for value in values if parameter.multiple else (values,):
            text = value.name if isinstance(value, Path) and value.is_absolute() else str(value)
            words += [text] if isinstance(parameter, click.Argument) else [parameter.opts[0], text]
    return shlex.join(words)
