"""raceway mesh: numbers, files, picture, refusals."""

from __future__ import annotations

import json
import sys

from tests.command_line import MINIMAL, invoke

COARSE = ("--set", "mesh.kind=structured", "--set", "mesh.element_size=2e-3", "--set", "mesh.nodes_per_semi_axis=1")


def test_mesh_counts_and_files(tmp_path):
    found = invoke("mesh", MINIMAL, *COARSE, "--out", tmp_path, "--json")
    assert found.exit_code == 0, found.output
    content = json.loads(found.stdout)
    assert content["elements"] == sum(body["elements"] for body in content["bodies"].values()) > 1000
    assert content["scaled_jacobian"]["min"] > 0.2
    assert len(content["files"]) == len(content["bodies"]) == 14
    assert sorted(map(str, tmp_path.iterdir())) == sorted(content["files"])


def test_the_picture_needs_no_display(tmp_path, monkeypatch):
    monkeypatch.delenv("DISPLAY", raising=False)
    found = invoke("mesh", MINIMAL, *COARSE, "--out", tmp_path, "--picture")
    assert found.exit_code == 0, found.output
    assert "scaled Jacobian" in found.stdout
    content = (tmp_path / "mesh.png").read_bytes()
    assert content.startswith(b"\x89PNG")
    assert len(content) > 50_000  # an empty picture is smaller


def test_without_pyvista_the_extra_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyvista", None)
    found = invoke("mesh", MINIMAL, *COARSE, "--out", tmp_path, "--picture")
    assert found.exit_code == 2
    assert "raceway[view]" in found.output


def test_sizes_that_cannot_be_meshed_are_refused(tmp_path):
    found = invoke("mesh", MINIMAL, *COARSE, "--set", "mesh.element_size=1.0", "--out", tmp_path)
    assert found.exit_code == 2
    assert "element_size" in found.output
