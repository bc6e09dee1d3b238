"""The commands ``run`` and ``plan``, and what a run writes beside result.json.  Part of ``raceway.cli.main``."""

from __future__ import annotations

import io
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import click
import numpy as np

from raceway.cli.console import warn
from raceway.cli.frame import (
    RESULTS,
    attempt,
    common,
    load,
    on_scene,
    out_folder,
    plugin_files,
    record,
    require_matplotlib,
    show,
    show_progress,
    tell_faults,
)
from raceway.errors import BeyondPlanError, ConvergenceError, PluginError, RacewayError, SceneError
from raceway.framework.registry import registry_with
from raceway.framework.sources import blamed
from raceway.out.progress import ProgressBar
from raceway.storage.files import slug, without_nan, writable, write_json, write_whole

if TYPE_CHECKING:
    from raceway.framework.contracts import Report
    from raceway.framework.registry import Entry, Registry
    from raceway.pipeline.result import Result
    from raceway.scene.scene import Scene

#: A report's entry in the registry, and the report with its options' defaults.
Chosen = tuple["Entry", "Report"]


class RunOptions(NamedTuple):
    """What ``raceway run`` is options."""

    scene: Path
    changes: tuple[str, ...]
    out: Path | None
    reports: tuple[str, ...]
    pictures: bool
    patience: float
    plugins: tuple[Path, ...]
    as_json: bool


@click.command(short_help="Compute one scene.")
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
def run(options: RunOptions) -> int:
    """Compute one scene: equilibrium, motion, dynamic stiffness with its error and cost.

    Writes DIR/result.json, or DIR/failure.json and DIR/last-good-state.npz when the numbers fail (exit code 1).  Reports are
    plug-ins (raceway dev plugins lists them); one that fails is told after the result is saved.

    \b
    Example:
      raceway run examples/b7206.toml --pictures \\
          --set excitation.speed_rpm=15000 --set supports.tilt=free
    """
    registry = registry_with(options.plugins)
    loaded = load(options.scene, options.changes, registry)
    folder = writable(options.out or RESULTS / slug(loaded.title))
    chosen = chosen_reports((*options.reports, "pictures") if options.pictures else options.reports, registry)
    if any(entry.name == "pictures" for entry, _ in chosen):
        require_matplotlib("leave out --pictures")
    tell_faults(registry)
    with show_progress() as progress:
        from raceway.pipeline.front import run as compute

        try:
            result = compute(loaded, progress=progress, patience=options.patience)
        except (ConvergenceError, BeyondPlanError) as error:
            _keep_state(error, loaded, folder)
            raise
    content = result.to_dict()
    files: list[str] = []
    failed = attempt(lambda: [result.save(folder)], files)
    if failed is None:
        forget_failure(folder)
        failed = write_reports(chosen, result, folder, files)
    from raceway.cli.run_screen import run_screen

    show(content, options.as_json, failed, lambda: run_screen(content, files))
    return 0


@click.command(short_help="Is a scene right, what would be built, and what not.")
@on_scene
@plugin_files
@common
def plan(scene: Path, changes: tuple[str, ...], plugins: tuple[Path, ...], as_json: bool) -> int:
    """Validate a scene, and say what it needs, what is left out and why, and the predicted size, time step and cost.

    Builds nothing. Every mistake is listed with its path, value, rule and the nearest valid choice.

    \b
    Example:
      raceway plan examples/b7206.toml --set supports.tilt=free
    """
    from raceway.cli.plan_screen import plan_screen
    from raceway.planning.plan import check
    from raceway.planning.plan import plan as planned

    registry = registry_with(plugins)
    loaded = load(scene, changes, registry)
    checked = check(loaded)
    tell_faults(registry)
    if checked.mistakes:
        raise SceneError(checked.mistakes)
    for text in checked.warnings:
        warn(text)
    content = {"title": loaded.title, "errors": [], **planned(loaded).to_dict()}
    show(content, as_json, None, lambda: plan_screen(loaded.title, content))
    return 0


def _keep_state(error: RacewayError, scene: Scene, folder: Path) -> None:
    """Write the last good state of a run that failed, and say so in the error."""
    try:
        paths = save_failure(error, scene, folder)
    except RacewayError as why:
        error.add_note(f"the last good state is lost: {why}")
        return
    error.files = {path.stem.replace("-", "_"): str(path) for path in paths}
    what = "failure and last good state" if len(paths) > 1 else "failure"
    error.add_note(f"{what} written: {', '.join(str(path) for path in paths)}")


def chosen_reports(names: Sequence[str], registry: Registry) -> list[Chosen]:
    """The reports of these names, each once, before anything is computed.

    Raises
    ------
    PluginError
        A name that no report has, or two; a report whose options have no defaults.
    """
    found = []
    for name in dict.fromkeys(names):
        entry = registry.find("report", name)
        with blamed(str(entry), "making it without options"):
            found.append((entry, entry.plugin()))
    return found


def write_reports(reports: Sequence[Chosen], result: Result, folder: Path, files: list[str]) -> RacewayError | None:
    """Write every report; one that fails stops no other and is told at the end, by name."""
    failures = []
    for entry, report in reports:
        try:
            with ProgressBar(f"report {entry.name}"), blamed(str(entry), "write()"):
                files += [str(path) for path in report.write(result, folder)]
        except PluginError as why:
            failures.append(str(why))
        except RacewayError as why:
            failures.append(f"{entry}: {why}")
    if not failures:
        return None
    return PluginError(f"{'; '.join(failures)}. The result is saved: `{folder / 'result.json'}`")


def save_failure(error: RacewayError, scene: Scene, folder: Path) -> list[Path]:
    """Write ``failure.json`` and, where there are arrays, ``last-good-state.npz``; an older ``result.json`` is renamed.

    Parameters
    ----------
    error : with ``state``, arrays by name: t [s]; q, v, a (5,) displacement [m, rad] and its rates; ball (Z, 2) [m]

    Raises
    ------
    RacewayError
        A folder or disk that cannot be written.
    """
    _set_aside(folder / "result.json")
    arrays = {name: np.asarray(value) for name, value in error.state.items()}
    content = {
        "title": scene.title,
        "error": {"kind": type(error).__name__, "message": str(error)},
        "state": {name: array.tolist() for name, array in arrays.items()},
        "scene": scene.to_dict(),
    }
    paths = [write_json(without_nan(content), folder / "failure.json")]
    if arrays:
        memory = io.BytesIO()
        np.savez(memory, **arrays)  # type: ignore[arg-type]
        paths.append(write_whole(memory.getvalue(), folder / "last-good-state.npz"))
    return paths


def forget_failure(folder: Path) -> None:
    """Remove what an earlier run that failed left beside a new result."""
    for name in ("failure.json", "last-good-state.npz"):
        with suppress(OSError):
            (folder / name).unlink(missing_ok=True)


def _set_aside(result: Path) -> None:
    """The result of another run is not the answer of this one: it stays, under the name ``result-older.json``."""
    with suppress(OSError):
        if result.is_file():
            result.replace(result.with_name("result-older.json"))
