"""A fault in a copy of the sources, and what its tests say."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from queue import Queue

import attrs

from benchmarks.mutants.faults import ROOT, Fault

#: Time for the tests of one fault [s]: kernels are compiled anew for each fault in the core.
LIMIT_S = 600.0
_COPIED = ("raceway", "tests", "benchmarks", "examples", "docs", "README.md", "CHANGELOG.md", "pyproject.toml", "Makefile")
_FAILED = 1


@attrs.frozen
class Verdict:
    """Whether the tests of a fault failed.

    Attributes
    ----------
    caught : a test failed, or ran beyond the limit
    how : the first test that failed, or what went wrong otherwise
    """

    fault: Fault
    caught: bool
    how: str


@contextmanager
def _copy() -> Iterator[Path]:
    """A copy of the sources, with a cache folder of its own beside it."""
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / "sources"
        place.mkdir()
        for name in _COPIED:
            source = ROOT / name
            if source.is_dir():
                shutil.copytree(source, place / name, ignore=shutil.ignore_patterns("__pycache__"))
            else:
                shutil.copy2(source, place / name)
        yield place


def _pytest(place: Path, tests: list[str]) -> tuple[int, str]:
    """Exit code of pytest (-1: beyond the limit) and its output."""
    environment = {**os.environ, "PYTHONPATH": str(place), "RACEWAY_CACHE_DIR": str(place.parent / "cache")}
    environment["PYTHONDONTWRITEBYTECODE"] = (
        "1"  # a fault of the same length within the same second would be read as the old file
    )
    command = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", *tests]
    try:
        done = subprocess.run(command, cwd=place, env=environment, capture_output=True, text=True, timeout=LIMIT_S)
    except subprocess.TimeoutExpired:
        return -1, ""
    return done.returncode, done.stdout + done.stderr


def unharmed(faults: list[Fault]) -> str:
    """What fails of the faults' tests without any fault; empty when they pass, as they must."""
    with _copy() as place:
        code, output = _pytest(place, sorted({test for fault in faults for test in fault.tests}))
    return "" if code == 0 else _first_failure(output) or output[-300:]


def trial(fault: Fault, place: Path) -> Verdict:
    """Put a fault into a copy of the sources, run its tests, take it out."""
    path = place / fault.file
    good = path.read_text(encoding="utf-8")
    path.write_text(fault.put(good), encoding="utf-8")
    try:
        code, output = _pytest(place, list(fault.tests))
    finally:
        path.write_text(good, encoding="utf-8")
        if fault.file.startswith("raceway/core"):  # kernels of this fault serve no other one
            shutil.rmtree(place.parent / "cache" / "kernels", ignore_errors=True)
    if code == -1:
        return Verdict(fault, True, "beyond the limit of time")
    if code == _FAILED:
        return Verdict(fault, True, _first_failure(output) or "a test failed")
    return Verdict(fault, False, "survived" if code == 0 else f"pytest ends with {code}: {output[-200:]}")


def trials(faults: list[Fault], workers: int = 2) -> Iterator[Verdict]:
    """The verdict on each fault, in their order, from so many copies at a time."""
    places: Queue[Path] = Queue()

    def one(fault: Fault) -> Verdict:
        place = places.get()
        try:
            return trial(fault, place)
        finally:
            places.put(place)

    with _copies(workers) as copies, ThreadPoolExecutor(workers) as pool:
        for copy in copies:
            places.put(copy)
        yield from pool.map(one, faults)


@contextmanager
def _copies(count: int) -> Iterator[list[Path]]:
    if count == 0:
        yield []
        return
    with _copy() as first, _copies(count - 1) as others:
        yield [first, *others]


def _first_failure(output: str) -> str:
    lines = [line for line in output.splitlines() if line.startswith(("FAILED ", "ERROR "))]
    return lines[0].split(" - ")[0].removeprefix("FAILED ").removeprefix("ERROR ") if lines else ""
