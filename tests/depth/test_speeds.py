"""Several speeds: K, m and C by a fit, a run-up with order tracking."""

from __future__ import annotations

import numpy as np
import pytest

from raceway import SceneError
from raceway.plugins.excitations.run_up import RunUp
from raceway.run import run
from raceway.scene_file import scene_from_dict
from tests.conftest import b7206c


def steady(rpm=12000.0, **tables):
    excitation = {"kind": "bidirectional", "speed_rpm": rpm, **tables.pop("excitation", {})}
    rotor = {"mass": 2.0, **tables.pop("rotor", {})}
    kinematics = {"spin_speed_rpm": 9000.0, **tables.pop("kinematics", {})}
    return b7206c(excitation=excitation, rotor=rotor, kinematics=kinematics, **tables)


SMALL = {"amplitude": "constant", "force": 2.0}
FIT = {"kind": "impedance_fit", "speeds_rpm": [8000.0, 12000.0, 16000.0, 24000.0]}


@pytest.mark.parametrize("integrator", ["newmark", "central_difference", "generalized_alpha"])
@pytest.mark.parametrize("tilt", ["locked", "free"])
def test_fit_recovers_mass_stiffness_and_damping(built, integrator, tilt):
    """2 N on 1000 N: K is the tangent's; m what the bearing carries; C the dashpot's; each to 1 %.

    Notes
    -----
    With free tilts the ring leans as it moves: m is that of the static shape, its tilt inertia included.
    """
    integration = {"kind": integrator, "turns": 6}
    tables = steady(
        excitation=SMALL, identifier=FIT, rotor={"damping": 800.0}, integrator=integration, supports={"tilt": tilt}
    )
    result = run(scene_from_dict(tables))
    found = result.identification
    free = 3 if tilt == "locked" else 5
    compliance = np.linalg.inv(result.equilibrium.stiffness[:free, :free])
    shape = compliance[:, 1] / compliance[1, 1]
    mass = shape @ result.model.system.mass[:free, :free] @ shape
    assert mass == result.model.system.mass[1, 1] if tilt == "locked" else mass > 1.05 * result.model.system.mass[1, 1]
    assert found.mass_used == pytest.approx(mass, rel=0.01)
    assert found.equivalent_damping == pytest.approx(800.0, rel=0.01)
    assert found.equivalent_stiffness == pytest.approx(1.0 / compliance[1, 1], rel=0.01)
    assert found.residual < 1e-3
    assert [round(w * 30.0 / np.pi) for w, _ in found.series] == [8000, 12000, 16000, 24000]


def test_fit_of_a_series_of_equilibria_has_no_mass():
    tables = steady(excitation=SMALL, identifier=FIT, integrator={"kind": "quasi_static"})
    found = run(scene_from_dict(tables)).identification
    assert abs(found.mass_used) < 1e-6 * found.equivalent_stiffness / found.speed**2


@pytest.mark.parametrize(
    ("speeds", "words"),
    [
        ([9000.0], "at least two different speeds"),
        ([9000.0, 9000.0], "two different"),
        ([0.0, 1.0], "greater than 0"),
        ([], "two"),
    ],
)
def test_bad_speeds(speeds, words):
    with pytest.raises(SceneError, match=rf"identifier\.speeds_rpm.*{words}"):
        scene_from_dict(steady(excitation=SMALL, identifier={"kind": "impedance_fit", "speeds_rpm": speeds}))


def rising(first=6000.0, last=9000.0, duration=0.6, **tables):
    excitation = {"kind": "run_up", "first_speed_rpm": first, "speed_rpm": last, "duration_s": duration, "unbalance": 3.2e-4}
    return steady(
        **{
            "excitation": {**excitation, **tables.pop("excitation", {})},
            "identifier": {"kind": "order_tracking", "window_turns": 4.0},
            "integrator": {"steps_per_turn": 120},
            **tables,
        }
    )


