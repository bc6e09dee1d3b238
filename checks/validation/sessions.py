"""Processes of a session: what a command that was ended has left."""

import time
from pathlib import Path

from checks.validation.command_line import PATIENCE_S


def members(session: int) -> list[str]:
    """Numbers of the processes of a session that live."""
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            state, _, _, own, *_ = path.read_text().rpartition(")")[2].split()
        except OSError:  # it ended meanwhile
            continue
        if int(own) == session and state != "Z":
            found.append(path.parent.name)
    return found


def left(session: int, patience_s: float = PATIENCE_S) -> list[str]:
    """Those that live after some time; as soon as there are none."""
    end = time.monotonic() + patience_s
    while (found := members(session)) and time.monotonic() < end:
        time.sleep(0.05)
    return found
