"""What shares the processor's cores: threads with numbered jobs, and a second process that compiles kernels beside the first.

Kernels let each other run (``jit(releases=True)``), so plain Python threads do.  Of the second process the first run of a clone waits half
as long.
"""

import atexit
import multiprocessing
import os
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait
from functools import cache
from itertools import pairwise
from typing import TypeVar

T = TypeVar("T")
#: Work on one thing, by its number.
Job = Callable[[int], None]
#: Variables of the environment that bound the threads of a program, as numba and OpenMP read them.
BOUNDS = ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS")


def usable_cores() -> int:
    """Cores that this process may use: those that the system gives it, at most what the variables ``BOUNDS`` say."""
    count = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    for name in BOUNDS:
        limit = os.environ.get(name, "").split(",")[0].strip()  # OpenMP takes a list, a number for each level
        if limit.isdigit() and int(limit) > 0:
            count = min(count, int(limit))
    return count


class ThreadPool:
    """Threads that share numbered jobs while the pool is open; the caller is one of them, and works alone before and after.

    count : threads, the caller's included

    ``with pool:`` opens it, again inside too; the threads end where the outermost one ends, also by an exception.  Jobs are
    begun in their order by whoever is free: put long ones first.
    """

    def __init__(self, count: int) -> None:
        self.count = count
        self._pool: ThreadPoolExecutor | None = None
        self._entered = 0

    def __enter__(self) -> "ThreadPool":
        if not self._entered and self.count > 1:
            self._pool = ThreadPoolExecutor(self.count - 1, thread_name_prefix="raceway")
        self._entered += 1
        return self

    def __exit__(self, *_: object) -> None:
        self._entered -= 1
        if not self._entered and self._pool is not None:
            pool, self._pool = self._pool, None
            pool.shutdown()

    def do(self, count: int, job: Job) -> None:
        """Jobs 0 to count - 1; returns when all are done.

        Raises What a job raised; none is running any more, and none that had not begun was begun..
        """
        queue = iter(range(count))

        def work() -> None:
            try:
                for number in queue:  # Python hands each number to one thread
                    job(number)
            except BaseException:
                for _ in queue:
                    pass
                raise

        if self._pool is None:
            work()
            return
        helpers = [self._pool.submit(work) for _ in range(min(self.count, count) - 1)]
        try:
            work()
        finally:
            wait(helpers)
        for helper in helpers:
            helper.result()

    def do_shares(self, count: int, job: Callable[[int, int], T]) -> list[T]:
        """What ``job(first, last)`` returns on equal shares of ``count`` things."""
        threads = self.count if self._pool is not None else 1
        shares = list(pairwise(count * k // threads for k in range(threads + 1)))
        # Every place is filled before the list is handed out.
        results: list[T] = [None] * len(shares)  # type: ignore[list-item]

        def share_job(number: int) -> None:
            results[number] = job(*shares[number])

        self.do(len(shares), share_job)
        return results


@cache
def compile_beside(*names: str) -> None:
    """Start a process that compiles these kernels, "module:name", in turn, unless they are there or no processor is left for it.

    Who needs one of them meanwhile waits for it; should the process end early, it compiles the kernel itself.
    """
    from raceway.core import jit, wheel_kernels

    folder = jit.kernel_folder()
    busy = usable_cores() < 2 or multiprocessing.parent_process() is not None or wheel_kernels.writing
    if busy or folder is None or folder.unwritable or wheel_kernels.folder() is not None:
        return
    missing = [name for name in names if name not in jit.awaited and not jit.kernel_named(*name.split(":")).kept]
    if not missing:
        return
    command = [sys.executable, "-P", "-m", __name__, *missing]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, start_new_session=True)
    atexit.register(process.kill)
    assert process.stdout is not None
    finished = map(str.strip, process.stdout)
    jit.awaited.update(dict.fromkeys(missing, finished))


if __name__ == "__main__":
    from raceway.core import jit

    for name in sys.argv[1:]:
        jit.kernel_named(*name.split(":")).compile()
        sys.stdout.write(f"{name}\n")
        sys.stdout.flush()
