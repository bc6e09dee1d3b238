"""Files that a user names: what has no end or would fill the memory is refused before it is read."""

from __future__ import annotations

import stat
from pathlib import Path


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
