"""Arrays that are expensive to make, kept on disk under a key of everything that they depend on.

One file an entry: a line of JSON (what it is, arrays, digest) and the arrays' bytes, which are mapped into memory, not
copied: an entry may be as large as a tenth of the memory or more.  A file is written beside its place
and moved there, so that two processes may make the same entry at once; a file that does not match its digest, of which its
key is a part, is made anew.  A folder that others may write is not used.
What was used last stays when the folder grows above its limit.
"""

from __future__ import annotations

import errno
import hashlib
import json
import os
import shutil
import time
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING
from uuid import uuid4

import attrs

from raceway.storage.kernel_cache import cache_root, refusal
from raceway.storage.kernel_cache import make as make_folder
from raceway.storage.tables import ReadTables, Tables

if TYPE_CHECKING:
    import numpy as np

#: Bytes that all entries may take together; the least recently used ones go first.
LIMIT = 8 * 2**30
#: Room that stays free on the disk, over the size of a new entry.
_ROOM = 1.0
_SUFFIX, _FORMAT = ".arrays", 3
#: Arrays begin at multiples of this, as BLAS wants them.
_ALIGNED = 64
#: Age [s] at which a file that is being written has no writer any more.
_ABANDONED = 3600.0


def folder() -> Path:
    """Folder of the entries; it need not exist."""
    return cache_root() / "arrays"


def kept(
    kind: str, label: str, inputs: ReadTables, sources: Iterable[str], make: Callable[[], Mapping[str, np.ndarray]]
) -> dict[str, np.ndarray]:
    """The arrays that ``make`` returns, C-contiguous; from the cache where they are there, then read-only.

    kind : what sort of entry, one word;  label : one short line for people
    inputs : everything that the arrays depend on, by name: numbers, strings, None, arrays, and sequences of these
    sources : files or folders of this package, such as "core/fem/revolution", whose code makes the arrays
    make : makes them, when they are not there

    A folder that cannot be written, or must not be used, costs one warning a process and nothing else.
    """
    if fault := refusal(folder()):
        _warn(f"are not stored: {fault}. Every run computes them again.")
        return _contiguous(make())
    names = tuple(sources)
    digest = hashlib.sha256(f"{_FORMAT} {kind} {_source_key(names)}".encode())
    for name in sorted(inputs):
        digest.update(f"\n{name}=".encode())
        _add(digest, inputs[name])
    path = folder() / f"{digest.hexdigest()[:32]}{_SUFFIX}"
    arrays = _read(path)
    if arrays is not None:
        return arrays
    start = time.process_time()
    arrays_made = _contiguous(make())
    _write(path, kind, label, arrays_made, time.process_time() - start)
    return arrays_made


@attrs.frozen
class Entry:
    """One entry: sort, what it is, bytes, CPU seconds that it took to make, when it was last used [s since 1970]."""

    kind: str
    what: str
    bytes: int
    made_in_s: float
    used: float


def entries() -> list[Entry]:
    """All entries, those used last first; damaged ones are called so.  OSError: a folder that cannot be listed."""
    out = []
    for path in _files():
        with suppress(FileNotFoundError):
            status = path.stat()
            try:
                with path.open("rb") as file:
                    head = json.loads(file.readline())
                entry = Entry(str(head["kind"]), str(head["what"]), status.st_size, float(head["seconds"]), status.st_mtime)
            except (ValueError, KeyError, TypeError):
                entry = Entry("damaged", path.name, status.st_size, 0.0, status.st_mtime)
            out.append(entry)
    return sorted(out, key=lambda e: -e.used)


def clear() -> None:
    """Remove every entry; OSError where one cannot be removed."""
    if folder().exists():
        shutil.rmtree(folder())


def _files() -> list[Path]:
    return sorted(folder().glob(f"*{_SUFFIX}")) if folder().is_dir() else []


def _add(digest: hashlib._Hash, value: object) -> None:
    """One input into the digest, so that no two different inputs give the same bytes."""
    if value is None or isinstance(value, str | bool | int | float):
        digest.update(f"{type(value).__name__}:{value!r};".encode())
        return
    import numpy as np

    if isinstance(value, np.ndarray):
        array = np.ascontiguousarray(value)
        digest.update(f"{array.dtype.str}{array.shape};".encode())
        digest.update(array.tobytes())
    elif isinstance(value, np.generic):
        _add(digest, value.item())
    elif isinstance(value, list | tuple):
        digest.update(f"[{len(value)}".encode())
        for part in value:
            _add(digest, part)
    else:
        raise TypeError(f"{type(value).__name__} cannot be part of a cache's key")


