"""Executors on this machine by Python alone: in this process, and in processes of their own.

A batch that hangs or kills its process costs that batch only.
"""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterable, Iterator
from contextlib import suppress
from typing import TYPE_CHECKING, Any, ClassVar

import attrs

from raceway.errors import PluginError
from raceway.framework.contracts import Answer, Lost, Work
from raceway.framework.options import between, option
from raceway.framework.orphans import deaf_to_terminals, end_with, start_tracker

if TYPE_CHECKING:
    from multiprocessing.connection import Connection

    from raceway.framework.contracts import Batch


@attrs.frozen
class Serial:
    """One point after the other, in this process: no start-up, and the debugger's choice."""

    name: ClassVar[str] = "serial"

    def compute(self, work: Work, batches: Iterable[Batch]) -> Iterator[Answer]:
        for number, points in batches:
            yield number, work(points)


#: What a process may take to import the program, beyond the patience with its first batch [s].
_START_S = 120.0


@attrs.frozen
class Processes:
    """Processes on this machine, without further packages; one that dies is replaced, one that hangs is ended."""

    name: ClassVar[str] = "processes"

    workers: int = option(2, help="processes that work at a time", rule=between(1, 1024))
    patience: float = option(1e7, unit="s", help="a batch that takes longer hangs: it is given up", rule=between(0.1, 1e9))

    def compute(self, work: Work, batches: Iterable[Batch]) -> Iterator[Answer]:
        waiting, again, tried = iter(batches), list[Any](), set[int]()
        crew: list[_Worker] = []

        from multiprocessing.connection import wait

        def following() -> Batch | None:
            return again.pop() if again else next(waiting, None)

        batch = following()
        try:
            while batch is not None or any(worker.batch for worker in crew):
                while batch is not None:
                    free = next((worker for worker in crew if worker.batch is None), None)
                    if free is None:
                        if len(crew) == self.workers:
                            break
                        crew.append(free := _Worker(work))
                    free.give(batch)
                    batch = following()
                arrived = wait([worker.pipe for worker in crew if worker.batch], timeout=1.0)
                for worker in [worker for worker in crew if worker.batch]:
                    sent, answer = worker.batch, worker.answer(worker.pipe in arrived, self.patience)
                    if answer is None or sent is None:
                        continue
                    if isinstance(answer, Lost):
                        worker.end()
                        crew.remove(worker)
                        if worker.died and sent[0] not in tried:
                            tried.add(sent[0])
                            again.append(sent)
                            continue
                    yield sent[0], answer
                batch = batch or following()
        finally:
            for worker in crew:
                worker.end()


class _Worker:
    """One process and the batch that it works at."""

    def __init__(self, work: Work) -> None:
        import multiprocessing

        context = multiprocessing.get_context("spawn")  # a fork would copy the progress bar's threads
        self.pipe, child = context.Pipe()
        self.process = context.Process(target=_serve, args=(child, work, os.getpid()), daemon=True)
        with deaf_to_terminals():
            start_tracker()
            self.process.start()
        child.close()
        self.batch: Batch | None = None
        self.begun, self.ready, self.died = 0.0, False, False

    def give(self, batch: Batch) -> None:
        self.batch, self.begun = batch, time.monotonic() + (0.0 if self.ready else _START_S)
        with suppress(OSError):  # it is dead, which is seen when its answer is waited for
            self.pipe.send(batch[1])

    def answer(self, arrived: bool, patience: float) -> object:
        """What it has to say of its batch, which it is then done with; None where nothing yet."""
        if not arrived:
            return Lost(f"no answer within {patience:g} s: it hangs") if time.monotonic() - self.begun > patience else None
        try:
            message = self.pipe.recv()
        except (EOFError, OSError):
            self.process.join()
            if not self.ready:
                raise PluginError(
                    f"processes do not start here: the first ended at once (exit code {self.process.exitcode})"
                ) from None
            self.died = True
            return Lost(f"its process died (exit code {self.process.exitcode})")
        if message is None:  # the program is imported: the time of its batch begins here
            self.begun, self.ready = time.monotonic(), True
            return None
        self.batch = None
        fine, answer = message
        if not fine:
            raise answer
        return answer

    def end(self) -> None:
        self.process.kill()
        self.process.join()
        self.pipe.close()


def _serve(pipe: Connection, work: Work, parent: int) -> None:
    """What a process does: answer batches until it is ended."""
    end_with(parent)
    os.environ.setdefault("OMP_NUM_THREADS", "1")  # the cores are the processes' already
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's business
    pipe.send(None)
    with suppress(EOFError, OSError):  # the parent is gone
        while True:
            points = pipe.recv()
            try:
                answer = True, work(points)
            except Exception as why:
                answer = False, why
            pipe.send(answer)
