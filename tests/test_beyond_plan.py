"""Runs far beyond their plan are stopped, say so, and leave what they have."""

import inspect
import json

import numpy as np
import pytest

from checks.validation.command_line import ARTICLE, invoke
from checks.validation.several import article
from raceway import BeyondPlanError, SceneError, check, load_scene, make_plan, plan, scene_from_dict
from raceway.cli.main import main
from raceway.testing import PATIENCE, Allowance, run
from tests.core.test_elastic_scene import QUICK
from tests.core.test_elastic_scene import scene as elastic_scene

LONG = ("--set", "integrator.turns=120")  # 43 200 steps: more than one chunk


class Clock:
    """Processor time that passes when it is told to."""

    def __init__(self, monkeypatch):
        self.now = 0.0
        monkeypatch.setattr("raceway.pipeline.run.working_processor_time", lambda: self.now)


def test_a_run_far_beyond_its_plan_is_stopped_and_keeps_its_state(tmp_path):
    """No time is measured: no run takes less than nothing."""
    found = invoke("run", ARTICLE, *LONG, "--patience", "0", "--out", tmp_path, "--json")
    assert found.exit_code == 1
    content = json.loads(found.stdout)
    message = content["errors"][0]["message"]
    assert "stopped far beyond the plan, in newmark, 43200 steps, 20000 of 43200 done" in message
    assert "over 0 times the planned" in message and "`raceway run --patience`" in message
    with np.load(content["last_good_state"]) as state:
        assert set(state) == {"t", "q", "v", "a", "ball"}
        assert all(np.isfinite(state[name]).all() for name in state)
        assert state["t"] > 0.0
    assert json.loads((tmp_path / "failure.json").read_text())["error"]["kind"] == "BeyondPlanError"


def test_a_motion_that_is_complete_is_kept_without_its_error():
    """Beyond the plan when the last step is done, or in a search that no step interrupts: Z is there."""
    scene = load_scene(ARTICLE)
    whole, late = run(scene), run(scene, patience=0.0)
    assert late.identification.dynamic_stiffness == whole.identification.dynamic_stiffness
    assert late.error["total"] is None
    assert late.warnings[0].startswith("the error is not estimated, because the run far exceeded its plan: ")
    assert not any("exceeded its plan" in text for text in whole.warnings)


@pytest.mark.slow
def test_a_stepped_motion_keeps_its_state(monkeypatch):
    """Elastic bodies are stepped from Python; the allowance is spent at the first report after the equilibrium."""
    monkeypatch.setattr("raceway.core.recorder._REPORT_S", 0.0)
    monkeypatch.setattr(Allowance, "spent", False)

    def progress(what, done, total):
        if total and done == 3:
            monkeypatch.setattr(Allowance, "spent", True)

    with pytest.raises(BeyondPlanError, match="3 of [0-9]+ done") as caught:
        run(elastic_scene(**QUICK), on_progress=progress)
    assert {"t", "q", "v", "a", "ball"} <= set(caught.value.state)


def test_a_search_that_is_stopped_tells_no_error(monkeypatch):
    """Three motions exist; the first one that a search meets is another one than the ramp settles on."""
    check = Allowance.check

    def stop(self, what, done, total):
        if what == "the steady motion":
            raise BeyondPlanError("stopped far beyond the plan")
        check(self, what, done, total)

    monkeypatch.setattr("raceway.pipeline.simulate.last_turn", lambda *_: None)
    scene = scene_from_dict(article(800.0, start="ramp", turns=24))
    whole = run(scene)
    monkeypatch.setattr(Allowance, "check", stop)
    stopped = run(scene)
    assert whole.error["transient"] > 0.0
    assert stopped.error["transient"] is None and stopped.error["total"] is None
    assert "the search for the steady motion was stopped far beyond the plan" in stopped.error["how"]["transient"]


def test_a_search_for_orbits_that_is_stopped_stops_the_run(monkeypatch):
    def stop(_self, what, done, total):
        if what == "the search for orbits":
            raise BeyondPlanError("stopped far beyond the plan")

    monkeypatch.setattr(Allowance, "check", stop)
    with pytest.raises(BeyondPlanError):
        run(scene_from_dict(article(800.0)))


def test_only_many_times_the_plan_is_beyond_it(monkeypatch):
    clock = Clock(monkeypatch)
    allowance = Allowance(planned=10.0, patience=PATIENCE)
    clock.now = 10.0 * PATIENCE
    allowance.check("steps", 1, 2)
    clock.now += 1.0
    with pytest.raises(BeyondPlanError):
        allowance.check("steps", 1, 2)
    allowance.check("steps", 2, 2)


def test_short_plans_count_as_three_seconds(monkeypatch):
    clock = Clock(monkeypatch)
    plan = type("Plan", (), {"predicted_wall_s": 0.01, "predicted_bytes": 0, "at_least": False})()
    allowance = Allowance.of(plan, PATIENCE)
    clock.now = 59.0
    assert not allowance.spent
    clock.now = 61.0
    assert allowance.spent


def test_the_command_and_the_function_have_one_patience():
    option = next(p for p in main.get_command(None, "run").params if p.name == "patience")
    assert option.default == inspect.signature(run).parameters["patience"].default == PATIENCE


def test_a_search_for_steady_motions_is_stopped_between_their_points(tmp_path):
    """What the search makes of being stopped, it tries elsewhere, is not the answer."""
    words = ["--set", "excitation.kind=unidirectional", "--set", "supports.tilt=free", "--set", "integrator.kind=periodic"]
    found = invoke(
        "run", ARTICLE, *words, "--set", "excitation.unbalance=2e-3", "--patience", "0", "--out", tmp_path, "--json"
    )
    assert found.exit_code == 1, found.output
    assert "stopped far beyond the plan, in periodic" in json.loads(found.stdout)["errors"][0]["message"]


def test_memory_beyond_the_plan_stops_a_run(monkeypatch):
    """Growth since the run began counts: what a process held before is not its own."""
    held = [3e9]
    monkeypatch.setattr("raceway.pipeline.run._resident_bytes", lambda: held[0])
    plan = type("Plan", (), {"predicted_wall_s": 1.0, "predicted_bytes": 1e9, "at_least": False})()
    allowance, endless = Allowance.of(plan, PATIENCE), Allowance.of(plan, float("inf"))
    held[0] = 6.4e9
    allowance.check("equilibrium", 3, 0)
    held[0] = 6.6e9
    endless.check("equilibrium", 3, 0)
    with pytest.raises(BeyondPlanError, match=r"its memory far exceeds the predicted 0.93 GiB.*--patience inf"):
        allowance.check("equilibrium", 3, 0)


def test_plan_refuses_what_check_refuses():
    scene = {"bearing": {"preset": "B7206C"}}
    with pytest.raises(SceneError, match="no load acts"):
        plan(scene)
    assert [one.path for one in check(scene).mistakes] == ["load.axial"]


def test_the_plan_of_elastic_bodies_states_their_memory():
    assert make_plan(elastic_scene(**QUICK)).to_dict()["predicted_bytes"] > 2e8
    assert make_plan(load_scene(ARTICLE)).to_dict()["predicted_bytes"] is None
