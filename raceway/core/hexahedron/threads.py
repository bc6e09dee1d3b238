"""Threads that share the work on a mesh; kernels let each other run, so plain Python threads do."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

from raceway.core.hexahedron.ranges import share

#: Work on one thing, by its number.
Job = Callable[[int], None]


class ThreadPool:
    """Threads that share numbered jobs; one thread is the caller itself."""

    def __init__(self, threads: int) -> None:
        self._threads = threads
        self._pool = ThreadPoolExecutor(threads) if threads > 1 else None

    def __enter__(self) -> ThreadPool:
        return self

    def __exit__(self, *_: object) -> None:
        if self._pool:
            self._pool.shutdown()

    def do(self, count: int, job: Job) -> None:
        """Jobs 0 to count - 1; returns when all are done."""
        if self._pool is None:
            for i in range(count):
                job(i)
        else:
            list(self._pool.map(job, range(count)))

    def do_shares(self, count: int, job: Callable[[int, int], None]) -> None:
        """``job(first, last)`` on equal shares of ``count`` things."""
        shares = share(count, self._threads)
        self.do(len(shares), lambda i: job(*shares[i]))
