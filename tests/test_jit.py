"""The one decorator: where compiled kernels are kept, what happens when they cannot be, what a kernel may not do."""

from __future__ import annotations

import json
import shutil
import sys
from pathlib import Path

import numba
import numpy as np
import pytest

import raceway
from raceway.core.jit import jit
from raceway.core.signatures import LAW
from raceway.errors import PluginError
from tests.command_line import python

#: The smallest kernels, three in a file, one used once; what was compiled and read, what was warned of, numba's own settings.
USE = """
import json, sys, warnings
import numba, numpy as np
before = numba.config.CACHE_DIR
with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    from raceway.core.contact_laws.power import three_halves
    from raceway.core.jit import clock
force, slope, rate = np.empty(1), np.empty(1), np.empty(1)
none = np.zeros((1, 0))
three_halves(np.array([-4e-6]), np.zeros(1), np.array([[1e9]]), none, none, 0.0, force, slope, rate)
kept = before == numba.config.CACHE_DIR
print(json.dumps([force[0], clock["compiled"], clock["loaded"], [str(w.message) for w in caught], kept]))
"""
FORCE = 1e9 * (4e-6) ** 1.5


def use(folder: Path) -> tuple[int, int, list[str]]:
    """Kernels compiled and read, and warnings, of a process with this cache folder."""
    done = python("-c", USE, RACEWAY_CACHE_DIR=folder)
    assert done.returncode == 0, done.stderr
    force, compiled, loaded, warned, kept = json.loads(done.stdout)
    assert force == pytest.approx(FORCE, rel=1e-14)  # one rounding of the power against a product with a root
    assert kept, "numba's own cache folder was left changed"
    return compiled, loaded, warned


def files(folder: Path, suffix: str = "") -> dict[Path, int]:
    return {path: path.stat().st_mtime_ns for path in folder.rglob(f"*{suffix}") if path.is_file()}


def test_a_second_process_compiles_nothing_and_writes_nothing(tmp_path):
    assert use(tmp_path) == (3, 0, [])
    before = files(tmp_path)
    assert before
    assert use(tmp_path) == (0, 3, [])
    assert files(tmp_path) == before


def test_a_folder_that_cannot_be_made_costs_one_warning(tmp_path):
    below_a_file = tmp_path / "file"
    below_a_file.write_text("in the way", encoding="utf-8")
    compiled, loaded, warned = use(below_a_file / "cache")
    assert (compiled, loaded) == (3, 0)
    assert len(warned) == 1
    assert "RACEWAY_CACHE_DIR" in warned[0]


@pytest.mark.parametrize("suffix", [".nbc", ".nbi"])
@pytest.mark.parametrize("left", [0, 100])
def test_truncated_cache_files_are_replaced(tmp_path, suffix, left):
    use(tmp_path)
    broken = files(tmp_path, suffix)
    assert broken
    for path in broken:
        path.write_bytes(path.read_bytes()[:left])
    compiled, loaded, warned = use(tmp_path)
    assert (compiled + loaded, warned) == (3, [])
    assert use(tmp_path) == (0, 3, [])


def key_of(package: Path) -> str:
    done = python("-c", "from raceway.cache_folder import source_key; print(source_key())", cwd=package.parent)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def test_the_folder_follows_the_sources_of_the_core(tmp_path):
    package = tmp_path / "raceway"
    shutil.copytree(Path(raceway.__file__).parent, package, ignore=shutil.ignore_patterns("__pycache__"))
    first = key_of(package)
    assert key_of(package) == first
    with (package / "plan.py").open("a", encoding="utf-8") as file:
        file.write("# no kernel\n")
    assert key_of(package) == first
    with (package / "core" / "hertz.py").open("a", encoding="utf-8") as file:
        file.write("# a kernel may have changed\n")
    assert key_of(package) != first


def test_numbas_settings_are_left_alone():
    before = numba.config.CACHE_DIR

    @jit(numba.float64(numba.float64))
    def twice(x):
        return 2.0 * x

    assert twice(2.0) == 4.0
    assert before == numba.config.CACHE_DIR


def test_division_by_zero_is_not_an_exception():
    @jit(numba.float64(numba.float64))
    def inverse(x):
        return 1.0 / x

    assert inverse(0.0) == np.inf


def test_a_kernel_that_creates_arrays_is_refused_by_name():
    with pytest.raises(PluginError, match="greedy.*creates arrays"):

        @jit(LAW)
        def greedy(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
            copy = np.maximum(-gap, 0.0)
            force[:] = copy


def test_a_time_loop_may_create_arrays():
    @jit(numba.float64(numba.int64), allocates=True)
    def total(n):
        return np.ones(n).sum()

    assert total(3) == 3.0


def test_a_kernel_that_numba_cannot_type_is_refused_by_name():
    with pytest.raises(PluginError, match="untyped"):

        @jit(numba.float64(numba.float64))
        def untyped(x):
            return sys.getsizeof(x)
