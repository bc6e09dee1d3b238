"""Many runs of a study: items in, rows out as they finish, kept, resumed, by any executor; their time and memory.

A study says what one item is and what is done with it; what is finished outlives Ctrl-C, a kill and a full disk.
"""

from __future__ import annotations

import json
import os
import platform
import threading
from collections.abc import Callable, Generator, Iterable, Sequence
from contextlib import closing
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs

from raceway import __version__
from raceway.errors import PluginError, RacewayError
from raceway.framework.contracts import Answer, Batch, Lost, Refused
from raceway.framework.loading.registry import Registry
from raceway.points.store import Row, Store, program_key
from raceway.scene.scene import Scene
from raceway.storage.tables import ReadTables, Tables

if TYPE_CHECKING:
    from raceway.framework.contracts import Executor
    from raceway.pipeline.content import ErrorTable
    from raceway.pipeline.simulate import OnProgress


def plugins_of(scene: Scene) -> list[tuple[str, str]]:
    """(kind, name) of every plug-in that a scene uses."""
    plugins = [("contact_law", scene.contact.kind), ("integrator", scene.integrator.kind)]
    plugins.append(("identifier", scene.identifier.kind))
    plugins += [("excitation", scene.excitation.name)] if scene.excitation is not None else []
    return plugins + ([("mesher", scene.mesh.name)] if scene.mesh is not None else [])


def identity(registry: Registry, used: Iterable[tuple[str, str]]) -> Tables:
    """Versions, hash of all sources, and those of the used (kind, name) that this process has, as plain values."""
    present = sorted(pair for pair in used if len(registry.entries.get(pair, [])) == 1)
    entries = [registry.find(*pair) for pair in present]
    return {
        "raceway": __version__,
        "python": platform.python_version(),
        **{name: version(name) for name in ("numpy", "numba", "scipy")},
        "program": program_key(registry, present),
        "plugins": {f"{e.kind}:{e.name}": f"{e.distribution} {e.version}" for e in entries},
    }


def differences(required: ReadTables, present: ReadTables) -> list[str]:
    """In words what is present instead of what is required; empty where nothing differs."""
    words = []
    for text, owner in required["plugins"].items():
        kind, _, name = text.partition(":")
        plugin, has = f"{kind.replace('_', ' ')} '{name}'", present["plugins"].get(text)
        if has is None:
            words.append(f"{plugin} of {owner} is missing")
        elif has != owner:
            words.append(f"{plugin} is of {has} instead of {owner}")
    for name in ("raceway", "python", "numpy", "numba", "scipy"):
        if required[name] != present[name]:
            words.append(f"{name} {present[name]} instead of {required[name]}")
    if not words and required["program"] != present["program"]:
        words.append("the sources of raceway or of a plug-in differ at the same version")
    return words


#: One at a time in a process: kernels may be compiling, and a run's cost is the process's.
_ONE = threading.Lock()
_OWN: dict[tuple[str, ...], Registry] = {}
_FAULTS: dict[tuple[str, ...], str | None] = {}


@attrs.frozen
class Work:
    """Callable on a list of what ``function`` takes; answers with a list of what it gives, or ``Refused``."""

    function: Callable[[Any, Registry], Tables | Row]  # called as ``function(task, registry)``
    plugins: tuple[str, ...] = ()  # one-off plug-in files, which each process loads
    required: Tables | None = None  # identity that a process must have; None where all are of this machine
    registry: Registry | None = None  # in the process that the work was made in; others have one of their own

    def __reduce__(self) -> tuple[object, ...]:
        return Work, (self.function, self.plugins, self.required)

    def fault(self) -> str | None:
        """Why this process is not fit for the work; None where it is."""
        if self.required is None:
            return None
        mark = (json.dumps(self.required, sort_keys=True), *self.plugins)
        if mark not in _FAULTS:
            try:
                plugins = [(kind, name) for kind, _, name in (text.partition(":") for text in self.required["plugins"])]
                present = identity(registry_of(self.plugins), plugins)
                _FAULTS[mark] = "; ".join(differences(self.required, present)) or None
            except PluginError as why:
                _FAULTS[mark] = str(why)
        return _FAULTS[mark]

    def __call__(self, tasks: list[object]) -> list[Tables | Row] | Refused:
        with _ONE:
            fault = self.fault()
            if fault is not None:
                return Refused(worker(), fault)
            registry = self.registry or registry_of(self.plugins)
            return [self.function(task, registry) for task in tasks]


