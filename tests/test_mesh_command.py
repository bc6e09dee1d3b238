"""raceway mesh: numbers, files, picture, refusals."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

from raceway.plugins.formats.vtu import Vtu
from tests.test_commands import COARSE
from validation.command_line import EXAMPLES, MINIMAL, invoke, raceway


def test_mesh_counts_and_files(tmp_path):
    found = invoke("mesh", MINIMAL, *COARSE, "--out", tmp_path, "--json")
    assert found.exit_code == 0, found.output
    content = json.loads(found.stdout)
    assert content["elements"] == sum(body["elements"] for body in content["bodies"].values()) > 1000
    assert content["scaled_jacobian"]["min"] > 0.2
    assert len(content["bodies"]) == 14
    assert [Path(name).name for name in content["files"]] == ["inner_ring.vtu", "outer_ring.vtu", "balls.vtu"]
    assert sorted(map(str, tmp_path.iterdir())) == sorted(content["files"])
    balls = Vtu().read(tmp_path / "balls.vtu")
    sizes = {name: body["elements"] for name, body in content["bodies"].items() if name.startswith("ball")}
    assert len(balls.cells) == sum(sizes.values()) and set(sizes) <= set(balls.node_sets)


def test_a_format_goes_by_the_ending_of_its_files_too(tmp_path):
    for word in ("inp", "abaqus"):
        found = invoke("mesh", MINIMAL, *COARSE, "--format", word, "--out", tmp_path / word)
        assert found.exit_code == 0, found.output
    assert (tmp_path / "inp/balls.inp").read_bytes() == (tmp_path / "abaqus/balls.inp").read_bytes()


def test_without_pyvista_the_extra_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyvista", None)
    found = invoke("mesh", MINIMAL, *COARSE, "--out", tmp_path, "--picture")
    assert found.exit_code == 2
    assert "pip install '.[view]'" in found.output


@pytest.mark.needs("pyvista")
def test_a_picture_without_a_display_is_silent(tmp_path):
    words = ("mesh", MINIMAL, *COARSE, "--out", tmp_path, "--picture")
    found = raceway(*words, DISPLAY="", PYTHONWARNINGS="always")
    assert found.returncode == 0 and found.stderr == "", found.stderr
    content = (tmp_path / "mesh.png").read_bytes()
    assert content.startswith(b"\x89PNG") and len(content) > 50_000  # an empty picture is smaller


def test_the_axial_load_sets_the_patch(tmp_path):
    widths = []
    for axial in (50.0, 5000.0):
        found = invoke("mesh", MINIMAL, *COARSE, "--set", f"load.axial={axial}", "--out", tmp_path, "--json")
        widths.append(json.loads(found.stdout)["patch_size_m"]["short"]["min"])
    # Semi-axes go with the cube root of a ball's load; 100 times the axial load, on a contact angle that grows, is 3 to 4.7.
    assert 3.0 < widths[1] / widths[0] < 4.7


MESHER = '''
import attrs
import numpy as np
from types import SimpleNamespace
from raceway import hookimpl

@attrs.frozen
class Wrong:
    """A mesher of a test."""

    name = "wrong"

    def mesh(self, bearing):
        corner = [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
        points = 0.01 * np.array(corner, dtype=float)
        return {answer}

@hookimpl
def raceway_meshers():
    return [Wrong]
'''
FLIPPED = '{"ball_0": SimpleNamespace(points=points, cells=np.array([[4, 5, 6, 7, 0, 1, 2, 3]]))}'


@pytest.mark.parametrize(
    ("number", "answer", "words"),
    [
        (1, "None", "mesher 'wrong': mesh() returned NoneType; it must be meshes by name"),
        (2, FLIPPED, "`ball_0`: 1 of 1 cells are inverted or degenerate"),
        (3, '{"ball_0": points}', "mesher 'wrong': body 'ball_0' is no mesh"),
        (4, '{"inner_ring": SimpleNamespace(points=1e3 * points, cells=np.arange(8)[None])}', "must return metres"),
    ],
)
def test_what_a_plug_in_mesher_must_not_return(tmp_path, number, answer, words):
    name = f"wrong_{number}"  # the plug-ins of a process are kept: each case has a name of its own
    words = words.replace("'wrong'", f"'{name}'")
    (tmp_path / "wrong.py").write_text(MESHER.replace("{answer}", answer).replace('"wrong"', f'"{name}"'))
    found = invoke(
        "mesh", MINIMAL, "--plugin", tmp_path / "wrong.py", "--set", f"mesh.kind={name}", "--out", tmp_path / "out"
    )
    assert found.exit_code == 2
    assert words in " ".join(found.output.split())


def test_the_documents_mesher_runs(tmp_path):
    text = (EXAMPLES.parent / "docs" / "plugins.md").read_text(encoding="utf-8")
    (tmp_path / "one_cell.py").write_text(text.split("# one_cell.py\n")[1].split("```")[0])
    words = ("mesh", MINIMAL, "--plugin", tmp_path / "one_cell.py", "--set", "mesh.kind=one_cell")
    found = invoke(*words, "--out", tmp_path / "out", "--json")
    assert found.exit_code == 0
    assert json.loads(found.stdout)["elements"] == 1
