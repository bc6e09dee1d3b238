"""``raceway dev new-scene``: what it writes is right for every bearing of the catalogue, and overwrites nothing."""

import json
import re

import pytest

import raceway as rw
from checks.validation.command_line import PRESETS, invoke


def written(preset, file):
    assert invoke("dev", "new-scene", preset, "--out", file).exit_code == 0
    return file.read_text()


@pytest.mark.parametrize("preset", [*(file.stem for file in PRESETS.glob("*.toml")), "7014C", "7952A5", "NU206", "N1014"])
def test_a_new_scene_has_no_mistakes_and_can_run(preset, tmp_path):
    text = written(preset, tmp_path / "new.toml")
    assert rw.check(text).ok
    assert rw.Scene.from_toml(text).bearing.preset == preset
    assert "" not in [line.partition("#")[2].strip() for line in text.splitlines() if "#" in line], (
        "a comment says something"
    )


@pytest.mark.parametrize("preset", ["B7206C", "6205", "NU206"])
def test_a_new_scene_teaches_what_runs(preset, tmp_path):
    """Every key that it names changes the answer or its cost: none is reported as without effect, and the run ends with K."""
    file = tmp_path / "new.toml"
    written(preset, file)
    # Half the rollers of NU206 are unloaded: the whole unbalance moves it on several motions, whose search takes long.
    result = rw.run(rw.load_scene(file, ["excitation.unbalance=32 g mm"]))
    assert result.K > 1e7 and not any("has no effect" in text for text in result.warnings)
    lessons = [line for line in file.read_text().splitlines() if "=" in line]
    assert len(lessons) >= 8 and all("#" in line or line.startswith("title") for line in lessons)


def test_keys_that_are_comments_can_be_taken_in(tmp_path):
    text = re.sub(r"^# (\w+ = )", r"\1", written("B7206C", tmp_path / "new.toml"), flags=re.MULTILINE)
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
