"""Sweeps: ``benchmarks/sweeps.py``."""

from __future__ import annotations

import os

from benchmarks import sweeps
from benchmarks.evidence import Row, below

TITLE = "Sweeps: speed, memory, what they survive"
_COMMAND = "python -m benchmarks.sweeps"
#: Wall time of 1000 points on 2 cores [s], growth of memory, and time a point of the sweep itself [ms].
_LIMITS = {"rigid": 60.0, "condensed": 120.0}
_FLAT, _OVERHEAD_MS, _FASTER = 1.05, 2.0, 1.7
_SAME = 1e-7


def rows() -> list[Row]:
    return [*_two_workers(), *_speed(), *_memory(), *_continuation(), *_survives()]


def _speed() -> list[Row]:
    out = []
    for bodies, limit in _LIMITS.items():
        found = sweeps.timed(1000, "--executor", "joblib", "--workers", "2", bodies=bodies)
        note = (
            f"{1e3 * found['points_cpu_s'] / 1000:.1f} ms of a processor a point, start of three processes included; load "
            f"average {os.getloadavg()[0]:.1f} at the end"
        )
        out.append(
            below(
                f"1000 points, {bodies}, periodic, two workers: wall time, s",
                found["wall_s"],
                limit,
                f"{_COMMAND} {bodies}",
                note,
            )
        )
    found = sweeps.overhead()
    note = f"{1e3 * found['swept_s']:.2f} ms a point against {1e3 * found['bare_s']:.2f} ms of the same runs alone, processor time"
    out.append(
        below(
            "overhead of the sweep, ms of processor time a point",
            1e3 * found["overhead_s"],
            _OVERHEAD_MS,
            f"{_COMMAND} overhead",
            note,
        )
    )
    return out


def _two_workers() -> list[Row]:
    name, command = "two workers over one: 2000 condensed points", "python -m benchmarks.evidence sweep"
    if not sweeps.quiet():
        note = f"other programs work here: load average {os.getloadavg()[0]:.1f}"
        return [Row(name, "not measured", f"at least {_FASTER:g}", False, command, note)]
    one, two = (
        sweeps.timed(2000, "--executor", "joblib", "--workers", workers, bodies="condensed")["wall_s"] for workers in "12"
    )
    return [Row(name, one / two, f"at least {_FASTER:g}", one / two >= _FASTER, command, f"{one:.1f} s against {two:.1f} s")]


def _memory() -> list[Row]:
    few, many = (sweeps.timed(count)["peak_bytes"] for count in (200, 2000))
    note = f"{few / 2**20:.0f} MiB and {many / 2**20:.0f} MiB, one process"
    return [below("peak memory of 2000 points over that of 200", many / few, _FLAT, f"{_COMMAND} memory", note)]


def _continuation() -> list[Row]:
    out = []
    for name, found in sweeps.continuation().items():
        note = f"{found['warm']:.1f} evaluations a point instead of {found['cold']:.1f}"
        out.append(
            below(
                f"change of Z by starting from a neighbour: {name}", found["change"], _SAME, f"{_COMMAND} continuation", note
            )
        )
    return out


def _survives() -> list[Row]:
    out = []
    found, command = sweeps.killed(), f"{_COMMAND} killed"
    times = found["killed"]
    note = "120 points; every fourth sweep with two processes"
    good = times == 20 and found["equal"] == times
    out.append(
        Row(
            "sweeps killed at random moments that resume to the same values",
            f"{found['equal']} of {times}",
            "20 of 20",
            good,
            command,
            note,
        )
    )
    out.append(below("stores that a kill left unreadable", found["unreadable"], 0, command))
    out.append(below("kills that lost a finished point", found["lost"], 0, command))
    out.append(below("processes left 5 s after a kill", found["orphans"], 0, command))
    worker, command = sweeps.worker_killed(), f"{_COMMAND} worker_killed"
    good = worker["code"] == 0 and worker["equal"]
    out.append(
        Row(
            "one of two joblib processes killed half-way",
            "same values" if good else str(worker),
            "same values",
            good,
            command,
        )
    )
    stopped, command = sweeps.interrupted(), f"{_COMMAND} interrupted"
    good = stopped == {"code": 130, "results": True, "equal": True, "orphans": 0}
    value = "code 130, results.nc, same values after --resume" if good else str(stopped)
    out.append(
        Row(
            "Ctrl-C while it computes, two processes",
            value,
            "code 130, results.nc, same values after --resume",
            good,
            command,
        )
    )
    disk, command = sweeps.full_disk(), f"{_COMMAND} full_disk"
    good = disk["told"] == disk["equal"] == disk["tried"]
    value = f"{disk['told']} told, {disk['equal']} same values after --resume, of {disk['tried']}"
    out.append(Row("disks full at different points", value, "all", good, command))
    return out
