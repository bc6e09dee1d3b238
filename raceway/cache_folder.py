"""Where compiled kernels are kept, without importing the compiler: for ``raceway.core.jit`` and ``raceway cache``."""

from __future__ import annotations

import hashlib
import os
import shutil
import sys
from functools import cache
from importlib.metadata import version
from pathlib import Path

import attrs


def cache_root() -> Path:
    """The user's cache folder of this package (``RACEWAY_CACHE_DIR`` overrides it)."""
    if chosen := os.environ.get("RACEWAY_CACHE_DIR"):
        return Path(chosen)
    from platformdirs import user_cache_path

    return user_cache_path("raceway", appauthor=False)


@cache
def source_key() -> str:
    """Hash of the core's sources, where all shared kernels are, and of the versions that produce machine code."""
    digest = hashlib.sha256()
    core = Path(__file__).resolve().parent / "core"
    for path in sorted(core.rglob("*.py")):
        digest.update(path.relative_to(core).as_posix().encode())
        digest.update(path.read_bytes())
    versions = (sys.version, *(version(name) for name in ("numba", "llvmlite", "numpy")))
    digest.update(repr(versions).encode())
    return digest.hexdigest()[:16]


def current_folder() -> Path:
    """The folder of the kernels that belong to these sources and versions; it need not exist."""
    return cache_root() / "kernels" / source_key()


@attrs.frozen
class KernelFolder:
    """One folder of compiled kernels: its name, how many there are, bytes, whether this version reads it."""

    name: str
    kernels: int
    bytes: int
    current: bool


def kernel_folders() -> list[KernelFolder]:
    """All of them, the current one first.

    Raises
    ------
    OSError
        A cache folder that cannot be listed.
    """
    root = cache_root() / "kernels"
    found = []
    for folder in root.iterdir() if root.is_dir() else ():
        if folder.is_dir():
            files = [f for f in folder.rglob("*") if f.is_file()]
            # numba writes one index (.nbi) for each function and one data file (.nbc) for each of its signatures.
            kernels = sum(f.suffix == ".nbc" for f in files)
            size = sum(f.stat().st_size for f in files)
            found.append(KernelFolder(folder.name, kernels, size, folder.name == source_key()))
    return sorted(found, key=lambda f: (not f.current, f.name))


def clear() -> None:
    """Remove every folder of compiled kernels.

    Raises
    ------
    OSError
        What cannot be removed.
    """
    root = cache_root() / "kernels"
    if root.exists():
        shutil.rmtree(root)
