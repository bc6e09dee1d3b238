"""Standard streams as they come: closed ones, and consoles that know ASCII only.  Part of ``raceway.cli.main``."""

import _thread
import atexit
import codecs
import io
import os
import signal
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from types import FrameType
from typing import NoReturn, Self

#: What stands for the characters of units and names where a console has none of them.
_PLAIN = {
    "\u00b5": "u",
    "\u03bc": "u",
    "\u00b2": "^2",
    "\u00b3": "^3",
    "\u00b0": " deg",
    "\u00b7": " ",
    "\u2013": "-",
    "\u2026": "...",
}


def _plain(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return "".join(_PLAIN.get(sign, "?") for sign in error.object[error.start : error.end]), error.end


def prepare() -> None:
    """Let every character be written somehow, and what is closed lead nowhere; a terminal without columns has those of any."""
    if os.environ.get("COLUMNS", "").isdigit() and int(os.environ["COLUMNS"]) == 0:
        del os.environ["COLUMNS"]
    codecs.register_error("raceway", _plain)
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115  as long as the process lives
        elif isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="raceway")


#: Time after which a signal is delivered again [s]: longer than a callback, short for a person.
_AGAIN_S = 0.05
#: Time after which an interruption that was raised is looked for [s].
_LOOK_S = 0.5
#: Time that libraries get to end their own threads and processes once the command was stopped [s].
_LEAVING_S = 3.0
#: Time in which a supervisor that asks again is not heard [s].
_ORDER_S = 5.0
#: llvmlite's callbacks, finalizers, weak references' callbacks by their file, and those of the locks of imports.
_CALLBACKS, _FINALIZER, _WEAK = "_raw_object_cache", "__del__", "weakref.py"
_IMPORTS = ("<frozen importlib._bootstrap>", "cb")
#: What ends a command in order, and what Python does about it when nobody asked for anything else.
_ENDING = {signal.SIGINT: signal.default_int_handler, signal.SIGTERM: signal.SIG_DFL, signal.SIGHUP: signal.SIG_DFL}
#: The first one that arrived in this command, whether that was said, and whether the last one was answered.
_first: int | None = None
_farewell_said = _answered = False


def stopped_by() -> int | None:
    """Number of the signal that ended the command; None where none arrived."""
    return _first


def answered() -> None:
    """The interruption that arrived last was not lost: what is done from here on is not interrupted by it again."""
    global _answered
    _answered = True


def farewell(say: Callable[[str], object]) -> int:
    """Say once what stopped the command; the exit code."""
    global _farewell_said
    number = signal.SIGINT if _first is None else _first
    if not _farewell_said:
        _farewell_said = True
        with suppress(OSError):  # a terminal that was closed
            say(f"stopped by {_signal_name(number)}; no file is left half-written")
    return 128 + number


def _signal_name(number: int) -> str:
    return "Ctrl-C" if number == signal.SIGINT else signal.Signals(number).name


class Interrupts:
    """While entered, a signal that asks for the end raises a ``KeyboardInterrupt`` wherever it arrives.

    Without effect outside the main thread, and on signals that the caller handles or ignores (``nohup``) itself.  After the
    first one only Ctrl-C interrupts what is being put in order, for some seconds.
    """

    def __init__(self) -> None:
        self._timer: threading.Timer | None = None
        self._before: dict[signal.Signals, Callable[[int, FrameType | None], object] | int | None] = {}
        self._until = 0.0
        self._looking = False

    def __enter__(self) -> Self:
        global _first, _farewell_said, _answered
        if threading.current_thread() is threading.main_thread():
            for number, usual in _ENDING.items():
                if signal.getsignal(number) is usual:
                    self._before[number] = signal.signal(number, self._arrived)
            if self._before:  # not inside another one of this command
                _first, _farewell_said, _answered = None, False, False
        return self

    def __exit__(self, *_: object) -> None:
        for number, before in self._before.items():
            signal.signal(number, before)
        if self._timer is not None:
            self._timer.cancel()

    def _arrived(self, number: int, frame: FrameType | None) -> None:
        global _first, _answered
        looking, self._looking = self._looking, False
        _answered = _answered and looking
        if looking and (_farewell_said or _answered or _unwinding()):
            self._later(_LOOK_S, self._look, number)
            return
        if _drops_exceptions(frame):
            self._later(_AGAIN_S, self._look if looking else _thread.interrupt_main, number)
            return
        self._later(_LOOK_S, self._look, number)
        again = not looking and _first is not None and number != signal.SIGINT and time.monotonic() < self._until
        if _first is None:
            _first, self._until = number, time.monotonic() + _ORDER_S
        if not again:
            raise KeyboardInterrupt

    def _later(self, seconds: float, action: Callable[[signal.Signals], None], number: int) -> None:
        if self._timer is not None:
            self._timer.cancel()
        self._timer = threading.Timer(seconds, action, (signal.Signals(number),))
        self._timer.daemon = True
        self._timer.start()

    def _look(self, number: signal.Signals) -> None:
        """See in the main thread whether the interruption is still on its way."""
        if not (_farewell_said or _answered):
            self._looking = True
            _thread.interrupt_main(number)


def _unwinding() -> bool:
    """Whether the main thread is putting something in order because of an interruption."""
    why = sys.exc_info()[1]
    while why is not None:
        if isinstance(why, KeyboardInterrupt):
            return True
        why = why.__context__
    return False


def end(code: int) -> NoReturn:
    """End the process: whatever ends is in order, and a signal from here on ends it without a word of Python's own."""

    def leave(number: int, _frame: FrameType | None) -> None:
        if not _farewell_said:
            with suppress(OSError):
                os.write(2, f"stopped by {_signal_name(number)}\n".encode())
        os._exit(128 + number)

    for number in _ENDING:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, leave)
    if _first is not None:
        # What libraries still do is done, for a while, but what they complain of in a process that was stopped is not news.
        with suppress(OSError, ValueError):
            sys.stdout.flush()
        with suppress(OSError, ValueError):
            sys.stderr.flush()
        with suppress(OSError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
        late = threading.Timer(_LEAVING_S, os._exit, (code,))
        late.daemon = True
        late.start()
        atexit._run_exitfuncs()
        # Not sys.exit: where an interruption passed through a C library, Python would end by another Ctrl-C of its own.
        os._exit(code)
    # As Python ends, but for taking itself apart: meanwhile it answers no signal, and the process would die of one.  This waits for threads, as the interpreter does when it ends; there is no public name for that, and typeshed knows no other.
    threading._shutdown()  # type: ignore[attr-defined]
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):  # a reader that has gone; closed
            stream.flush()
    os._exit(code)


def _drops_exceptions(frame: FrameType | None) -> bool:
    """Whether an exception that is raised in this frame would be forgotten."""
    while frame is not None:
        code = frame.f_code
        if code.co_name == _FINALIZER or code.co_name.startswith(_CALLBACKS) or code.co_filename.endswith(_WEAK):
            return True
        if (code.co_filename, code.co_name) == _IMPORTS:
            return True
        frame = frame.f_back
    return False
