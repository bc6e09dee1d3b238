"""The error that a result states: series of equilibria, sudden starts, several speeds, and the digits of K."""

from types import SimpleNamespace

import numpy as np
import pytest

from checks.validation.error_estimate import judge, named, right
from checks.validation.scenes import rotating
from checks.validation.series_errors import SERIES, series
from raceway import run
from raceway.extend import number_within
from raceway.pipeline.error import Part, equilibria_of_second_series
from raceway.pipeline.simulate import model_at_speed, settles_elsewhere
from raceway.planning.resolve import recorded_per_turn, samples_per_turn
from raceway.testing import b7206c


def test_a_series_that_cannot_be_told_from_a_finer_one_states_its_residual():
    error = run(series(*SERIES[2], 360)).error
    assert error["total"] == pytest.approx(1e-11, rel=0.1) and "residual" in error["how"]["time_step"]


def test_a_finer_series_has_other_harmonics():
    assert all(equilibria_of_second_series(n) > 2 * n and equilibria_of_second_series(n) % n for n in range(8, 3000))


def test_of_equilibria_every_step_is_recorded_up_to_the_limit_of_long_runs():
    found = run(series(*SERIES[2], 2880))
    assert len(found.simulation.record.time) == 2880
    assert recorded_per_turn(2880, 12) == 360 and recorded_per_turn(2880, 12, inertial=False) == 2880
    assert samples_per_turn(1000, inertial=False) == samples_per_turn(1000) == 72


def _near_resonance(**integrator):
    """A carried mass that puts the radial natural frequency 5 % above the speed, no damping but the contacts' 0.001 N s/m."""
    tables = rotating(1000.0, "locked", 12000.0, False, "newmark")
    tables["excitation"] = {"kind": "bidirectional", "speed_rpm": 12000.0, "amplitude": "constant", "force": 20.0}
    return {**tables, "rotor": {"mass": 134.0}, "integrator": {"kind": "newmark", "steps_per_turn": 180, **integrator}}


@pytest.mark.parametrize(("start", "turns"), [("static", 3), ("static", 6), ("ramp", 3), ("ramp", 12)])
def test_a_start_near_resonance_states_at_least_a_third_of_its_error(start, turns):
    tables = _near_resonance(start=start, turns=turns)
    found = run(tables)
    wanted = run({**tables, "integrator": {"kind": "periodic"}}).identification.dynamic_stiffness
    true = abs(found.identification.dynamic_stiffness - wanted) / abs(wanted)
    assert true > 0.01 and right(found.error["total"], true), (found.error["total"], true)


def _turns(*lines):
    """A motion of one frequency whose turns have given 1x lines [m] along y, as a simulation and as a record."""
    time = np.arange(1, 361) / 360.0
    wave = [np.outer((line * np.exp(2j * np.pi * time)).real, [0.0, 1.0, 0.0, 0.0, 0.0]) for line in lines]
    schedule = SimpleNamespace(steps_per_turn=360, stride=1)
    whole = SimpleNamespace(time=np.arange(1, 360 * len(lines) + 1) / 360.0, displacement=np.vstack(wave), schedule=schedule)
    return SimpleNamespace(whole=whole)


def test_turns_that_repeat_far_from_the_steady_motion_are_another_motion():
    model = SimpleNamespace(excitation=SimpleNamespace(frequency_hz=1.0))
    settled = _turns(1.0).whole
    assert settles_elsewhere(model, _turns(0.0, 3.0, 3.0), settled)
    assert not settles_elsewhere(model, _turns(0.0, 3.0, 2.9), settled), "a transient that is on its way"
    assert not settles_elsewhere(model, _turns(0.0, 1.001, 1.0005), settled), "nearly there"
    assert not settles_elsewhere(model, _turns(3.0), settled), "a single turn repeats nothing"


def test_parts_whose_phases_cancel_leave_half_the_larger(monkeypatch):
    monkeypatch.setattr("raceway.pipeline.error._time_step", lambda run: (Part(0.02, "made up", 0.02j), None))
    monkeypatch.setattr("raceway.pipeline.error._transient", lambda run, step: Part(0.019, "made up", -0.019j))
    error = run(b7206c(excitation={"kind": "bidirectional", "speed_rpm": 9000.0, "unbalance": 1e-4})).to_dict()["error"]
    assert error["total"] == pytest.approx(0.01 + error["identification"], abs=1e-12)


def test_fits_over_speeds_and_run_ups_have_a_part_for_the_transient():
    tables = rotating(1000.0, "locked", 12000.0, False, "newmark")
    tables["integrator"] |= {"turns": 4, "steps_per_turn": 60, "start": "static"}
    tables["identifier"] = {"kind": "impedance_fit", "speeds_rpm": [9000.0, 12000.0, 15000.0]}
    found = run(tables)
    sudden, z = found.error, found.identification.dynamic_stiffness
    coarse = run({**tables, "integrator": tables["integrator"] | {"steps_per_turn": 30}}).identification.dynamic_stiffness
    assert sudden["time_step"] == pytest.approx(abs(z - coarse) / 3.0 / abs(z), rel=1e-6)  # order 2, of the fit over speeds
    assert sudden["total"] >= 0.3 * sudden["transient"] > 1e-4 and "steady motion" in sudden["how"]["transient"]
    tables["contact"] |= {"friction": 0.03}
    rubbing = run(tables).error
    assert rubbing["transient"] is None and rubbing["total"] is None
    assert rubbing["how"]["total"].startswith("not estimated: the error of the transient is unknown (a steady motion")


