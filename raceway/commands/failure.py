"""What a run that failed leaves: the reason, the scene and the last good arrays."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np

from raceway.errors import ConvergenceError
from raceway.files import write_whole
from raceway.result import without_nan, write_json
from raceway.scene import Scene


def save_failure(error: ConvergenceError, scene: Scene, folder: Path) -> list[Path]:
    """Write ``failure.json`` and, where there are arrays, ``last-good-state.npz``.

    Parameters
    ----------
    error : with ``state``, arrays by name: t [s]; q, v, a (5,) displacement [m, rad] and its rates; ball (Z, 2) [m]

    Raises
    ------
    RacewayError
        A folder or disk that cannot be written.
    """
    arrays = {name: np.asarray(value) for name, value in error.state.items()}
    content = {
        "title": scene.title,
        "error": {"kind": type(error).__name__, "message": str(error)},
        "state": {name: array.tolist() for name, array in arrays.items()},
        "scene": scene.as_dict(),
    }
    paths = [write_json(without_nan(content), folder / "failure.json")]
    if arrays:
        memory = io.BytesIO()
        np.savez(memory, **arrays)  # type: ignore[arg-type]
        paths.append(write_whole(memory.getvalue(), folder / "last-good-state.npz"))
    return paths
