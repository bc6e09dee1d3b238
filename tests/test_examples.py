"""Every scene in examples/ runs to a finite, sensible result; those with a mesh alone are meshed in tests/mesh."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from raceway import load_scene
from raceway.errors import SceneError
from raceway.run import run

FOLDER = Path(__file__).resolve().parents[1] / "examples"
#: Scenes for `raceway mesh`: bodies that deform are not run yet.
MESHES = {"b7206_article_mesh"}
RUNNING = [path for path in sorted(FOLDER.glob("*.toml")) if path.stem not in MESHES]


@pytest.mark.parametrize("path", RUNNING, ids=lambda path: path.stem)
def test_example_runs(path):
    result = run(load_scene(path)).as_dict()
    json.dumps(result, allow_nan=False)
    found = result["identification"]
    assert found["equivalent_stiffness"] > 1e6
    # Estimates of the parts of the error; a run-up changes its speed while it is looked at.
    assert result["error"]["total"] < (0.05 if found["series"] else 0.01)
    assert result["stability"]["status"] == "completed"


@pytest.mark.parametrize("name", sorted(MESHES))
def test_running_a_mesh_example_is_refused_with_the_reason(name):
    with pytest.raises(SceneError, match="bodies.kind"):
        run(load_scene(FOLDER / f"{name}.toml"))
