"""Compiled kernels that a wheel brings, so that a first run compiles nothing: read where all that they were made for is there.

That is the system, the level of the processor, the versions of Python, numba and llvmlite, and the sources (``folder``).  A file begins
with a digest of what follows; one that is not what was written is not read, and its kernel is compiled as in a clone.
``python -m checks.kernels`` makes them.
"""

import hashlib
import pickle
import platform
import sys
import zlib
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm
import numba
from numba.core.serialize import dumps

from raceway.storage.kernel_cache import source_digest

#: What the kernels are compiled for, and the features that llvmlite must find: those of AVX2 processors since 2013.
LEVEL = "x86-64-v3"
_FEATURES = ("avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe")
#: Where a wheel has them, a folder for all that they were made for.
PLACE = Path(__file__).parents[1] / "data" / "kernels"
#: Where kernels that are compiled are written as well; set by ``checks.kernels`` alone.
writing: list[Path] = []


@cache
def folder() -> Path | None:
    """The folder of the kernels that fit this process, or None."""
    config: Any = numba.config
    name = config.CPU_NAME or "host"
    host = llvm.get_host_cpu_features()
    place = PLACE / key()
    fits = name == LEVEL or (name == "host" and all(host.get(feature) for feature in _FEATURES))
    return place if fits and place.is_dir() else None


def key() -> str:
    """Name of the folder: a hash of system, versions and sources."""
    versions = sys.platform, platform.machine(), LEVEL, sys.implementation.cache_tag, version("numba"), version("llvmlite")
    return hashlib.sha256(f"{versions} {source_digest()}".encode()).hexdigest()[:16]


def _path(place: Path, name: str, marks: object) -> tuple[Path, bytes]:
    """File of a kernel, and what its digest covers beside the content: its name and all that decides its machine code."""
    words = repr((name, marks)).encode()
    return place / f"{name}.{hashlib.blake2b(words, digest_size=8).hexdigest()}", words


def read(name: str, marks: object) -> Any:
    """What numba made of a kernel's machine code; None where the wheel has none, or one that was altered."""
    if (place := folder()) is None:
        return None
    path, words = _path(place, name, marks)
    try:
        content = path.read_bytes()
    except OSError:
        return None
    if content[:32] != hashlib.sha256(words + content[32:]).digest():
        return None
    return pickle.loads(zlib.decompress(content[32:]))


def write(name: str, marks: object, payload: object) -> None:
    """Write a kernel for a wheel."""
    for place in writing:
        path, words = _path(place / key(), name, marks)
        path.parent.mkdir(parents=True, exist_ok=True)
        content = zlib.compress(dumps(payload), 9)
        path.write_bytes(hashlib.sha256(words + content).digest() + content)
