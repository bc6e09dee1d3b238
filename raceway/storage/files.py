"""Files that a reader sees whole or not at all; refusal of those without end, or beyond the memory that is available."""

import json
import math
import os
import re
import resource
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from math import inf
from pathlib import Path
from typing import Any

from raceway.errors import RacewayError


@contextmanager
def scratch_file(path: Path, remedy: str) -> Iterator[Path]:
    """A place beside ``path`` to write at, moved there in the end; folders are made.  An interruption leaves nothing behind.

    RacewayError: A folder or disk that cannot be written.

    remedy : sentence for who cannot write there
    """
    if os.path.isdir(path):  # no question of pathlib's, which ends in an OSError where a name is too long
        raise RacewayError(f"`{path}` cannot be written: it is a folder. {remedy}")
    scratch = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        yield scratch
        scratch.replace(path)
    except OSError as why:
        raise RacewayError(f"`{path}` cannot be written: {why.strerror or why}. {remedy}") from None
    finally:
        with suppress(OSError):
            scratch.unlink(missing_ok=True)


def write_whole(content: bytes | memoryview, path: Path) -> Path:
    """Write a file beside its place and move it there; folders are made.  An interruption leaves nothing behind.

    RacewayError: A folder or disk that cannot be written.
    """
    with scratch_file(path, "Choose another folder with --out.") as scratch:
        scratch.write_bytes(content)
    return path


def writable(folder: Path) -> Path:
    """Refuse a folder that cannot be written before anything is computed; make nothing yet."""
    parent = folder
    while not os.path.exists(parent) and parent != parent.parent:
        parent = parent.parent
    if not parent.is_dir():
        reason = f"`{folder}` cannot be the folder of the results: `{parent}` is a file. Choose another with --out."
        raise RacewayError(reason)
    if not os.access(parent, os.W_OK | os.X_OK):
        raise RacewayError(f"`{folder}` cannot be written: no permission in `{parent}`. Choose another folder with --out.")
    if not os.path.exists(folder):
        # A folder that cannot be made is refused now; an empty one is taken away again.
        try:
            folder.mkdir(parents=True)
            folder.rmdir()
        except OSError as why:
            reason = f"`{folder}` cannot be made: {why.strerror or why}. Choose another folder with --out."
            raise RacewayError(reason) from None
    return folder


#: Memory in which a file of other programs must be read: so many times its size, and so many bytes more.  Text takes 5 to 10
#: times its size while it is parsed, packed arrays of few different values inflate to 20 times theirs.
_TIMES, _MORE = 40, 2**29


def size_of(path: str | Path, most: int) -> int:
    """Bytes of a file that can be read to its end.

    most : bytes that its reader takes

    ValueError: A pipe or a device, or a file that is larger; the sentence follows the file's name.
    OSError: No such file; a folder is left to who opens it.
    """
    status = Path(path).stat()
    if not stat.S_ISREG(status.st_mode) and not stat.S_ISDIR(status.st_mode):
        raise ValueError("is not a regular file: pipes and devices are not read")
    if status.st_size > most:
        raise ValueError(f"has {size_words(status.st_size)}; at most {size_words(most)} are read")
    return status.st_size


def size_words(size: float) -> str:
    """A number of bytes with three digits."""
    for unit in ("bytes", "KiB", "MiB"):
        if size < 1024.0:
            return f"{size:.3g} {unit}"
        size /= 1024.0
    return f"{size:.3g} GiB"


