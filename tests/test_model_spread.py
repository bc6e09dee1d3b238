"""``error.model``: what hypotheses left at their defaults change in K and kyy, against runs under them."""

import pytest

import raceway as rw
from checks.validation.command_line import EXAMPLES
from raceway.points.dataset import values_of

STATIC = {"bearing": {"preset": "7014A"}, "load": {"axial": 400.0}, "kinematics": {"spin_speed_rpm": 5000.0}}
MOVING = {
    "bearing": {"preset": "7014C"}, "load": {"axial": 800.0}, "rotor": {"mass": 3.0},
    "excitation": {"kind": "bidirectional", "speed_rpm": 12000.0, "amplitude": "constant", "force": 200.0},
    "integrator": {"kind": "periodic"},
}  # fmt: skip
SPRUNG = {"arrangement": "DB", "preload": 600.0, "preload_kind": "spring"}
KINDS = {
    "rigid": {},
    "quasi-static": {"integrator": {"kind": "quasi_static"}},
    "one direction, tilt free": {"excitation": {"kind": "unidirectional"}, "supports": {"tilt": "free"}},
    "tangent": {"identifier": {"kind": "tangent"}},
    "film": {"contact": {"kind": "film", "oil": "VG 32", "temperature_c": 60.0}},
    # Films near two regimes.
    "film on a spring": {
        "bearing": {**SPRUNG, "preload": 300.0},
        "load": {"axial": 0.0, "radial": [100.0, 0.0]},
        "contact": {"kind": "film", "oil": "VG 32", "temperature_c": 40.0},
        "excitation": {"speed_rpm": 18000.0, "force": 10.0},
        "identifier": {"kind": "tangent"},
    },
    "spring": {"bearing": SPRUNG, "load": {"axial": 50.0}},
    "held": {"supports": {"axial": "displacement"}},
    "condensed": {"bodies": {"kind": "condensed"}},
}


def _of(tables):
    return rw.run(tables).to_dict()["error"]


def _alone(model, quantity="kyy"):
    return {entry["value"]: entry[quantity] for entry in model["hypotheses"]}


def test_static_scenes_state_what_moments_and_growth_would_change():
    """7014A, 400 N, 5000 r/min: 44.4 N/um without moments, 83.4 and 50.4 with all of them; 'auto' is between."""
    alone, kyy = _alone(_of(STATIC)["model"]), rw.run(STATIC).stiffness[1, 1]
    for value, expected in (("none", 44.53e6), ("outer_race", 83.61e6), ("shared", 50.51e6)):
        assert (1.0 + alone[value]) * kyy == pytest.approx(expected, rel=1e-3)
    assert alone["none"] < alone["shared"] < 0.0 < alone["outer_race"]


@pytest.mark.parametrize("kind", [pytest.param(kind, marks=[pytest.mark.slow] * (kind == "condensed")) for kind in KINDS])
def test_every_hypothesis_is_that_of_a_run_under_it(kind):
    """Within 1 % of the change; errors of orbits on 17 times cancel to far less."""
    base = rw.Scene.from_dict(MOVING).with_(**KINDS[kind])
    own = rw.run(base)
    model, _ = own.model_spread
    for gyroscopic, growth in (("outer_race", "auto"), ("none", "auto"), ("auto", True), ("none", False)):
        other = rw.run(base.with_(kinematics={"gyroscopic": gyroscopic, "ring_growth": growth}))
        k = other.equivalent_stiffness / own.equivalent_stiffness - 1.0
        kyy = other.stiffness[1, 1] / own.stiffness[1, 1] - 1.0
        if "auto" not in (gyroscopic, growth):
            low, high = model["equivalent_stiffness"]
            assert low <= k + 1e-2 * abs(k) and k - 1e-2 * abs(k) <= high
            continue
        value = growth if gyroscopic == "auto" else gyroscopic
        assert _alone(model, "equivalent_stiffness")[value] == pytest.approx(k, rel=1e-2, abs=1e-5)
        assert _alone(model)[value] == pytest.approx(kyy, rel=1e-6, abs=1e-9)
    assert max(map(abs, model["kyy"])) < model["bound"]


def test_what_is_stated_is_no_spread():
    """Said to be "none" is decided; with all said there is no table, and the reason stands in its place; "auto" is not said."""
    said = {**STATIC, "kinematics": {"spin_speed_rpm": 5000.0, "gyroscopic": "none", "ring_growth": "auto"}}
    model = _of(said)["model"]
    assert set(_alone(model)) == {False, True}
    assert model["kyy"] == [_alone(model)[False], _alone(model)[True]] and 0.0 < model["kyy"][1] < model["bound"]
    fitted = _of({**said, "mounting": {"shaft_interference": 5e-6}})["model"]  # a fit that is given is not left out
    assert fitted["kyy"] == [_alone(fitted)[False], 0.0]  # the scene's own hypotheses change nothing
    assert "none" in _alone(_of(rw.Scene.from_dict(STATIC).to_dict())["model"])
    said["kinematics"]["ring_growth"] = False
    assert (error := _of(said))["model"] is None and "stated" in error["how"]["model"]
    said["kinematics"]["spin_speed_rpm"] = 0.0  # without spin nothing changes
    assert rw.run(said).stiffness.tobytes() == rw.run({**STATIC, "kinematics": {}}).stiffness.tobytes()


