"""The commands.  This module, with ``console``, is the only place that prints or exits.

Whatever is heavy is imported inside the command that needs it: ``--help`` loads no command, ``check``, ``plan``, ``plugins``,
``schema`` and ``cache`` load no numba, scipy or matplotlib.
"""

from __future__ import annotations

import os
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import click

from raceway import __version__
from raceway.cli.console import Commands, print_json, warn
from raceway.cli.frame import (
    RESULTS,
    attempt,
    common,
    on_scene,
    out_folder,
    plugin_files,
    record,
    show,
    show_progress,
)
from raceway.errors import BeyondPlanError, ConvergenceError, RacewayError, SceneError

if TYPE_CHECKING:
    from raceway.scene.scene import Scene


#: Commands that are imported when they are asked for: module, where the command has the name of its words, and short help.
_LATER = {
    "compare": ("raceway.points.commands", "One scene, some keys varied, everything else the same."),
    "verify": ("raceway.studies.verify.command", "Compute the reference cases."),
    "precision": ("raceway.points.commands", "Error against run time: which setting is good enough."),
    "stability": ("raceway.studies.stability.command", "Stiff and extreme cases: what must hold, holds."),
    "band": ("raceway.points.commands", "The range of an answer over the tolerances of its scene."),
    "sensitivities": ("raceway.points.commands", "How much each number of a scene changes the answer."),
    "sweep": ("raceway.points.commands", "One scene at thousands of points, kept in a store; parallel, resumable."),
    "follow": (
        "raceway.points.follow_command",
        "K as a curve over speed or any continuous key: folds, stability, special points.",
    ),
    "study": ("raceway.studies.command", "Whole studies that end in a page, and others' studies."),
    "plot": ("raceway.points.commands", "Draw a sweep: curves, maps, surfaces."),
    "export": ("raceway.studies.rotor.command", "Write a sweep's coefficients for a rotor program."),
    "infer": ("raceway.studies.catalogue.infer_command", "Balls and grooves of a bearing from what its maker prints."),
    "catalogue": ("raceway.studies.catalogue.command", "List, search and draw the bearings of the catalogue."),
    "law": ("raceway.points.law_command", "What a contact law does: force, stiffness, damping, energy a cycle."),
    "fit": ("raceway.studies.fit.command", "Numbers of a scene, or K and C of a rig's bearing, from measured data."),
    "identify": ("raceway.studies.fit.command", "The same as fit: without --free K and C from a rig's signals."),
    "view": ("raceway.studies.view.command", "Draw a bearing: loads, contacts, mesh, orbit; pictures and a page."),
    "mesh": ("raceway.studies.view.mesh", "Mesh the bodies of a scene: counts, quality, files."),
    "new-scene": ("raceway.cli.new_scene", "Write a scene to start from."),
    "plugins": ("raceway.cli.plugins", "List what is installed, with options."),
    "check-plugin": ("raceway.cli.plugins", "Does a plug-in keep its contract?"),
    "new-plugin": ("raceway.cli.plugins", "Write a package for a new plug-in."),
    "schema": ("raceway.cli.plugins", "JSON schema of a scene."),
    "cache": ("raceway.cli.cache", "See or clear what is kept between runs."),
}


