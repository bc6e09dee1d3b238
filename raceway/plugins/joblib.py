"""Processes on this machine, by joblib."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, ClassVar

import attrs

from raceway.errors import PluginError, extra
from raceway.framework.contracts import Answer, Lost, Work
from raceway.framework.options import between, option
from raceway.framework.orphans import deaf_to_terminals, end_with, start_tracker

if TYPE_CHECKING:
    from raceway.framework.contracts import Batch


@attrs.frozen
class Joblib:
    """Processes on this machine, each with one thread; one that dies is replaced.

    Notes
    -----
    A process that dies takes joblib's whole pool with it.  What was in flight is then computed again, a batch at a time, so
    that the one to blame is known.
    """

    name: ClassVar[str] = "joblib"

    workers: int = option(2, help="processes that work at a time", rule=between(1, 1024))

    def compute(self, work: Work, batches: Iterable[Batch]) -> Iterator[Answer]:
        try:
            from joblib.externals.loky import get_reusable_executor
            from joblib.externals.loky.backend.resource_tracker import ensure_running
            from joblib.externals.loky.process_executor import TerminatedWorkerError
        except ImportError as why:
            raise PluginError(f"executor 'joblib' needs joblib: {extra('sweep')} ({why})") from None
        with deaf_to_terminals():  # the process that clears up behind the workers must outlive them
            ensure_running()
        waiting, flying = iter(batches), dict[int, list[object]]()

        def taken() -> Iterator[Batch]:
            for number, points in waiting:
                flying[number] = points
                yield number, points

        try:
            while True:
                try:
                    for number, answer in self._pool(work, taken()):
                        del flying[number]
                        yield number, answer
                    return
                except TerminatedWorkerError:
                    for number, points in list(flying.items()):
                        try:
                            yield from self._pool(work, [(number, points)])
                        except TerminatedWorkerError as why:
                            yield number, Lost(f"its worker died: {str(why).splitlines()[0]}")
                    flying.clear()
        finally:
            get_reusable_executor().shutdown(wait=True, kill_workers=True)

    def _pool(self, work: Work, batches: Iterable[Batch]) -> Iterator[Answer]:
        from joblib import Parallel, delayed, parallel_config

        calls = (delayed(_answer)(work, number, points) for number, points in batches)
        # One worker too is a process of its own: joblib would take this one.
        workers = max(self.workers, 2)
        before = workers * 2 if self.workers > 1 else 1
        begin = {"initializer": end_with, "initargs": (os.getpid(),)}
        with parallel_config(backend="loky", inner_max_num_threads=1, **begin):
            pool = Parallel(n_jobs=workers, return_as="generator_unordered", batch_size=1, pre_dispatch=before)
            with deaf_to_terminals():  # it starts the workers
                start_tracker()
                answers = pool(calls)
            try:
                yield from answers
            finally:
                with warnings.catch_warnings():
                    warnings.filterwarnings("ignore", message=".*tasks which were still being processed")
                    answers.close()


def _answer(work: Work, number: int, points: list[object]) -> Answer:
    return number, work(points)
