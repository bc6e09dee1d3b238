"""Kinematic frequencies against printed ones, and their sums."""

from __future__ import annotations

import numpy as np
import pytest

from raceway import build_model, make_plan, scene_from_dict
from raceway.core.ring.kernels.layout import CAGE, CENTRIFUGAL
from raceway.pipeline.ball_pass import ball_pass, ball_pass_table
from raceway.testing import run, settle


def test_a_bearing_of_a_public_data_set_has_the_printed_frequencies():
    """9 balls of 7.9375 mm on 38.50 mm, 0 deg; printed to four digits."""
    found = ball_pass(9, 7.9375e-3, 38.5e-3, 0.0)
    assert found["ftf"] == pytest.approx(0.3969, abs=5e-5)
    assert found["bpfo"] == pytest.approx(3.572, abs=5e-4)
    assert found["bpfi"] == pytest.approx(5.428, abs=5e-4)
    assert found["bsf"] == pytest.approx(2.32, abs=5e-3)


@pytest.mark.parametrize("angle", [0.0, 0.3, 0.7])
def test_ball_passes_are_those_of_the_cage_against_both_rings(angle):
    found = ball_pass(12, 9.525e-3, 46e-3, angle)
    assert found["bpfo"] + found["bpfi"] == pytest.approx(12.0, rel=1e-14)
    assert found["bpfo"] == pytest.approx(12 * found["ftf"], rel=1e-14)
    # A ball rolls on the outer race without slip: its spin times its radius at the contact is the cage's speed there.
    g = 9.525e-3 * np.cos(angle) / 46e-3
    assert found["bsf"] * 9.525e-3 == pytest.approx(46e-3 * (1 + g) * found["ftf"], rel=1e-14)


def test_a_result_has_them_at_the_loaded_angle_and_in_hertz():
    tables = {
        "bearing": {"preset": "B7206C"},
        "load": {"axial": 1200.0},
        "kinematics": {"spin_speed_rpm": 6000.0, "ball_inertia": False},
    }
    result = run(scene_from_dict(tables))
    (row,) = result.ball_pass["rows"]
    assert row["contact_angle_deg"] == pytest.approx(19.26, abs=0.02)  # shared expectation of the loaded angle, 1200 N
    assert row["bpfo"] == pytest.approx(ball_pass(12, 9.525e-3, 46e-3, np.radians(row["contact_angle_deg"]))["bpfo"])
    assert row["bpfo_hz"] == pytest.approx(100.0 * row["bpfo"], rel=1e-12)
    assert result.to_dict()["ball_pass"] == result.ball_pass
    still = run(scene_from_dict({**tables, "kinematics": {}})).ball_pass
    assert still["speed_rpm"] == 0.0 and still["rows"][0]["bpfo_hz"] is None


def test_each_row_of_a_pair_has_its_own():
    pair = {"preset": "7014C", "arrangement": "DB", "preload": 300.0}
    # Half the axial load that lifts the second row off: the first row's angle opens, the second's closes.
    rows = run(scene_from_dict({"bearing": pair, "load": {"axial": 400.0}})).ball_pass["rows"]
    assert len(rows) == 2
    assert rows[0]["contact_angle_deg"] > rows[1]["contact_angle_deg"] > 15.0


def test_forces_know_one_cage_speed_which_the_table_has_beside_the_loaded_one():
    """Centrifugal forces and orbiting balls go round at the free angle."""
    tables = {
        "bearing": {"preset": "B7206C"},
        "load": {"axial": 2000.0},
        "kinematics": {"spin_speed_rpm": 15000.0, "orbiting": True},
    }
    scene = scene_from_dict(tables)
    model = build_model(scene, make_plan(scene))
    row = ball_pass_table(model, settle(model))["rows"][0]
    cage, b = row["ftf_in_forces"] * scene.spin_speed, scene.bearing
    assert model.system.scalars[CAGE] == pytest.approx(cage, rel=1e-14)
    centrifugal = model.geometry.ball_mass(b.balls.density) * 0.5 * b.pitch_diameter * cage**2
    assert model.system.table[:, CENTRIFUGAL] == pytest.approx(centrifugal, rel=1e-13)
    assert row["ftf"] > 1.005 * row["ftf_in_forces"]


def test_at_speed_the_angle_is_the_mean_of_both_races():
    """Centrifugal force opens the inner angle and closes the outer one: Q_i sin(a_i) = Q_o sin(a_o) = F_a / Z."""
    tables = {"bearing": {"preset": "B7206C"}, "load": {"axial": 400.0}, "kinematics": {"spin_speed_rpm": 15000.0}}
    result = run(scene_from_dict(tables))
    inner, outer = np.arcsin(400.0 / 12.0 / result.equilibrium.contact_force.reshape(2, -1)[:, 0])
    assert inner > 1.2 * outer
    assert result.ball_pass["rows"][0]["contact_angle_deg"] == pytest.approx(np.degrees(0.5 * (inner + outer)), rel=1e-6)
