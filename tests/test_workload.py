"""`--plan` of sweep, band, follow and studies: counts, sizes and times before anything is computed."""

import json

import pytest

import raceway as rw
from checks.validation.command_line import EXAMPLES, invoke

STEADY = EXAMPLES / "minimal.toml"


def planned(*words):
    return json.loads(invoke(*map(str, words), "--plan", "--json").stdout)


def test_sweep_counts_what_rules_refuse_and_writes_nothing(tmp_path):
    # Sticking has no single orbit.
    axes = ("--grid", "integrator.kind=periodic,newmark", "--grid", "contact.friction=0,0.03")
    plan = planned("sweep", STEADY, *axes, "--out", tmp_path / "s")
    assert (plan["points"], plan["looped"], plan["refused"], plan["runs"], plan["stored"]) == (4, 0, 1, 3, 0)
    assert not (tmp_path / "s").exists()
    mistake = invoke("sweep", str(STEADY), "--grid", "excitation.speed_rpm=-5,3000", "--plan")
    assert mistake.exit_code == 2


def test_sweep_predicts_its_size_on_the_disk_and_finds_what_is_stored(tmp_path):
    words = ("sweep", STEADY, "--grid", "load.axial=400:2000:300", "--out", tmp_path / "s")
    plan = planned(*words)
    assert invoke(*map(str, words)).exit_code == 0
    written = sum(file.stat().st_size for file in (tmp_path / "s").iterdir())
    assert written == pytest.approx(plan["predicted_disk_bytes"], rel=0.3)
    assert planned(*words)["stored"] == 300 and planned(*words)["looped"] == 0


def test_points_of_runs_are_planned_each(tmp_path):
    plan = planned(
        "sweep", STEADY, "--set", "integrator.kind=newmark", "--grid", "supports.tilt=locked,free", "--out", tmp_path / "s"
    )
    one = rw.plan(rw.evolve(rw.Scene.from_toml(STEADY), "integrator.kind=newmark"))
    assert plan["runs"] == 2
    assert plan["predicted_wall_s"] == pytest.approx(2.0 * one.predicted_wall_s - one.predicted_once_s, rel=0.3)


@pytest.mark.parametrize("bodies", [{"kind": "rigid"}, {"kind": "condensed"}])
def test_what_a_second_run_does_not_take_again_is_a_part_of_the_whole(bodies):
    still = rw.plan({"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}, "bodies": bodies})
    assert 0.0 < still.predicted_once_s <= still.predicted_wall_s


def test_band_and_follow():
    assert planned("band", STEADY, "--tolerance", "load.axial=±10 %", "--samples", 64)["looped"] == 3 * 64
    assert planned("band", STEADY, "--by", "load.axial")["points"] == 1
    follow = planned("follow", STEADY, "--over", "load.axial=2000:300", "--points", 50)
    assert follow["points"] == 50 and follow["predicted_at_most"]


def test_studies():
    assert planned("study", "rig", EXAMPLES / "test_rig.toml")["points"] == 6
    article = planned("study", "article", "--bodies", "rigid", "--speeds", "11000:15000:3", "--axial", "400,1000,2000")
    # 24 settings without friction, which loops have, and 12 with it, which go through time; three loads and speeds each.
    assert (article["looped"], article["runs"], article["points"]) == (216, 108, 324)
