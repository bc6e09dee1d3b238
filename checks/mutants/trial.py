"""A fault in a copy of the sources, and what its tests say."""

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import attrs

from checks.mutants.faults import ROOT, Fault
from checks.mutants.kernels import carry_over

#: Time for the tests of one fault [s]: none takes a tenth of it without a fault.
LIMIT_S = 600.0
#: What the tests need of the sources.
COPIED = (
    "raceway", "packages", "tests", "checks", "examples", "docs", "README.md", "CHANGELOG.md",
    "pyproject.toml", "Makefile", "conftest.py",
)  # fmt: skip
#: What `make test` runs.
QUICK = "not slow and not docs and not night and not release and not ross"
_FAILED, _NONE_LEFT = 1, 5


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


@attrs.frozen
class Copy:
    """A copy of the sources, with a cache folder of its own for each state of them.

    Attributes
    ----------
    place : root of the copied sources;  good : folder of the kernels of the sources without a fault, once they were needed
    """

    place: Path
    good: Path

    def pytest(self, tests: list[str], cache: Path, quick: bool, limit: float | None = LIMIT_S) -> tuple[int, str]:
        """Exit code of pytest (-1: beyond the limit) and its output."""
        words = [
            "-m",
            "pytest",
            "-q",
            "-x",
            "-p",
            "no:cacheprovider",
            "-p",
            "no:checks.processor_time",
        ]  # a fault may take its time
        command = [sys.executable, *words, *(["-m", QUICK] if quick else []), *tests]
        try:
            done = subprocess.run(
                command, cwd=self.place, env=self.environment(cache), capture_output=True, text=True, timeout=limit
            )
        except subprocess.TimeoutExpired:
            return -1, ""
        return done.returncode, done.stdout + done.stderr

    def environment(self, cache: Path) -> dict[str, str]:
        """What the tests run under: these sources, this cache."""
        return {
            **os.environ,
            "PYTHONPATH": os.pathsep.join(map(str, (self.place, *sorted(self.place.glob("packages/*"))))),
            "RACEWAY_CACHE_DIR": str(cache),
        }

    def unharmed(self, faults: list[Fault], quick: bool = False) -> str:
        """What fails of the faults' tests without any fault; empty when all pass, as they must."""
        tests = sorted({test for fault in faults for test in fault.tests})
        if not tests:
            return ""
        code, output = self.pytest(tests, self.good, quick, limit=None)
        return "" if code in (0, _NONE_LEFT) else _first_failure(output) or output[-300:]

    def trial(self, fault: Fault, quick: bool = False) -> Verdict:
        """Put a fault in, run its tests, take it out."""
        path = self.place / fault.file
        good, before = path.read_text(encoding="utf-8"), path.stat()
        path.write_text(fault.put(good), encoding="utf-8")
        try:
            with tempfile.TemporaryDirectory(dir=self.place.parent) as folder:
                cache = Path(folder)
                if fault.file.startswith("raceway/core/"):
                    carry_over(self.good, self.place, fault.file, self.environment(cache))
                else:  # another key would mean other kernels
                    cache = self.good
                code, output = self.pytest(list(fault.tests), cache, quick)
        finally:
            path.write_text(good, encoding="utf-8")
            os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))  # compiled files tell by the time what is theirs
        return Verdict(fault, *_judged(code, output))


@contextmanager
def copied() -> Iterator[Copy]:
    """A copy of the sources, in a temporary folder."""
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / "sources"
        place.mkdir()
        for name in COPIED:
            source = ROOT / name
            if source.is_dir():
                shutil.copytree(source, place / name, ignore=shutil.ignore_patterns("__pycache__"))
            else:
                shutil.copy2(source, place / name)
        yield Copy(place, place.parent / "cache")


def _judged(code: int, output: str) -> tuple[bool, str]:
    if code == -1:
        return True, "beyond the limit of time"
    if code == _FAILED:
        return True, _first_failure(output) or "a test failed"
    if code == _NONE_LEFT:
        return False, "no test of this tier"
    return False, "survived" if code == 0 else f"pytest ends with {code}: {output[-200:]}"


def _first_failure(output: str) -> str:
    lines = [line for line in output.splitlines() if line.startswith(("FAILED ", "ERROR "))]
    return lines[0].split(" - ")[0].removeprefix("FAILED ").removeprefix("ERROR ") if lines else ""
