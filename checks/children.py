"""A function in a child of this process, so that a signal or an endless loop in it is an answer as well."""

import multiprocessing
import signal
from collections.abc import Callable
from typing import Any


def in_child(function: Callable[..., Any], *given: Any, limit_s: float = 120.0) -> Any:
    """What it returns; or in words which signal or exception ended it, or that it did not end.  The child is forked: it has
    the modules and the compiled kernels of this process, and its own copy of everything else."""
    context = multiprocessing.get_context("fork")
    here, there = context.Pipe(duplex=False)
    process = context.Process(target=_answer, args=(there, function, given))
    process.start()
    there.close()
    try:
        found = here.recv() if here.poll(limit_s) else f"no end within {limit_s:g} s"
    except EOFError:
        found = ""
    process.join(5.0)
    if process.is_alive():
        process.kill()
        process.join()
    if found == "":
        code = process.exitcode or 0
        found = f"ended by {signal.Signals(-code).name}" if code < 0 else f"ended without an answer, code {code}"
    return found


def _answer(there: Any, function: Callable[..., Any], given: tuple[Any, ...]) -> None:
    try:
        there.send(function(*given))
    except BaseException as why:
        there.send(f"unexpected {type(why).__name__}: {why}")
