"""How fast this machine is: a fixed piece of work, timed once and kept."""

from __future__ import annotations

import os
import platform
import sys
import time
from functools import cache

#: Iterations of the piece of work, and its processor time on the machine that ``wall_time``'s constants belong to [s].
_ITERATIONS, _REFERENCE_S = 4000, 2.0e-4
#: Repeats: the least of many short ones finds the moments in which other programs leave the core alone.
_REPEATS = 60


@cache
def slowness() -> float:
    """Processor time of this machine over that of the machine on which the plan's constants were measured.

    Notes
    -----
    Timed once (15 ms) and kept beside the compliances: two plans of one scene agree, and `raceway cache --clear` has it
    timed again.  A folder that cannot be written leaves it unkept, without a word: the run itself says so.
    """
    import numpy as np

    from raceway.array_cache import folder, kept
    from raceway.cache_folder import refusal

    place = next((place for place in (folder(), *folder().parents) if place.exists()), None)
    if place is None or not place.is_dir() or not os.access(place, os.W_OK) or refusal(folder()):
        return timed()
    inputs = {"python": sys.version, "machine": platform.machine(), "processor": _processor(), "cores": os.cpu_count()}
    found = kept(
        "machine", "speed of this machine", inputs, ("planning/machine.py",), lambda: {"slowness": np.array([timed()])}
    )
    return float(found["slowness"][0])


def timed() -> float:
    """``slowness`` as it is now."""
    return min(_seconds() for _ in range(_REPEATS)) / _REFERENCE_S


def _seconds() -> float:
    """Of the logistic map in floating-point numbers of Python: scalar work like that of the compiled loops."""
    begun, x, total = time.process_time(), 0.5, 0.0
    for _ in range(_ITERATIONS):
        x = 3.7 * x * (1.0 - x)
        total += x
    return time.process_time() - begun


def _processor() -> str:
    """Its name, where the system tells it."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            return next((line.partition(":")[2].strip() for line in file if line.startswith("model name")), "")
    except OSError:
        return platform.processor()
