"""Curves of a map in processes of their own; the parent alone writes."""

from __future__ import annotations

import multiprocessing
import signal
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any

from raceway.errors import ConvergenceError
from raceway.registry import Registry, default_registry
from raceway.studies.map.design import Design
from raceway.studies.map.point import point_row

Numbered = list[tuple[int, dict[str, Any]]]


def rows_of(design: Design, points: Numbered, registry: Registry) -> Numbered:
    """Number and row of each point."""
    return [(number, point_row(design.scene(point, registry), registry)) for number, point in points]


def _begin(plugins: Sequence[Path]) -> None:
    # Ctrl-C is the parent's business: it keeps what is finished and ends the others.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for file in plugins:
        default_registry().load_file(file)


def _work(design: Design, points: Numbered) -> Numbered:
    return rows_of(design, points, default_registry())


def in_processes(design: Design, tasks: Sequence[Numbered], processes: int, plugins: Sequence[Path]) -> Iterator[Numbered]:
    """Rows of each task as it is finished."""
    context = multiprocessing.get_context("spawn")  # a fork would copy the progress bar's threads
    pool = ProcessPoolExecutor(processes, mp_context=context, initializer=_begin, initargs=(list(plugins),))
    try:
        pending = {pool.submit(_work, design, task) for task in tasks}
        while pending:
            finished, pending = wait(pending, return_when=FIRST_COMPLETED)
            for one in finished:
                yield one.result()
    except BrokenProcessPool:
        message = (
            "a process of the map ended without an answer; finished points are kept. Run it again, or with --processes 0"
        )
        raise ConvergenceError(message) from None
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
