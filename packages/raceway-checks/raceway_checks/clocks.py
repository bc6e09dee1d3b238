"""Time and memory that a process takes."""

import resource
import sys
import time
from pathlib import Path

from raceway.extend import Tables


def processor_time() -> float:
    """Of this process and of those that it has ended [s]."""
    usages = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)


class Clocks:
    """Readings of the clocks as a run starts, and the peak of memory counted anew where the system does so."""

    def __init__(self) -> None:
        from raceway.extend import working_process_time

        self._counted_anew, self._clock = reset_peak(), working_process_time
        self._cpu, self._wall = self._clock(), time.perf_counter()

    def read(self) -> tuple[float, float, Tables]:
        """Processor time without what kernels took to compile, and wall time since then [s]; ``peak_memory`` of the run."""
        return self._clock() - self._cpu, time.perf_counter() - self._wall, peak_memory("run", self._counted_anew)


def peak_memory(counted: str, anew: bool) -> Tables:
    """Peak of memory of this process [bytes], and whose it is: of what is ``counted`` where the count began ``anew`` with it."""
    scale = 1 if sys.platform == "darwin" else 1024
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * scale
    return {"peak_memory_bytes": peak, "peak_memory_of": counted if anew else "process so far"}


def reset_peak() -> bool:
    """Let the system count the peak of memory of this process anew (Linux); whether it does."""
    try:
        Path("/proc/self/clear_refs").write_bytes(b"5")
    except OSError:
        return False
    return True
