"""Executors of many points: in this process, in processes of this machine by joblib's loky, workers of a dask.distributed scheduler.

A batch that hangs or kills its process costs that batch only: each process is a pool of its own.  Workers end
with the process that they work for, when it is killed, and by its word alone, when it is asked to end.
"""

from __future__ import annotations

import asyncio
import math
import os
import signal
import threading
import time
import warnings
from collections.abc import Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager, suppress
from operator import methodcaller
from typing import TYPE_CHECKING, ClassVar

import attrs

from raceway.errors import PluginError, extra
from raceway.framework.contracts import Answer, Batch, Lost, Refused, Work
from raceway.framework.options import between, inside, option, optional

if TYPE_CHECKING:
    from distributed import Client
    from distributed import Future as DaskFuture

#: Name of the thread that looks, and how often it does [s].
WATCH, _WATCH_S = "end with parent", 1.0


def end_with(parent: int) -> None:
    """In a worker: end when the process of this number is no longer its parent.

    Called when the worker begins, before it has anything to do: pools keep workers that wait, some for minutes.
    """

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(_WATCH_S)
        os._exit(1)

    threading.Thread(target=watch, name=WATCH, daemon=True).start()


@contextmanager
def deaf_to_terminals() -> Iterator[None]:
    """Threads and processes that are started meanwhile do not hear Ctrl-C and SIGHUP, which a terminal sends to all.

    They inherit what is blocked.  What arrives here meanwhile is delivered afterwards.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGHUP})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def start_tracker() -> None:
    """Start what clears up behind processes of Python, before the first of them.

    Python starts it with the first process and lets that thread hear Ctrl-C again afterwards, and so the process, too.
    """
    from multiprocessing import resource_tracker

    blocked = signal.pthread_sigmask(signal.SIG_BLOCK, ())
    resource_tracker.ensure_running()
    signal.pthread_sigmask(signal.SIG_SETMASK, blocked)


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
    from joblib.externals.loky import process_executor

    # Otherwise loky replaces, with a warning, a process that grows by 300 MB, as elastic bodies make it.
    process_executor._MAX_MEMORY_LEAK_SIZE = math.inf
    end_with(parent)


#: How often the list of workers is looked at [s].
_LOOK_S = 2.0
#: How often a batch that is refused is given to another worker.
_REFUSALS = 3
_TEXT = optional(lambda _instance, _attribute, _value: None)


@attrs.frozen
class Dask:
    """Workers of dask.distributed: of a scheduler that runs already, else of a cluster on this machine.

    Workers may come and go.  Each is asked first whether it has the same program and plug-ins; one that has not gets no
    points, and a warning names it.  Dask itself gives the batch of a dead worker to another one.
    """

    name: ClassVar[str] = "dask"

    workers: int = option(2, help="processes of the cluster on this machine, without a scheduler", rule=between(1, 1024))
    scheduler: str | None = option(None, help="address of a running scheduler, for instance tcp://10.0.0.1:8786", rule=_TEXT)
    patience: float = option(
        20.0, unit="s", help="timeout for the scheduler's answer, and without any worker", rule=inside(0.0, 86400.0)
    )

    @classmethod
    def examples(cls) -> list[Dask]:
        """Instances for the conformance suite."""
        return [cls(workers=1)]

    def compute(self, work: Work, batches: Iterable[Batch]) -> Iterator[Answer]:
        with self._client() as client:
            flight = _Flight(client, work, self.patience)
            yield from flight.answers(iter(batches))

    @contextmanager
    def _client(self) -> Iterator[Client]:
        try:
            from distributed import Client, LocalCluster
        except ImportError as why:
            raise PluginError(f"executor 'dask' needs dask.distributed: {extra('sweep')} ({why})") from None
        if self.scheduler is None:
            # None would be a fixed port, with a warning where another cluster has it.
            options = {"processes": True, "threads_per_worker": 1, "dashboard_address": "127.0.0.1:0", "silence_logs": 50}
            with deaf_to_terminals():
                start_tracker()
                local = LocalCluster(n_workers=self.workers, **options)
            with local as cluster, Client(cluster) as client:
                yield client
            return
        try:
            _greet(self.scheduler, self.patience)
            client = Client(self.scheduler, timeout=self.patience)
        except (OSError, ValueError, TypeError) as why:
            reason = f"within {self.patience:g} s: {str(why) or type(why).__name__}"
            remedy = "Start one with `dask scheduler`, or correct --scheduler."
            raise PluginError(f"no dask scheduler answers at `{self.scheduler}` {reason}. {remedy}") from None
        with client:
            yield client


class _Flight:
    """What is computed at the moment, and who is fit for it."""

    def __init__(self, client: Client, work: Work, patience: float) -> None:
        self.client, self.work, self.patience = client, work, patience
        self.unfit: dict[str, str] = {}
        self.fit: set[str] = set()
        #: future -> its batch, and the workers that it is bound to (none: any)
        self.flying: dict[DaskFuture, tuple[Batch, frozenset[str]]] = {}
        self.refusals: dict[int, int] = {}
        self.looked, self.alone_since = -_LOOK_S, time.monotonic()

    def answers(self, batches: Iterator[Batch]) -> Iterator[Answer]:
        from distributed import wait

        try:
            self.client.wait_for_workers(1, timeout=self.patience)
        except TimeoutError:
            message = f"the dask scheduler has had no worker for {self.patience:g} s: start some with `dask worker`"
            raise PluginError(message) from None
        self._look()
        if not self.fit:
            reasons = "; ".join(f"{worker}: {why}" for worker, why in self.unfit.items())
            raise PluginError(f"no dask worker can compute these points: {reasons}")
        try:
            self._fill(batches)
            while self.flying:
                with suppress(TimeoutError):
                    wait(list(self.flying), timeout=_LOOK_S, return_when="FIRST_COMPLETED")
                for future in [f for f in self.flying if f.done()]:
                    batch, _ = self.flying.pop(future)
                    answer = _outcome(future)
                    if isinstance(answer, Refused) and self._try_others(batch):
                        continue
                    yield batch[0], answer
                self._look()
                self._fill(batches)
        finally:
            self.client.cancel(list(self.flying), force=True)

    def _try_others(self, batch: Batch) -> bool:
        """Give a batch that a worker refused, for one that came after the last look, to those that are fit."""
        self.refusals[batch[0]] = self.refusals.get(batch[0], 0) + 1
        if self.refusals[batch[0]] > _REFUSALS:
            return False
        self.fit.clear()
        self.looked = -_LOOK_S
        self._look()
        if self.fit:
            self._submit(batch)
        return bool(self.fit)

    def _look(self) -> None:
        now = time.monotonic()
        if now - self.looked < _LOOK_S:
            return
        self.looked = now
        living = set(self.client.nthreads())
        self.fit &= living
        new = living - self.fit - set(self.unfit)
        if new:
            for worker, fault in self.client.run(
                methodcaller("fault"), self.work, workers=sorted(new), on_error="return"
            ).items():
                if fault is None:
                    self.fit.add(worker)
                    continue
                self.unfit[worker] = fault if isinstance(fault, str) else f"{type(fault).__name__}: {fault}"
                warnings.warn(f"dask worker {worker} gets no points: {self.unfit[worker]}", stacklevel=2)
        for future, (batch, bound) in list(self.flying.items()):
            # Its workers are gone for good: a nanny's next one has another address.
            if bound and self.fit and not bound & living:
                self.client.cancel([future], force=True)
                del self.flying[future]
                self._submit(batch)
        if self.fit:
            self.alone_since = now
        elif now - self.alone_since > self.patience:
            raise PluginError(
                f"the dask scheduler has had no suitable worker for {self.patience:g} s; start one, and go on with --resume"
            )

    def _fill(self, batches: Iterator[Batch]) -> None:
        threads = self.client.nthreads()
        while len(self.flying) < 2 * max(sum(threads.get(worker, 0) for worker in self.fit), 1):
            batch = next(batches, None)
            if batch is None:
                return
            self._submit(batch)

    def _submit(self, batch: Batch) -> None:
        bound = frozenset(self.fit) if self.unfit else frozenset()
        workers, key = sorted(bound) or None, f"sweep-{batch[0]}-{time.time_ns()}"
        future = self.client.submit(self.work, batch[1], pure=False, workers=workers, key=key)
        self.flying[future] = batch, bound


def _greet(address: str, patience: float) -> None:
    """Connect once and leave: a client gives up where nobody listens, but waits for ever for one who says nothing.

    OSError, ValueError: as a client does.
    """
    from distributed.comm.core import connect

    async def meet() -> None:
        comm = await asyncio.wait_for(connect(address, timeout=patience), patience)
        await comm.close()

    # In a thread of its own: the caller may have a loop that runs, a notebook has.
    with ThreadPoolExecutor(1) as thread:
        thread.submit(asyncio.run, meet()).result()


def _outcome(future: DaskFuture) -> object:
    from distributed import KilledWorker

    try:
        return future.result()
    except KilledWorker as why:
        return Lost(f"its workers died: {why}")
