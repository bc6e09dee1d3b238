"""A duty in a child process with limits: what it tests may write beyond an array, run for ever, or take all memory.

The child is a fork: it has the plug-in as it is here, loaded from wherever it came.
"""

from __future__ import annotations

import faulthandler
import os
import pickle
import resource
import select
import signal
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from importlib import import_module
from typing import TypeVar

T = TypeVar("T")

#: Time [s] that a duty may take on busy cores, compiling too, and memory [bytes] that it may take beyond what is there.
LIMIT_S, LIMIT_BYTES = 300.0, 8 * 2**30


class Died(Exception):
    """How the child ended without an answer, in words."""


def apart(work: Callable[[], T]) -> T:
    """What ``work()`` returns or raises, from a child process.

    Parameters
    ----------
    work : returns, and raises, what can be pickled

    Raises
    ------
    Died
        It ended by a signal or an exit of its own, or was stopped.
    """
    _import_compiler()
    sys.stdout.flush()
    sys.stderr.flush()
    reader, writer = os.pipe()
    child = os.fork()
    if not child:
        os.close(reader)
        _serve(work, writer)
    os.close(writer)
    try:
        answer, late = _collected(reader)
    finally:
        os.close(reader)
        with suppress(ProcessLookupError):
            os.killpg(child, signal.SIGKILL)
        _, status = os.waitpid(child, 0)
    if late:
        raise Died(f"died: it had not ended after {LIMIT_S:g} s")
    if not answer:
        how = (
            f"by {signal.Signals(-code).name}"
            if (code := os.waitstatus_to_exitcode(status)) < 0
            else f"with exit code {code}"
        )
        raise Died(f"died: its process ended {how}")
    good, found = pickle.loads(answer)
    if good:
        return found
    raise found


@cache
def _import_compiler() -> None:
    """Once for all children, with a small kernel, whose first use starts the compiler: most duties take less time than that."""
    for name in ("scipy.sparse.linalg", "scipy.optimize", "raceway.pipeline.run"):
        import_module(name)
    import_module("raceway.core.contact_laws.power").three_halves.compile()


def _serve(work: Callable[[], object], writer: int) -> None:
    """What the child does; it does not come back."""
    code = 1
    try:
        faulthandler.disable()
        os.setpgid(0, 0)
        os.dup2(2, 1)  # what is printed here is no part of an answer in JSON
        _limit_memory()
        try:
            answer = pickle.dumps((True, work()))
        except Exception as why:  # hands over what the duty found
            answer = pickle.dumps((False, why))
        with os.fdopen(writer, "wb") as pipe:
            pipe.write(answer)
        code = 0
    except SystemExit as why:
        code = why.code if isinstance(why.code, int) else 1
    finally:
        os._exit(code)


def _limit_memory() -> None:
    with open("/proc/self/statm", encoding="ascii") as file:
        there = int(file.read().split()[0]) * os.sysconf("SC_PAGE_SIZE")
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    wanted = there + LIMIT_BYTES
    resource.setrlimit(resource.RLIMIT_AS, (wanted if hard == resource.RLIM_INFINITY else min(wanted, hard), hard))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def _collected(reader: int) -> tuple[bytes, bool]:
    """All that the child writes, and whether its time was over before."""
    parts: list[bytes] = []
    end = time.monotonic() + LIMIT_S
    while True:
        ready, _, _ = select.select([reader], [], [], max(end - time.monotonic(), 0.0))
        if not ready:
            return b"", True
        part = os.read(reader, 65536)
        if not part:
            return b"".join(parts), False
        parts.append(part)
