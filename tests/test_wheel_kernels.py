"""Compiled kernels that a wheel brings: read where they fit, otherwise compiled as in a clone, with the same numbers."""

import json
import platform

import pytest

from checks.validation.command_line import python

pytestmark = pytest.mark.skipif(platform.machine() != "x86_64", reason="wheels bring kernels for x86-64")

LEVEL = {"NUMBA_CPU_NAME": "x86-64-v3", "NUMBA_CPU_FEATURES": ""}
USE = """
import json
from pathlib import Path
import numpy as np
from raceway.core import wheel_kernels
{before}
from raceway.core.ring.system import no_force
from raceway.core.jit import clock
out = np.ones(5)
no_force(0.0, np.zeros(0), out)
print(json.dumps([out.tolist(), clock["of_wheel"], clock["compiled"]]))
"""


def use(before, cache, **environment):
    """(kernels of the wheel, kernels compiled) of a process that calls one kernel."""
    done = python("-c", USE.format(before=before), RACEWAY_CACHE_DIR=cache, **environment)
    assert done.returncode == 0, done.stderr
    out, arrived, compiled = json.loads(done.stdout)
    assert out == [0.0] * 5
    return arrived, compiled


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """A folder as in a wheel, and a place for caches; numba takes the name of the level as a processor's."""
    folder = tmp_path_factory.mktemp("wheel")
    assert use(f"wheel_kernels.writing.append(Path({str(folder / 'kernels')!r}))", folder / "cache", **LEVEL) == (0, 1)
    return folder


def placed(folder, more=""):
    return f"wheel_kernels.PLACE = Path({str(folder / 'kernels')!r}){more}"


def test_a_first_run_compiles_nothing(wheel, tmp_path):
    assert use(placed(wheel), tmp_path, **LEVEL) == (1, 0)


@pytest.mark.slow
@pytest.mark.parametrize("cpu", ["generic", "nehalem"])
def test_a_processor_without_avx2_compiles(wheel, tmp_path, cpu):
    assert use(placed(wheel), tmp_path, NUMBA_CPU_NAME=cpu, NUMBA_CPU_FEATURES="") == (0, 1)


@pytest.mark.slow
@pytest.mark.parametrize(
    "change",
    ["; wheel_kernels.version = lambda name: '0.1'", "; wheel_kernels.source_digest = lambda: 'another source'"],
    ids=["another numba", "other sources"],
)
def test_kernels_of_other_versions_are_left_alone(wheel, tmp_path, change):
    assert use(placed(wheel, change), tmp_path, **LEVEL) == (0, 1)


@pytest.mark.slow
def test_an_altered_kernel_is_not_read(wheel, tmp_path):
    (path,) = [path for path in (wheel / "kernels").rglob("*") if path.is_file()]
    content = path.read_bytes()
    place = tmp_path / "kernels" / path.parent.name
    place.mkdir(parents=True)
    (place / path.name).write_bytes(content[:-1] + bytes([content[-1] ^ 1]))
    assert use(placed(tmp_path), tmp_path / "cache", **LEVEL) == (0, 1)
