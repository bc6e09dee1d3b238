"""Long runs, motions that cannot be, and small parts of Z that are not resolved: what a user is told."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from raceway.errors import ConvergenceError
from raceway.framework.options import nearest
from raceway.pipeline.run import run
from raceway.pipeline.simulate import _stride
from raceway.planning.recording import samples_per_turn
from raceway.scene.reading import scene_from_dict
from validation.command_line import EXAMPLES
from validation.tables import b7206c

EXCITED = {"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 3.2e-4}


def computed(**tables):
    return run(scene_from_dict(b7206c(**{"excitation": EXCITED, **tables})))


def test_angles_of_many_states_at_once_are_those_of_each():
    found = computed(kinematics={"orbiting": True, "ball_inertia": True}, supports={"tilt": "free"}, integrator={"turns": 3})
    record, some = found.simulation.record, slice(0, 40)
    parts = [part[some] for part in (record.displacement, record.ball, record.contact_force, record.time)]
    inner, outer = found.model.bearing.contact_angles(found.model, *parts)
    for k, state in enumerate(zip(*parts, strict=True)):
        one = found.model.bearing.contact_angles(found.model, *state)
        assert np.array_equal(one[0], inner[k], equal_nan=True) and np.array_equal(one[1], outer[k], equal_nan=True)
    assert np.ptp(inner) > 0.0


@pytest.mark.parametrize("turns", [1, 12, 200, 201, 1000, 1800, 3000, 20000])
@pytest.mark.parametrize("steps_per_turn", [8, 9, 120, 180, 360, 361, 720, 1080, 7200])
def test_recorded_samples_divide_the_turn(turns, steps_per_turn):
    stride = _stride(steps_per_turn, turns)
    assert steps_per_turn % stride == 0
    assert steps_per_turn // stride >= min(steps_per_turn, samples_per_turn(turns))


def test_a_long_run_and_its_run_with_half_the_steps_keep_whole_turns():
    short, long = (computed(integrator={"turns": turns, "steps_per_turn": 60}) for turns in (12, 1300))
    assert len(long.simulation.whole.time) == 1300 * 60 // _stride(60, 1300)
    # The same steady orbit: what differs is what is left of the start, far below the error of 60 steps a turn.
    assert long.identification.equivalent_stiffness == pytest.approx(short.identification.equivalent_stiffness, rel=1e-4)


def test_a_motion_out_of_the_grooves_is_refused_with_the_likely_cause():
    with pytest.raises(ConvergenceError, match="mm, more than the groove centres are apart.*unbalance in kg m") as caught:
        computed(excitation={**EXCITED, "unbalance": 639.0})
    assert set(caught.value.state) == {"q", "v", "ball"}


def test_balls_that_unload_during_a_turn_are_told():
    heavy = computed(excitation={**EXCITED, "unbalance": 3.2e-3})
    assert any("balls lose contact with the inner race during a turn" in text for text in heavy.warnings)
    assert computed(excitation={**EXCITED, "unbalance": 1e-5}).warnings == ()


def test_a_moment_on_locked_tilts_has_no_effect_and_says_so():
    assert any("`load.moment` has no effect" in w for w in computed(load={"moment": [3.0, 0.0]}).warnings)


def test_damping_comes_with_its_absolute_error():
    found = computed(contact={"damping": 0.001}).to_dict()
    table, total = found["identification"], found["error"]["total"]
    w = 2.0 * 3.141592653589793 * table["frequency_hz"]
    assert table["equivalent_damping_error"] == pytest.approx(total * table["dynamic_stiffness"]["abs"] / w)
    assert table["phase_lag_error_deg"] == pytest.approx(total * 180.0 / 3.141592653589793)


def test_the_nearest_word_keeps_its_capitals():
    assert nearest("b7207c", ["B7206C", "DGB7-MASTA"]) == " (did you mean 'B7206C'?)"


def test_a_full_standard_output_ends_with_one_line_and_no_traceback(tmp_path):
    command = [sys.executable, "-m", "raceway", "check", str(EXAMPLES / "minimal.toml"), "--json"]
    with open("/dev/full", "w") as full:
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, cwd=tmp_path, check=False)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr and done.stderr.count("No space left") == 1


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"identifier": {"kind": "tangent"}, "integrator": {"turns": 5}}, "`integrator.turns` has no effect"),
        ({"integrator": {"kind": "quasi_static"}, "rotor": {"mass": 2.0}}, "`rotor.mass` has no effect"),
        ({"integrator": {"kind": "quasi_static"}, "contact": {"damping": 5.0}}, "`contact.damping` has no effect"),
        ({"contact": {"stick_stiffness": 1e7}}, "`contact.stick_stiffness` has no effect"),
        ({"rotor": {"polar_inertia": 1e-3}}, "`rotor.polar_inertia` has no effect"),
        ({"bearing": {"row_distance": 0.02}}, "`bearing.row_distance` has no effect"),
    ],
)
def test_keys_that_change_nothing_are_told(changes, told):
    assert any(told in text for text in computed(**changes).warnings)
    assert not any("has no effect" in text for text in computed().warnings)
