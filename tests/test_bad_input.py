"""Every way to hand in something wrong: one message with path, value, rule and remedy, and the right exit code."""

import json
import os
import re
import subprocess
import sys

import numpy as np
import pytest

from checks.validation.command_line import ARTICLE, MINIMAL, PATIENCE_S, install, invoke, raceway, several
from raceway import SceneError, scene_from_dict
from raceway.extend import read_toml

#: What is set; the path that is named; words of the message.
SCENES = {
    "unknown key": ("load.axail=3", "load.axail", "did you mean 'axial'?"),
    "unknown key of a plug-in": ("contact.stifness=1e15", "contact.stifness", "unknown key"),
    "unknown kind": ("excitation.kind=bidirectonal", "excitation.kind", "did you mean 'bidirectional'?"),
    "unknown word": ("supports.tilt=looked", "supports.tilt", "did you mean 'locked'?"),
    "unknown table": ("beering.ball_count=3", "beering", "did you mean 'bearing'?"),
    "fraction for an integer": ("bearing.ball_count=12.7", "bearing.ball_count", "must be a whole number"),
    "negative number": ("rotor.mass=-1", "rotor.mass", "must be at least 0"),
    "negative length": ("bearing.ball_diameter=-0.01", "bearing.ball_diameter", "must be greater than 0"),
    "NaN": ("load.axial=nan", "load.axial", "must be a finite number"),
    "infinite": ("excitation.speed_rpm=inf", "excitation.speed_rpm", "must be a finite number"),
    "NaN in a list": ("load.radial=[nan, 0.0]", "load.radial", "must be a finite number"),
    "string for a number": ('load.axial="much"', "load.axial", "must be a number, not a string"),
    "number for a string": ("title=3", "title", "must be a string"),
    "true for a number": ("load.axial=true", "load.axial", "must be a number"),
    "number for a switch": ("kinematics.ball_inertia=1", "kinematics.ball_inertia", "must be true or false"),
    "number for a table": ("load=3", "load", "must be a table"),
    "wrong length": ("load.radial=[1.0]", "load.radial", "list of 2 numbers"),
    "conformity at its limit": ("bearing.conformity_inner=0.5", "bearing.conformity_inner", "greater than 0.5"),
    "conformity below": ("bearing.conformity_outer=0.48", "bearing.conformity_outer", "greater than 0.5"),
    "too many balls": ("bearing.ball_count=20", "bearing", "do not fit a pitch circle of 0.046 m: at most 15"),
    "ball larger than the pitch circle": ("bearing.ball_diameter=0.05", "bearing",
        "must be smaller than `pitch_diameter`"),
    "preset with a typo": ("bearing.preset=B7206G", "bearing.preset", "say which); the nearest: B7206E, B7206C"),
    "length whose square is no number": ("bearing.row_distance=1e300", "bearing.row_distance", "less than 1000"),
    "force of zero": ("excitation.unbalance=0", "excitation", "delete the table"),
    "nodal on rigid bodies": ("contact.discretisation=nodal", "contact.discretisation", "use 'resultant'"),
    "largest number": ("integrator.kind=central_difference integrator.steps_per_turn=96 excitation.amplitude=constant excitation.force=1.7e308",
        "integrator.steps_per_turn", "steps per turn are needed"),
    "clearance against angle": ("bearing.radial_clearance=1e-4 bearing.contact_angle_deg=15.0", "bearing",
        "Give one of them"),
    "a beta that is stable below a step": ("integrator.kind=newmark integrator.gamma=0.6", "integrator", "must be at least gamma / 2"),
    "harmonics beyond the samples": ("integrator.kind=newmark integrator.steps_per_turn=24 identifier.kind=sine_fit identifier.harmonics=12",
        "identifier.harmonics", "are 26 unknowns, but 24 samples a turn are recorded: use at most 11 harmonics"),
    "no load": ("load.axial=0", "load.axial", "no load acts"),
    "window": ("identifier.kind=order_tracking identifier.window_turns=20.0", "identifier.window_turns",
        "is longer than the record of 12 turns"),
    "step": ("integrator.kind=central_difference integrator.steps_per_turn=8", "integrator.steps_per_turn",
        "far above the stable step"),
    "--set without =": ("load.axial", "--set load.axial", "for instance load.axial=400"),
    "--set through a value": ("title.part=3", "--set title.part", "is not a table"),
}  # fmt: skip


