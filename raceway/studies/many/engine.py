"""Many runs of a study: items in, rows out as they finish, kept, resumed, by any executor.

A study says what one item is and what is done with it; what is finished outlives Ctrl-C, a kill and a full disk.
"""

from __future__ import annotations

import resource
from collections.abc import Callable, Generator, Iterable, Sequence
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs

from raceway.errors import PluginError, RacewayError
from raceway.framework.contracts import Answer, Batch, Lost, Refused
from raceway.framework.registry import Registry
from raceway.storage.tables import Tables
from raceway.studies.many.row_store import RowStore
from raceway.studies.many.work import Work

if TYPE_CHECKING:
    from raceway.framework.contracts import Executor
    from raceway.pipeline.simulate import OnProgress


@attrs.frozen
class Item:
    """A piece of work.

    Attributes
    ----------
    key : of its row: a hash of all that decides it;  name : for people
    given : what the study's function takes; plain values, or what can be pickled
    """

    key: str
    name: str
    given: Any


def work_through(
    function: Callable[[Any, Registry], Tables],
    items: Sequence[Item],
    store: RowStore,
    executor: Executor,
    registry: Registry,
    plugins: Sequence[Path] = (),
    on_progress: OnProgress | None = None,
    lost: Callable[[Item, str], Tables] | None = None,
) -> tuple[list[Tables], int]:
    """Rows of all items, in their order, and how many of them were kept from before.

    Parameters
    ----------
    function : called as ``function(item.given, registry)``, here or in another process: a row, plain values
    store : of finished rows, read and added to;  executor : follows ``raceway.framework.contracts.Executor``
    plugins : one-off plug-in files, which each process loads
    on_progress : called as ``on_progress(name, done, total)`` after each item; an exception stops the study
    lost : row of an item that took its process down, which is not kept, from the item and the reason

    Raises
    ------
    RacewayError
        An item took its process down, and no row was made of that.  Whatever is raised, Ctrl-C too: what is finished is kept.
    """
    found = {place: row for place, item in enumerate(items) if (row := store.get(item.key)) is not None}
    reused = len(found)
    work = Work(function, tuple(str(file.resolve()) for file in plugins), own=registry)
    batches = ((place, [item.given]) for place, item in enumerate(items) if place not in found)
    with closing(answers(executor, work, batches)) as finished:
        for place, answer in finished:
            item = items[place]
            if isinstance(answer, Lost):
                found[place] = _lost(item, answer, lost)
            else:
                found[place] = answer[0]
                store.put(item.key, answer[0])
            if on_progress is not None:
                on_progress(item.name, len(found), len(items))
    return [found[place] for place in range(len(items))], reused


def _lost(item: Item, answer: Lost, lost: Callable[[Item, str], Tables] | None) -> Tables:
    if lost is None:
        raise RacewayError(
            f"{item.name}: {answer.reason}, perhaps for want of memory; what is finished is kept: run the command again, with "
            "--processes 1"
        )
    return lost(item, answer.reason)


def answers(executor: Executor, work: Work, batches: Iterable[Batch]) -> Generator[Answer, None, None]:
    """Number and answer of each batch as it is finished; nothing is left at work, whatever ends it.

    Raises
    ------
    PluginError
        A worker that is not fit for the work, or an executor that cannot work.
    """
    found = executor.compute(work, batches)
    try:
        for number, answer in found:
            if isinstance(answer, Refused):
                raise PluginError(f"worker {answer.worker} cannot compute these points: {answer.reason}")
            yield number, answer
    finally:
        close = getattr(found, "close", None)  # an iterator that is no generator has none
        if close is not None:
            close()


def local(registry: Registry, processes: int, **options: Any) -> Executor:
    """The executor of ``--processes``: so many at a time, with these options; 0: this process."""
    if processes == 0:
        return registry.find("executor", "serial").plugin()
    return registry.find("executor", "processes").plugin(workers=processes, **options)


def processor_time() -> float:
    """Of this process and of those that it has ended [s]."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)
