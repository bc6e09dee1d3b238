"""Tasks of a study in processes of their own; the parent alone writes."""

from __future__ import annotations

import multiprocessing
import os
import resource
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import TypeVar

from raceway.framework.orphans import end_with
from raceway.framework.registry import Registry, default_registry

Task = TypeVar("Task")
Result = TypeVar("Result")


def in_processes(
    function: Callable[[Task, Registry], Result], tasks: Sequence[Task], processes: int, plugins: Sequence[Path]
) -> Iterator[tuple[int, Result]]:
    """Place and result of each task, as they end.

    Parameters
    ----------
    function : called as ``function(task, registry)`` with the process's own registry; it, tasks and results can be pickled
    processes : how many work at a time, at least 1
    plugins : one-off plug-in files, which each process loads

    Raises
    ------
    BrokenProcessPool
        A process ended without an answer.
    KeyboardInterrupt
        Tasks at work are finished, and the others are dropped.
    """
    if not tasks:
        return
    context = multiprocessing.get_context("spawn")  # a fork would copy the progress bar's threads
    pool = ProcessPoolExecutor(min(processes, len(tasks)), context, _begin, (list(plugins), os.getpid()))
    try:
        places = {pool.submit(_do, function, task): place for place, task in enumerate(tasks)}
        for done in as_completed(places):
            yield places[done], done.result()
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _begin(plugins: Sequence[Path], parent: int) -> None:
    end_with(parent)
    # Ctrl-C is the parent's business: it keeps what is finished and drops what has not begun.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for file in plugins:
        default_registry().load_file(file)


def _do(function: Callable[[Task, Registry], Result], task: Task) -> Result:
    return function(task, default_registry())


def processor_time() -> float:
    """Of this process and of those that it has ended [s]."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)