@pytest.mark.parametrize("case", SCENES)
def test_a_mistake_in_a_scene(case):
    changes, path, words = SCENES[case]
    given = [word for change in re.split(r" (?=[\w.]+=)", changes) for word in ("--set", change)]
    found = invoke("check", ARTICLE, *given)
    assert found.exit_code == 2
    assert found.stdout == ""
    assert f"`{path}`" in found.stderr
    assert words in found.stderr and ("nan" in changes or "nan" not in found.stderr)
    errors = json.loads(invoke("check", ARTICLE, *given, "--json").stdout)["errors"]
    assert [set(error) for error in errors] == [{"path", "value", "message"}] * len(errors)
    assert path in {error["path"] for error in errors}


def test_a_number_that_python_cannot_write_is_a_mistake_like_others():
    with pytest.raises(SceneError, match="`load.axial` = .*: must be a finite number"):
        scene_from_dict({"bearing": {"preset": "B7206C"}, "load": {"axial": 10**5000}})


def test_several_mistakes_are_told_together():
    changes = [
        "load.axial=nan", "bearing.ball_count=12.7", "contact.kind=hrtz", "integrator.turnz=3", "nothing", "rotor.mass=-1",
    ]  # fmt: skip
    found = invoke("run", ARTICLE, *(word for change in changes for word in ("--set", change)), "--json")
    assert found.exit_code == 2
    paths = [error["path"] for error in json.loads(found.stdout)["errors"]]
    expected = {"load.axial", "bearing.ball_count", "contact.kind", "--set nothing", "rotor.mass"}
    assert expected <= set(paths)
    assert len(paths) == len(set(paths)), "each mistake once"


HEAD = '[bearing]\npreset = "B7206C"\n[load]\n'
FILES = {
    "missing": (None, "no such file"), "empty": ("", "is empty"), "blank": ("\n  \n", "is empty"),
    "malformed": ("[bearing\npreset = 3", "is not valid TOML"),
    "malformed value": ('[load]\naxial = 1 000\n[bearing]\npreset = "B7206C"', "at line 2"),
    "not text": (b"\xff\xfe\x00\x01", "is not UTF-8 text"),
    "no bearing": ("[load]\naxial = 3.0", "`bearing`: is required"),
    "nested": (HEAD + "radial = " + "[" * 500 + "]" * 500, "nested too deep"),
    "digits": (HEAD + "axial = " + "9" * 5000, "a number has thousands of digits"),
    "large": (HEAD + "axial = " + "9" * 400, "must be a finite number"),
}  # fmt: skip


@pytest.mark.parametrize("case", FILES)
def test_a_file_that_is_no_scene(case, tmp_path):
    content, words = FILES[case]
    path = tmp_path / "scene.toml"
    if content is not None:
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
    for command in ("check", "run", "plan"):
        found = invoke(command, path)
        assert found.exit_code == 2 and words in found.stderr and "unexpected" not in found.stderr
        assert found.stderr.count("error: ") == 1


def test_a_plug_in_that_fails_to_import(tmp_path):
    install(tmp_path, "broken", "import sys; sys.exit(3)")
    check = ["check", MINIMAL, "--json"]
    found, listed, used = several(
        [check, ["dev", "plugins"], [*check[:2], "--set", "contact.kind=broken"]], PYTHONPATH=tmp_path
    )
    assert found[0] == 0 and json.loads(found[1])["errors"] == []
    assert "warning: plug-in `broken (broken)`: fails to import: SystemExit: 3" in found[2]
    assert listed[0] == 2 and "SystemExit: 3" in listed[2] and "newmark" in listed[1]
    assert used[0] == 2 and "Not loaded: plug-in `broken (broken)`" in used[2]


def test_a_traceback_is_shown_where_it_is_asked_for():
    assert "Traceback" in raceway("check", "nowhere.toml", "--debug").stderr


def test_a_step_above_the_stable_limit_is_refused_with_a_number_that_works(tmp_path):
    explicit = ("run", ARTICLE, "--set", "integrator.kind=central_difference", "--out", tmp_path, "--set")
    found = invoke(*explicit, "integrator.steps_per_turn=10")
    assert found.exit_code == 1 and "above the stable limit" in found.stderr
    least = found.stderr.split("Use at least ")[1].split(",")[0]
    again = invoke(*explicit, f"integrator.steps_per_turn={least}")
    assert again.exit_code == 0, again.stderr


def test_a_file_that_cannot_be_read(tmp_path, monkeypatch):
    path = tmp_path / "scene.toml"
    path.write_text("x = 1")
    monkeypatch.setattr(
        "pathlib.Path.read_bytes", lambda self: (_ for _ in ()).throw(PermissionError(13, "Permission denied"))
    )
    found = invoke("check", path)
    assert found.exit_code == 2
    assert "cannot be read: Permission denied" in found.stderr