@pytest.mark.parametrize(("first", "last"), [(6000.0, 9000.0), (9000.0, 6000.0)])
@pytest.mark.parametrize("whirl", ["forward", "backward"])
def test_slow_run_up_agrees_with_steady_runs(first, last, whirl):
    """0.2 %: in a window of four turns the speed changes by some 3 %, Z by m w^2 and the amplitude's bend."""
    found = run(scene_from_dict(rising(first, last, excitation={"whirl": whirl}))).identification
    assert len(found.series) > 15
    speeds = np.array([w for w, _ in found.series]) * 30.0 / np.pi
    assert (np.diff(speeds) * np.sign(last - first) > 0.0).all()
    for k in (1, len(speeds) // 2, -2):
        tables = steady(float(speeds[k]), excitation={"unbalance": 3.2e-4, "whirl": whirl}, integrator={"turns": 4})
        expected = run(scene_from_dict(tables)).identification.dynamic_stiffness
        assert abs(found.series[k][1] - expected) < 2e-3 * abs(expected)
    forward, backward = found.forward_amplitude, found.backward_amplitude
    assert (forward > 100.0 * backward) if whirl == "forward" else (backward > 100.0 * forward)


def test_phase_is_the_kernels():
    """Up to the end and beyond it, where the speed stays: F turns with ``phase`` but for the tangential part."""
    force = RunUp(first_speed_rpm=3000.0, speed_rpm=9000.0, duration_s=0.1, unbalance=1e-3, phase_lag_deg=20.0)
    kernel, params, out = force.kernel(), force.parameters(), np.zeros(5)
    times = np.linspace(0.0, 0.15, 301)
    phase = force.phase(times)
    assert phase[0] == pytest.approx(-np.radians(20.0))
    rate = (force.phase(times + 1e-7) - force.phase(times - 1e-7)) / 2e-7
    speed = np.pi / 30.0 * np.minimum(3000.0 + 6000.0 * times / 0.1, 9000.0)
    np.testing.assert_allclose(rate, speed, rtol=1e-5)
    for t, p, w in zip(times, phase, speed, strict=True):
        kernel(t, params, out)
        across = 1e-3 * (6000.0 * np.pi / 30.0 / 0.1 if t < 0.1 else 0.0)
        radial = 1e-3 * w**2
        assert out[1] == pytest.approx(radial * np.cos(p) + across * np.sin(p), abs=1e-9 * radial)
        assert out[2] == pytest.approx(radial * np.sin(p) - across * np.cos(p), abs=1e-9 * radial)


def test_run_up_force_is_the_reaction_of_the_centre_of_mass():
    """-m d2/dt2 (e cos phase, e sin phase), by differences."""
    force = RunUp(first_speed_rpm=3000.0, speed_rpm=9000.0, duration_s=0.1, unbalance=1e-3)
    kernel, params, out, h = force.kernel(), force.parameters(), np.zeros(5), 1e-5
    for t in (0.01, 0.05, 0.09):
        phase = force.phase(np.array([t - h, t, t + h]))
        for part, wave in ((1, np.cos(phase)), (2, np.sin(phase))):
            kernel(t, params, out)
            assert out[part] == pytest.approx(-1e-3 * (wave[0] - 2.0 * wave[1] + wave[2]) / h**2, rel=1e-3, abs=0.05)


@pytest.mark.parametrize("identifier", ["fft_1x", "sine_fit", "tangent", "impedance_fit"])
def test_identifiers_of_one_speed_are_refused(identifier):
    from raceway import make_plan

    tables = rising()
    tables["identifier"] = {"kind": identifier, **({"speeds_rpm": [8e3, 9e3]} if identifier == "impedance_fit" else {})}
    with pytest.raises(SceneError, match=r"identifier\.kind.*order_tracking"):
        make_plan(scene_from_dict(tables))


def test_short_run_up_is_refused_with_the_remedy():
    from raceway import ConvergenceError

    with pytest.raises(ConvergenceError, match="less than 4 turns.*window_turns"):
        run(scene_from_dict(rising(duration=0.02)))


def test_plan_says_what_a_run_up_leaves_out(built):
    plan = built(**{k: v for k, v in rising().items() if k != "title"}).plan
    assert any("centrifugal forces with the speed" in part.part and "9000" in part.why for part in plan.left_out)
