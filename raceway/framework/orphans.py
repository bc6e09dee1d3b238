"""Worker processes end with the process that they work for, when it is killed, and by its word alone, when it is asked to end."""

import os
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

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