class CommandsByName(Commands):
    """All commands; only the one that is asked for is imported, none for ``--help``."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return sorted({*super().list_commands(ctx), *_LATER})

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        # Matrices of some hundred rows: threads of the linear algebra only wait for each other, and halve the speed of a run
        # on busy cores.  Read when numpy is imported, which is later than this.
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
        if cmd_name in _LATER:
            command: click.Command = getattr(import_module(_LATER[cmd_name][0]), cmd_name.replace("-", "_"))
            return command
        return super().get_command(ctx, cmd_name)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        own = {name: command.get_short_help_str(80) for name, command in self.commands.items()}
        rows = {**own, **{name: words for name, (_, words) in _LATER.items()}}
        with formatter.section("Commands"):
            formatter.write_dl([(name, rows[name]) for name in self.list_commands(ctx)])


@click.group(cls=CommandsByName, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(__version__, prog_name="raceway")
@click.option("--debug", is_flag=True, expose_value=False, help="Show tracebacks.")
def main() -> None:
    """Dynamic stiffness of ball bearings under axial load and rotor unbalance, with error and cost.

    A scene is a TOML file with SI units; ten lines are enough.

    \b
      raceway check examples/b7206.toml     is the scene right?
      raceway plan examples/b7206.toml      what would be built, and what not
      raceway run examples/b7206.toml       the answer
      raceway run examples/b7206.toml --set load.axial=400 --pictures

    Exit codes: 0 success, 1 a numerical failure, 2 a mistake in the scene or on the command line; 130 Ctrl-C,
    143 SIGTERM, 129 SIGHUP.
    """


class RunOptions(NamedTuple):
    """What ``raceway run`` is given."""

    scene: Path
    changes: tuple[str, ...]
    out: Path | None
    reports: tuple[str, ...]
    pictures: bool
    patience: float
    plugins: tuple[Path, ...]
    as_json: bool


@main.command(short_help="Compute one scene.")
@on_scene
@out_folder
@click.option("--report", "reports", multiple=True, metavar="NAME", help="Also write this report; repeat for more.")
@click.option("--pictures", is_flag=True, help="The report 'pictures': orbit, spectrum and ball loads as PNG.")
@click.option(
    "--patience", type=click.FloatRange(min=0.0), default=20.0, show_default=True, metavar="FACTOR",
    help="Stop a run that takes this many times its planned time, or far more memory than planned; inf: never.",
)  # fmt: skip
@plugin_files
@common
@record(RunOptions)
def run(given: RunOptions) -> int:
    """Compute one scene: equilibrium, motion, dynamic stiffness with its error and cost.

    Writes DIR/result.json, or DIR/failure.json and DIR/last-good-state.npz when the numbers fail (exit code 1).  Reports are
    plug-ins (raceway plugins lists them); one that fails is told after the result is saved.

    \b
    Example:
      raceway run examples/b7206.toml --pictures \\
          --set excitation.speed_rpm=15000 --set supports.tilt=free
    """
    from raceway.cli.frame import load, require_matplotlib, slug, tell_faults
    from raceway.cli.run import chosen_reports, write_reports
    from raceway.framework.registry import registry_with
    from raceway.storage.files import writable

    registry = registry_with(given.plugins)
    loaded = load(given.scene, given.changes, registry)
    folder = writable(given.out or RESULTS / slug(loaded.title))
    chosen = chosen_reports((*given.reports, "pictures") if given.pictures else given.reports, registry)
    if any(entry.name == "pictures" for entry, _ in chosen):
        require_matplotlib("leave out --pictures")
    tell_faults(registry)
    with show_progress() as progress:
        from raceway.pipeline.front import run as compute

        try:
            result = compute(loaded, progress=progress, patience=given.patience)
        except (ConvergenceError, BeyondPlanError) as error:
            _keep_state(error, loaded, folder)
            raise
    content = result.to_dict()
    files: list[str] = []
    failed = attempt(lambda: [result.save(folder)], files)
    if failed is None:
        from raceway.cli.run import forget_failure

        forget_failure(folder)
        failed = write_reports(chosen, result, folder, files)
    from raceway.cli.run_screen import run_screen

    show(content, given.as_json, failed, lambda: run_screen(content, files))
    return 0


@main.command(short_help="Say what would be built and what not.")
@on_scene
@plugin_files
@common
def plan(
    scene: Path,
    changes: tuple[str, ...],
    plugins: tuple[Path, ...],
    as_json: bool,
) -> int:
    """Say what a scene needs, what is left out and why, and the predicted size, time step and cost.  Builds nothing.

    \b
    Example:
      raceway plan examples/b7206.toml --set supports.tilt=free
    """
    from raceway.cli.frame import load, tell_faults
    from raceway.framework.registry import registry_with
    from raceway.planning.plan import plan as planned

    registry = registry_with(plugins)
    loaded = load(scene, changes, registry)
    content = planned(loaded).to_dict()
    tell_faults(registry)
    from raceway.cli.plan_screen import plan_screen

    show({"title": loaded.title, **content}, as_json, None, lambda: plan_screen(loaded.title, content))
    return 0


@main.command(short_help="Validate a scene; compute nothing.")
@on_scene
@plugin_files
@common
def check(
    scene: Path,
    changes: tuple[str, ...],
    plugins: tuple[Path, ...],
    as_json: bool,
) -> int:
    """Validate a scene and list every mistake, each with its path, value, rule and the nearest valid choice.

    \b
    Example:
      raceway check examples/b7206.toml --json
    """
    from raceway.cli.frame import load, tell_faults
    from raceway.framework.registry import registry_with
    from raceway.planning.plan import check as checked

    registry = registry_with(plugins)
    found = checked(load(scene, changes, registry))
    tell_faults(registry)
    if found.mistakes:
        raise SceneError(found.mistakes)
    for text in found.warnings:
        warn(text)
    if as_json:
        print_json({"errors": []})
    else:
        click.echo(f"{scene}: no mistakes")
    return 0


def _keep_state(error: RacewayError, scene: Scene, folder: Path) -> None:
    """Write the last good state of a run that failed, and say so in the error."""
    from raceway.cli.run import save_failure

    try:
        paths = save_failure(error, scene, folder)
    except RacewayError as why:
        error.add_note(f"the last good state is lost: {why}")
        return
    error.files = {path.stem.replace("-", "_"): str(path) for path in paths}
    what = "failure and last good state" if len(paths) > 1 else "failure"
    error.add_note(f"{what} written: {', '.join(str(path) for path in paths)}")
