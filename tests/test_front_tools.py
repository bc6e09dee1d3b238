"""compare, sweep, precision, export_ross and view from Python: the command line's numbers, in objects that show themselves."""

import json
import sys

import numpy as np
import pytest

import raceway as rw
from checks.validation.command_line import invoke
from checks.validation.scenes import built_in
from raceway import ConvergenceError, PluginError, RacewayError, SceneError

SCENE = {
    "title": "tools", "bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0},
    "excitation": {"kind": "bidirectional", "speed_rpm": 12000.0, "amplitude": "constant", "force": 10.0},
    "integrator": {"kind": "quasi_static"},
}  # fmt: skip
STATIC = {name: SCENE[name] for name in ("title", "bearing", "load")}
SPEED, SPIN = "excitation.speed_rpm", "kinematics.spin_speed_rpm"
TOML = """
title = "tools"
bearing.preset = "B7206C"
load.axial = 1000.0
excitation = {kind = "bidirectional", speed_rpm = 12000.0, amplitude = "constant", force = 10.0}
integrator.kind = "quasi_static"
"""


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "tools.toml"
    path.write_text(TOML)
    return path


def brief(found):
    """What a console and a notebook show: few lines, one table."""
    html = found._repr_html_()
    return len(repr(found).splitlines()) <= 15 and html.count("<table") == 1


@pytest.fixture(scope="module")
def comparison():
    return rw.compare(SCENE, {"supports.tilt": ["locked", "free"], "load.axial": np.array([400.0, 1000.0])})


def test_compare_gives_the_rows_of_the_command_line(comparison, file, tmp_path):
    axes = ("--vary", "supports.tilt=locked,free", "--vary", "load.axial=400,1000")
    found = json.loads(invoke("compare", file, *axes, "--no-pictures", "--json", "--out", tmp_path / "out").stdout)
    own = json.loads(json.dumps(comparison.to_dict()))
    assert [row["point"] for row in found["rows"]] == [row["point"] for row in own["rows"]]
    for theirs, ours in zip(found["rows"], own["rows"], strict=True):
        assert theirs["result"]["identification"] == ours["result"]["identification"]
    assert found["effects"] == own["effects"] and found["words"] == own["words"]


def test_a_comparison_shows_itself_and_is_labelled(comparison, tmp_path):
    assert brief(comparison)
    starts = {path.suffix: path.read_bytes()[:500] for path in comparison.save(tmp_path, "svg")}
    assert b"<svg" in starts[".svg"] and starts[".png"].startswith(b"\x89PNG")
    data = comparison.to_xarray()
    for row in comparison.rows:
        k = float(data.equivalent_stiffness.sel(row.point))
        assert k == row.result["identification"]["equivalent_stiffness"]
        error = row.result["identification"]["equivalent_stiffness_error"]
        assert float(data.equivalent_stiffness_error.sel(row.point)) == pytest.approx(error, rel=1e-12)
    assert data.equivalent_stiffness.attrs["units"] == "N/m"
    assert comparison.plot().get_xlabel() == "axial load [N]"
    one = rw.compare(SCENE, {"supports.tilt": ["locked", "free"]})
    axes = one.plot()  # a mark for each run, where no axis has numbers
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("tilt", "K [N/µm]")


