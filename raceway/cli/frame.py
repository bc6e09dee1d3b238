"""Options, progress, writing and showing of results, shared by all commands.  Part of ``raceway.cli.main``."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from raceway.cli.completion import scene_keys
from raceway.cli.console import described, print_json, warn
from raceway.cli.verbose import listen
from raceway.errors import Mistake, RacewayError, SceneError, extra
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from raceway.answers.progress import ProgressBar
    from raceway.framework.registry import Registry
    from raceway.scene.scene import Given, Scene


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
    start = waiting or ("starting" if warm else "compiling kernels (first run only)")
    return ProgressBar(start, remaining=remaining)


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
        sentences.append(
            f"{kind.replace('_', ' ')} '{name}' is claimed by two plug-ins: {owners}. Remove one, or name it in "
            "RACEWAY_DISABLE"
        )
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
    """A scene from its file and the changes.

    Raises
    ------
    SceneError
        With the mistakes of both.
    """
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
