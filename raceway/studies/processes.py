"""What a study's processes have used."""

from __future__ import annotations

import resource


def processor_time() -> float:
    """Of this process and of those that it has ended [s]."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)
