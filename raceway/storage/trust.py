"""Programs that whoever gave the command allowed to be executed.  A scene can name a program, but never allow it."""

from __future__ import annotations

from pathlib import Path

_ALLOWED: set[Path] = set()


def allow(path: str | Path) -> None:
    """Allow one file to be executed by this process, for as long as it lives."""
    _ALLOWED.add(Path(path).resolve())


def is_allowed(path: str | Path) -> bool:
    """Whether this very file was allowed."""
    return Path(path).resolve() in _ALLOWED