def test_a_run_up_is_held_against_the_steady_motion_at_its_last_speed(monkeypatch):
    tables = rotating(1000.0, "locked", 12000.0, False, "newmark")
    tables["excitation"] = {
        "kind": "run_up", "first_speed_rpm": 9000.0, "speed_rpm": 12000.0, "duration_s": 0.2, "unbalance": 3.2e-4,
    }  # fmt: skip
    tables["integrator"] |= {"steps_per_turn": 90}
    tables["identifier"] = {"kind": "order_tracking"}
    speeds = []
    monkeypatch.setattr(
        "raceway.pipeline.simulate.model_at_speed", lambda *given: (speeds.append(given[1]), model_at_speed(*given))[1]
    )
    found = run(tables)
    assert speeds == [speed for speed, _ in found.identification.series]  # for both error and series: once
    rpm = found.identification.frequency_hz * 60.0
    steady = {**tables, "integrator": {"kind": "periodic"}, "identifier": {"kind": "fft_1x"}}
    steady["excitation"] = {"kind": "bidirectional", "speed_rpm": rpm, "unbalance": 3.2e-4}
    wanted = run(steady).identification.dynamic_stiffness
    true = abs(found.identification.dynamic_stiffness - wanted) / abs(wanted)
    assert true > 1e-6 and right(found.error["total"], true), (found.error["total"], true)
    assert found.identification.series_error[-1] == pytest.approx(true, rel=0.02)  # of the window alone, nothing estimated


def test_k_shows_the_digits_that_its_error_leaves():
    assert number_within(233.8912, 1.6e-4, "N/µm") == "233.89 N/µm"
    assert number_within(233.8912, 0.3, "N/µm") == "233.9 N/µm"
    assert number_within(233.8912, 4.0, "N/µm") == "234 N/µm"
    assert number_within(233.8912, 40.0, "N/µm") == "230 N/µm"
    assert number_within(0.0, 1.0, "N/µm") == "0 N/µm"


def test_the_error_of_k_is_that_of_z_where_the_inertia_cancels_it():
    tables = _near_resonance(start="static", turns=6)
    tables["rotor"] = {"mass": 1000.0}  # |Z| is six times K
    found = run(tables).to_dict()
    k, z = found["identification"], found["identification"]["dynamic_stiffness"]
    assert k["equivalent_stiffness_error"] == pytest.approx(found["error"]["total"] * z["abs"])
    assert k["equivalent_stiffness_error"] > 5.0 * found["error"]["total"] * k["equivalent_stiffness"]


def _with_and_without_the_steady_motion(monkeypatch, tables):
    """A result that knows no steady motion, and its true error."""
    wanted = run({**tables, "integrator": {"kind": "periodic"}}).identification.dynamic_stiffness
    monkeypatch.setattr("raceway.pipeline.transient_error.settled_value", lambda *_: None)
    found = run(tables)
    return found, abs(found.identification.dynamic_stiffness - wanted) / abs(wanted)


def test_without_a_steady_motion_a_beat_that_no_window_tells_from_1x_states_what_turns_differ_by(monkeypatch):
    """33 100 r/min lie within a line of the radial natural frequency: Hann's window sees 0.05 of an error of 0.3."""
    parts = {"bearing": {"preset": "7206A"}, "rotor": {"mass": 0.4}, "load": {"axial": 140.0}, "contact": {"damping": 300.0}}
    force = {"kind": "unidirectional", "amplitude": "constant", "force": 5.7, "speed_rpm": 33100.0}
    tables = {**parts, "excitation": force, "integrator": {"kind": "newmark", "start": "ramp"}}
    found, true = _with_and_without_the_steady_motion(monkeypatch, tables)
    assert true > 0.2 and right(found.error["total"], true), (found.error["total"], true)
    assert found.error["transient"] >= found.identification.spread


def test_without_a_steady_motion_a_free_vibration_that_a_window_sees_states_no_more_than_that(monkeypatch):
    """The single turns differ by many times what all of them are off by."""
    tables = rotating(1000.0, "locked", 12000.0, False, "newmark")
    tables["integrator"] |= {"steps_per_turn": 180, "start": "static", "turns": 60}
    found, true = _with_and_without_the_steady_motion(monkeypatch, tables)
    assert right(found.error["total"], true), (found.error["total"], true)
    assert found.identification.spread > 5.0 * true


def test_a_second_run_that_vibrates_by_more_than_its_steps_change_is_made_with_closer_steps():
    """Lift-off under 100 N: 180 steps per turn leave the orbit and differ by 150 times what 240 steps do."""
    case = named("lift-off, 100 N, tilt free")
    estimate, true, _ = judge(case)
    assert right(estimate, true), (estimate, true)
    assert "240 instead of 360 steps" in run(case.tables).error["how"]["time_step"]


def motion(tolerance: float, axial: float):
    tables = b7206c(
        load={"axial": axial},
        rotor={"mass": 2.0},
        excitation={"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 6.39e-4, "load_share": 0.5},
        supports={"tilt": "free"},
        integrator={"kind": "periodic", "tolerance": tolerance, "symmetry": "none"},
    )
    return run(tables)


@pytest.mark.parametrize("axial", [400.0, 1000.0])
def test_the_stated_error_is_neither_far_below_nor_far_above_the_true_one(axial):
    loose, tight = motion(1e-3, axial), motion(1e-11, axial)
    stated = loose.simulation.whole.counts["error"]
    change = (loose.simulation.record.displacement - tight.simulation.record.displacement)[:, :3]
    size = np.abs(tight.simulation.record.displacement[:, 1:3]).max()
    true = np.abs(change).max() / size
    assert true <= 3.0 * stated
    assert stated <= 30.0 * true
