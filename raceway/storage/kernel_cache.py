"""Folder of the compiled kernels, without importing the compiler: for ``raceway.core.jit`` and ``raceway dev cache``.

Compiled kernels are pickles, and reading one can execute anything: a folder that someone else may write is refused.
"""

import atexit
import hashlib
import os
import shutil
import stat
import sys
import tempfile
from contextlib import suppress
from functools import cache
from importlib.metadata import version
from pathlib import Path
from uuid import uuid4

import attrs


def cache_root() -> Path:
    """The user's cache folder of this package (``RACEWAY_CACHE_DIR`` overrides it)."""
    if path := os.environ.get("RACEWAY_CACHE_DIR"):
        return Path(path)
    from platformdirs import user_cache_path

    return user_cache_path("raceway", appauthor=False)


def refusal(folder: Path) -> str | None:
    """Why a folder of the cache must not be read or written; None where it may, or does not exist yet.

    It and what it lies in, up to the root of the cache, belong to the user, or to root, who can replace the program as well;
    nobody else may write there.  Below a folder that is closed to others, their rights do not matter.
    """
    root = cache_root()
    inside = [parent for parent in (*reversed(folder.parents), folder) if parent == root or root in parent.parents]
    for parent in inside:
        try:
            status = parent.stat()
        except (FileNotFoundError, NotADirectoryError):
            return None
        except OSError as why:
            return f"`{parent}` cannot be inspected ({why.strerror or why})"
        if status.st_uid not in (os.geteuid(), 0):
            return f"`{parent}` belongs to another user (number {status.st_uid})"
        if status.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
            return (
                f"others may write in `{parent}`: restrict it by `chmod -R go-w {parent}`, after `raceway dev cache --clear`"
            )
        if not status.st_mode & (stat.S_IRWXG | stat.S_IRWXO):
            return None
    return None


def make(folder: Path) -> None:
    """Make a folder of the cache, closed to others where it is new; OSError where it cannot be made."""
    root = cache_root()
    root.parent.mkdir(parents=True, exist_ok=True)
    for parent in (*reversed(folder.parents), folder):
        if parent == root or root in parent.parents:
            parent.mkdir(mode=0o700, exist_ok=True)


#: Folders whose kernels the sources below name: their place and time are no part of a kernel's key.
SHARED = ("core", "contact_laws", "plugins/excitations")


@cache
def source_digest() -> str:
    """Hash of the sources of the core and of laws and excitations, where all shared kernels are."""
    digest = hashlib.sha256()
    package = Path(__file__).resolve().parents[1]
    for path in sorted(path for folder in SHARED for path in package.glob(f"{folder}/**/*.py")):
        digest.update(path.relative_to(package).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


@cache
def source_key() -> str:
    """Hash of these sources and of the versions that produce machine code."""
    versions = (sys.version, *(version(name) for name in ("numba", "llvmlite", "numpy")))
    return hashlib.sha256(f"{source_digest()} {versions}".encode()).hexdigest()[:16]


def current_folder() -> Path:
    """The folder of the kernels that belong to these sources and versions; it need not exist."""
    return cache_root() / "kernels" / source_key()


@attrs.frozen
class _KernelFolder:
    """One folder of compiled kernels: its name, how many there are, bytes, whether this version reads it."""

    name: str
    kernels: int
    bytes: int
    current: bool


def kernel_folders() -> list[_KernelFolder]:
    """All of them, the current one first; OSError: a cache folder that cannot be listed."""
    root = cache_root() / "kernels"
    folders = []
    for folder in root.iterdir() if root.is_dir() else ():
        if folder.is_dir():
            files = [f for f in folder.rglob("*") if f.is_file()]
            # numba writes one index (.nbi) for each function and one data file (.nbc) for each of its signatures.
            kernels = sum(f.suffix == ".nbc" for f in files)
            size = sum(f.stat().st_size for f in files)
            folders.append(_KernelFolder(folder.name, kernels, size, folder.name == source_key()))
    return sorted(folders, key=lambda f: (not f.current, f.name))


def clear() -> None:
    """Remove every folder of compiled kernels; OSError where one cannot be removed."""
    root = cache_root() / "kernels"
    if root.exists():
        shutil.rmtree(root)


DIGEST = ".digest"


@attrs.frozen
class OpenFolder:
    """A folder that numba reads and writes; ``unwritable`` says why it only stands for one that cannot be written, or is ""."""

    path: Path
    unwritable: str = ""


def opened(folder: Path) -> OpenFolder | str:
    """The folder to use for compiled kernels, or why there is none."""
    if fault := refusal(folder):
        return fault
    try:
        make(folder)
        with tempfile.TemporaryFile(dir=folder) as probe:
            probe.write(b"raceway" * 1024)
            probe.flush()
        return OpenFolder(folder)
    except OSError as why:
        reason = why.strerror or str(why)
    with suppress(OSError):
        if any(folder.iterdir()):
            # A temporary folder with links to all files of another one, for this process: numba reads in no folder that it cannot write.
            links = Path(tempfile.mkdtemp(prefix="raceway-kernels-"))
            atexit.register(shutil.rmtree, links, ignore_errors=True)
            for path in folder.rglob("*"):
                beside = links / path.relative_to(folder)
                if path.is_dir():
                    beside.mkdir(parents=True, exist_ok=True)
                else:
                    beside.parent.mkdir(parents=True, exist_ok=True)
                    beside.symlink_to(path.resolve())
            return OpenFolder(links, reason)
    return reason


@attrs.frozen
class FilesOfKernel:
    """The cache files of one kernel."""

    base: str  # how their names begin
    folder: Path  # folder of numba's for the function's source file

    @property
    def complete(self) -> bool:
        """Whether all of them are there as they were written."""
        files = self._files()
        return len(files) == 2 and all(map(self._sound, files))

    def discard_damaged(self) -> None:
        """Remove what is not what was written; ``OSError`` for what cannot be removed."""
        for path in self._files():
            if not self._sound(path):
                _remove(path)

    def note_digests(self) -> None:
        """Write the digest of each file that has none of its own; best effort: without it, the file is not read again."""
        for path in self._files():
            if not self._sound(path):
                beside = path.with_name(path.name + DIGEST)
                scratch = path.with_name(f"{beside.name}.tmp.{uuid4().hex[:16]}")
                with suppress(OSError):
                    scratch.write_text(digest(path), encoding="ascii")
                    scratch.replace(beside)

    def discard(self) -> None:
        """Remove all of them."""
        for path in self._files():
            with suppress(OSError):
                _remove(path)

    def _files(self) -> list[Path]:
        return [path for path in (self.folder / f"{self.base}{end}" for end in (".nbi", ".1.nbc")) if path.exists()]

    def _sound(self, path: Path) -> bool:
        try:
            return path.with_name(path.name + DIGEST).read_text(encoding="ascii") == digest(path)
        except (OSError, UnicodeDecodeError):
            return False


def _remove(path: Path) -> None:
    path.unlink(missing_ok=True)
    path.with_name(path.name + DIGEST).unlink(missing_ok=True)


def digest(path: Path) -> str:
    """Of the content, the name and the program's version: another kernel's file fails it, too."""
    digest = hashlib.blake2b(f"{source_key()} {path.name}\n".encode(), digest_size=16)
    digest.update(path.read_bytes())
    return digest.hexdigest()
