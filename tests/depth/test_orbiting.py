"""Orbiting balls: inertia, rates of the moving groove centres, lines of the result."""

from __future__ import annotations

import attrs
import numpy as np
import pytest

from raceway import SceneError, make_plan, scene_from_dict
from raceway.core.ring.kernels.layout import CAGE, place
from raceway.core.signals.lines import phasors
from raceway.core.signatures import Constants
from raceway.testing import b7206c, run, settle, simulate
from validation.ball_pass import SPEED, passing_hz
from validation.ball_pass import passing_scene as scene


def test_inertia_amplifies_the_ball_pass_line_as_a_linear_oscillator_would(built):
    """k / (k - m W^2) with the small-signal stiffness, W the ball-pass speed; 2 %: the stiffness itself varies."""
    tables = scene(rotor={"mass": 4.0, "damping": 4000.0}, bearing={"ball_count": 7})
    tables["integrator"] = {"kind": "newmark", "turns": 12, "steps_per_turn": 360, "start": "static"}
    model = built(**{k: v for k, v in tables.items() if k != "title"})
    equilibrium = settle(model)
    record = simulate(model, equilibrium).record
    slow = built(
        **{
            **{k: v for k, v in tables.items() if k != "title"},
            "integrator": {**tables["integrator"], "kind": "quasi_static"},
        }
    )
    still = simulate(slow, settle(slow)).whole
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
        place(t, q + v * t, v, Constants(system.scalars, system.table), out, (0, 1, 2))
        return out

    t, h = 1.3e-3, 1e-6
    now, after, before = centres(t), centres(t + h), centres(t - h)
    speed = (after[1] - before[1]) / (2.0 * h)
    np.testing.assert_allclose(now[2], speed, atol=1e-6 * np.abs(speed).max())
    assert system.scalars[CAGE] > 0.0


@pytest.mark.parametrize("damping", [0.0, 500.0])
def test_a_series_of_equilibria_has_no_rates(built, damping):
    """Contact dampers change nothing in it, however fast the balls travel."""
    tables = scene(turns=1, contact={"damping": damping})
    model = built(**{k: v for k, v in tables.items() if k != "title"})
    equilibrium = settle(model)
    record = simulate(model, equilibrium).whole
    without = attrs.evolve(model.system, scalars=model.system.without(CAGE).scalars)
    np.testing.assert_allclose(equilibrium.displacement, without.settle(model.guess)[0], rtol=1e-9, atol=1e-14)
    spread = record.displacement[:, 1] - record.displacement[:, 1].mean()
    assert 0.0 < np.abs(spread).max() < 0.1 * record.displacement[:, 1].mean()


def test_lines_of_the_result():
    tables = scene(rotor={"mass": 2.0})
    tables["excitation"] = {"kind": "bidirectional", "speed_rpm": SPEED, "unbalance": 3e-4}
    result = run(scene_from_dict(tables)).to_dict()
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
    found = run(scene_from_dict(tables)).to_dict()["identification"]
    assert found["backward_amplitude_m"] > 1e3 * found["forward_amplitude_m"]
    assert found["lines"][0]["backward_m"] == pytest.approx(found["backward_amplitude_m"], rel=1e-3)


def test_lines_above_half_the_sampling_rate_are_left_out():
    tables = scene(turns=3, steps=16)
    names = [line["name"] for line in run(scene_from_dict(tables)).to_dict()["identification"]["lines"]]
    assert "ball pass" in names and "2x ball pass" not in names


def test_orbiting_without_speed_is_refused():

    with pytest.raises(SceneError, match=r"kinematics\.orbiting.*spin speed"):
        make_plan(scene_from_dict(b7206c(kinematics={"orbiting": True})))
