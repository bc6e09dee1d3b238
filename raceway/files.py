"""Files that a reader sees whole or not at all."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

from raceway.errors import RacewayError


def write_whole(content: bytes, path: Path) -> Path:
    """Write a file beside its place and move it there; folders are made.  An interruption leaves nothing behind.

    Raises
    ------
    RacewayError
        A folder or disk that cannot be written.
    """
    scratch = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        scratch.write_bytes(content)
        scratch.replace(path)
    except OSError as why:
        raise RacewayError(f"`{path}` cannot be written: {why.strerror or why}. Choose another folder with --out.") from None
    finally:
        with suppress(OSError):
            scratch.unlink(missing_ok=True)
    return path
