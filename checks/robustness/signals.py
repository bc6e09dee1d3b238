"""Commands asked to end at random moments, by each of three signals, and sweeps that are killed."""

from __future__ import annotations

import os

from checks import signals
from checks.robustness import Row, below

_COMMAND = "python -m checks.signals"
_ASKED, _KILLED = 100, 30


def rows() -> list[Row]:
    # Another number of threads rounds a matrix product otherwise: the same as the commands have.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    return [*_asked(), *_killed()]


def _asked() -> list[Row]:
    command = f"{_COMMAND} asked"
    found = signals.asked(_ASKED)
    count = found["count"]
    took = ", ".join(f"{name} {seconds:g} s" for name, seconds in found["seconds"].items())
    note = f"SIGINT, SIGTERM, SIGHUP to the process or its group, at a moment drawn from the whole life: {took}"

    def every(words: str, name: str, note: str = "") -> Row:
        return Row(words, f"{found[name]} of {count}", f"{_ASKED} of {_ASKED}", found[name] == _ASKED, command, note)

    return [
        every("commands that end with the signal's exit code, 130, 143 or 129", "codes", note),
        every("one line that says what stopped it, no traceback", "told", "a sweep's second line says how much is done"),
        every("resumed to the same rows; files of the others whole and the same", "equal"),
        below("processes left 5 s after a signal", found["left"], 0, command),
    ]


def _killed() -> list[Row]:
    command = f"{_COMMAND} killed"
    found = signals.killed(_KILLED)
    words = f"sweeps in processes killed (SIGKILL) 2 to 3 s after the start, {found['killed']} of {_KILLED}: processes left 5 s later"
    good = found["left"] == 0 and found["killed"] == _KILLED
    return [
        Row(words, found["left"], f"at most 0, all {_KILLED} killed", good, command, f"{found['sweeps']} sweeps left some")
    ]