def test_finished_runs_are_kept_where_a_folder_is_given(tmp_path):
    first = rw.compare(SCENE, {"load.axial": "400:1000:2"}, out=tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {"compare.json", "points.sqlite", ".lock"}
    calls = []
    again = rw.compare(SCENE, {"load.axial": [400, 1000]}, out=tmp_path, progress=lambda *step: calls.append(step))
    assert not calls and again.to_dict()["rows"] == first.to_dict()["rows"]


def test_axes_take_units_text_and_single_values():
    data = rw.sweep(STATIC, {"load.axial": ["0.4 kN", "1 kN"], SPIN: "0:2000:2", "supports.tilt": "free"})
    np.testing.assert_array_equal(data["load.axial"], [400.0, 1000.0])
    assert data.stiffness.shape == (2, 2, 1, 5, 5) and data["load.axial"].attrs["units"] == "N"
    with pytest.raises(SceneError, match="is duplicated in the axis"):
        rw.sweep(STATIC, {"load.axial": [400.0, 400.0]})
    with pytest.raises(SceneError, match="load.axail"):
        rw.sweep(STATIC, {"load.axail": [400.0, 500.0]})


def test_a_sweep_in_memory_is_that_of_a_store_and_leaves_nothing(tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "temporary"))
    (tmp_path / "temporary").mkdir()
    axes = {SPEED: np.linspace(1000.0, 9000.0, 5)}
    free, kept = rw.sweep(SCENE, axes), rw.sweep(SCENE, axes, store=tmp_path / "store")
    assert not list((tmp_path / "temporary").iterdir()) and (tmp_path / "store" / "points.sqlite").is_file()
    for name in ("equivalent_stiffness", "stiffness", "error_total"):
        np.testing.assert_array_equal(free[name], kept[name])
        assert free[name].attrs["units"] and free[name].attrs["long_name"]
    one = rw.run({**SCENE, "excitation": {**SCENE["excitation"], "speed_rpm": 5000.0}})
    assert float(free.equivalent_stiffness.sel({SPEED: 5000.0})) == pytest.approx(one.equivalent_stiffness, rel=1e-9)
    with pytest.raises(RacewayError, match="holds this sweep already, 5 of 5 points done"):
        rw.sweep(SCENE, axes, store=tmp_path / "store")
    again = rw.sweep(SCENE, axes, store=tmp_path / "store", resume=True)
    np.testing.assert_array_equal(again.equivalent_stiffness, kept.equivalent_stiffness)


def test_executors_by_name_or_as_such_give_the_same_bits():
    axes = {"load.axial": [400.0, 700.0, 1000.0]}
    alone = rw.sweep(STATIC, axes, executor=built_in("executor", "serial")())
    beside = rw.sweep(STATIC, axes, executor="processes", workers=1)
    np.testing.assert_array_equal(alone.stiffness, beside.stiffness)
    with pytest.raises(PluginError, match="no executor 'procesess'|'procesess'"):
        rw.sweep(STATIC, axes, executor="procesess")
    with pytest.raises(PluginError, match="has no --workers"):
        rw.sweep(STATIC, axes, workers=2)


def test_a_list_of_points_is_swept():
    data = rw.sweep(
        STATIC, [{"load.axial": 400.0, "supports.tilt": "free"}, {"load.axial": "1 kN", "supports.tilt": "locked"}]
    )
    assert data.sizes["point"] == 2
    np.testing.assert_array_equal(data["load.axial"], [400.0, 1000.0])


def test_a_sweep_without_any_result_is_an_error():
    with pytest.raises(ConvergenceError, match="all 2 points failed; the first: "):
        rw.sweep({**SCENE, "load": {"axial": 0.0}}, {SPEED: [1000.0, 2000.0]})


def test_precision_takes_keys_with_values(tmp_path):
    scene = {**SCENE, "integrator": {"kind": "newmark"}, "rotor": {"mass": 2.0}}
    steps, fine = {"integrator.steps_per_turn": [45, 90]}, {"integrator.steps_per_turn": 720}
    found = rw.precision(scene, steps, reference=fine, repeats=1, out=tmp_path)
    assert brief(found) and (tmp_path / "precision.json").is_file()
    data = found.to_xarray()
    np.testing.assert_array_equal(data.error, [row["error"] for row in found.judged])
    assert data.error[1] < data.error[0]
    assert "error" in found.plot().get_ylabel()


@pytest.fixture(scope="module")
def turning():
    return rw.sweep(SCENE, {SPEED: "2000:18000:5", "load.axial": [400.0, 1000.0]})


