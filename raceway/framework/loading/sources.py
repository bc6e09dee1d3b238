"""Sources of plug-ins: entry points of installed distributions, and one-off files."""

import hashlib
import os
import sys
import threading
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stdout
from importlib.metadata import EntryPoint, entry_points
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from traceback import extract_tb
from typing import Any

from raceway.errors import PluginError, RacewayError
from raceway.framework.loading import names_in, packages
from raceway.framework.options import nearest
from raceway.storage.files import size_of

#: Bytes of a plug-in file at most.
_LONGEST = 2**24


def chosen_entry_points(third_party: bool = True) -> tuple[list[EntryPoint], list[str]]:
    """The entry points to load, and the names in RACEWAY_PLUGINS that nothing installed has; those of this project's packages always."""
    points = sorted(entry_points(group="raceway"), key=lambda p: (p.name, owner(p)[0]))
    if not third_party:
        points = [p for p in points if owner(p)[0] in packages()]
    missing: list[str] = []
    every = {name for p in points for name in _called(p)}
    if "RACEWAY_PLUGINS" in os.environ and third_party:
        names = names_in("RACEWAY_PLUGINS")
        missing = sorted(names - every)
        points = [p for p in points if owner(p)[0] in packages() or names & _called(p)]
    blocked = names_in("RACEWAY_DISABLE")
    labels = sorted(every)
    for name in sorted(blocked - set(labels)):
        installed = f"installed: {', '.join(labels)}" if labels else "no plug-in is installed"
        words = f"RACEWAY_DISABLE names '{name}', which nothing is called{nearest(name, labels)}; {installed}"
        warnings.warn(words, stacklevel=2)
    return [p for p in points if not blocked & _called(p)], missing


def _called(point: EntryPoint) -> set[str]:
    """Names of an entry point: its own and its distribution's."""
    return {point.name, owner(point)[0]}


def owner(point: EntryPoint) -> tuple[str, str]:
    """Name and version of an entry point's distribution; of one that was half removed, what is left of them."""
    try:
        name, version = str(point.dist.name or ""), str(point.dist.version or "")  # type: ignore[union-attr]
    except Exception:  # its METADATA is gone, or is none
        name = version = ""
    if not name:
        folder = getattr(point.dist, "_path", None)
        name = Path(str(folder)).name.partition("-")[0] if folder is not None else point.name
    return name, version


def is_foreign_fault(why: BaseException) -> bool:
    """Whether what a third party's code raised is its own: not Ctrl-C."""
    return not isinstance(why, KeyboardInterrupt)


@contextmanager
def foreign_words() -> Iterator[None]:
    """What plug-ins print while they are loaded goes to standard error: standard output may be JSON."""
    with redirect_stdout(sys.stderr):
        yield


def attempted(call: Callable[[], Any]) -> tuple[Any, str]:
    """What a third party's code returns, and in words what it raises instead; empty where it returns.  Ctrl-C passes through."""
    try:
        with foreign_words():
            return call(), ""
    except BaseException as why:  # whatever a third party's own code raises
        if not is_foreign_fault(why):
            raise
        return None, f"{type(why).__name__}: {why}"


def shown(thing: object) -> str:
    """A third party's object in words; its type where it has none."""
    return attempted(lambda: repr(thing))[0] or f"an object of type {type(thing).__name__}"


class blamed:
    """Put what a plug-in's own code raises to its name; what it prints goes to standard error.

    PluginError: Instead of anything but a ``RacewayError``, a lack of memory and the end of a generator, which pass through.

    A class, as ``contextlib.suppress`` is one: a run calls plug-ins some twenty times.  Several threads may be inside: standard output
    is itself again when the last one leaves.
    """

    _lock, _inside, _out = threading.Lock(), 0, sys.stdout

    def __init__(self, who: str, duty: str) -> None:
        self._who, self._duty = who, duty

    def __enter__(self) -> None:
        with blamed._lock:
            if not blamed._inside:
                blamed._out, sys.stdout = sys.stdout, sys.stderr
            blamed._inside += 1

    def __exit__(self, kind: type[BaseException] | None, why: BaseException | None, _: object) -> None:
        with blamed._lock:
            blamed._inside -= 1
            if not blamed._inside:
                sys.stdout = blamed._out
        if why is not None and not isinstance(why, RacewayError | MemoryError | GeneratorExit) and is_foreign_fault(why):
            raise PluginError(f"{self._who}: {self._duty} raises {type(why).__name__}: {why}") from why


def import_file(path: Path) -> tuple[Any, str]:
    """The module of a plug-in file, one for each content, and its hash; PluginError: missing, or fails to import."""
    try:
        size_of(path, _LONGEST)
        content = path.read_bytes()
    except OSError as why:
        raise PluginError(f"plug-in file `{path}`: {why.strerror or why}") from None
    except ValueError as why:
        raise PluginError(f"plug-in file `{path}` {why}") from None
    if path.suffix != ".py":
        raise PluginError(f"plug-in file `{path}`: must be a Python file (.py)")
    version = hashlib.sha256(content).hexdigest()[:12]
    name = f"raceway_file_{hashlib.sha256(str(path.resolve()).encode()).hexdigest()[:8]}_{version}"
    if name in sys.modules:
        return sys.modules[name], version
    spec = spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise PluginError(f"plug-in file `{path}`: cannot be imported")
    module = module_from_spec(spec)
    sys.modules[name] = module  # attrs looks types up in the module by its name
    try:
        with foreign_words():
            spec.loader.exec_module(module)
    except BaseException as why:  # whatever the file's own code raises
        del sys.modules[name]
        if not is_foreign_fault(why):
            raise
        line = next((f", line {f.lineno}" for f in reversed(extract_tb(why.__traceback__)) if f.filename == str(path)), "")
        raise PluginError(f"plug-in file `{path}`{line}: {type(why).__name__}: {why}") from why
    return module, version
