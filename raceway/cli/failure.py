"""What a run that failed leaves: its last good state."""

from __future__ import annotations

import io
from contextlib import suppress
from pathlib import Path

import numpy as np

from raceway.errors import RacewayError
from raceway.scene.scene import Scene
from raceway.storage.files import without_nan, write_json, write_whole


def keep_state(error: RacewayError, scene: Scene, folder: Path) -> None:
    """Write ``failure.json`` and, where there are arrays, ``last-good-state.npz``, and say so in the error.

    The result of another run is not the answer of this one: it stays, under the name ``result-older.json``.

    Parameters
    ----------
    error : with ``state``, arrays by name: t [s]; q, v, a (5,) displacement [m, rad] and its rates; ball (Z, 2) [m]
    """
    older = folder / "result.json"
    with suppress(OSError):
        if older.is_file():
            older.replace(older.with_name("result-older.json"))
    arrays = {name: np.asarray(value) for name, value in error.state.items()}
    content = {
        "title": scene.title,
        "error": {"kind": type(error).__name__, "message": str(error)},
        "state": {name: array.tolist() for name, array in arrays.items()},
        "scene": scene.to_dict(),
    }
    try:
        paths = [write_json(without_nan(content), folder / "failure.json")]
        if arrays:
            memory = io.BytesIO()
            np.savez(memory, **arrays)  # type: ignore[arg-type]
            paths.append(write_whole(memory.getvalue(), folder / "last-good-state.npz"))
    except RacewayError as why:
        error.add_note(f"the last good state is lost: {why}")
        return
    error.files = {path.stem.replace("-", "_"): str(path) for path in paths}
    contents = "failure and last good state" if len(paths) > 1 else "failure"
    error.add_note(f"{contents} written: {', '.join(str(path) for path in paths)}")
