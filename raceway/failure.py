"""What a run that failed leaves: the reason, the scene and the last good arrays."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from raceway.errors import ConvergenceError, RacewayError
from raceway.result import without_nan, write_json
from raceway.scene import Scene


def save_failure(error: ConvergenceError, scene: Scene, folder: Path) -> list[Path]:
    """Write ``failure.json`` and, where there are arrays, ``last-good-state.npz``.

    Parameters
    ----------
    error : with ``state``, arrays by name (q, v, a (5,): displacement [m, rad], velocity, acceleration; ball (Z, 2) [m]; t [s])

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
        paths.append(_save_arrays(arrays, folder / "last-good-state.npz"))
    return paths


def _save_arrays(arrays: dict[str, np.ndarray], path: Path) -> Path:
    scratch = path.with_name(f".{path.stem}.{os.getpid()}.npz")
    try:
        np.savez(scratch, **arrays)  # type: ignore[arg-type]
        scratch.replace(path)
    except OSError as why:
        raise RacewayError(f"`{path}` cannot be written: {why.strerror or why}.") from None
    finally:
        scratch.unlink(missing_ok=True)
    return path
