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


def writable(folder: Path) -> Path:
    """Refuse a folder that cannot be written before anything is computed; make nothing yet."""
    place = folder
    while not os.path.exists(place) and place != place.parent:
        place = place.parent
    if not place.is_dir():
        raise RacewayError(
            f"`{folder}` cannot be the folder of the results: `{place}` is a file. Choose another with --out."
        )
    if not os.access(place, os.W_OK | os.X_OK):
        raise RacewayError(f"`{folder}` cannot be written: no permission in `{place}`. Choose another folder with --out.")
    if not os.path.exists(folder):
        # A folder that cannot be made is refused now; an empty one is taken away again.
        try:
            folder.mkdir(parents=True)
            folder.rmdir()
        except OSError as why:
            raise RacewayError(
                f"`{folder}` cannot be made: {why.strerror or why}. Choose another folder with --out."
            ) from None
    return folder
