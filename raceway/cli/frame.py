"""Options, progress, writing and showing of results, shared by all commands.  Part of ``raceway.cli.main``."""

from __future__ import annotations

import logging
import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from raceway.cli.console import described, print_json, warn
from raceway.errors import Mistake, RacewayError, SceneError, extra
from raceway.framework.hookspecs import hookimpl
from raceway.storage.tables import ReadTables, Tables

if TYPE_CHECKING:
    from raceway.answers.progress import ProgressBar
    from raceway.framework.loading.registry import Registry
    from raceway.pipeline.result import Result
    from raceway.planning.plan import ScenePlan
    from raceway.scene.scene import Given, Scene

#: Arguments of fronts that take keys of a scene.
OF_KEYS = ("changes", "keys", "vary", "axes", "free", "at", "ranges", "tolerances")


def scene_keys(context: click.Context, option: click.Parameter, incomplete: str) -> list[str]:
    """Keys that begin so, or after "key=" the values that begin so."""
    from raceway.cli.schema import scene_schema
    from raceway.framework.loading.registry import default_registry

    key, equals, value = incomplete.partition("=")
    # Path of each key -> words that it takes, of all plug-ins that have the key.
    words: dict[str, dict[str, None]] = {}
    for path, word in _walk(scene_schema(default_registry()), ""):
        words.setdefault(path, {}).update({word: None} if word else {})
    if equals:
        return [f"{key}={word}" for word in words.get(key, {}) if word.startswith(value)]
    return sorted(path for path in words if path.startswith(key))


def _walk(schema: ReadTables, path: str) -> Iterator[tuple[str, str]]:
    forms = [schema, *schema.get("oneOf", ()), *schema.get("anyOf", ())]
    if path and not any("properties" in form for form in forms):
        yield path, ""
    for form in forms:
        boolean = ["true", "false"] if form.get("type") == "boolean" else []
        yield from ((path, str(w)) for w in [*form.get("enum", boolean), *([form["const"]] if "const" in form else [])])
        for name, below in form.get("properties", {}).items():
            yield from _walk(below, f"{path}.{name}" if path else name)


F = TypeVar("F", bound=Callable[..., object])

#: Where results go unless --out says otherwise.
RESULTS = Path("raceway-out")
#: A file or folder that need not be there yet: what reads it says what is wrong with it.
FILE = click.Path(path_type=Path, readable=False)
set_keys = click.option(
    "--set", "changes", multiple=True, metavar="A.B=C", shell_complete=scene_keys,
    help="Change a key of the scene; repeat for more.",
)  # fmt: skip


def out_option(default: str) -> Callable[[F], F]:
    """--out; ``default`` is only shown, the command chooses it."""
    return click.option("--out", type=FILE, metavar="DIR", help=f"Folder [{default}].")


plugin_files = click.option(
    "--plugin", "plugins", multiple=True, type=click.Path(path_type=Path), metavar="FILE.py",
    help="A one-off plug-in file, not installed; repeat for more.",
)  # fmt: skip


def common(command: F) -> F:
    """--json, -v and --debug, which every command takes; ``console`` reads --json and --debug from the command line, too."""
    command = click.option("--debug", is_flag=True, expose_value=False, help="Show tracebacks.")(command)
    command = click.option(
        "-v", "--verbose", is_flag=True, expose_value=False, callback=listen, help="Report progress on standard error."
    )(command)
    return click.option("--json", "as_json", is_flag=True, help="Print JSON only, errors too.")(command)


def show_progress(remaining: bool = False, waiting: str | None = None) -> ProgressBar:
    """A bar; ``waiting`` says what happens before the first step where that is not the start of this process."""
    from raceway.answers.progress import ProgressBar
    from raceway.storage.kernel_cache import current_folder

    folder = current_folder()
    warm = folder.is_dir() and any(folder.iterdir())
    return ProgressBar(waiting or ("starting" if warm else "compiling kernels (first run only)"), remaining=remaining)