@cache
def _source_key(sources: tuple[str, ...]) -> str:
    digest = hashlib.sha256()
    root = Path(__file__).resolve().parents[1]
    for name in sorted(sources):
        file = root / name
        for path in sorted(file.rglob("*.py")) if file.is_dir() else [file]:
            digest.update(path.relative_to(root).as_posix().encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()


def _contiguous(arrays: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    import numpy as np

    return {name: np.ascontiguousarray(array) for name, array in arrays.items()}


def _read(path: Path) -> dict[str, np.ndarray] | None:
    """The arrays of a file; None when there is none, or a damaged one, which is said and removed."""
    import numpy as np

    try:
        with path.open("rb") as file:
            line = file.readline()
        body = np.memmap(path, dtype=np.uint8, mode="r")[len(line) :] if line else np.zeros(0, dtype=np.uint8)
    except OSError:
        return None
    try:
        head = json.loads(line)
        if head["digest"] != _digest(path.stem, head["arrays"], [body.data]):
            raise ValueError("the digest differs")
        out, at = {}, 0
        for name, (kind, shape) in head["arrays"].items():
            size = int(np.prod(shape, dtype=np.int64)) * np.dtype(kind).itemsize
            out[name] = np.frombuffer(body[at : at + size], dtype=np.dtype(kind)).reshape(shape)
            at += size + -size % _ALIGNED
    except (ValueError, KeyError, TypeError) as why:
        warnings.warn(f"{path} is damaged ({why}): its content is computed again", RuntimeWarning, stacklevel=3)
        with suppress(OSError):
            path.unlink()
        return None
    with suppress(OSError):
        os.utime(path)
    return out


def _digest(key: str, arrays: Tables, parts: Iterable[memoryview | bytes]) -> str:
    digest = hashlib.sha256(f"{key} {json.dumps(arrays)}".encode())
    for part in parts:
        digest.update(part)
    return digest.hexdigest()[:32]


def _chunks(arrays: Mapping[str, np.ndarray]) -> Iterator[memoryview | bytes]:
    for array in arrays.values():
        if array.nbytes:
            yield array.reshape(-1).data.cast("B")
        yield bytes(-array.nbytes % _ALIGNED)


def _write(path: Path, kind: str, label: str, arrays: Mapping[str, np.ndarray], seconds: float) -> None:
    words = {name: [array.dtype.str, list(array.shape)] for name, array in arrays.items()}
    digest = _digest(path.stem, words, _chunks(arrays))
    head = {"kind": kind, "what": label, "seconds": round(seconds, 3), "digest": digest, "arrays": words}
    line = json.dumps(head).encode()
    scratch = path.with_name(f".{path.stem}.{os.getpid()}.{uuid4().hex[:8]}")
    try:
        make_folder(path.parent)
        size, free = sum(array.nbytes for array in arrays.values()), shutil.disk_usage(path.parent).free
        if free < (1.0 + _ROOM) * size:
            raise OSError(errno.ENOSPC, f"{size / 2**30:.2g} GiB to write, {free / 2**30:.2g} GiB free on the disk")
        with scratch.open("wb") as file:
            file.write(line + b" " * (-(len(line) + 1) % _ALIGNED) + b"\n")
            for part in _chunks(arrays):
                file.write(part)
        scratch.replace(path)
    except OSError as why:
        with suppress(OSError):
            scratch.unlink()
        _warn(
            f"cannot be stored in {path.parent} ({why.strerror or why}); the next run computes it again. Set "
            "RACEWAY_CACHE_DIR to a writable folder with space, or free space by raceway dev cache --clear."
        )
        return
    # The least recently used entries above the limit go, and what killed processes left; the newest entry stays.
    entries = []
    for scratch in path.parent.glob(".*"):
        with suppress(OSError):
            if time.time() - scratch.stat().st_mtime > _ABANDONED:
                scratch.unlink()
    for other in _files():
        with suppress(OSError):
            status = other.stat()
            entries.append((other == path, status.st_mtime, status.st_size, other))
    total = sum(size for _, _, size, _ in entries)
    for fresh, _, size, other in sorted(entries, key=lambda f: f[:2]):
        if total <= LIMIT or fresh:
            break
        with suppress(OSError):
            other.unlink()
            total -= size


@cache
def _warn(why: str) -> None:
    warnings.warn(f"the compliances of the bodies {why}", RuntimeWarning, stacklevel=4)
