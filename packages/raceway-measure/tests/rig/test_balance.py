"""Shaft and bearing together, and the way back."""

import attrs
import numpy as np
import pytest
from raceway_measure.fit.identify import coefficients_of_state, standard_errors
from raceway_measure.fit.rig import invert, with_moment, with_tilt_of
from raceway_rotor.shaft import bearing, find_root, rotor, shaft, whirling_load

from checks.validation.command_line import EXAMPLES
from checks.validation.records import SPEED
from raceway import ConvergenceError, SceneError, load_scene
from raceway.testing import default_registry


def test_answers_of_the_compiled_loop_are_those_of_runs(monkeypatch):
    """Both solve for the same steady orbit, a run to 1e-8."""
    scene, speed, load = load_scene(EXAMPLES / "test_rig.toml"), 13000.0 * np.pi / 30.0, (300.0 + 20.0j, 1.0 - 0.3j)
    tested = bearing(scene, 400.0, default_registry())
    looped = tested.answer(speed, *load)
    assert not tested.last
    monkeypatch.setattr("raceway.points.column_quantities.why_not", lambda scene, moving: "runs are asked for")
    assert looped == pytest.approx(tested.anew().answer(speed, *load), rel=1e-7)


def test_a_root_that_is_not_analytic():
    def apart(u):
        return u * (1.0 + np.abs(u) ** 2) - np.array([1.0 + 2.0j, -0.5j])

    root, _ = find_root(apart, np.zeros(2, dtype=complex), np.eye(2, dtype=complex), np.ones(2))
    assert np.abs(apart(root)).max() < 1e-7


def test_no_root_ends_with_a_message():
    with pytest.raises(ConvergenceError, match="no common motion"):
        find_root(lambda u: np.abs(u) ** 2 + 1.0, np.ones(1, dtype=complex), np.eye(1, dtype=complex), np.ones(1))


def test_force_and_moment_of_a_shaft_turn():
    load = whirling_load(600.0 * np.pi / 30.0, 3.0 + 4.0j, 0.2 - 0.1j)
    kernel, out = load.kernel(), np.empty(5)
    for t in (0.0, 0.013):
        kernel(t, load.parameters(), out)
        turn = np.exp(1j * load.whirl_speed * t)
        assert out[1] + 1j * out[2] == pytest.approx((3.0 + 4.0j) * turn)
        assert out[4] - 1j * out[3] == pytest.approx((0.2 - 0.1j) * turn)
        assert out[0] == 0.0


def test_a_small_force_meets_the_tangent(held):
    force, moment, slow = 2.0, 0.01j, 10.0
    found = held.answer(slow, force, moment)
    # A small force: the secant's own change is 1e-5, the ring's inertia at 10 rad/s nothing.
    assert found == pytest.approx(held.compliance @ np.array([force, moment]), rel=1e-4)


def test_shaft_and_bearing_agree_and_forces_balance(rig, held, state):
    line = rotor(rig, SPEED)
    assert held.answer(SPEED, state.force, state.moment) == pytest.approx([state.deflection, state.slope], rel=1e-6)
    # Newton: the unbalance and the inertia of all that moves are what the two bearings carry.
    model = shaft(rig)
    loads = np.zeros(len(model.stiffness), dtype=complex)
    loads[2 * model.node(0.5 * rig.shaft_length)] = line.unbalance_force
    left, right = (2 * model.node(place) for place in rig.bearings)
    loads[[left, right]] -= state.force
    loads[left + 1], loads[right + 1] = -state.moment, state.moment
    motion = np.linalg.solve(model.dynamic(SPEED, SPEED), loads)
    rigid = np.zeros(len(motion))
    rigid[::2] = 1.0
    inertia = SPEED**2 * (rigid @ model.mass @ motion)
    assert 2.0 * state.force == pytest.approx(line.unbalance_force + inertia, rel=1e-9)
    assert motion[left] == pytest.approx(motion[right])
    assert state.force.real > 0.5 * line.unbalance_force  # below the critical speed the bow adds to the unbalance


def test_mirrored_bearings_turn_slope_and_moment_round(rig):
    there, back = (rotor(attrs.evolve(rig, arrangement=word), SPEED) for word in ("DB", "DF"))
    assert back.ring[0] == pytest.approx(there.ring[0] * [1.0, 1.0, -1.0])
    assert back.ring[1] == pytest.approx(there.ring[1] * [-1.0, -1.0, 1.0])


def test_finer_elements_change_nothing(rig, held):
    coarse, fine = (rotor(rig, SPEED, shaft(rig, finer=n)) for n in (1, 3))
    assert coarse.ring == pytest.approx(fine.ring, rel=1e-6)


def test_the_inversion_gives_the_bearing_back(rig, held, state):
    line = rotor(rig, SPEED)
    found = invert(line, held, state.sensor)
    # The tolerance of both fixed points, grown by the bow over the bearing's share of the signal.
    assert found.stiffness == pytest.approx(state.stiffness, rel=1e-5)
    assert with_tilt_of(line, state, state.sensor).stiffness == pytest.approx(state.stiffness, rel=1e-9)
    assert with_moment(line, state.sensor, state.moment, state).stiffness == pytest.approx(state.stiffness, rel=1e-9)


def test_scatter_is_that_of_many_noisy_lines(rig, state):
    line, error = rotor(rig, SPEED), 1e-3 * abs(state.sensor)
    random = np.random.default_rng(3)
    noise = error / np.sqrt(2.0) * (random.standard_normal(400) + 1j * random.standard_normal(400))
    found = [with_tilt_of(line, state, state.sensor + one) for one in noise]
    # 400 samples know a standard deviation to 1 / sqrt(800) = 3.5 %; three times that.
    assert np.std([coefficients_of_state(one) for one in found], axis=0) == pytest.approx(
        standard_errors(line, state, error), rel=0.11
    )


@pytest.mark.parametrize(
    ("change", "path"), [("load.radial=[5.0, 0.0]", "load"), ("bearing.arrangement=DT", "bearing.arrangement")]
)
def test_what_cannot_whirl_in_circles_is_refused(change, path):
    with pytest.raises(SceneError) as caught:
        bearing(load_scene(EXAMPLES / "test_rig.toml", [change]), 400.0, default_registry())
    assert caught.value.mistakes[0].path == path
