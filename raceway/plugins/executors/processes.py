"""Executors on this machine: in this process, and in processes by joblib's loky.

A batch that hangs or kills its process costs that batch only: each process is a pool of its own.
"""

import math
import os
import time
from collections.abc import Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, wait
from typing import ClassVar

import attrs

from raceway.errors import PluginError
from raceway.framework.contracts import Answer, Batch, Lost, Work
from raceway.framework.options import between, option
from raceway.framework.orphans import deaf_to_terminals, end_with, start_tracker


@attrs.frozen
class Serial:
    """One point after the other, in this process: no start-up, and the debugger's choice."""

    name: ClassVar[str] = "serial"

    def compute(self, work: Work, batches: Iterable[Batch]) -> Iterator[Answer]:
        yield from ((number, work(points)) for number, points in batches)


#: What a process may take to import the program, beyond the patience with its first batch [s].
_START_S = 120.0
#: Numbers of threads of libraries, 1 where the user says nothing: the cores are the processes' already.
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


@attrs.frozen
class Processes:
    """Processes on this machine, each with one thread; one that dies is replaced, one that hangs is ended."""

    name: ClassVar[str] = "processes"

    workers: int = option(2, help="parallel processes", rule=between(1, 1024))
    patience: float = option(
        1e7, unit="s", help="a batch that takes longer is taken as hung and stopped", rule=between(0.1, 1e9)
    )

    def compute(self, work: Work, batches: Iterable[Batch]) -> Iterator[Answer]:
        waiting, tried = iter(batches), set[int]()
        again: list[Batch] = []
        idle: list[_Worker] = []
        busy: dict[Future[object], tuple[_Worker, Batch]] = {}

        def following() -> Batch | None:
            return again.pop() if again else next(waiting, None)

        batch = following()
        try:
            while batch is not None or busy:
                while batch is not None and len(busy) < self.workers:
                    worker = idle.pop() if idle else _Worker(work)
                    busy[worker.begin(work, batch)] = worker, batch
                    batch = following()
                done, _ = wait(busy, timeout=1.0, return_when=FIRST_COMPLETED)
                late = {future for future, (worker, _) in busy.items() if time.monotonic() - worker.begun > self.patience}
                for future in done | late:
                    worker, sent = busy.pop(future)
                    idle.append(worker)
                    answer = worker.answer(future, self.patience)
                    if isinstance(answer, Lost):
                        idle.remove(worker)
                        worker.end()
                        if worker.died and sent[0] not in tried:
                            tried.add(sent[0])
                            again.append(sent)
                            continue
                    yield sent[0], answer
                batch = batch or following()
        finally:
            for worker in [*idle, *(worker for worker, _ in busy.values())]:
                worker.end()


class _Worker:
    """One process, the only one of its pool."""

    def __init__(self, work: Work) -> None:
        from joblib.externals.loky import ProcessPoolExecutor
        from joblib.externals.loky.backend.resource_tracker import ensure_running

        environment = {name: os.environ.get(name, "1") for name in _THREADS}
        with deaf_to_terminals():
            ensure_running()  # it clears up behind the workers, and must outlive them
        with deaf_to_terminals():
            start_tracker()
            self.pool = ProcessPoolExecutor(1, initializer=_begin, initargs=(os.getpid(),), env=environment)
            self.ready = self.pool.submit(type, work)  # imports the program
        self.begun, self.died = time.monotonic() + _START_S, False
        self.ready.add_done_callback(self._start)

    def _start(self, *_: object) -> None:
        """The time of its batch begins."""
        self.begun = time.monotonic()

    def begin(self, work: Work, batch: Batch) -> Future[object]:
        from joblib.externals.loky.process_executor import BrokenProcessPool

        if self.ready.done():
            self._start()
        try:
            return self.pool.submit(work, batch[1])
        except BrokenProcessPool as why:  # it died while it had nothing to do
            future = Future[object]()
            future.set_exception(why)
            return future

    def answer(self, future: Future[object], patience: float) -> object:
        from joblib.externals.loky.process_executor import BrokenProcessPool

        if not future.done():
            return Lost(f"no answer within {patience:g} s: it hangs")
        try:
            return future.result()
        except BrokenProcessPool as why:
            if self.ready.exception() is not None:
                raise PluginError(f"processes cannot be started: {why}") from None
            self.died = True
            return Lost(f"its process died ({str(why).partition('{')[2].partition('}')[0]})")

    def end(self) -> None:
        self.pool.shutdown(kill_workers=True)


def _begin(parent: int) -> None:
    """In a process, before its first batch."""
    from joblib.externals.loky import process_executor

    # Otherwise loky replaces, with a warning, a process that grows by 300 MB, as elastic bodies make it.
    process_executor._MAX_MEMORY_LEAK_SIZE = math.inf
    end_with(parent)
