"""Ctrl-C that is not lost where Python drops exceptions.  Part of ``raceway.cli``.

The compiler of the kernels calls back into Python, and an exception that is raised in such a callback or in a finalizer is
printed and forgotten.  A Ctrl-C that arrives there is delivered again a moment later.
"""

from __future__ import annotations

import _thread
import signal
import threading
from types import FrameType
from typing import Self

#: Time after which a Ctrl-C is delivered again [s]: longer than a callback, short for a person.
_AGAIN_S = 0.05
#: llvmlite's callbacks, finalizers, and weak references' callbacks by their file.
_CALLBACKS, _FINALIZER, _WEAK = "_raw_object_cache", "__del__", "weakref.py"


class Interrupts:
    """While entered, Ctrl-C ends in a ``KeyboardInterrupt`` wherever it arrives; without effect outside the main thread."""

    def __init__(self) -> None:
        self._timer: threading.Timer | None = None
        self._ours = False

    def __enter__(self) -> Self:
        main = threading.current_thread() is threading.main_thread()
        self._ours = main and signal.getsignal(signal.SIGINT) is signal.default_int_handler
        if self._ours:
            signal.signal(signal.SIGINT, self._arrived)
        return self

    def __exit__(self, *_: object) -> None:
        if self._ours:
            signal.signal(signal.SIGINT, signal.default_int_handler)
        if self._timer is not None:
            self._timer.cancel()

    def _arrived(self, number: int, frame: FrameType | None) -> None:
        if not drops_exceptions(frame):
            raise KeyboardInterrupt
        self._timer = threading.Timer(_AGAIN_S, _thread.interrupt_main, (number,))
        self._timer.daemon = True
        self._timer.start()


def drops_exceptions(frame: FrameType | None) -> bool:
    """Whether an exception that is raised in this frame would be forgotten."""
    while frame is not None:
        code = frame.f_code
        if code.co_name == _FINALIZER or code.co_name.startswith(_CALLBACKS) or code.co_filename.endswith(_WEAK):
            return True
        frame = frame.f_back
    return False
