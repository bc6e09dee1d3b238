"""The one decorator: where compiled kernels are kept, what happens when they cannot be, what a kernel may not do."""

import json
import os
import shutil
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from itertools import count
from pathlib import Path

import numba
import numpy as np
import pytest
from numba.core.bytecode import FunctionIdentity
from numba.core.caching import IndexDataCacheFile

import raceway
from checks.validation.command_line import python
from raceway import LAW, PluginError, jit
from raceway.core.jit import clock
from raceway.core.signatures import Pointer
from raceway.storage.kernel_cache import current_folder, make, opened, refusal

#: The smallest kernels, three in two files, each used once; what was compiled and read, what was warned of, numba's own settings.
USE = """
import json, sys, warnings
import numba, numpy as np
before = numba.config.CACHE_DIR
with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    from raceway.contact_laws.hertz import three_halves
    from raceway.contact_laws.penalty import linear, square
    from raceway.core.jit import clock
    at_import = clock["compiled"] + clock["loaded"]
    force, slope, rate = np.empty(1), np.empty(1), np.empty(1)
    none = np.zeros((1, 0))
    for law in (linear, square, three_halves):
        law()(np.array([-4e-6]), np.zeros(1), np.array([[1e9]]), none, none, 0.0, force, slope, rate)
assert at_import == 0, at_import
kept = before == numba.config.CACHE_DIR
print(json.dumps([force[0], clock["compiled"], clock["loaded"], [str(w.message) for w in caught], kept]))
"""
FORCE = 1e9 * (4e-6) ** 1.5


def use(folder: Path, before: str = "") -> tuple[int, int, list[str]]:
    """Kernels compiled and read, and warnings, of a process with this cache folder; ``before``: what it does first."""
    done = python("-c", before + USE, RACEWAY_CACHE_DIR=folder)
    assert done.returncode == 0, done.stderr
    force, compiled, loaded, warned, kept = json.loads(done.stdout)
    assert force == pytest.approx(FORCE, rel=1e-14)  # one rounding of the power against a product with a root
    assert kept, "numba's own cache folder was left changed"
    return compiled, loaded, warned


@pytest.fixture(scope="module")
def compiled_once(tmp_path_factory):
    folder = tmp_path_factory.mktemp("cache")
    assert use(folder) == (3, 0, [])
    return folder


@pytest.fixture
def warm(compiled_once, tmp_path):
    """A copy of a folder with the three kernels, of this test alone."""
    return Path(shutil.copytree(compiled_once, tmp_path / "cache"))


def files(folder: Path, suffix: str = "") -> dict[Path, int]:
    return {path: path.stat().st_mtime_ns for path in folder.rglob(f"*{suffix}") if path.is_file()}


def test_a_second_process_compiles_nothing_and_writes_nothing(warm):
    before = files(warm)
    assert before and use(warm) == use(warm, FULL) == (0, 3, [])  # nor does one that cannot write
    assert files(warm) == before


