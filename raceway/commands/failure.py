"""Files of a run that failed: the reason, the scene and the last good arrays."""

from __future__ import annotations

import io
from contextlib import suppress
from pathlib import Path

import numpy as np

from raceway.errors import RacewayError
from raceway.pipeline.result import without_nan, write_json
from raceway.scene.scene import Scene
from raceway.storage.files import write_whole


def save_failure(error: RacewayError, scene: Scene, folder: Path) -> list[Path]:
    """Write ``failure.json`` and, where there are arrays, ``last-good-state.npz``; an older ``result.json`` is renamed.

    Parameters
    ----------
    error : with ``state``, arrays by name: t [s]; q, v, a (5,) displacement [m, rad] and its rates; ball (Z, 2) [m]

    Raises
    ------
    RacewayError
        A folder or disk that cannot be written.
    """
    _set_aside(folder / "result.json")
    arrays = {name: np.asarray(value) for name, value in error.state.items()}
    content = {
        "title": scene.title,
        "error": {"kind": type(error).__name__, "message": str(error)},
        "state": {name: array.tolist() for name, array in arrays.items()},
        "scene": scene.to_dict(),
    }
    paths = [write_json(without_nan(content), folder / "failure.json")]
    if arrays:
        memory = io.BytesIO()
        np.savez(memory, **arrays)  # type: ignore[arg-type]
        paths.append(write_whole(memory.getvalue(), folder / "last-good-state.npz"))
    return paths


def forget_failure(folder: Path) -> None:
    """Remove what an earlier run that failed left beside a new result."""
    for name in ("failure.json", "last-good-state.npz"):
        with suppress(OSError):
            (folder / name).unlink(missing_ok=True)


def _set_aside(result: Path) -> None:
    """The result of another run is not the answer of this one: it stays, under the name ``result-older.json``."""
    with suppress(OSError):
        if result.is_file():
            result.replace(result.with_name("result-older.json"))
