"""Long runs, motions that cannot be, and small parts of Z that are not resolved: what a user is told."""

import re
import subprocess
import sys
from contextlib import redirect_stdout
from io import StringIO

import numpy as np
import pytest
from rich.console import Console

import raceway as rw
from checks.validation.command_line import EXAMPLES
from raceway import ConvergenceError, SceneError, check, run, scene_from_dict
from raceway.extend import nearest
from raceway.pipeline.plausible import inertia_warnings
from raceway.pipeline.simulate import recording_stride
from raceway.planning.resolve import damped_step_limit, samples_per_turn
from raceway.testing import b7206c

EXCITED = {"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 3.2e-4}


def computed(**tables):
    return run(b7206c(**{"excitation": EXCITED, **tables}))


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
    stride = recording_stride(steps_per_turn, turns)
    assert steps_per_turn % stride == 0
    assert steps_per_turn // stride >= min(steps_per_turn, samples_per_turn(turns))


@pytest.mark.slow
def test_a_long_run_and_its_run_with_half_the_steps_keep_whole_turns():
    short, long = (computed(integrator={"turns": turns, "steps_per_turn": 60}) for turns in (12, 1300))
    assert len(long.simulation.whole.time) == 1300 * 60 // recording_stride(60, 1300)
    # The same steady orbit: what differs is what is left of the start, far below the error of 60 steps per turn.
    assert long.identification.equivalent_stiffness == pytest.approx(short.identification.equivalent_stiffness, rel=1e-4)


def test_a_motion_out_of_the_grooves_is_refused_with_the_likely_cause():
    with pytest.raises(ConvergenceError, match="mm, more than the groove centres are apart.*unbalance in kg m") as caught:
        computed(excitation={**EXCITED, "unbalance": 639.0})
    assert set(caught.value.state) == {"q", "v", "ball"}


def test_balls_that_unload_during_a_turn_are_told():
    heavy = computed(excitation={**EXCITED, "unbalance": 2e-3})
    assert any("balls lose contact with the inner race during a turn" in text for text in heavy.warnings)
    assert computed(excitation={**EXCITED, "unbalance": 1e-5}).warnings == ()


def test_a_bearing_that_unseats_during_a_turn_is_told():
    """On free tilts a force of twenty times the axial load tilts the ring until balls run below 0 deg; loaded, at rest, none does."""
    words = "the bearing loses axial contact during a turn"
    for force, said in ((2000.0, True), (100.0, False)):
        excitation = {"kind": "bidirectional", "speed_rpm": 6000.0, "amplitude": "constant", "force": force}
        free = {"supports": {"tilt": "free"}, "integrator": {"kind": "quasi_static"}, "load": {"axial": 100.0}}
        assert any(words in text for text in computed(excitation=excitation, **free).warnings) == said


def test_a_moment_on_locked_tilts_has_no_effect_and_says_so():
    assert any("`load.moment` has no effect" in w for w in computed(load={"moment": [3.0, 0.0]}).warnings)
    for tilt, faults in (("locked", 1), ("free", 0)):
        told = check({"bearing": {"preset": "B7206C"}, "load": {"moment": [3.0, 0.0]}, "supports": {"tilt": tilt}}).mistakes
        assert sum("no load acts" in mistake.message for mistake in told) == faults


def static(**tables):
    return run({"bearing": {"preset": "B7206C"}, "load": {"axial": 300.0}, **tables}).warnings


def of_one_kind(warnings, words):
    """The one warning with these words, no other one with it."""
    (text,) = warnings
    assert words in text
    return text


SET = {"preset": "7014C", "arrangement": "DB", "preload": 500.0}
FAST = {"ring_growth": True, "spin_speed_rpm": 20000.0}


def test_a_ring_without_a_fit_is_as_loose_as_one_whose_fit_is_lost():
    """16.3 um: plane-stress annuli of a bore of 70 mm and a land of 85.7 mm on a solid shaft, both turning."""
    kyy = []
    for fit in (0.0, 1e-6, 5e-6):
        result = run({"bearing": SET, "kinematics": FAST, "mounting": {"shaft_interference": fit}})
        text = of_one_kind(result.warnings, "has grown 16.3 µm more")
        assert f"loose on its shaft by {16.3 - 1e6 * fit:.1f} µm" in text
        kyy.append(result.stiffness[1, 1])
    assert kyy[0] == kyy[1] == kyy[2]
    assert not static(bearing=SET, kinematics=FAST, mounting={"shaft_interference": 20e-6})
    # A hollow shaft grows more, by a share of a quarter of the bore's square; the finest tolerance of a fit is no loss.
    hollow = of_one_kind(static(bearing=SET, kinematics=FAST, mounting={"shaft_bore": 35e-3}), "loose on its shaft")
    assert float(hollow.split(" by ")[1].split()[0]) < 16.0
    assert not static(bearing=SET, kinematics={**FAST, "spin_speed_rpm": 2000.0})


def test_an_aluminium_housing_that_lets_its_ring_go_is_told():
    """62 mm, 11 ppm/K more than steel, 40 K: 27 um, of which the fit takes 10."""
    aluminium = {"young": 70e9, "poisson": 0.33, "density": 2700.0, "thermal_expansion": 23e-6}
    warm = {"outer_temperature": 40.0, "inner_temperature": 40.0, "ball_temperature": 40.0, "housing_material": aluminium}
    steel = scene_from_dict({"bearing": {"preset": "B7206C"}, "load": {"axial": 300.0}}).bearing.rings.thermal_expansion
    for fit in (0.0, 10e-6):
        lost = 1e6 * (62e-3 * 40.0 * (23e-6 - steel) - fit)
        text = of_one_kind(
            static(mounting={**warm, "housing_interference": fit}), "the outer ring is loose in its housing by "
        )
        assert float(text.split("housing by ")[1].split()[0]) == pytest.approx(lost, rel=5e-3)
    assert not static(mounting={**warm, "housing_interference": 30e-6})


def test_a_check_tells_of_the_loose_ring():
    assert any("loose on its shaft" in text for text in rw.check({"bearing": SET, "kinematics": FAST}).warnings)


def test_a_row_that_lifts_off_is_told():
    pair = {"preset": "B7206C", "arrangement": "DB", "preload": 300.0}
    assert of_one_kind(static(bearing=pair, load={"axial": 3000.0}), "row 2 lifts off")
    assert of_one_kind(static(bearing=pair, load={"axial": -3000.0}), "row 1 lifts off")
    assert not static(bearing=pair, load={"axial": 300.0, "radial": [300.0, 0.0]})


@pytest.mark.parametrize(("axial", "angle"), [(0.0, 0.0), (1.0, 0.03), (100.0, 2.56)])
def test_a_row_that_the_radial_load_unseats_is_told(axial, angle):
    text = of_one_kind(static(load={"axial": axial, "radial": [2000.0, 0.0]}), "the bearing loses axial contact")
    assert f"loaded ball is {angle:.2f} deg, 15 deg without loads" in text
    # At least one ball stands at atan(F_a / F_r) or below.
    assert angle <= np.degrees(np.arctan2(axial, 2000.0)) + 0.005


def test_rows_that_run_at_a_low_angle_by_their_make_or_growth_are_no_unseated_ones():
    own = {
        "ball_diameter": 9.525e-3, "pitch_diameter": 46e-3, "ball_count": 9, "conformity_inner": 0.52,
        "conformity_outer": 0.52,
    }  # fmt: skip
    assert not static(bearing={**own, "radial_clearance": 10e-6}, load={"radial": [2000.0, 0.0]})
    assert not static(load={"axial": 600.0, "radial": [2000.0, 0.0]})
    # Without loads a raceway wider by 12 um leaves 5 deg of 15.
    assert not static(kinematics={"radial_expansion": 12e-6}, load={"axial": 100.0})


def test_the_body_that_lags_most_is_named_where_the_stated_error_is_less():
    lags = {"inner_supported_error": 0.02, "outer_supported_error": 0.05, "ball_along_grooves_error": None}
    (text,) = inertia_warnings({"inertia": lags}, 0.03)
    assert text.startswith("the outer ring is quasi-static") and "= 0.05 of" in text
    assert len(inertia_warnings({"inertia": lags}, None)) == 1
    for silent in (({"inertia": lags}, 0.06), ({"inertia": {}}, None), (None, None)):
        assert inertia_warnings(*silent) == []


def test_a_contact_pressure_beyond_static_ratings_is_told():
    text = of_one_kind(
        [w for w in static(load={"axial": 1e6}) if "groove's edge" not in w and "dynamic rating" not in w],
        "10657 MPa on the inner race, ball 0",
    )
    assert "4200 MPa" in text
    # Of 12 equal balls at the angle of this load the limit is met near 39 kN.
    low, high = (any("contact pressure" in w for w in static(load={"axial": load})) for load in (37e3, 41e3))
    assert (low, high) == (False, True)
    pair = {"preset": "B7206C", "arrangement": "DB", "preload": 300.0}
    assert any("inner race, row 2, ball 0:" in w for w in static(bearing=pair, load={"axial": -5e4}))
    moving = computed(
        load={"axial": 20e3}, excitation={**EXCITED, "amplitude": "constant", "unbalance": None, "force": 20e3}
    ).warnings
    assert any("during a turn the contact pressure" in w for w in moving)
    assert not any(w.startswith("the contact pr") for w in moving)


@pytest.mark.parametrize(("tables", "words"), [
    ({"contact": {"friction": 1.5}}, "`contact.friction` = 1.5 is more than 1: "),
    ({"rotor": {"mass": 1e6}}, "`rotor.mass` = 1e+06 kg is more than 10000 kg"),
    ({"mounting": {"shaft_interference": 2.0}}, None),
])  # fmt: skip
def test_implausible_numbers_are_told(tables, words):
    if words is None:  # so large a fit is refused before
        with pytest.raises(SceneError, match="close the bearing"):
            static(**tables)
    else:
        assert any(words in text for text in static(**tables))


def test_check_says_what_is_implausible_and_takes_a_window_as_long_as_the_record():
    scene = {"bearing": {"preset": "B7206C"}, "load": {"axial": 400.0}, "excitation": EXCITED, "integrator": {"turns": 5}}
    assert any("`contact.friction` = 1.5" in text for text in check({**scene, "contact": {"friction": 1.5}}).warnings)
    windows = [check({**scene, "identifier": {"kind": "order_tracking", "window_turns": turns}}).ok for turns in (5, 6)]
    assert windows == [True, False]


@pytest.mark.parametrize("time_constant", [0.0, 1e-7, 1e-5])
def test_the_stable_step_with_dashpots_is_that_of_one_damped_mode(time_constant):
    """Velocity Verlet, whose forces see the predicted velocity v + dt a, with c = tau k: eigenvalues on the unit circle at the limit."""
    limit, w = 1e-6, 2e6
    dt = damped_step_limit(limit, time_constant)

    def growth(dt):
        """Of (q, v, a) over a step."""
        moved, predicted = np.array([1.0, dt, 0.5 * dt**2]), np.array([0.0, 1.0, dt])
        a = -(w**2) * (moved + time_constant * predicted)
        step = np.array([moved, np.array([0.0, 1.0, 0.5 * dt]) + 0.5 * dt * a, a])
        scale = np.array([1.0, dt, dt**2])
        return np.abs(np.linalg.eigvals(step * scale[:, None] / scale)).max()

    assert growth(0.99 * dt) < 1.0 + 1e-6 < growth(1.01 * dt)


def test_an_error_that_is_not_known_is_a_warning_with_its_reason():
    (text,) = [w for w in computed(integrator={"turns": 1}).warnings if "the error of Z" in w]
    assert (
        text
        == "the error of Z is not estimated: the error of the transient is unknown (a single turn contains no measure of a transient)"
    )
    assert not computed(integrator={"turns": 3}).warnings


def test_numbers_that_a_part_of_the_error_is_as_large_as_are_no_numbers():
    soft = computed(contact={"kind": "penalty", "stiffness": 1e15})
    assert soft.error["contact"] > 1.0 > soft.error["total"] and soft.error["unresolved"] == ["contact"]
    assert soft.warnings[0].startswith("Z is not resolved: the error of contact is ")
    assert all(re.search(rf"{re.escape(name)} +not resolved", repr(soft)) for name in ("stiffness K", "damping C", "|Z|"))
    with redirect_stdout(StringIO()) as shown:
        Console(width=160).print(soft.screen())
    told = re.findall(r"not resolved: the error of Z \(contact\) is as large as Z", shown.getvalue())
    assert len(told) == 1 and len(re.findall(r"(?:K|\|Z\||C) +-(?: |$)", shown.getvalue(), re.M)) == 3
    other = computed(contact={"kind": "penalty", "stiffness": 1e14})
    assert other.error["unresolved"] == [] and other.warnings == ()


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


@pytest.mark.parametrize(("changes", "told"), [
    ({"identifier": {"kind": "tangent"}, "integrator": {"turns": 5}}, "`integrator.turns` has no effect"),
    ({"integrator": {"kind": "quasi_static"}, "rotor": {"mass": 2.0}}, "`rotor.mass` has no effect"),
    ({"integrator": {"kind": "quasi_static"}, "contact": {"damping": 5.0}}, "`contact.damping` has no effect"),
    ({"contact": {"stick_stiffness": 1e7}}, "`contact.stick_stiffness` has no effect"),
    ({"rotor": {"polar_inertia": 1e-3}}, "`rotor.polar_inertia` has no effect"),
    ({"bearing": {"row_distance": 0.02}}, "`bearing.row_distance` has no effect"),
])  # fmt: skip
def test_keys_that_change_nothing_are_told(changes, told):
    assert any(told in text for text in computed(**changes).warnings)
    assert not any("has no effect" in text for text in computed().warnings)