#: Files, and what is left of each one's content.
DAMAGES = {
    "cut": (".nbi", lambda content: content[:100]),
    "emptied": (".nbc", lambda content: b""),
    # What a machine that lost its power leaves: numba reads it, and the linker ends the process.
    "zeroed": (".nbc", lambda content: bytes(len(content))),
    "one bit": (".nbc", lambda content: content[:-9] + bytes([content[-9] ^ 1]) + content[-8:]),
    "half zeroed": (".nbc", lambda content: content[: len(content) // 2] + bytes((len(content) + 1) // 2)),
}


@pytest.mark.slow
@pytest.mark.parametrize(("suffix", "left"), DAMAGES.values(), ids=DAMAGES)
def test_damaged_cache_files_are_replaced(warm, suffix, left):
    for path in files(warm, suffix):
        path.write_bytes(left(path.read_bytes()))
    compiled, loaded, warned = use(warm)
    assert (compiled + loaded, warned) == (3, [])
    assert compiled >= 2, "a file that cannot be trusted is not read"


@pytest.mark.slow
@pytest.mark.parametrize("suffix", [".nbi", ".nbc"])
def test_files_of_another_kernel_or_without_digest_are_replaced(warm, suffix):
    """Of another kernel: complete, with its digest; only the name is wrong."""
    first, *others = files(warm, suffix)
    for path in others:
        for end in ("", ".digest"):
            shutil.copyfile(f"{first}{end}", f"{path}{end}")
    assert use(warm) == (len(others), 3 - len(others), [])
    for path in files(warm, suffix):
        path.with_name(f"{path.name}.digest").unlink(missing_ok=True)
    assert use(warm) == (3, 0, [])
    assert use(warm) == (0, 3, [])


@pytest.mark.slow
@pytest.mark.parametrize("place", ["", "kernels"])
def test_a_folder_that_others_may_write_is_refused(warm, place):
    """Compiled kernels are pickles: whoever may write one executes what he likes."""
    (warm / place).chmod(0o777)
    warm.chmod(warm.stat().st_mode | 0o055)
    before = files(warm)
    compiled, loaded, warned = use(warm)
    assert (compiled, loaded) == (3, 0)
    assert len(warned) == 1
    assert f"others may write in `{(warm / place)}`" in warned[0] and "chmod -R go-w" in warned[0]
    assert files(warm) == before
    (warm / place).chmod(0o755)
    assert use(warm) == (0, 3, [])


def test_a_folder_of_another_user_is_refused(tmp_path, monkeypatch):
    monkeypatch.setenv("RACEWAY_CACHE_DIR", str(tmp_path / "cache"))
    make(current_folder())
    assert refusal(current_folder()) is None
    real = Path.stat

    def another_users(self, **options):
        found = real(self, **options)
        return os.stat_result((*found[:4], os.geteuid() + 1, *found[5:]))

    monkeypatch.setattr(Path, "stat", another_users)
    assert "belongs to another user" in refusal(current_folder())


def test_new_folders_are_closed_to_others(tmp_path, monkeypatch):
    monkeypatch.setenv("RACEWAY_CACHE_DIR", str(tmp_path / "cache"))
    before = os.umask(0o002)
    try:
        make(current_folder())
    finally:
        os.umask(before)
    assert (tmp_path / "cache").stat().st_mode & 0o777 == 0o700
    assert refusal(current_folder()) is None


#: A disk that takes nothing more in the cache: for root a folder's mode is no hindrance.
FULL = """
import errno, os, tempfile
real = tempfile.TemporaryFile
def full(*words, dir=None, **named):
    if str(dir).startswith(os.environ["RACEWAY_CACHE_DIR"]):
        raise OSError(errno.EROFS, "Read-only file system")
    return real(*words, dir=dir, **named)
tempfile.TemporaryFile = full
"""


def test_what_lacks_in_a_cache_that_cannot_be_written_is_compiled_after_one_warning(warm):
    path = next(iter(files(warm, ".nbc")))
    path.write_bytes(bytes(path.stat().st_size))
    before = files(warm)
    compiled, loaded, warned = use(warm, FULL)
    assert (compiled, loaded) == (1, 2)
    assert len(warned) == 1 and "cannot be written (Read-only file system) and lacks some kernels" in warned[0]
    assert files(warm) == before


def key_of(package: Path) -> str:
    done = python("-c", "from raceway.storage.kernel_cache import source_key; print(source_key())", cwd=package.parent)
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


def scaled(factor):
    @jit(numba.float64(numba.float64))
    def product(x):
        return factor * x

    return product


def test_variants_of_a_closure_that_compile_at_once_do_not_mix(tmp_path, monkeypatch):
    """Each saw an index without the other, as two processes may."""
    monkeypatch.setattr(raceway.core.jit, "kernel_folder", lambda: opened(tmp_path))
    with monkeypatch.context() as both:
        both.setattr(IndexDataCacheFile, "_load_index", lambda self: {})
        assert [scaled(factor)(1.0) for factor in (2.0, 3.0)] == [2.0, 3.0]
    loaded = clock["loaded"]
    assert [scaled(factor)(1.0) for factor in (2.0, 3.0)] == [2.0, 3.0]
    assert clock["loaded"] == loaded + 2


def around(first, second):
    """A kernel around others, each of which holds what it was made of."""

    @jit(numba.float64(numba.float64))
    def both(x):
        return first(x) + second(x)

    return both


def test_closures_over_closures_are_found_again(tmp_path, monkeypatch):
    """Each is made anew, as in another process: numba then marks the same function by another number."""

    def countdown():
        @numba.njit(numba.float64(numba.float64))
        def down(x):
            return x if x < 1.0 else down(x - 1.0)

        return down

    monkeypatch.setattr(raceway.core.jit, "kernel_folder", lambda: opened(tmp_path))
    for again in (False, True):
        before, files = clock["loaded"], len(list(tmp_path.rglob("*.nbc")))
        made = [around(scaled(2.0), scaled(3.0)), around(scaled(3.0), around(scaled(1.0), countdown()))]
        assert [kernel(4.5) for kernel in made] == [22.5, 18.5]
        assert (clock["loaded"] - before >= 2, len(list(tmp_path.rglob("*.nbc"))) == files) == (again, again)


@jit(numba.float64(Pointer(numba.float64(numba.float64)), numba.float64))
def called(function, x):
    return function(x)


def test_a_kernel_is_called_by_its_address():
    @jit(numba.float64(numba.float64))
    def root(x):
        if x < 0.0:
            raise ValueError("negative")
        return np.sqrt(x)

    assert called(root, 4.0) == 2.0
    with pytest.raises(ValueError, match="negative"):
        called(root, -4.0)
    with pytest.raises(AttributeError, match="address"):
        called(np.sqrt, 4.0)
    with pytest.raises(PluginError, match="does not compile"):
        jit(numba.float64(Pointer(numba.float64(numba.float64))))(lambda function: function(1.0, 2.0)).compile()


def test_variants_of_a_closure_from_two_processes_are_loaded_apart(tmp_path, monkeypatch):
    """numba counts the functions of a process: the symbols of both may have one number."""
    monkeypatch.setattr(raceway.core.jit, "kernel_folder", lambda: opened(tmp_path))
    for factor in (2.0, 3.0):
        monkeypatch.setattr(FunctionIdentity, "_unique_ids", count(10**6))
        scaled(factor).compile()
    loaded, kernels = clock["loaded"], [scaled(2.0), scaled(3.0)]
    for kernel in kernels:
        kernel.compile()
    assert clock["loaded"] == loaded + 2
    assert [called(kernel, 1.0) for kernel in kernels] == [2.0, 3.0]


def test_division_by_zero_is_not_an_exception():
    @jit(numba.float64(numba.float64))
    def inverse(x):
        return 1.0 / x

    assert inverse(0.0) == np.inf


def test_a_kernel_that_creates_arrays_is_refused_by_name():
    @jit(LAW)
    def greedy(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
        copy = np.maximum(-gap, 0.0)
        force[:] = copy

    with pytest.raises(PluginError, match="greedy.*creates arrays"):
        greedy.compile()


def test_a_time_loop_may_create_arrays():
    @jit(numba.float64(numba.int64), allocates=True)
    def total(n):
        return np.ones(n).sum()

    assert total(3) == 3.0


#: Every first use of a kernel.
USES = {
    "called": lambda kernel: kernel(1.0),
    "its address": lambda kernel: kernel.get_compile_result(numba.float64(numba.float64)),
    "its signatures": lambda kernel: kernel.nopython_signatures,
    "called by a kernel": lambda kernel: jit(numba.float64(numba.float64))(lambda x: kernel(x)).compile(),
}


@pytest.mark.parametrize("use_it", USES.values(), ids=USES)
def test_a_kernel_that_numba_cannot_type_is_refused_by_name_at_each_first_use(use_it):
    @jit(numba.float64(numba.float64))
    def untyped(x):
        return sys.getsizeof(x)

    for _ in range(2):
        with pytest.raises(PluginError, match="kernel `test_a_kernel.*<locals>.untyped`"):
            use_it(untyped)


@pytest.mark.parametrize("use_it", USES.values(), ids=USES)
def test_a_kernel_is_compiled_at_its_first_use_and_once(use_it):
    @jit(numba.float64(numba.float64))
    def half(x):
        return 0.5 * x

    before = clock["compiled"] + clock["loaded"]
    assert half.signatures == []
    use_it(half)
    assert clock["compiled"] + clock["loaded"] > before
    if use_it is USES["called by a kernel"]:  # as a part of that one; by itself at the first call from Python
        assert half.signatures == []
        half(3)
    once = clock["compiled"] + clock["loaded"]
    assert half.signatures == [(numba.float64,)]
    assert half(3) == 1.5  # for its one signature, whatever it is given
    assert (clock["compiled"] + clock["loaded"], len(half.signatures)) == (once, 1)


def test_arrays_that_a_kernel_is_not_made_for_are_refused_at_the_first_call():
    @jit(numba.float64(numba.float64[::1]))
    def first(x):
        return x[0]

    with pytest.raises(TypeError, match="No matching definition"):
        first(np.zeros((2, 2)))
    with pytest.raises(TypeError, match="No matching definition"):
        first(np.zeros(4)[::2])
    assert first(np.ones(2)) == 1.0


def test_seconds_of_kernels_that_are_called_are_counted_once():
    @jit(numba.float64(numba.float64))
    def inner(x):
        return x + 1.0

    @jit(numba.float64(numba.float64))
    def outer(x):
        return 2.0 * inner(x)

    kinds = ("compile_s", "load_s")
    before, begun = sum(clock[kind] for kind in kinds), time.perf_counter()
    assert outer(1.0) == 4.0
    assert 0.0 < sum(clock[kind] for kind in kinds) - before <= time.perf_counter() - begun


def test_threads_that_use_a_kernel_first_at_the_same_time_compile_it_once():
    @jit(numba.float64(numba.float64), releases=True)
    def third(x):
        return x / 3.0

    before = clock["compiled"] + clock["loaded"]
    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(third, [3.0] * 8)) == [1.0] * 8
    assert clock["compiled"] + clock["loaded"] == before + 1


def test_a_kernel_is_handed_to_another_process_uncompiled():
    import pickle

    from raceway.extend import square

    assert pickle.loads(pickle.dumps(square)) is square
    done = python("-c", f"import pickle; print(pickle.loads({pickle.dumps(square)!r}).signature.args[0])")
    assert done.stdout.strip() == "array(float64, 1d, C)", done.stderr


@jit(numba.void(numba.float64[:, ::1], numba.int64, numba.float64[::1]))
def _ends(matrix, column, out):
    matrix[-1, column] = 7.0
    out[-1], out[0] = matrix[-1, -1], matrix[1, column - 1]


def test_negative_indices_count_from_the_end() -> None:
    matrix, out = np.arange(6.0).reshape(2, 3), np.zeros(3)
    _ends(matrix, -2, out)
    np.testing.assert_array_equal(matrix, [[0.0, 1.0, 2.0], [3.0, 7.0, 5.0]])
    np.testing.assert_array_equal(out, [3.0, 0.0, 5.0])


#: Two kernels, the second by a process that fails: how many are awaited before and after, counts, and what comes from the cache.
BESIDE = """
import json, sys
from raceway.core import jit, threads
from raceway.core.ring.elimination import cholesky_solve, copy_matrix
threads.usable_cores = lambda: 2
rows = []
for kernel in (cholesky_solve, copy_matrix):
    name = f"{kernel.py_func.__module__}:{kernel.py_func.__qualname__}"
    threads.compile_beside(name)
    rows.append([list(jit.awaited) == [name]])
    kernel.compile()
    rows[-1] += len(jit.awaited), jit.clock["compiled"], jit.clock["loaded"], sum(kernel.stats.cache_hits.values())
    threads.compile_beside.__wrapped__(name)
    rows[-1].append(len(jit.awaited))
    sys.executable = "false"
print(json.dumps(rows))
"""


@pytest.mark.slow
def test_one_process_waits_for_what_another_compiles(tmp_path):
    """Billed as compiled; what a process that ends early leaves is compiled here; what is there is not asked for."""
    done = python("-c", BESIDE, RACEWAY_CACHE_DIR=tmp_path)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout) == [[True, 0, 1, 0, 1, 0], [True, 0, 2, 0, 0, 0]]


PRODUCTS = """
import numpy as np
from numba import float64, void
from raceway import jit


@jit(void(float64[:, ::1], float64[:, ::1], float64[:, ::1]), allocates=True)
def product(a, b, out):
    np.dot(a, b, out)
"""
MULTIPLY = """
import sys
import numpy as np
from raceway.core.ring.elimination import copy_matrix
copy_matrix.compile()
assert "scipy.linalg" not in sys.modules
sys.path.insert(0, ".")
from products import product
a, out = np.arange(4.0).reshape(2, 2), np.empty((2, 2))
product(a, a, out)
print(out.tolist())
"""


def test_compiling_loads_no_linear_algebra_before_a_kernel_multiplies_matrices(tmp_path):
    (tmp_path / "products.py").write_text(PRODUCTS)
    done = python("-c", MULTIPLY, cwd=tmp_path, RACEWAY_CACHE_DIR=tmp_path / "cache")
    assert done.stdout.strip() == "[[2.0, 3.0], [6.0, 11.0]]", done.stderr


def test_the_light_key_is_the_one_that_kernels_are_kept_under():
    from raceway.core.jit import kernel_folder
    from raceway.storage.kernel_cache import current_folder

    folder = kernel_folder()
    assert folder is None or folder.path == current_folder()
