"""integrator.kind = "auto": what planning chooses, what a run does where no steady orbit lasts, one method for a comparison."""

import numpy as np
import pytest

import raceway as rw
from checks.validation.several import article
from raceway import function
from raceway.testing import b7206c

FORCE = {"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 3.2e-4}
RUN_UP = {"kind": "run_up", "first_speed_rpm": 6000.0, "speed_rpm": 9000.0, "duration_s": 0.1, "unbalance": 3.2e-4}


def scene(**tables):
    filled = {"load": {"axial": 1000.0}, "excitation": FORCE, **tables}
    return b7206c(**{name: table for name, table in filled.items() if table is not None})


def chosen(**tables):
    return rw.plan(scene(**tables)).to_dict()["integrator"]


def said_kind(tables, kind="auto"):
    return {**tables, "integrator": {**tables["integrator"], "kind": kind}}


@pytest.mark.parametrize("tables", [
    {}, {"integrator": {"kind": "auto"}},
    {"supports": {"tilt": "free"}, "excitation": {**FORCE, "kind": "unidirectional"}},
    {"identifier": {"kind": "impedance_fit", "speeds_rpm": [9000.0, 12000.0]}},
    {"contact": {"kind": "film", "oil": "VG 46", "temperature_c": 60.0, "roughness": 2e-7}},
    {"bodies": {"kind": "condensed"}}, {"kinematics": {"orbiting": True}},
])  # fmt: skip
def test_what_repeats_and_forgets_is_solved_for(tables):
    assert chosen(**tables)["kind"] == "periodic"


@pytest.mark.parametrize(("tables", "word"), [
    ({"integrator": {"turns": 12}}, "`integrator.turns`"),
    ({"integrator": {"steps_per_turn": 90}}, "`integrator.steps_per_turn`"),
    ({"integrator": {"kind": "auto", "start": "ramp"}}, "`integrator.start`"),
    ({"excitation": {**FORCE, "ramp_turns": 3.0}}, "grows from zero"),
    ({"excitation": RUN_UP, "identifier": {"kind": "order_tracking"}}, "does not repeat"),
    ({"contact": {"friction": 0.05}}, "friction"),
    ({"kinematics": {"orbiting": True}, "load": {"axial": 1000.0, "radial": [100.0, 0.0]}}, "orbiting"),
    ({"bodies": {"kind": "condensed"}, "contact": {"kind": "penalty", "discretisation": "nodal"}}, "not compiled"),
])  # fmt: skip
def test_else_the_motion_is_integrated_and_the_plan_says_why(tables, word):
    assert (found := chosen(**tables))["kind"] == "newmark" and word in found["why"]


def test_a_kind_that_is_said_has_no_reason_and_a_static_scene_no_integrator():
    assert chosen(integrator={"kind": "newmark"}) == {"kind": "newmark", "why": None}
    assert chosen(excitation=None) is None


def test_a_scene_in_full_reads_as_the_same_choice():
    full = rw.Scene.from_dict(scene()).to_dict()
    assert full["integrator"] == {"kind": "auto"}
    assert rw.plan(full).to_dict()["integrator"] == chosen()
    assert rw.Scene.from_dict(scene(integrator={"turns": 5})).to_dict()["integrator"] == {"kind": "auto", "turns": 5}


@pytest.mark.parametrize(("key", "kinds"), [("gamma", "kind = 'newmark'"), ("tolerance", "'newmark' or 'periodic'")])
def test_an_option_of_a_method_needs_its_kind(key, kinds):
    (mistake,) = rw.check(scene(integrator={key: 0.6})).mistakes
    assert mistake.path == f"integrator.{key}" and kinds in mistake.message
    (mistake,) = rw.check(scene(integrator={"turn": 3})).mistakes
    assert "did you mean 'turns'" in mistake.message


def test_the_answer_is_that_of_the_method():
    auto, periodic = (rw.run(scene(integrator={"kind": kind})) for kind in ("auto", "periodic"))
    assert auto.dynamic_stiffness == periodic.dynamic_stiffness
    assert auto.error["total"] == periodic.error["total"]


@pytest.mark.slow
def test_an_unstable_orbit_is_left_over_time():
    """800 N, 15 000 r/min, a force in one direction: disturbances grow by half a turn."""
    tables = said_kind(article(800.0))
    tables["excitation"]["reference_speed_rpm"] = 15000.0
    orbit, auto, newmark = (rw.run(said_kind(tables, kind)) for kind in ("periodic", "auto", "newmark"))
    assert orbit.to_dict()["stability"]["floquet"]["verdict"] == "unstable"
    assert auto.to_dict()["plan"]["integrator"]["kind"] == "newmark"
    assert "the motion is integrated over time: the steady orbit is unstable" in auto.warnings
    assert auto.dynamic_stiffness == newmark.dynamic_stiffness
    assert auto.error["transient"] > 0.0


def test_where_no_orbit_is_found_the_motion_is_integrated():
    """1 r/min: no mesh holds vibrations 6e5 times as fast as the force."""
    slow = scene(excitation={**FORCE, "speed_rpm": 1.0})
    with pytest.raises(rw.ConvergenceError):
        rw.run(said_kind({**slow, "integrator": {}}, "periodic"))
    found = rw.run(slow)
    assert found.to_dict()["plan"]["integrator"]["kind"] == "newmark"
    assert any(text.startswith("the motion is integrated over time: no steady orbit was found") for text in found.warnings)


def test_both_excitations_of_a_comparison_take_one_method():
    kinds = {"excitation.kind": ["unidirectional", "bidirectional"]}
    found = rw.compare(scene(), {"excitation.speed_rpm": [1.0, 12000.0]})  # no orbit is found at the first
    assert {row.result["plan"]["integrator"]["kind"] for row in found.rows} == {"newmark"}
    assert any("all points take 'newmark'" in note for note in found.notes)
    found = rw.compare(scene(), {"contact.friction": [0.0, 0.05]})
    assert {row.result["plan"]["integrator"]["kind"] for row in found.rows} == {"newmark"}
    found = rw.compare(scene(), kinds)
    assert {row.result["plan"]["integrator"]["kind"] for row in found.rows} == {"periodic"} and not found.notes


def test_a_function_of_a_scene_without_a_kind_is_a_compiled_loop():
    f = function(scene(), ["excitation.speed_rpm"], ["K"])
    assert f.why_slow == ""
    speeds = np.array([9000.0, 12000.0])
    wanted = [rw.run(scene(excitation={**FORCE, "speed_rpm": speed})).equivalent_stiffness for speed in speeds]
    assert f(speeds)["equivalent_stiffness"] == pytest.approx(wanted, rel=1e-7)