def registry_of(files: tuple[str, ...]) -> Registry:
    """The plug-ins of this process and of one-off files, loaded once."""
    if files not in _OWN:
        registry = Registry()
        for file in files:
            registry.load_file(Path(file))
        _OWN[files] = registry
    return _OWN[files]


@cache
def worker() -> str:
    """Name of this process."""
    return f"{platform.node()}:{os.getpid()}"


@attrs.frozen
class Item:
    """A piece of work.

    key : of its row: a hash of all that decides it;  name : for people
    task : what the study's function takes; plain values, or what can be pickled
    """

    key: str
    name: str
    task: Any


def work_through(
    function: Callable[[Any, Registry], Tables],
    items: Sequence[Item],
    store: Store,
    executor: Executor,
    registry: Registry,
    plugins: Sequence[Path] = (),
    on_progress: OnProgress | None = None,
    lost: Callable[[Item, str], Tables] | None = None,
) -> tuple[list[Tables], int]:
    """Rows of all items, in their order, and how many of them were stored before.

    function : called as ``function(item.task, registry)``, here or in another process: a row, plain values
    store : of finished rows, read and added to;  executor : follows ``raceway.framework.contracts.Executor``
    plugins : one-off plug-in files, which each process loads
    on_progress : called as ``on_progress(name, done, total)`` after each item; an exception stops the study
    lost : row of an item that took its process down, which is not stored, from the item and the reason

    RacewayError: An item took its process down, and no row was made of that.  Whatever is raised, Ctrl-C too: finished points are stored.
    """
    records = [store.get(item.key) for item in items]
    rows = {index: row.content for index, row in enumerate(records) if row.state != "waiting"}
    old = len(rows)
    work = Work(function, tuple(str(file.resolve()) for file in plugins), registry=registry)
    batches = ((index, [item.task]) for index, item in enumerate(items) if index not in rows)
    with closing(answers(executor, work, batches)) as results:
        for index, answer in results:
            item = items[index]
            if isinstance(answer, Lost):
                if lost is None:
                    reason = f"{answer.reason}, perhaps out of memory: run the command again, with --processes 1"
                    raise RacewayError(f"{item.name}: {reason}")
                rows[index] = lost(item, answer.reason)
            else:
                rows[index] = answer[0]
                # Store a row; on a disk that takes no more the study goes on without, and says so at its end.
                row = Row(item.key, "done", "", answer[0], {})
                if store.fault is None:
                    try:
                        store.put([row])
                    except RacewayError as why:
                        store.fault = why
            if on_progress is not None:
                on_progress(item.name, len(rows), len(items))
    return [rows[index] for index in range(len(items))], old


def answers(executor: Executor, work: Work, batches: Iterable[Batch]) -> Generator[Answer, None, None]:
    """Number and answer of each batch as it is finished; nothing is left at work, whatever ends it.

    PluginError: A worker that is not fit for the work, or an executor that cannot work.
    """
    batch_answers = executor.compute(work, batches)
    try:
        for number, answer in batch_answers:
            if isinstance(answer, Refused):
                raise PluginError(f"worker {answer.worker} cannot compute these points: {answer.reason}")
            yield number, answer
    finally:
        close = getattr(batch_answers, "close", None)  # an iterator that is no generator has none
        if close is not None:
            close()


def local(registry: Registry, processes: int, **options: object) -> Executor:
    """The executor of ``--processes``: so many at a time, with these options; 0: this process."""
    if processes == 0:
        return registry.find("executor", "serial").plugin()
    return registry.find("executor", "processes").plugin(workers=processes, **options)


def without_mesh(error: ErrorTable) -> float | None:
    """The run's own estimate, less its bodies': rows on one mesh are compared with a reference on the same."""
    return None if error["total"] is None else max(error["total"] - (error["bodies"] or 0.0), 0.0)
