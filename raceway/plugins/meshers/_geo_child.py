"""The child process that executes a script of Gmsh."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np

from raceway.errors import MeshError
from raceway.plugins.meshers._geo import ARRAYS, REFUSED
from raceway.plugins.meshers.gmsh import Gmsh
from raceway.storage.tables import Tables


def main() -> None:
    """The child: execute and mesh the script that standard input names, leave arrays or the refusal in the folder."""
    asked = json.load(sys.stdin)
    folder, path, copies = Path(asked.pop("folder")), asked.pop("path"), asked.pop("copies")
    try:
        mesh = Gmsh(ball=path, **asked).execute(path, copies)
    except MeshError as why:
        mistake = why.mistake and [why.mistake.path, why.mistake.value, why.mistake.message]
        (folder / REFUSED).write_text(json.dumps({"message": str(why), "mistake": mistake}), encoding="utf-8")
        return
    arrays: Tables = {
        "points": mesh.points,
        "cells": mesh.cells,
        "names": np.array(list(mesh.facet_sets), dtype=np.str_),
    }
    arrays |= {f"facets_{number}": members for number, members in enumerate(mesh.facet_sets.values())}
    np.savez(folder / ARRAYS, **arrays)


if __name__ == "__main__":
    main()
