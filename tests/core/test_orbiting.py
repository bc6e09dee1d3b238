"""Orbiting balls: kinematic frequencies, inertia, rates of the moving groove centres, lines of the result."""

import attrs
import numpy as np
import pytest

from checks.validation.ball_pass import SPEED, passing_hz
from checks.validation.ball_pass import passing_scene as scene
from raceway import SceneError, make_plan, run, scene_from_dict
from raceway.core.signatures import Constants
from raceway.extend import CAGE, ball_pass, layout, phasors
from raceway.testing import b7206c, model_of, simulate, solve_equilibrium


def test_inertia_amplifies_the_ball_pass_line_as_a_linear_oscillator_would():
    """k / (k - m W^2) with the small-signal stiffness, W the ball-pass speed; 2 %: the stiffness itself varies."""
    tables = scene(rotor={"mass": 4.0, "damping": 4000.0}, bearing={"ball_count": 7})
    tables["integrator"] = {"kind": "newmark", "turns": 12, "steps_per_turn": 360, "start": "static"}
    model = model_of(tables)
    equilibrium = solve_equilibrium(model)
    record = simulate(model, equilibrium).record
    slow = model_of({**tables, "integrator": {**tables["integrator"], "kind": "quasi_static"}})
    still = simulate(slow, solve_equilibrium(slow)).whole
    frequency = passing_hz(model)
    dynamic, static = (phasors(r.time, r.displacement[:, :3], [frequency])[0, 1] for r in (record, still))
    w = 2.0 * np.pi * frequency
    k = equilibrium.stiffness[:3, :3]
    # The force that the passing balls exert, seen through the ring's stiffness, then through its dynamic stiffness.
    push = k @ phasors(still.time, still.displacement[:, :3], [frequency])[0]
    z = k - w**2 * model.system.mass[:3, :3] + 1j * w * model.system.damping[:3, :3]
    assert abs(dynamic / static) > 1.1
    assert abs(dynamic / static) == pytest.approx(abs(np.linalg.solve(z, push)[1] / static), rel=0.02)


def test_rates_of_the_groove_centres(built):
    """The kernel's rate of every gap against differences in time, the ring moving and tilting; balls held."""
    model = built(kinematics={"orbiting": True, "spin_speed_rpm": 12000.0}, supports={"tilt": "free"})
    system = model.system
    rng = np.random.default_rng(5)
    q = np.array([2e-5, 3e-6, -2e-6, 4e-5, -3e-5])
    v = rng.normal(size=5) * [1e-3, 1e-3, 1e-3, 3e-2, 3e-2]

    def centres(t):
        out = np.zeros((3, 2 * system.ball_count))
        layout.place(t, q + v * t, v, Constants(system.scalars, system.table), out, (0, 1, 2))
        return out

    t, h = 1.3e-3, 1e-6
    now, after, before = centres(t), centres(t + h), centres(t - h)
    speed = (after[1] - before[1]) / (2.0 * h)
    np.testing.assert_allclose(now[2], speed, atol=1e-6 * np.abs(speed).max())
    assert system.scalars[CAGE] > 0.0


@pytest.mark.parametrize("damping", [0.0, 500.0])
def test_a_series_of_equilibria_has_no_rates(damping):
    """Contact dampers change nothing in it, however fast the balls travel."""
    model = model_of(scene(turns=1, contact={"damping": damping}))
    equilibrium = solve_equilibrium(model)
    record = simulate(model, equilibrium).whole
    without = attrs.evolve(model.system, scalars=model.system.without(CAGE).scalars)
    np.testing.assert_allclose(equilibrium.displacement, without.solve_equilibrium(model.guess)[0], rtol=1e-9, atol=1e-14)
    spread = record.displacement[:, 1] - record.displacement[:, 1].mean()
    assert 0.0 < np.abs(spread).max() < 0.1 * record.displacement[:, 1].mean()


def test_lines_of_the_result():
    tables = scene(rotor={"mass": 2.0})
    tables["excitation"] = {"kind": "bidirectional", "speed_rpm": SPEED, "unbalance": 3e-4}
    result = run(tables).to_dict()
    found = {line["name"]: line for line in result["identification"]["lines"]}
    assert list(found) == ["1x", "2x", "3x", "ball pass", "2x ball pass"]
    assert found["1x"]["forward_m"] == pytest.approx(result["identification"]["forward_amplitude_m"], rel=1e-2)
    assert found["ball pass"]["frequency_hz"] == pytest.approx(
        12 * 0.5 * (1 - 9.525 * np.cos(np.radians(15)) / 46) * SPEED / 60
    )
    # The radial load makes the bearing stiffer along it than across: the orbit is an ellipse.
    assert found["1x"]["forward_m"] > 3.0 * found["1x"]["backward_m"] > 0.0
    assert found["ball pass"]["axial_m"] > 0.0


def test_backward_whirl_has_a_backward_line():
    tables = b7206c(excitation={"kind": "bidirectional", "speed_rpm": SPEED, "unbalance": 3e-4, "whirl": "backward"})
    tables["integrator"] = {"turns": 3, "steps_per_turn": 120}
    found = run(tables).to_dict()["identification"]
    assert found["backward_amplitude_m"] > 1e3 * found["forward_amplitude_m"]
    assert found["lines"][0]["backward_m"] == pytest.approx(found["backward_amplitude_m"], rel=1e-3)