@contextmanager
def memory_for(size: int) -> Iterator[None]:
    """While entered, this process takes no more memory than a file of so many bytes is worth: ``MemoryError`` beyond.

    A limit of the operating system on address space: what C libraries inflate or allocate counts, too.  Where the system does
    not report how much is taken (it is no Linux), there is no limit.
    """
    try:
        pages = int(Path("/proc/self/statm").read_text().split()[0])
    except OSError:
        yield
        return
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    limit = pages * resource.getpagesize() + _TIMES * size + _MORE
    if soft != resource.RLIM_INFINITY:
        limit = min(limit, soft)
    resource.setrlimit(resource.RLIMIT_AS, (limit, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


def why_unreadable(why: OSError | ValueError) -> str:
    """What an exception of reading a text file says to people."""
    return "it is not UTF-8 text" if isinstance(why, UnicodeDecodeError) else getattr(why, "strerror", None) or str(why)


def without_nan(value: Any) -> Any:
    """The same tree with null for numbers that are not finite, and plain Python types."""
    if isinstance(value, dict):
        return {str(k): without_nan(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [without_nan(v) for v in value]
    if hasattr(value, "item"):  # a scalar of numpy
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value


def write_json(content: object, path: Path) -> Path:
    """Write JSON so that a reader sees the old file or the complete new one.

    RacewayError: Folder or disk that cannot be written.
    """
    return write_whole((json.dumps(content, indent=1, allow_nan=False) + "\n").encode(), path)


def slug(title: str) -> str:
    """A folder's name from a title: letters, digits, dots and dashes, at most 80, then what the second line says was changed.

    Accents are left out.  A title with letters of another script, or more of them, ends in a hash of it.  Other changes make another name: where
    letters of them are lost, or more than 100, a hash of all stands at the end.
    """
    import hashlib
    import unicodedata

    first, _, changes = title.partition("\n")
    latin = unicodedata.normalize("NFKD", first)
    text = re.sub(r"[^A-Za-z0-9._]+", "-", "".join(s for s in latin if not unicodedata.combining(s))).strip("-._")
    name = text[:80].strip("-._") or "scene"
    if len(text) > 80 or any(sign.isalnum() and not sign.isascii() for sign in latin):  # titles stay apart
        name += f"-{hashlib.sha256(first.encode()).hexdigest()[:8]}"
    plain = changes.replace(" = ", "=").replace(", ", ",")
    label = re.sub(r"[^A-Za-z0-9._=,+-]+", "-", plain)
    if label != plain or len(label) > 100:
        label = f"{label[:100]}-{hashlib.sha256(plain.encode()).hexdigest()[:8]}"
    return f"{name}-{label}" if label else name


_PROC, _GROUPS = Path("/proc"), Path("/sys/fs/cgroup")

#: Files of a control group by the version of the interface: limit and use [B], and which line of memory.stat may be given back.
_V1 = ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file")

_V2 = ("memory.max", "memory.current", "inactive_file")


def allowed_bytes() -> float:
    """The machine's, its container's or the process's own limit [B]; inf where the system does not say."""
    machine, (own, resident) = _machine("MemTotal"), _own()
    return min(machine, *(limit for limit, _ in _groups()), own - resident)


def available_bytes() -> float:
    """What is left of it [B]: pages of the file cache that the system gives back are not in use."""
    own, resident = _own()
    return max(min(_machine("MemAvailable"), *(limit - usage for limit, usage in _groups()), own - resident), 0.0)


def _machine(entry: str) -> float:
    with suppress(OSError, ValueError, StopIteration):
        lines = (_PROC / "meminfo").read_text().splitlines()
        return 1024.0 * float(next(line for line in lines if line.startswith(f"{entry}:")).split()[1])
    with suppress(AttributeError, ValueError, OSError):  # no Linux
        return float(os.sysconf("SC_PAGE_SIZE")) * float(os.sysconf("SC_PHYS_PAGES"))
    return inf


def _groups() -> list[tuple[float, float]]:
    """Limit and use of the control groups of this process, as containers and job schedulers make them, and of those above."""
    groups = [(inf, 0.0)]
    with suppress(OSError, ValueError):
        for line in (_PROC / "self/cgroup").read_text().splitlines():
            _, kinds, name = line.split(":", 2)
            if kinds and "memory" not in kinds.split(","):
                continue
            root, (limit, usage, idle) = (_GROUPS / "memory", _V1) if kinds else (_GROUPS, _V2)
            place = root / name.strip("/")
            for group in (place, *place.parents):
                with suppress(OSError, ValueError):  # no such file, or "max"
                    most = float((group / limit).read_text())
                    stat = dict(entry.split() for entry in (group / "memory.stat").read_text().splitlines())
                    groups.append((most, float((group / usage).read_text()) - float(stat.get(idle, 0.0))))
    return groups


def _own() -> tuple[float, float]:
    """What ``ulimit -v`` allows, and what the process holds."""
    with suppress(ImportError, ValueError, OSError):
        import resource

        limit = resource.getrlimit(resource.RLIMIT_AS)[0]
        pages = int((_PROC / "self/statm").read_text().split()[0])
        return inf if limit == resource.RLIM_INFINITY else float(limit), float(pages * resource.getpagesize())
    return inf, 0.0
