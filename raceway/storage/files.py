"""Files that a reader sees whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from raceway.errors import RacewayError


@contextmanager
def scratch_file(path: Path, remedy: str) -> Iterator[Path]:
    """A place beside ``path`` to write at, moved there in the end; folders are made.  An interruption leaves nothing behind.

    Parameters
    ----------
    remedy : sentence for who cannot write there

    Raises
    ------
    RacewayError
        A folder or disk that cannot be written.
    """
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


def write_whole(content: bytes, path: Path) -> Path:
    """Write a file beside its place and move it there; folders are made.  An interruption leaves nothing behind.

    Raises
    ------
    RacewayError
        A folder or disk that cannot be written.
    """
    with scratch_file(path, "Choose another folder with --out.") as scratch:
        scratch.write_bytes(content)
    return path
