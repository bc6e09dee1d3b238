"""A fault in a copy of the sources, and what its tests say."""

import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from itertools import count
from pathlib import Path

import attrs

from checks.mutants.faults import ROOT, Fault
from checks.mutants.kernels import kept
from raceway.storage.kernel_cache import current_folder

#: Time for the tests of one fault [s]: none takes a tenth of it without a fault.
LIMIT_S = 600
#: What the tests need of the sources.
COPIED = (
    "raceway", "packages", "tests", "checks", "examples", "docs", "README.md", "CHANGELOG.md",
    "pyproject.toml", "Makefile", "conftest.py",
)  # fmt: skip
#: What most tests import that is not of the sources.
LIBRARIES = (
    "numpy", "scipy.interpolate", "scipy.linalg", "scipy.optimize", "scipy.sparse.linalg", "scipy.special", "numba", "pytest", "rich",
    "xarray", "numba.np.arrayobj", "matplotlib.pyplot", "click", "cattrs.preconf.json", "PIL.Image", "xdist.plugin",
)  # fmt: skip
#: What `make test` runs.
QUICK = "not slow and not docs and not night and not release and not ross"
_FAILED, _NONE_LEFT = 1, 5
#: Of faulty files [s], one for each: compiled files tell by time and size what is theirs.
_TIMES = count()


@attrs.frozen
class Verdict:
    """Whether a test of a fault failed or ran beyond the limit; the first that did, or what went wrong otherwise."""

    fault: Fault
    caught: bool
    how: str


@attrs.frozen
class Copy:
    """A copy of the sources.

    place : root of the copied sources;  good : the cache of the sources without a fault;  warm : the process that runs tests here
    places : roots of the same sources, and the folder of the kernels of each
    """

    place: Path
    good: Path
    places: dict[Path, Path]
    warm: subprocess.Popen[str]

    def pytest(
        self, tests: Iterable[str], cache: Path, quick: bool, kernels: list[tuple[str, str]], limit: int = 0
    ) -> tuple[int, str]:
        """Exit code of pytest (that of ``SIGALRM``: beyond the limit) and its output."""
        plugins = ["-p", "no:cacheprovider", "-p", "no:checks.processor_time"]  # a fault may take its time
        words = ["-q", "-x", *plugins, *(["-m", QUICK] if quick else []), *tests]
        with tempfile.NamedTemporaryFile("r", encoding="utf-8") as output:
            job = {"cache": str(cache), "kernels": kernels, "words": words, "output": output.name, "limit": limit}
            assert self.warm.stdin and self.warm.stdout
            print(json.dumps(job), file=self.warm.stdin, flush=True)
            return int(self.warm.stdout.readline()), output.read()

    def unharmed(self, tests: Iterable[str], quick: bool = False) -> str:
        """What fails of tests without any fault; empty when all pass, as they must."""
        code, output = self.pytest(tests, self.good, quick, kept(self.places))
        return "" if code in (0, _NONE_LEFT) else _first_failure(output) or output[-300:]

    def trial(self, fault: Fault, quick: bool = False) -> Verdict:
        """Put a fault in, run its tests, take it out."""
        path = self.place / fault.file
        good, before = path.read_text(encoding="utf-8"), path.stat()
        path.write_text(fault.put(good), encoding="utf-8")
        os.utime(path, (0, next(_TIMES)))
        try:
            with tempfile.TemporaryDirectory(dir=self.place.parent) as cache:
                code, output = self.pytest(fault.tests, Path(cache), quick, kept(self.places, fault), LIMIT_S)
        finally:
            path.write_text(good, encoding="utf-8")
            os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))
        return Verdict(fault, *_judged(code, output))


@contextmanager
def copied(folder: Path, number: int = 0) -> Iterator[Copy]:
    """One of two copies of the sources in a temporary folder, which share the cache beside them; kernels of the user's cache serve both."""
    good, one, other = (folder.resolve() / name for name in ("cache", "0", "1"))
    kernels = good / "kernels" / current_folder().name
    places = {ROOT: current_folder(), one: kernels, other: kernels}
    place = (one, other)[number]
    place.mkdir()
    for name in COPIED:
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, place / name, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy2(source, place / name)
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, (place, *sorted(place.glob("packages/*")))))}
    command = [sys.executable, "-m", "checks.mutants.warm", *LIBRARIES]
    with subprocess.Popen(
        command, cwd=place, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as warm:
        yield Copy(place, good, places, warm)


def _judged(code: int, output: str) -> tuple[bool, str]:
    if code == -signal.SIGALRM:
        return True, "beyond the limit of time"
    if code == _FAILED and (first := _first_failure(output)):
        return True, first
    if code == _NONE_LEFT:
        return False, "no test of this tier"
    return False, "survived" if code == 0 else f"pytest ends with {code}: {output[-200:]}"


def _first_failure(output: str) -> str:
    lines = [line for line in output.splitlines() if line.startswith(("FAILED ", "ERROR "))]
    return lines[0].split(" - ")[0].removeprefix("FAILED ").removeprefix("ERROR ") if lines else ""
