"""What `--set` changes stands in the second line of the title and in the folder's name."""

import json

import pytest

from checks.validation.command_line import EXAMPLES, invoke
from checks.validation.stores import SPEEDS, made
from raceway import SceneError, load_scene, scene_from_dict
from raceway.extend import Page, head, picture, row_key, select, slug
from raceway.testing import b7206c, default_registry, run

SCENE = EXAMPLES / "b7206.toml"
FIRST = "B7206C, 1 kN axial, rig unbalance at 12 000 r/min"


@pytest.mark.parametrize(
    ("title", "changes", "expected"),
    [
        ("T", [], "T"),
        (None, ["load.axial=400"], "file\nload.axial = 400"),
        ("T", ["load.axial=400.0", "supports.tilt=free"], "T\nload.axial = 400, supports.tilt = free"),
        ("T", ["supports.tilt=free", "load.axial=400"], "T\nload.axial = 400, supports.tilt = free"),
        ("T", ["load.axial=1", "load.axial=2"], "T\nload.axial = 2"),
        ("T", ["kinematics.orbiting=true", "load.radial=[0, 1.5]"], "T\nkinematics.orbiting = true, load.radial = [0, 1.5]"),
        ("T\nrotor.mass = 1", ["load.axial=2"], "T\nrotor.mass = 1, load.axial = 2"),  # the scene of a result, changed again
        ("own", ["title=own"], "own"),
    ],
)
def test_the_second_line_says_what_was_changed(title, changes, expected, tmp_path):
    head = "" if title is None else f"title = {json.dumps(title)}\n"
    (tmp_path / "file.toml").write_text(f'{head}[bearing]\npreset = "B7206C"\n')
    assert load_scene(tmp_path / "file.toml", changes).title == expected


def test_an_empty_title_stays_a_mistake_of_a_changed_scene(tmp_path):
    (tmp_path / "file.toml").write_text('title = " "\n[bearing]\npreset = "B7206C"\n')
    with pytest.raises(SceneError, match="title"):
        load_scene(tmp_path / "file.toml", ["load.axial=1"])


def test_other_titles_and_changes_make_other_folders():
    changes = [
        "", "a = 5", "a = -5", "a = 0.5", "a = [0, 5]", "f = x/y", "f = x y", "f = x-y", "k = " + "1, " * 60,
        "k = " + "1, " * 61,
    ]  # fmt: skip
    names = [slug(f"T\n{line}") for line in changes]
    assert names[:3] == ["T", "T-a=5", "T-a=-5"]
    titles = [
        "Подшипник 7206", "Шпиндель 7206", "Ρουλεμάν", "Άξονας", "轴承", "主轴",
        *("x" * 80 + end for end in ("", "a", "b", "a" * 300)),
    ]  # fmt: skip
    names += map(slug, titles)
    assert len(set(names)) == len(names) and max(map(len, names)) < 200
    assert all(name.isascii() for name in names) and not any(set(name) & set('/\\ \n:*?"<>|') for name in names)
    assert slug("Bearing of the spindle, café") == "Bearing-of-the-spindle-cafe" and slug("../..") == "scene"


def test_a_changed_run_overwrites_no_other(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    static = ["--set", "identifier.kind=tangent"]
    loads = {"400": 400.0, "1200": 1200.0, "400.0": 400.0}
    for load in loads:
        assert invoke("run", SCENE, *static, "--set", f"load.axial={load}").exit_code == 0
    found = sorted((tmp_path / "raceway-out").iterdir())
    assert len(found) == 2  # 400 and 400.0 are one scene
    for folder in found:
        result = json.loads((folder / "result.json").read_text())
        load = result["scene"]["load"]["axial"]
        assert folder.name.endswith(f"-identifier.kind=tangent,load.axial={load:g}")
        assert result["title"] == f"{FIRST}\nidentifier.kind = tangent, load.axial = {load:g}"
    screen = invoke("plan", SCENE, "--set", "load.axial=400").stdout.splitlines()
    assert screen[screen.index(FIRST) + 1] == "load.axial = 400"
    assert load_scene(SCENE, ["load.axial=400"]).title == f"{FIRST}\nload.axial = 400"


def test_pictures_pages_and_tables_for_rotor_programs_say_it():
    figure = picture(run(scene_from_dict(b7206c(title="T\nload.axial = 1000"))), "ball_loads")
    assert figure.axes[0].get_title().splitlines()[1:] == ["T", "load.axial = 1000"]
    keys = {row_key(scene_from_dict(b7206c(title=title)), default_registry()) for title in ("one", "two\nload.axial = 1000")}
    assert len(keys) == 1, "a title decides no number"
    page = Page("T\nload.axial = 400", "below")
    assert page.title == "T" and '<p class="subtitle">load.axial = 400<br>below</p>' in page.html()
    data = made({"excitation.speed_rpm": SPEEDS})
    data.attrs["scene"] = json.dumps({**json.loads(data.attrs["scene"]), "title": "T\nload.axial = 400"})
    assert head(select(data, {}))[0].endswith(": T; load.axial = 400")
