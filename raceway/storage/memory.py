"""Memory that this process may take, and what of it is left, as the system says."""

from __future__ import annotations

import os
from contextlib import suppress
from math import inf
from pathlib import Path

_PROC, _GROUPS = Path("/proc"), Path("/sys/fs/cgroup")
#: Files of a control group by the version of the interface: limit and use [B], and which line of memory.stat may be given back.
_V1 = ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file")
_V2 = ("memory.max", "memory.current", "inactive_file")


def allowed_bytes() -> float:
    """The machine's, its container's or the process's own limit [B]; inf where the system does not say."""
    machine, (own, resident) = _machine("MemTotal"), _own()
    return min(machine, *(limit for limit, _ in _groups()), own - resident)


def available_bytes() -> float:
    """What is left of it [B]: pages of the file cache that the system gives back are not in use."""
    own, resident = _own()
    return max(min(_machine("MemAvailable"), *(limit - usage for limit, usage in _groups()), own - resident), 0.0)


def _machine(entry: str) -> float:
    with suppress(OSError, ValueError, StopIteration):
        lines = (_PROC / "meminfo").read_text().splitlines()
        return 1024.0 * float(next(line for line in lines if line.startswith(f"{entry}:")).split()[1])
    with suppress(AttributeError, ValueError, OSError):  # no Linux
        return float(os.sysconf("SC_PAGE_SIZE")) * float(os.sysconf("SC_PHYS_PAGES"))
    return inf


def _groups() -> list[tuple[float, float]]:
    """Limit and use of the control groups of this process, as containers and job schedulers make them, and of those above."""
    groups = [(inf, 0.0)]
    with suppress(OSError, ValueError):
        for line in (_PROC / "self/cgroup").read_text().splitlines():
            _, kinds, name = line.split(":", 2)
            if kinds and "memory" not in kinds.split(","):
                continue
            root, (limit, usage, idle) = (_GROUPS / "memory", _V1) if kinds else (_GROUPS, _V2)
            place = root / name.strip("/")
            for group in (place, *place.parents):
                with suppress(OSError, ValueError):  # no such file, or "max"
                    most = float((group / limit).read_text())
                    stat = dict(entry.split() for entry in (group / "memory.stat").read_text().splitlines())
                    groups.append((most, float((group / usage).read_text()) - float(stat.get(idle, 0.0))))
    return groups


def _own() -> tuple[float, float]:
    """What ``ulimit -v`` allows, and what the process holds."""
    with suppress(ImportError, ValueError, OSError):
        import resource

        limit = resource.getrlimit(resource.RLIMIT_AS)[0]
        pages = int((_PROC / "self/statm").read_text().split()[0])
        return inf if limit == resource.RLIM_INFINITY else float(limit), float(pages * resource.getpagesize())
    return inf, 0.0
