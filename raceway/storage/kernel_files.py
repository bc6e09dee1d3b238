"""Files of compiled kernels: a digest beside each, and folders that may only be read.

numba unpickles what it finds and hands machine code to the linker: a file that was cut, zeroed, or is another kernel's ends
the process by a signal.  Here a file without the digest of its name and content is removed before numba sees it.
"""

from __future__ import annotations

import atexit
import hashlib
import shutil
import tempfile
from contextlib import suppress
from pathlib import Path
from uuid import uuid4

import attrs

from raceway.storage.cache_folder import make, refusal, source_key

_DIGEST = ".digest"


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
            return OpenFolder(_linked(folder), reason)
    return reason


def _linked(folder: Path) -> Path:
    """A temporary folder with links to all files of another one, for this process: numba reads in no folder that it cannot write."""
    place = Path(tempfile.mkdtemp(prefix="raceway-kernels-"))
    atexit.register(shutil.rmtree, place, ignore_errors=True)
    for path in folder.rglob("*"):
        beside = place / path.relative_to(folder)
        if path.is_dir():
            beside.mkdir(parents=True, exist_ok=True)
        else:
            beside.parent.mkdir(parents=True, exist_ok=True)
            beside.symlink_to(path.resolve())
    return place


@attrs.frozen
class FilesOfKernel:
    """The cache files of one kernel.

    Attributes
    ----------
    base : how their names begin
    place : folder of numba's for the function's source file
    """

    base: str
    place: Path

    def discard_damaged(self) -> None:
        """Remove what is not what was written; ``OSError`` for what cannot be removed."""
        for path in self._files():
            if not self._sound(path):
                _remove(path)

    def note_digests(self) -> None:
        """Write the digest of each file that has none of its own; best effort: without it, the file is not read again."""
        for path in self._files():
            if not self._sound(path):
                beside = path.with_name(path.name + _DIGEST)
                scratch = path.with_name(f"{beside.name}.tmp.{uuid4().hex[:16]}")
                with suppress(OSError):
                    scratch.write_text(_digest(path), encoding="ascii")
                    scratch.replace(beside)

    def discard(self) -> None:
        """Remove all of them."""
        for path in self._files():
            with suppress(OSError):
                _remove(path)

    def _files(self) -> list[Path]:
        return [path for path in (self.place / f"{self.base}{end}" for end in (".nbi", ".1.nbc")) if path.exists()]

    def _sound(self, path: Path) -> bool:
        try:
            return path.with_name(path.name + _DIGEST).read_text(encoding="ascii") == _digest(path)
        except (OSError, UnicodeDecodeError):
            return False


def _remove(path: Path) -> None:
    path.unlink(missing_ok=True)
    path.with_name(path.name + _DIGEST).unlink(missing_ok=True)


def _digest(path: Path) -> str:
    """Of the content, the name and the program's version: another kernel's file fails it, too."""
    digest = hashlib.blake2b(f"{source_key()} {path.name}\n".encode(), digest_size=16)
    digest.update(path.read_bytes())
    return digest.hexdigest()