def attempt(write: Callable[[], list[Path]], files: list[str]) -> RacewayError | None:
    """Write files; hand a failure back, so that what was computed is shown before it is reported."""
    from raceway.answers.progress import ProgressBar

    try:
        with ProgressBar("writing"):
            files += [str(path) for path in write()]
    except RacewayError as error:
        return error
    return None


def show(content: Any, as_json: bool, failed: RacewayError | None, screen: Callable[[], object]) -> None:
    """JSON or tables on standard output; then the failure of writing them, if there was one."""
    if as_json:
        print_json(content if failed is None else {**content, "errors": described(failed)[1]})
        if failed is not None:
            raise click.exceptions.Exit(failed.exit_code)
        return
    from rich.console import Console

    Console(highlight=False).print(screen(), crop=False)
    if failed is not None:
        raise failed


@contextmanager
def keeping(folder: Path | None) -> Iterator[None]:
    """Say where a study goes on that is stopped meanwhile, if anything was finished."""
    try:
        yield
    except KeyboardInterrupt:
        if folder is not None and (file := folder / "points.sqlite").is_file():
            warn(f"finished results are in {file}; the same command continues", label="")
        raise


def faults(registry: Registry) -> list[str]:
    """Plug-ins that could not be loaded, and names that two of them claim; a sentence each."""
    sentences = [str(fault) for fault in registry.faults]
    for kind, name in registry.shadowed():
        owners = " and ".join(f"{e.title} of {e.distribution}" for e in registry.entries[kind, name])
        claim = f"{kind.replace('_', ' ')} '{name}' is claimed by two plug-ins: {owners}"
        sentences.append(f"{claim}. Remove one, or name it in RACEWAY_DISABLE")
    return sentences


def tell_faults(registry: Registry) -> None:
    """Plug-ins that the scene does not use are no reason to stop."""
    for text in faults(registry):
        warn(f"{text} (not used here)")


def changed_tables(scene: Path, changes: tuple[str, ...], registry: Registry) -> tuple[Tables, list[Mistake]]:
    """The scene's tables with the changes, and the changes that cannot be made; files start at the scene's folder."""
    scene_input, mistakes = _with_changes(scene, changes)
    return scene_input.plain(registry), mistakes


def load(scene: Path, changes: tuple[str, ...], registry: Registry) -> Scene:
    """A scene from its file and the changes; SceneError with the mistakes of both."""
    scene_input, mistakes = _with_changes(scene, changes)
    try:
        read = scene_input.scene(registry)
    except SceneError as error:
        raise SceneError([*mistakes, *error.mistakes]) from None
    if mistakes:
        raise SceneError(mistakes)
    return read


def _with_changes(scene: Path, changes: tuple[str, ...]) -> tuple[Given, list[Mistake]]:
    from raceway.scene.scene import as_given

    scene_input = as_given(scene)
    mistakes: list[Mistake] = []
    for change in changes:
        try:
            scene_input = scene_input.changed(change)
        except SceneError as error:
            mistakes += [Mistake(f"--set {m.path}", m.value, m.message) for m in error.mistakes]
    return scene_input, mistakes


def require_matplotlib(otherwise: str) -> None:
    if find_spec("matplotlib") is None:
        raise RacewayError(f"pictures need matplotlib: {extra('pictures')}, or {otherwise}.")


def has_matplotlib(by_default: bool) -> bool:
    """Whether pictures can be drawn; says what is missing where they are no more than the default, else raises it."""
    present = find_spec("matplotlib") is not None
    if not present and not by_default:
        require_matplotlib("leave out --pictures")
    if not present:
        warn(f"no picture: it needs matplotlib, {extra('pictures')}")
    return present


LOGGER = logging.getLogger("raceway")
#: Signs of a line that tell the time.
_TIME = 12


class _Lines(logging.Handler):
    """A line each on standard error, above a bar if one is drawn, with the seconds since the command began."""

    def __init__(self) -> None:
        super().__init__()
        self._begun = time.perf_counter()

    def emit(self, record: logging.LogRecord) -> None:
        from raceway.answers.table import lines_of

        first, *following = lines_of(record.getMessage(), shutil.get_terminal_size().columns - _TIME) or [""]
        click.echo(f"{time.perf_counter() - self._begun:{_TIME - 4}.2f} s  {first}", err=True)
        for line in following:
            click.echo(" " * _TIME + line, err=True)


