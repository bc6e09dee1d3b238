"""Scripts of Gmsh (.geo) are programs: they are executed only where the user allowed it, in a child with a time limit.

The language can start any command of the system, write any file and loop for ever.  The child hands back arrays.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from raceway.errors import MeshError, Mistake
from raceway.storage.tables import Tables
from raceway.storage.trust import is_allowed

if TYPE_CHECKING:
    from raceway.core.mesh.hex_mesh import HexMesh

#: Time that a script and its mesh may take [s].
LIMIT_S = 600.0
ARRAYS, REFUSED = "mesh.npz", "refused.json"


def is_script(path: str) -> bool:
    """Whether a file is a program of Gmsh's language."""
    return Path(path).suffix.lower() == ".geo"


def mesh_of_script(mesher: Any, body: str, path: str, copies: int) -> HexMesh:
    """The mesh that a script makes, by a child process.

    Parameters
    ----------
    mesher : ``Gmsh`` with its options;  copies : of the body in the bearing, for the size of all

    Raises
    ------
    MeshError
        A script that was not allowed, takes too long, or fails; what the mesher itself refuses.
    """
    if not is_allowed(path):
        raise MeshError.at(
            f"mesh.{body}",
            path,
            "is a program of Gmsh, which can start any command: nothing of it was executed. Read it; then give the command "
            f"`raceway run` or `raceway mesh` the words --execute {path}, or save the solid as .step or .brep",
        )
    with tempfile.TemporaryDirectory() as folder:
        place = Path(path).resolve()
        asked = {"path": str(place), "method": mesher.method, "element_size": mesher.element_size, "scale": mesher.scale}
        _executed({**asked, "copies": copies, "folder": folder}, place.name, folder)
        refused, arrays = Path(folder) / REFUSED, Path(folder) / ARRAYS
        if refused.is_file():
            found = json.loads(refused.read_text(encoding="utf-8"))
            error = MeshError(found["message"])
            error.mistake = Mistake(*found["mistake"]) if found["mistake"] else None
            raise error
        if not arrays.is_file():
            raise MeshError(f"'{path}' cannot be meshed: the process that executed it ended without a mesh")
        return _read(arrays)


def _executed(asked: Tables, name: str, folder: str) -> None:
    """Let a child execute a script; the child and whatever it started end with this call."""
    words = [sys.executable, "-P", "-m", f"{__name__}_child"]
    paths = {**os.environ, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)}
    child = subprocess.Popen(
        words, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        cwd=folder, env=paths, start_new_session=True,
    )  # fmt: skip
    try:
        child.communicate(json.dumps(asked).encode(), timeout=LIMIT_S)
    except subprocess.TimeoutExpired:
        raise MeshError(f"'{name}' was stopped: it had not ended after {LIMIT_S:g} s") from None
    finally:
        with suppress(ProcessLookupError):
            os.killpg(child.pid, signal.SIGKILL)
        child.wait()


def _read(path: Path) -> HexMesh:
    from raceway.core.mesh.hex_mesh import HexMesh

    with np.load(path, allow_pickle=False) as kept:
        names = [str(name) for name in kept["names"]]
        facets = {name: kept[f"facets_{number}"] for number, name in enumerate(names)}
        return HexMesh(kept["points"], kept["cells"], {}, facets)
