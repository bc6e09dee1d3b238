"""Cases in processes of their own: in parallel, and none of them can stop the others by hanging or dying."""

from __future__ import annotations

import multiprocessing
import time
import traceback
from collections.abc import Iterator, Sequence
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any

from raceway.framework.registry import Registry, default_registry
from raceway.studies.stability.case import Case, Row, lost, short

#: A case that takes longer has hung [s].  The longest takes 20 s, and compiling for the first time on busy cores some minutes.
PATIENCE_S = 900.0
#: What a process may take to import the program beyond that [s].
_START_S = 120.0


def rows_of(case: Case, registry: Registry) -> list[Row]:
    """The rows of a case; whatever its code raises becomes a failed row."""
    from importlib import import_module

    module, _, function = case.measure.partition(":")
    try:
        place = module if "." in module else f"raceway.studies.stability.{module}"
        rows: list[Row] = getattr(import_module(place), function)(case, registry)
    except Exception as why:  # a traceback is what no case may end in: it is the finding
        last = traceback.extract_tb(why.__traceback__)[-1]
        return [lost(case, f"{type(why).__name__} in {Path(last.filename).name}, line {last.lineno}: {short(why)}")]
    return rows


def _serve(pipe: Connection, plugins: Sequence[Path]) -> None:
    """What a process does: answer cases until it gets None."""
    registry = default_registry()
    for file in plugins:
        registry.load_file(file)
    try:
        pipe.send(None)  # ready: the time of a case begins here
        while (case := pipe.recv()) is not None:
            pipe.send(rows_of(case, registry))
    except (EOFError, KeyboardInterrupt):
        return  # the parent is gone, or ends by itself and says so


class _Worker:
    """One process and the case that it works at."""

    def __init__(self, plugins: Sequence[Path]) -> None:
        context: Any = multiprocessing.get_context("spawn")  # a fork would copy the progress bar's threads
        self.pipe, child = context.Pipe()
        self.process = context.Process(target=_serve, args=(child, list(plugins)), daemon=True)
        self.process.start()
        child.close()
        self.case: Case | None = None
        self.begun, self.ready = 0.0, False

    def give(self, case: Case) -> None:
        self.case, self.begun = case, time.monotonic() + (0.0 if self.ready else _START_S)
        self.pipe.send(case)

    def end(self) -> None:
        self.process.terminate()
        self.process.join()
        self.pipe.close()


def in_parallel(
    cases: Sequence[Case], processes: int, plugins: Sequence[Path], patience: float = PATIENCE_S
) -> Iterator[tuple[Case, list[Row]]]:
    """Cases with their rows, as they are finished; the heaviest are begun first.

    A process that dies, or works longer than ``patience`` [s] at a case, costs that case only.
    """
    waiting = sorted(cases, key=lambda case: case.weight)
    workers: list[_Worker] = []
    try:
        while waiting or any(worker.case for worker in workers):
            workers = [worker for worker in workers if worker.process.is_alive() or worker.case]
            while waiting and len(workers) < processes:
                workers.append(_Worker(plugins))
            for worker in workers:
                if worker.case is None and waiting:
                    worker.give(waiting.pop())
            ready = set(wait([w.pipe for w in workers if w.case], timeout=1.0))
            for worker in [w for w in workers if w.case]:
                case, seconds = worker.case, max(time.monotonic() - worker.begun, 0.0)
                assert case is not None
                rows: list[Row] | None = None
                if worker.pipe in ready:
                    try:
                        rows = worker.pipe.recv()
                        if rows is None:
                            worker.begun, worker.ready = time.monotonic(), True
                    except EOFError:
                        worker.process.join()
                        rows = [lost(case, f"its process died (exit code {worker.process.exitcode})")]
                elif seconds > patience:
                    rows = [lost(case, f"no answer within {patience:g} s: it hangs")]
                if rows is None:
                    continue
                worker.case = None
                if worker.pipe not in ready or not worker.process.is_alive():
                    worker.end()
                    workers.remove(worker)
                yield case, rows
    finally:
        for worker in workers:
            worker.end()