class _Listener:
    """Tells of each run's plan and of its parts' times, by the life-cycle hooks that plug-ins have, too."""

    @hookimpl
    def raceway_plan_made(self, plan: ScenePlan) -> None:
        steps = f", {plan.predicted_steps} steps in {plan.turns} turns" if plan.predicted_steps else ""
        LOGGER.info("plan: %d degrees of freedom%s, predicted %.2g s", plan.dofs, steps, plan.predicted_wall_s)
        for part in plan.kept:
            LOGGER.info("included: %s (%s)", part.part, part.why)
        LOGGER.info("left out: %s", ", ".join(part.part for part in plan.left_out) or "nothing")

    @hookimpl
    def raceway_run_finished(self, result: Result) -> None:
        cost = result.cost
        parts = [f"{word} {cost[name]:.2f} s" for word, name in _PARTS.items() if cost.get(name)]
        LOGGER.info("run finished in %.2f s: %s", cost["wall_s"], ", ".join(parts) or "nothing to build")
        from raceway.core.jit import clock

        cached = clock["loaded"] - clock["of_wheel"]
        LOGGER.info("kernels: %d came compiled, %d cached, %d compiled now", clock["of_wheel"], cached, clock["compiled"])
        if result.identification is not None:
            from raceway.answers.quantities import K

            LOGGER.info("K = %s at %g r/min", K.text(K.of(result)), 60.0 * result.identification.frequency_hz)

    @hookimpl
    def raceway_run_failed(self, error: Exception) -> None:
        LOGGER.info("run failed: %s", str(error).splitlines()[0] if str(error) else type(error).__name__)


#: Parts of a run's time, and their names in ``cost`` of result.json.
_PARTS = {"compiling": "compile_s", "building": "build_s", "solving": "solve_s", "error": "error_s"}


def listen(context: click.Context, _option: click.Parameter, verbose: bool) -> None:
    """Begin to report, until the command ends."""
    if not verbose:
        return
    from raceway.framework.loading.registry import default_registry

    handler, listener, manager = _Lines(), _Listener(), default_registry().manager
    before = LOGGER.level
    LOGGER.addHandler(handler)
    LOGGER.setLevel(logging.INFO)
    manager.register(listener, name="raceway -v")

    def stop() -> None:
        manager.unregister(listener)
        LOGGER.removeHandler(handler)
        LOGGER.setLevel(before)

    context.call_on_close(stop)


def keep_state(error: RacewayError, scene: Scene, folder: Path) -> None:
    """Write ``failure.json`` and, where there are arrays, ``last-good-state.npz``, and say so in the error.

    The result of another run is not the answer of this one: it stays, under the name ``result-older.json``.

    error : with ``state``, arrays by name: t [s]; q, v, a (5,) displacement [m, rad] and its rates; ball (Z, 2) [m]
    """
    import io

    import numpy as np

    from raceway.storage.files import without_nan, write_json, write_whole

    older = folder / "result.json"
    with suppress(OSError):
        if older.is_file():
            older.replace(older.with_name("result-older.json"))
    arrays: Tables = {name: np.asarray(value) for name, value in error.state.items()}
    content = {
        "title": scene.title,
        "error": {"kind": type(error).__name__, "message": str(error)},
        "state": {name: array.tolist() for name, array in arrays.items()},
        "scene": scene.to_dict(),
    }
    try:
        paths = [write_json(without_nan(content), folder / "failure.json")]
        if arrays:
            memory = io.BytesIO()
            np.savez(memory, **arrays)
            paths.append(write_whole(memory.getvalue(), folder / "last-good-state.npz"))
    except RacewayError as why:
        error.add_note(f"the last good state is lost: {why}")
        return
    error.files = {path.stem.replace("-", "_"): str(path) for path in paths}
    contents = "failure and last good state" if len(paths) > 1 else "failure"
    error.add_note(f"{contents} written: {', '.join(str(path) for path in paths)}")