def test_coefficients_come_from_a_sweep_or_its_store(turning, tmp_path):
    rw.sweep(SCENE, {SPEED: "2000:18000:5", "load.axial": [400.0, 1000.0]}, store=tmp_path / "store")
    here = rw.export_ross(turning, at={"load.axial": "1 kN"})
    there = rw.export_ross(tmp_path / "store", tmp_path / "bearing.toml", at=["load.axial=1000"])
    for name, values in here.coefficients.columns().items():
        np.testing.assert_array_equal(there.coefficients.columns()[name], values)
    expected = turning.equivalent_stiffness.sel({"load.axial": 1000.0})
    np.testing.assert_array_equal(here.coefficients.stiffness[:, 0, 0], expected)
    assert '["BearingElement_B7206C"]' in (tmp_path / "bearing.toml").read_text()
    assert here.tag == "B7206C" and rw.export_ross(turning, at={"load.axial": 400}, tag="left seat").tag == "left-seat"
    assert brief(here) and here.to_xarray().kyy.attrs["units"] == "N/m"
    assert here.plot().get_xlabel() == "speed [r/min]"
    with pytest.raises(RacewayError, match="is no sweep: give what raceway.sweep returned"):
        rw.export_ross({"kyy": 1.0})
    with pytest.raises(SceneError, match="must be one of 2, 3"):
        rw.export_ross(turning, at={"load.axial": 400}, ross_version=4)


def test_the_notes_say_what_tilt_was_and_that_a_dry_bearing_does_not_damp(turning):
    notes = " ".join(rw.export_ross(turning, at={"load.axial": 1000}).notes)
    assert "tilt locked in these numbers; of the tangent, kyy, with the tilts held, is" in notes
    assert "with them free" in notes
    free = rw.run({**STATIC, "supports": {"tilt": "free"}}).to_dict()["equilibrium"]["kyy_tilts_follow_n_per_m"]
    locked = rw.run(STATIC).stiffness[1, 1]
    assert locked > 5.0 * free  # what the note is worth
    assert ", nearly dry; the rule of thumb" in notes and "damping=C" in notes
    shown = repr(rw.export_ross(turning, at={"load.axial": 1000}))  # these two are not those that fall away
    assert ", nearly dry; the rule" in shown and "in these numbers; of the tangent, kyy" in shown
    given = rw.export_ross(turning, at={"load.axial": 1000}, damping=1000.0)
    assert "next to nothing" not in " ".join(given.notes)


def test_an_element_without_ross_says_what_is_missing(turning, monkeypatch):
    monkeypatch.setitem(sys.modules, "ross", None)
    with pytest.raises(RacewayError, match=r"an element needs ROSS: pip install './packages/raceway-rotor\[ross\]'"):
        rw.export_ross(turning, at={"load.axial": 1000}).element()


def test_stiffness_from_standstill_is_refused_with_the_command_that_gives_it(file, tmp_path):
    refused = invoke("sweep", file, "--grid", f"{SPEED}=0:20000:5", "--out", tmp_path / "refused")
    assert refused.exit_code == 2
    told = " ".join(refused.stderr.split())
    words = f"raceway sweep SCENE --set identifier.kind=tangent --grid {SPIN}=0:20000:21 --out STORE"
    assert words in told and "raceway export STORE --from tangent --ross bearing.toml" in told
    # The commands that it names work, with fewer points.
    swept = invoke(
        "sweep", file, "--set", "identifier.kind=tangent", "--grid", f"{SPIN}=0:20000:5", "--out", tmp_path / "store"
    )
    assert swept.exit_code == 0, swept.output
    path = tmp_path / "bearing.toml"
    found = invoke("export", tmp_path / "store", "--from", "tangent", "--ross", path, "--ross-version", "3", "--json")
    content = json.loads(found.stdout)
    assert content["speed"][0] == 0.0
    for n, k in zip(content["speed"], content["coefficients"]["kyy"], strict=True):
        own = rw.run({**STATIC, "kinematics": {"spin_speed_rpm": n * 30.0 / np.pi}}).stiffness
        assert k == pytest.approx(own[1, 1] - own[1, 0] * own[0, 1] / own[0, 0], rel=1e-6)


@pytest.mark.slow
@pytest.mark.needs("pyvista")
def test_a_view_of_a_result_keeps_its_pictures_in_memory(tmp_path):
    found = rw.view(rw.run(STATIC))
    assert found.files == [] and all(content[:4] == b"\x89PNG" for content in found.pictures.values())
    assert brief(found) and 'src="data:image/png;base64,' in found._repr_html_()
    written = found.save(tmp_path)
    assert {path.name for path in written} == {"bearing.png", "contacts.png", "ball-loads.png"}
    assert found.plot("contacts.png").images
    with pytest.raises(SceneError, match="must be one of bearing.png"):
        found.plot("bearing.gif")