def test_a_singular_equilibrium_names_the_free_motion(tmp_path):
    """Two balls on the y axis leave a rotation about it, and one loaded ball leaves the motion across it."""
    scene = ["--set", "load.axial=0", "--set", "load.radial=[100.0, 0.0]", "--set", "supports.tilt=free"]
    found = invoke("run", MINIMAL, *scene, "--set", "bearing.ball_count=2", "--out", tmp_path)
    assert found.exit_code == 1
    assert "the equilibrium is singular: no stiffness against" in found.stderr
    assert "tilt" in found.stderr
    assert (tmp_path / "failure.json").exists()


#: Stable at rest (0.29 ms), far above the limit once the force has pressed the balls (0.01 ms): grows within a turn.
DIVERGING = (
    "integrator.kind=central_difference", "integrator.start=static", "integrator.steps_per_turn=40",
    "load.axial=50", "excitation.unbalance=5e-2", "kinematics.ball_inertia=false",
)  # fmt: skip


def test_a_run_that_diverges_says_when_and_why_and_keeps_the_last_good_state(tmp_path):
    changes = [word for change in DIVERGING for word in ("--set", change)]
    found = invoke("run", ARTICLE, *changes, "--out", tmp_path, "--json")
    assert found.exit_code == 1
    content = json.loads(found.stdout)
    message = content["errors"][0]["message"]
    assert "grew without bound after" in message
    assert "stable limit of explicit steps there" in message
    assert "`integrator.steps_per_turn`" in message
    with np.load(content["last_good_state"]) as state:
        assert {"t", "q", "v", "a", "ball"} <= set(state)
        assert all(np.isfinite(state[name]).all() for name in state)
        assert state["t"] > 0.0
        assert np.abs(state["q"]).max() > 0.0
    failure = json.loads((tmp_path / "failure.json").read_text())
    assert failure["error"]["kind"] == "StabilityError"
    assert not (tmp_path / "result.json").exists()


def test_a_fault_of_the_program_is_one_message(monkeypatch):
    monkeypatch.setattr("raceway.planning.plan.plan_of", lambda problem, **_: 1 / 0)
    found = invoke("check", ARTICLE)
    assert found.exit_code == 1
    assert "unexpected ZeroDivisionError" in found.stderr
    assert "--debug" in found.stderr


def test_a_missing_file_is_told_by_names_that_are_near(tmp_path):
    for name, text in (("pyproject.toml", "[project]"), ("b7206.toml", "[bearing]"), ("broken.toml", "= 1")):
        (tmp_path / name).write_text(text)

    def said(name):
        with pytest.raises(SceneError) as caught:
            read_toml(tmp_path / name)
        return str(caught.value)

    assert "did you mean 'b7206.toml'?" in said("b7260.toml")
    far = said("nofile.toml")
    assert "did you mean" not in far and far.endswith("scenes there: b7206.toml")
    (tmp_path / "b7206.toml").unlink()
    assert said("nofile.toml").endswith("no such file")


def test_a_byte_order_mark_is_no_mistake(tmp_path):
    (tmp_path / "scene.toml").write_bytes(b"\xef\xbb\xbf" + (HEAD + "axial = 1000.0").encode())
    assert invoke("check", tmp_path / "scene.toml").exit_code == 0


def test_numba_without_its_compiler_is_refused(tmp_path):
    found = raceway("run", MINIMAL, "--out", tmp_path, NUMBA_DISABLE_JIT=1)
    assert found.returncode == 2 and "NUMBA_DISABLE_JIT is set" in found.stderr and "unexpected" not in found.stderr


def test_a_reader_that_goes_away_is_no_error():
    command = f"{sys.executable} -m raceway dev schema | head -n 1"
    found = subprocess.run(["bash", "-c", command], capture_output=True, text=True, timeout=PATIENCE_S, check=False)
    assert found.stdout == "{\n"
    assert found.stderr == ""


def test_pipes_and_devices_are_no_scenes(tmp_path):
    os.mkfifo(tmp_path / "pipe.toml")
    for path in (tmp_path / "pipe.toml", "/dev/zero"):
        found = invoke("check", path)
        assert found.exit_code == 2 and "is not a regular file" in found.stderr


def test_consoles_that_are_closed_or_know_ascii_only(tmp_path):
    command = f'"{sys.executable}" -m raceway check "{MINIMAL}" >&-'
    closed = subprocess.run(command, shell=True, capture_output=True, text=True, check=False)
    assert closed.returncode == 0 and closed.stderr == ""
    found = raceway("run", MINIMAL, "--out", tmp_path, LC_ALL="C", COLUMNS=0, PYTHONIOENCODING="ascii", PYTHONUTF8=0)
    assert found.returncode == 0, found.stderr
    assert "N/um" in found.stdout and found.stderr == ""
