"""Files that a user names: what has no end or would fill the memory is refused before it does."""

from __future__ import annotations

import resource
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

#: Memory in which a file of other programs must be read: so many times its size, and so many bytes more.  Text takes 5 to 10
#: times its size while it is parsed, packed arrays of few different values inflate to 20 times theirs.
_TIMES, _MORE = 40, 2**29


def size_of(path: str | Path, most: int) -> int:
    """Bytes of a file that can be read to its end.

    Parameters
    ----------
    most : bytes that its reader takes

    Raises
    ------
    ValueError
        A pipe or a device, or a file that is larger; the sentence follows the file's name.
    OSError
        No such file; a folder is left to who opens it.
    """
    status = Path(path).stat()
    if not stat.S_ISREG(status.st_mode) and not stat.S_ISDIR(status.st_mode):
        raise ValueError("is no file: a pipe or a device has no end that can be waited for")
    if status.st_size > most:
        raise ValueError(f"has {told(status.st_size)}; at most {told(most)} are read")
    return status.st_size


def told(size: float) -> str:
    """A number of bytes with three digits."""
    for unit in ("bytes", "KiB", "MiB"):
        if size < 1024.0:
            return f"{size:.3g} {unit}"
        size /= 1024.0
    return f"{size:.3g} GiB"


@contextmanager
def memory_for(size: int) -> Iterator[None]:
    """While entered, this process takes no more memory than a file of so many bytes is worth: ``MemoryError`` beyond.

    Notes
    -----
    A limit of the operating system on address space: what C libraries inflate or allocate counts, too.  Where the system does
    not tell how much is taken (it is no Linux), there is no limit.
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
    if isinstance(why, UnicodeDecodeError):
        return "it is not UTF-8 text"
    return getattr(why, "strerror", None) or str(why)
