"""A motion on disk, from which an integration goes on as if it had never stopped."""

from __future__ import annotations

import zipfile
from pathlib import Path

import attrs
import numpy as np

from raceway.core.stepping.record import Motion
from raceway.errors import RacewayError

_WHOLE = "whole."


def save_motion(motion: Motion, path: Path) -> Path:
    """Write all arrays of a motion, bit for bit; returns the file's path (``.npz``).

    Raises
    ------
    RacewayError
        A file that cannot be written.
    """
    arrays = {name: value for name, value in attrs.asdict(motion, recurse=False).items() if isinstance(value, np.ndarray)}
    arrays |= {_WHOLE + name: value for name, value in (motion.whole or {}).items()}
    path = path.with_suffix(".npz")
    partial = path.with_suffix(".part.npz")
    try:
        np.savez(partial, **arrays)  # type: ignore[arg-type]
        partial.replace(path)  # a reader sees the old file or the whole new one
    except OSError as why:
        raise RacewayError(f"the state cannot be written to {path}: {why.strerror or why}") from why
    return path


def load_motion(path: Path) -> Motion:
    """Read what ``save_motion`` wrote.

    Raises
    ------
    RacewayError
        A file that is missing, damaged, or no motion.
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        whole = {name.removeprefix(_WHOLE): arrays.pop(name) for name in list(arrays) if name.startswith(_WHOLE)}
        return Motion(**arrays, whole=whole or None)
    except (OSError, ValueError, TypeError, zipfile.BadZipFile) as why:
        raise RacewayError(f"{path} holds no motion to go on from: {why}") from why
