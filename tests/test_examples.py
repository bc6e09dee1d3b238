"""Every scene in examples/ runs to a finite, sensible result."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from raceway import load_scene
from raceway.run import run

FOLDER = Path(__file__).resolve().parents[1] / "examples"


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.toml")), ids=lambda path: path.stem)
def test_example_runs(path):
    result = run(load_scene(path)).as_dict()
    json.dumps(result, allow_nan=False)
    found = result["identification"]
    assert found["equivalent_stiffness"] > 1e6
    # Estimates of the parts of the error; a run-up changes its speed while it is looked at.
    assert result["error"]["total"] < (0.05 if found["series"] else 0.01)
    assert result["stability"]["status"] == "completed"
