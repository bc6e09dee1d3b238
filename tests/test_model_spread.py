"""``error.model``: what hypotheses left at their defaults change in K and kyy, against runs under them."""

from __future__ import annotations

import numpy as np
import pytest

import raceway as rw
from raceway.points.dataset import values_of

STATIC = {"bearing": {"preset": "7014A"}, "load": {"axial": 400.0}, "kinematics": {"spin_speed_rpm": 5000.0}}
MOVING = {
    "bearing": {"preset": "7014C"},
    "load": {"axial": 800.0},
    "rotor": {"mass": 3.0},
    "excitation": {"kind": "bidirectional", "speed_rpm": 12000.0, "amplitude": "constant", "force": 200.0},
    "integrator": {"kind": "periodic"},
}
SPRUNG = {"arrangement": "DB", "preload": 600.0, "preload_kind": "spring"}
KINDS = {
    "rigid": {},
    "quasi-static": {"integrator": {"kind": "quasi_static"}},
    "one direction, tilt free": {"excitation": {"kind": "unidirectional"}, "supports": {"tilt": "free"}},
    "tangent": {"identifier": {"kind": "tangent"}},
    "film": {"contact": {"kind": "film", "oil": "VG 32", "temperature_c": 60.0}},
    # Films near two regimes have two equilibria: it is that of a run.
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
    """7014A, 400 N, 5000 r/min: 44.42 N/um without moments, 83.44 and 50.38 with them."""
    alone = _alone(_of(STATIC)["model"])
    assert alone["outer_race"] == pytest.approx(83.44 / 44.42 - 1.0, rel=1e-3)
    assert alone["shared"] == pytest.approx(50.38 / 44.42 - 1.0, rel=1e-2)


@pytest.mark.parametrize("kind", KINDS)
def test_every_hypothesis_is_that_of_a_run_under_it(kind):
    """Within 1 % of the change; errors of orbits on 17 times cancel to far less."""
    base = rw.Scene.from_dict(MOVING).with_(**KINDS[kind])
    own = rw.run(base)
    model, _ = own.model_spread
    for gyroscopic, growth in (("outer_race", False), ("shared", False), ("none", True), ("shared", True)):
        other = rw.run(base.with_(kinematics={"gyroscopic": gyroscopic, "ring_growth": growth}))
        k = other.equivalent_stiffness / own.equivalent_stiffness - 1.0
        kyy = other.stiffness[1, 1] / own.stiffness[1, 1] - 1.0
        if gyroscopic != "none" and growth:
            assert (
                model["equivalent_stiffness"][0] <= k + 1e-2 * abs(k)
                and k - 1e-2 * abs(k) <= model["equivalent_stiffness"][1]
            )
            continue
        value = True if growth else gyroscopic
        assert _alone(model, "equivalent_stiffness")[value] == pytest.approx(k, rel=1e-2, abs=1e-5)
        assert _alone(model)[value] == pytest.approx(kyy, rel=1e-6, abs=1e-9)
    assert max(map(abs, model["kyy"])) < model["bound"]


def test_what_is_stated_is_no_spread():
    """Said to be "none" is decided; with all said there is no table, and the reason stands in its place."""
    said = {**STATIC, "kinematics": {"spin_speed_rpm": 5000.0, "gyroscopic": "none"}}
    model = _of(said)["model"]
    assert set(_alone(model)) == {True}
    assert (
        model["kyy"] == [0.0, _alone(model)[True]] and 0.0 < model["kyy"][1] < model["bound"]
    )  # the scene's own choice is 0
    said["kinematics"]["ring_growth"] = False
    error = _of(said)
    assert error["model"] is None and "stated" in error["how"]["model"]


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({"kinematics": {"spin_speed_rpm": 0.0}}, "nothing turns"),
        ({"kinematics": {"spin_speed_rpm": 100.0}}, "closed bound"),
        ({"kinematics": {"spin_speed_rpm": 5000.0, "ball_inertia": False}}, "without kinematics.gyroscopic"),
    ],
)
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


def test_what_is_left_out_by_default_is_said_so():
    def why(tables):
        return {part.part: part.why for part in rw.make_plan(rw.Scene.from_dict(tables)).left_out}

    assert why(STATIC)["gyroscopic moments of the balls"] == "kinematics.gyroscopic is none, by default"
    assert why(STATIC)["centrifugal growth of the inner ring"] == "kinematics.ring_growth is false, by default"
    said = {**STATIC, "kinematics": {"spin_speed_rpm": 5000.0, "gyroscopic": "none"}}
    assert why(said)["gyroscopic moments of the balls"] == "kinematics.gyroscopic is none"


def test_rows_pressed_together_by_less_than_the_centrifugal_force_slide():
    """F_c = m d_m / 2 w_c^2 with w_c = w (1 - D cos(a) / d_m) / 2; both rows of a set are judged."""
    cage = 13200.0 * np.pi / 30.0 * 0.5 * (1.0 - 9.525 / 46.0 * np.cos(np.radians(15.0)))
    ratio = 100.0 / (12 * 7810.0 * np.pi / 6.0 * 9.525e-3**3 * 23e-3 * cage**2)
    fast = {"bearing": {"preset": "B7206C"}, "load": {"axial": 100.0}, "kinematics": {"spin_speed_rpm": 13200.0}}
    told = [w for w in rw.run(fast).warnings if "Hirano" in w]
    assert len(told) == 1 and told[0].startswith("row 1") and f"{ratio:.2g} times" in told[0]
    assert not any("Hirano" in w for w in rw.run({**fast, "load": {"axial": 400.0}}).warnings)
    pair = {**fast, "bearing": {"preset": "B7206C", **SPRUNG, "preload": 100.0}, "load": {"axial": 0.0}}
    (both,) = (w for w in rw.run(pair).warnings if "Hirano" in w)
    assert "row 1 carries" in both and "row 2 carries" in both