def test_lines_above_half_the_sampling_rate_are_left_out():
    tables = scene(turns=3, steps=16)
    names = [line["name"] for line in run(tables).to_dict()["identification"]["lines"]]
    assert "ball pass" in names and "2x ball pass" not in names


def test_orbiting_without_speed_is_refused():
    with pytest.raises(SceneError, match=r"kinematics\.orbiting.*needs kinematics\.spin_speed_rpm"):
        make_plan(scene_from_dict(b7206c(kinematics={"orbiting": True})))


def test_a_bearing_of_a_public_data_set_has_the_printed_frequencies():
    """9 balls of 7.9375 mm on 38.50 mm, 0 deg; printed to four digits."""
    found = ball_pass(9, 7.9375e-3, 38.5e-3, 1.0)
    assert found["ftf"] == pytest.approx(0.3969, abs=5e-5)
    assert found["bpfo"] == pytest.approx(3.572, abs=5e-4)
    assert found["bpfi"] == pytest.approx(5.428, abs=5e-4)
    assert found["bsf"] == pytest.approx(2.32, abs=5e-3)


@pytest.mark.parametrize("angle", [0.0, 0.3, 0.7])
def test_ball_passes_are_those_of_the_cage_against_both_rings(angle):
    found = ball_pass(12, 9.525e-3, 46e-3, np.cos(angle))
    assert found["bpfo"] + found["bpfi"] == pytest.approx(12.0, rel=1e-14)
    assert found["bpfo"] == pytest.approx(12 * found["ftf"], rel=1e-14)
    # A ball rolls on the outer race without slip: its spin times its radius at the contact is the cage's speed there.
    g = 9.525e-3 * np.cos(angle) / 46e-3
    assert found["bsf"] * 9.525e-3 == pytest.approx(46e-3 * (1 + g) * found["ftf"], rel=1e-14)


def test_a_result_has_them_at_the_loaded_angle_and_in_hertz():
    tables = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1200.0}}
    result = run({**tables, "kinematics": {"spin_speed_rpm": 6000.0, "ball_inertia": False}})
    (row,) = result.ball_pass["rows"]
    assert row["contact_angle_deg"] == pytest.approx(19.26, abs=0.02)  # shared expectation of the loaded angle, 1200 N
    assert row["bpfo"] == pytest.approx(ball_pass(12, 9.525e-3, 46e-3, np.cos(np.radians(row["contact_angle_deg"])))["bpfo"])
    assert row["bpfo_hz"] == pytest.approx(100.0 * row["bpfo"], rel=1e-12)
    assert result.to_dict()["ball_pass"] == result.ball_pass
    still = run(tables).ball_pass
    assert still["speed_rpm"] == 0.0 and still["rows"][0]["bpfo_hz"] is None


def test_each_row_of_a_pair_has_its_own():
    pair = {"preset": "7014C", "arrangement": "DB", "preload": 300.0}
    # Half the axial load that lifts the second row off: the first row's angle opens, the second's closes.
    rows = run({"bearing": pair, "load": {"axial": 400.0}}).ball_pass["rows"]
    assert len(rows) == 2
    assert rows[0]["contact_angle_deg"] > rows[1]["contact_angle_deg"] > 15.0


def test_the_angle_is_the_mean_of_the_balls_that_carry():
    result = run({"bearing": {"preset": "B7206C"}, "load": {"axial": 200.0, "radial": [2000.0, 0.0]}})
    loaded = result.equilibrium.contact_force[:12] > 0.0
    angles = np.degrees(result.equilibrium.angle_inner[loaded])
    assert 0 < loaded.sum() < 12 and angles.min() < result.ball_pass["rows"][0]["contact_angle_deg"] < angles.max()


def test_forces_know_one_cage_speed_which_the_table_has_beside_the_loaded_one():
    """Centrifugal forces and orbiting balls go round at the free angle."""
    orbiting = {"spin_speed_rpm": 15000.0, "orbiting": True}
    result = run({"bearing": {"preset": "B7206C"}, "load": {"axial": 2000.0}, "kinematics": orbiting})
    model, row = result.model, result.ball_pass["rows"][0]
    cage, b = row["ftf_in_forces"] * model.problem.spin_speed, model.scene.bearing
    assert model.system.scalars[CAGE] == pytest.approx(cage, rel=1e-14)
    centrifugal = model.geometry.ball_mass(b.balls.density) * 0.5 * b.pitch_diameter * cage**2
    assert model.system.table[:, layout.CENTRIFUGAL] == pytest.approx(centrifugal, rel=1e-13)
    assert row["ftf"] > 1.005 * row["ftf_in_forces"]


def test_at_speed_the_angle_is_the_mean_of_both_races():
    """Centrifugal force opens the inner angle and closes the outer one: Q_i sin(a_i) = Q_o sin(a_o) = F_a / Z."""
    kinematics = {"spin_speed_rpm": 15000.0, "gyroscopic": "none"}  # no traction in these balances
    result = run({"bearing": {"preset": "B7206C"}, "load": {"axial": 400.0}, "kinematics": kinematics})
    inner, outer = np.arcsin(400.0 / 12.0 / result.equilibrium.contact_force.reshape(2, -1)[:, 0])
    assert inner > 1.2 * outer
    assert result.ball_pass["rows"][0]["contact_angle_deg"] == pytest.approx(np.degrees(0.5 * (inner + outer)), rel=1e-6)
