"""``raceway dev new-scene``: what it writes is right for every bearing of the catalogue, and overwrites nothing."""

from __future__ import annotations

import json
import re

import pytest

import raceway as rw
from raceway.cli.new_scene import _scene_text
from raceway.framework.registry import default_registry
from raceway.scene.catalogue import _single_presets
from validation.command_line import invoke


@pytest.mark.parametrize("preset", [*_single_presets(), "7014C", "7952A5"])
def test_a_new_scene_has_no_mistakes_and_can_run(preset):
    text = _scene_text(preset, default_registry())
    assert rw.check(text).ok
    assert rw.Scene.from_toml(text).bearing.preset == preset
    assert "" not in [line.partition("#")[2].strip() for line in text.splitlines() if "#" in line], (
        "a comment says something"
    )


def test_keys_that_are_comments_can_be_taken_in():
    text = re.sub(r"^# (\w+ = )", r"\1", _scene_text("B7206C", default_registry()), flags=re.MULTILINE)
    scene = rw.Scene.from_toml(text)
    assert scene.bearing.arrangement == "DB" and scene.bearing.preload == 200.0 and scene.contact.friction == 0.05
    assert rw.check(scene).ok


def test_it_is_written_once(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    found = invoke("dev", "new-scene")
    assert found.exit_code == 0 and "raceway run B7206C.toml" in found.stdout
    (tmp_path / "B7206C.toml").write_text("mine")
    refused = invoke("dev", "new-scene")
    assert refused.exit_code == 2
    assert "`B7206C.toml` exists" in refused.stderr and "--out" in refused.stderr
    assert (tmp_path / "B7206C.toml").read_text() == "mine"
    found = invoke("dev", "new-scene", "B7206E", "--out", "inside/other.toml", "--json")
    assert json.loads(found.stdout) == {"file": "inside/other.toml"}
    assert invoke("check", "inside/other.toml").exit_code == 0
