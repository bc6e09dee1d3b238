"""Folder of the compiled kernels, without importing the compiler: for ``raceway.core.jit`` and ``raceway cache``.

Compiled kernels are pickles, and reading one can execute anything: a folder that someone else may write is refused.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import stat
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


def refusal(folder: Path) -> str | None:
    """Why a folder of the cache must not be read or written; None where it may, or does not exist yet.

    Notes
    -----
    It and what it lies in, up to the root of the cache, belong to the user, or to root, who can replace the program as well;
    nobody else may write there.  Below a folder that is closed to others, their rights do not matter.
    """
    root = cache_root()
    inside = [place for place in (*reversed(folder.parents), folder) if place == root or root in place.parents]
    for place in inside:
        try:
            found = place.stat()
        except (FileNotFoundError, NotADirectoryError):
            return None
        except OSError as why:
            return f"`{place}` cannot be looked at ({why.strerror or why})"
        if found.st_uid not in (os.geteuid(), 0):
            return f"`{place}` belongs to another user (number {found.st_uid})"
        if found.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
            return f"others may write in `{place}`: close it by `chmod -R go-w {place}`, after `raceway cache --clear`"
        if not found.st_mode & (stat.S_IRWXG | stat.S_IRWXO):
            return None
    return None


def make(folder: Path) -> None:
    """Make a folder of the cache, closed to others where it is new.

    Raises
    ------
    OSError
        It cannot be made.
    """
    root = cache_root()
    root.parent.mkdir(parents=True, exist_ok=True)
    for place in (*reversed(folder.parents), folder):
        if place == root or root in place.parents:
            place.mkdir(mode=0o700, exist_ok=True)


@cache
def source_key() -> str:
    """Hash of the sources of core and elastic, where all shared kernels are, and of the versions that produce machine code."""
    digest = hashlib.sha256()
    package = Path(__file__).resolve().parents[1]
    for path in sorted((*package.glob("core/**/*.py"), *package.glob("elastic/*.py"))):
        digest.update(path.relative_to(package).as_posix().encode())
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