@pytest.mark.parametrize(("changes", "why"), [
    ({"kinematics": {"spin_speed_rpm": 0.0}}, "nothing turns"),
    ({"kinematics": {"spin_speed_rpm": 100.0}}, "closed bound"),
    ({"kinematics": {"spin_speed_rpm": 5000.0, "ball_inertia": False}}, "without kinematics.gyroscopic"),
])  # fmt: skip
def test_what_is_not_solved_says_why(changes, why):
    error = _of({**STATIC, **changes})
    assert why in error["how"]["model"]
    if why == "closed bound":
        assert error["model"]["kyy"] is None and 0.0 < error["model"]["bound"] < 1e-3


def test_friction_leaves_k_out_and_keeps_kyy():
    model = _of({**MOVING, "integrator": {"kind": "newmark", "turns": 4}, "contact": {"friction": 0.05}})["model"]
    assert model["equivalent_stiffness"] is None and model["kyy"][1] > 0.0


def test_the_spread_is_no_part_of_the_total_and_a_number_of_every_point():
    result = rw.run(MOVING)
    assert result.to_dict()["error"]["total"] == result.error["total"] < 1e-6
    assert "model" not in result.error
    assert values_of(result)["error_model_bound"] == pytest.approx(result.model_spread[0]["bound"])


def _parts(**kinematics):
    plan = rw.make_plan(rw.Scene.from_dict({**STATIC, **kinematics.pop("tables", {}), "kinematics": kinematics}))
    return plan, {part.part: part.why for part in (*plan.kept, *plan.left_out)}


def test_planning_decides_once_what_auto_stands_for_and_why():
    moments, growth = "gyroscopic moments of the balls", "centrifugal growth of the inner ring"
    plan, why = _parts(spin_speed_rpm=5000.0)
    assert plan.gyroscopic and why[moments].startswith("kinematics.gyroscopic is traction by 'auto': ")
    assert why[growth] == "kinematics.ring_growth is with_shaft by 'auto': ring and shaft grow together, as one body"
    assert plan.problem.derived()["gyroscopic"]["value"] == plan.problem.kinematics.gyroscopic == "traction"
    said, why = _parts(spin_speed_rpm=5000.0, gyroscopic="none", ring_growth=False)
    assert not said.gyroscopic and why[moments] == "kinematics.gyroscopic is none"
    assert why[growth] == "kinematics.ring_growth is false"


ROWS = {"row": [{"preset": "7014A", "direction": "-"}, {"preset": "7014C", "direction": "+"}]}


@pytest.mark.parametrize(("tables", "why"), [
    ({"kinematics": {}}, "nothing turns"),
    ({"kinematics": {"ball_inertia": False, "spin_speed_rpm": 5000.0}}, "centrifugal force"),
    ({"contact": {"friction": 0.1}}, "contacts that stick"), ({"bearing": ROWS}, "different bearings"),
    (
        {"bodies": {"kind": "elastic"}, "mesh": {"kind": "structured", "element_size": 4e-3, "nodes_per_semi_axis": 1}},
        "do not rotate",
    ),
    (EXAMPLES / "cylindrical_rollers.toml", "no gyroscopic moment"),
])  # fmt: skip
def test_where_moments_cannot_be_computed_auto_leaves_them_out_and_says_why(tables, why):
    scene = {**STATIC, **tables} if isinstance(tables, dict) else tables
    problem = rw.make_plan(rw.evolve(scene, {"kinematics.gyroscopic": "auto"})).problem
    assert problem.kinematics.gyroscopic == "none" and why in problem.why("gyroscopic")


def test_growth_that_cannot_be_computed_is_left_out_too():
    sizes = {"ball_count": 12, "ball_diameter": 9.525e-3, "pitch_diameter": 46e-3, "contact_angle_deg": 15.0,
             "conformity_inner": 0.522, "conformity_outer": 0.522}  # fmt: skip
    shaft = {"mounting": {"shaft_material": {"young": 70e9}}}
    for tables, why in (({"bearing": sizes}, "bore"), (shaft, "is required by kinematics.ring_growth")):
        problem = rw.make_plan(rw.Scene.from_dict({**STATIC, **tables})).problem
        assert problem.kinematics.ring_growth is False and why in problem.why("ring_growth")


def test_ring_and_shaft_without_a_fit_grow_as_with_one_that_holds():
    """Lamé's rings superpose: what speed takes from a fit does not depend on it, as long as it holds."""

    def growth(fit, hypothesis):
        kinematics = {"spin_speed_rpm": 20000.0, "ring_growth": hypothesis}
        running = rw.make_plan(
            rw.Scene.from_dict({**STATIC, "kinematics": kinematics, "mounting": {"shaft_interference": fit}})
        ).problem.running
        return running.grooves[0].radial - running._by_interference(running.bearing, fit)

    assert growth(0.0, "auto") == growth(0.0, "with_shaft") == pytest.approx(growth(60e-6, "auto"), rel=1e-9)
    assert growth(60e-6, True) == growth(60e-6, "auto")
    assert 0.0 < growth(0.0, "auto") < 0.5 * growth(0.0, True)
