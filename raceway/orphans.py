"""Worker processes that end when the process that they work for is gone: a kill gives it no time to end them."""

from __future__ import annotations

import os
import threading
import time

#: Name of the thread that looks, and how often it does [s].
WATCH, _WATCH_S = "end with parent", 1.0


def end_with(parent: int) -> None:
    """In a worker: end when the process of this number is no longer its parent.

    Notes
    -----
    Called when the worker begins, before it has anything to do: pools keep workers that wait, some for minutes.
    """

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(_WATCH_S)
        os._exit(1)

    threading.Thread(target=watch, name=WATCH, daemon=True).start()
