"""The ROSS that is installed, or a sentence about what is missing."""

from __future__ import annotations

import contextlib
import os
import sys
import warnings
from collections.abc import Iterator
from typing import Any

from raceway.errors import RacewayError, extra
from raceway.studies.ross.file import GENERATIONS


def ross(asked_by: str, least: int = GENERATIONS[0]) -> Any:
    """The package ``ross``, imported without what its own packages print while they are loaded.

    Parameters
    ----------
    asked_by : what needs it, for the message;  least : generation that it needs

    Raises
    ------
    RacewayError
        ROSS is missing, cannot be imported, or is older.
    """
    try:
        with _silence():
            import ross as found
    except ImportError as why:
        raise RacewayError(f"{asked_by} needs ROSS: {extra('ross')} ({why})") from None
    version = str(getattr(found, "__version__", "of no version"))
    if generation(found) < least:
        raise RacewayError(f"{asked_by} needs ROSS {least}.0 or later, and {version} is installed here: {extra('ross')}")
    return found


def generation(found: Any) -> int:
    """Major number of a ROSS; 0 where it tells none."""
    major = str(getattr(found, "__version__", "")).partition(".")[0]
    return int(major) if major.isdigit() else 0


@contextlib.contextmanager
def _silence() -> Iterator[None]:
    """Streams of the process, whose compiled packages write past Python."""
    if "ross" in sys.modules:
        yield
        return
    try:
        kept = [os.dup(stream) for stream in (1, 2)]
    except OSError:  # no such streams
        yield
        return
    nowhere = os.open(os.devnull, os.O_WRONLY)
    sys.stdout.flush()
    try:
        for stream in (1, 2):
            os.dup2(nowhere, stream)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        sys.stdout.flush()
        for stream, old in zip((1, 2), kept, strict=True):
            os.dup2(old, stream)
            os.close(old)
        os.close(nowhere)
