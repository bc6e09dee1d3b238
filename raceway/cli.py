"""The commands.  This module, with ``console``, is the only place that prints or exits.

Whatever is heavy is imported inside the command that needs it: ``--help``, ``check``, ``plan``, ``plugins``, ``schema`` and
``cache`` load no numba, scipy or matplotlib.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from raceway import __version__
from raceway.console import Commands, described, print_json, warn
from raceway.errors import ConvergenceError, Mistake, RacewayError, SceneError

if TYPE_CHECKING:
    from raceway.registry import Registry
    from raceway.scene import Scene

_RESULTS = Path("raceway-out")


@click.group(cls=Commands, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(__version__, prog_name="raceway")
@click.option("--debug", is_flag=True, expose_value=False, help="Show tracebacks.")
def main() -> None:
    """Dynamic stiffness of rolling bearings under axial load and rotor unbalance, with error and cost.

    A scene is a TOML file with SI units; ten lines are enough.

    \b
      raceway check examples/b7206.toml     is the scene right?
      raceway plan examples/b7206.toml      what would be built, and what not
      raceway run examples/b7206.toml       the answer
      raceway run examples/b7206.toml --set load.axial=400 --pictures

    Exit codes: 0 success, 1 a numerical failure, 2 a mistake in the scene or on the command line, 130 Ctrl-C.
    """


def _common(command: Callable[..., Any]) -> Callable[..., Any]:
    """--json and --debug, which every command takes; ``console`` reads both from the command line, too."""
    command = click.option("--debug", is_flag=True, expose_value=False, help="Show tracebacks.")(command)
    return click.option("--json", "as_json", is_flag=True, help="Print JSON only, errors too.")(command)


_scene = click.argument("scene", type=click.Path(path_type=Path))
_set = click.option("--set", "changes", multiple=True, metavar="A.B=C", help="Change a key of the scene; repeat for more.")
_out = click.option(
    "--out", type=click.Path(path_type=Path), metavar="DIR", help="Folder of the results [raceway-out/TITLE]."
)


@main.command(short_help="Compute one scene.")
@_scene
@_set
@_out
@click.option("--pictures", is_flag=True, help="Also write orbit, spectrum and ball loads as PNG.")
@_common
def run(scene: Path, changes: tuple[str, ...], out: Path | None, pictures: bool, as_json: bool) -> int:
    """Compute one scene: equilibrium, motion, dynamic stiffness with its error and cost.

    Writes DIR/result.json, or DIR/failure.json and DIR/last-good-state.npz when the numbers fail (exit code 1).

    \b
    Example:
      raceway run examples/b7206.toml --set excitation.speed_rpm=15000 --set supports.tilt=free --pictures
    """
    registry = _registry()
    loaded = _load(scene, changes, registry)
    folder = _writable(out or _RESULTS / slug(loaded.title))
    if pictures:
        _require_matplotlib("leave out --pictures")
    _tell_faults(registry)
    with _progress() as progress:
        from raceway.run import run as compute

        try:
            result = compute(loaded, registry, progress)
        except ConvergenceError as error:
            _keep_state(error, loaded, folder)
            raise
    content = result.as_dict()
    files: list[str] = []
    failed = _attempt(lambda: [result.save(folder)], files)
    if pictures and failed is None:
        report = registry.find("report", "pictures").plugin()
        failed = _attempt(lambda: report.write(result, folder), files)
    _show(content, as_json, failed, lambda screen: screen.run_screen(content, files))
    return 0


@main.command(short_help="Say what would be built and what not.")
@_scene
@_set
@_common
def plan(scene: Path, changes: tuple[str, ...], as_json: bool) -> int:
    """Say what a scene needs, what is left out and why, and the predicted size, time step and cost.  Builds nothing.

    \b
    Example:
      raceway plan examples/b7206.toml --set supports.tilt=free
    """
    from raceway.plan import make_plan

    registry = _registry()
    loaded = _load(scene, changes, registry)
    content = make_plan(loaded).as_dict()
    _tell_faults(registry)
    _show({"title": loaded.title, **content}, as_json, None, lambda screen: screen.plan_screen(loaded.title, content))
    return 0


@main.command(short_help="Validate a scene; compute nothing.")
@_scene
@_set
@_common
def check(scene: Path, changes: tuple[str, ...], as_json: bool) -> int:
    """Validate a scene and list every mistake, each with its path, value, rule and the nearest valid choice.

    \b
    Example:
      raceway check examples/b7206.toml --json
    """
    from raceway.plan import make_plan

    registry = _registry()
    loaded = _load(scene, changes, registry)
    make_plan(loaded)
    _tell_faults(registry)
    if as_json:
        print_json({"errors": []})
    else:
        click.echo(f"{scene}: no mistakes")
    return 0


@main.command(short_help="One scene, some keys varied, everything else the same.")
@_scene
@click.option("--vary", multiple=True, required=True, metavar="A.B=X,Y", help="Values x,y,z or a range start:stop:count.")
@_set
@_out
@click.option("--pictures/--no-pictures", default=True, help="Write the curves as PNG (default).")
@_common
def compare(
    scene: Path, vary: tuple[str, ...], changes: tuple[str, ...], out: Path | None, pictures: bool, as_json: bool
) -> int:
    """Vary some keys of a scene and say which of them causes what: main effects and interactions.

    \b
    Example:
      raceway compare examples/b7206.toml --vary excitation.kind=unidirectional,bidirectional \\
          --vary excitation.speed_rpm=10980:15000:5
    """
    registry = _registry()
    tables = _tables(scene, changes)
    title = _load(scene, changes, registry).title
    folder = _writable(out or _RESULTS / f"{slug(title)}-compare")
    if pictures:
        _require_matplotlib("add --no-pictures")
    _tell_faults(registry)
    with _progress() as progress:
        from raceway.result import write_json
        from raceway.studies.compare import compare as study

        comparison = study(tables, list(vary), registry, progress)
    content = comparison.as_dict()
    files: list[str] = []
    failed = _attempt(lambda: [write_json(content, folder / "compare.json")], files)
    if pictures and failed is None:
        failed = _attempt(lambda: comparison.picture(folder), files)
    _show(content, as_json, failed, lambda screen: screen.compare_screen(title, comparison.table(), comparison.words, files))
    return 0


@main.command(short_help="Compute the published reference cases.")
@click.option("--only", metavar="CASE", help="One case instead of all.")
@_common
def verify(only: str | None, as_json: bool) -> int:
    """Compute published reference cases; exit code 1 when a number misses its tolerance.

    \b
    Example:
      raceway verify --json
    """
    with _progress() as progress:
        from raceway.studies.verify import verify as study

        verification = study(only, progress)
    content = verification.as_dict()
    _show(content, as_json, None, lambda screen: screen.verify_screen(content, verification.passed))
    return 0 if verification.passed else 1


@main.command(short_help="List what is installed, with options.")
@_common
def plugins(as_json: bool) -> int:
    """List every plug-in with its options; broken or shadowed ones are named (exit code 2).

    RACEWAY_DISABLE=NAME,... leaves plug-ins out; RACEWAY_PLUGINS=NAME,... loads exactly these.

    \b
    Example:
      raceway plugins --json
    """
    from raceway.screen import plugin_rows

    registry = _registry()
    rows = plugin_rows(registry.all())
    faults = _faults(registry)
    if as_json:
        print_json({"plugins": rows, "errors": [{"path": None, "value": None, "message": text} for text in faults]})
        return 2 if faults else 0
    _show(rows, False, None, lambda screen: screen.plugins_screen(rows))
    if faults:
        raise RacewayError("\n  ".join(faults))
    return 0


@main.command(short_help="JSON schema of a scene.")
@_common
def schema(as_json: bool) -> int:
    """Print the JSON schema (draft 2020-12) of a scene, for editors, with the options of every installed plug-in.

    \b
    Example:
      raceway schema > scene.schema.json
    """
    from raceway.schema import scene_schema

    del as_json  # it is JSON either way
    print_json(scene_schema(_registry()))
    return 0


@main.command(short_help="See or clear the compiled kernels.")
@click.option("--clear", is_flag=True, help="Remove all compiled kernels; the next run compiles again.")
@_common
def cache(clear: bool, as_json: bool) -> int:
    """Say where compiled kernels are kept (RACEWAY_CACHE_DIR overrides it), how many and how large, and clear them.

    \b
    Example:
      raceway cache --clear
    """
    import attrs

    from raceway import cache_folder

    if clear:
        cache_folder.clear()
    folders = [attrs.asdict(folder) for folder in cache_folder.kernel_folders()]
    content = {
        "root": str(cache_folder.cache_root() / "kernels"),
        "current": cache_folder.source_key(),
        "folders": folders,
        "kernels": sum(f["kernels"] for f in folders),
        "bytes": sum(f["bytes"] for f in folders),
        "cleared": clear,
    }
    _show(content, as_json, None, lambda screen: screen.cache_screen(content))
    return 0


def slug(title: str) -> str:
    """A folder's name from a title: letters, digits, dots and dashes, at most 80."""
    return re.sub(r"[^A-Za-z0-9._]+", "-", title)[:80].strip("-._") or "scene"


