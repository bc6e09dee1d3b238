"""The matrix of all combinations: how many ran, how many were refused, how long it took."""

from __future__ import annotations

import os
import re
import resource
import subprocess
import sys
import time

from benchmarks.evidence import Row, below
from benchmarks.evidence._files import ROOT

TITLE = "Every registered combination"
COMMAND = "python -m pytest tests/matrix"
#: Asked for: three minutes on two cores.
SECONDS = 180.0


def rows() -> list[Row]:
    # One thread a linear solver: small matrices gain nothing by more, and the time is that of one core.
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    command = [sys.executable, "-m", "pytest", "-q", "tests/matrix"]
    begin, before = time.perf_counter(), _processor()
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    seconds, used = time.perf_counter() - begin, _processor() - before
    counted = {
        word: int(number)
        for number, word in re.findall(r"(\d+) (combinations|run|accepted|refused|need options)", done.stdout)
    }
    bad = int(found[1]) if (found := re.search(r"(\d+) failed", done.stdout)) else 0
    every = counted.get("combinations", 0)
    ran, refused, planned = (counted.get(word, 0) for word in ("run", "refused", "accepted"))
    rest = every - ran - planned - counted.get("need options", 0)
    return [
        Row("combinations", every, "every one of the registry's", every > 0, COMMAND),
        Row("combinations that run, finite and in agreement", ran, "more than 0", ran > 0 and done.returncode == 0, COMMAND),
        Row(
            "combinations that the plan accepts, not run for their cost",
            planned,
            "reported",
            True,
            COMMAND,
            "condensed bodies: those run that change one choice of a plain scene (contacts at points) or two (resultants)",
        ),
        Row("combinations refused with a reason", refused, f"the rest, {rest}", refused == rest, COMMAND),
        below("combinations that fail", bad, 0, COMMAND),
        below(
            "wall time, s",
            seconds,
            SECONDS,
            COMMAND,
            f"{used:.0f} s of a processor, on one of two cores that others use too",
        ),
    ]


def _processor() -> float:
    """Processor time of the processes that have ended [s]."""
    of = resource.getrusage(resource.RUSAGE_CHILDREN)
    return of.ru_utime + of.ru_stime