def _registry() -> Registry:
    from raceway.registry import default_registry

    return default_registry()


def _faults(registry: Registry) -> list[str]:
    found = [str(fault) for fault in registry.faults]
    for kind, name in registry.shadowed():
        owners = " and ".join(f"{e.plugin.__qualname__} of {e.distribution}" for e in registry.entries[kind, name])
        found.append(
            f"{kind.replace('_', ' ')} '{name}' is claimed by two plug-ins: {owners}. Remove one, or name it in RACEWAY_DISABLE"
        )
    return found


def _tell_faults(registry: Registry) -> None:
    """Plug-ins that the scene does not use are no reason to stop."""
    for text in _faults(registry):
        warn(f"{text} (not used here)")


def _tables(scene: Path, changes: tuple[str, ...]) -> dict[str, Any]:
    """The scene's tables with the changes; a folder in its place is a common slip."""
    from raceway.scene_file import parse_change, read_toml, with_value

    if scene.is_dir():
        inside = sorted(str(p) for p in scene.glob("*.toml"))
        hint = f"; scenes in it: {', '.join(inside[:5])}" if inside else " without a scene (*.toml) in it"
        raise SceneError.at(str(scene), None, f"is a folder{hint}")
    tables = read_toml(scene)
    mistakes: list[Mistake] = []
    for change in changes:
        try:
            tables = with_value(tables, *parse_change(change))
        except SceneError as error:
            mistakes += [Mistake(f"--set {m.path}", m.value, m.message) for m in error.mistakes]
    if mistakes:
        raise SceneError(mistakes)
    tables.setdefault("title", scene.stem)
    return tables


def _load(scene: Path, changes: tuple[str, ...], registry: Registry) -> Scene:
    from raceway.scene_file import scene_from_dict

    return scene_from_dict(_tables(scene, changes), registry)


def _writable(folder: Path) -> Path:
    """Refuse a folder that cannot be written before anything is computed; make nothing yet."""
    place = folder
    while not place.exists() and place != place.parent:
        place = place.parent
    if not place.is_dir():
        raise RacewayError(
            f"`{folder}` cannot be the folder of the results: `{place}` is a file. Choose another with --out."
        )
    if not os.access(place, os.W_OK | os.X_OK):
        raise RacewayError(f"`{folder}` cannot be written: no permission in `{place}`. Choose another folder with --out.")
    return folder


def _require_matplotlib(otherwise: str) -> None:
    if find_spec("matplotlib") is None:
        raise RacewayError(f'pictures need matplotlib: pip install "raceway[pictures]", or {otherwise}.')


def _progress() -> Any:
    from raceway.cache_folder import current_folder
    from raceway.progress import ProgressBar

    folder = current_folder()
    warm = folder.is_dir() and any(folder.iterdir())
    return ProgressBar("starting" if warm else "compiling kernels (first run only)")


def _attempt(write: Callable[[], list[Path]], files: list[str]) -> RacewayError | None:
    """Write files; hand a failure back, so that what was computed is shown before it is reported."""
    try:
        files += [str(path) for path in write()]
    except RacewayError as error:
        return error
    return None


def _keep_state(error: ConvergenceError, scene: Scene, folder: Path) -> None:
    """Write the last good state of a run that failed, and say so in the error."""
    from raceway.failure import save_failure

    try:
        paths = save_failure(error, scene, folder)
    except RacewayError as why:
        error.add_note(f"the last good state is lost: {why}")
        return
    error.files = {path.stem.replace("-", "_"): str(path) for path in paths}  # type: ignore[attr-defined]
    error.add_note("last good state: " + ", ".join(str(path) for path in paths))


def _show(content: Any, as_json: bool, failed: RacewayError | None, screen: Callable[[Any], Any]) -> None:
    """JSON or tables on standard output; then the failure of writing them, if there was one."""
    if as_json:
        print_json(content if failed is None else {**content, "errors": described(failed)[1]})
        if failed is not None:
            raise click.exceptions.Exit(failed.exit_code)
        return
    from rich.console import Console

    from raceway import screen as tables

    Console(highlight=False).print(screen(tables), crop=False, overflow="ignore")
    if failed is not None:
        raise failed
