"""Several speeds: K and C by a fit, a run-up with order tracking."""

from types import SimpleNamespace

import numpy as np
import pytest

from checks.validation.scenes import built_in
from raceway import ConvergenceError, SceneError, make_plan, run, scene_from_dict
from raceway.core.ring.energy import friction_energy
from raceway.extend import CAGE, Schedule, SteppedBearing, at_rest, integrate, layout
from raceway.testing import b7206c, ring_inertia, series_warnings

RunUp = built_in("excitation", "run_up")


def steady(rpm=12000.0, **tables):
    excitation = {"kind": "bidirectional", "speed_rpm": rpm, **tables.pop("excitation", {})}
    rotor = {"mass": 2.0, **tables.pop("rotor", {})}
    kinematics = {"spin_speed_rpm": 9000.0, **tables.pop("kinematics", {})}
    return b7206c(excitation=excitation, rotor=rotor, kinematics=kinematics, **tables)


#: 400 N and 2 kg; the spin speed is the excitation's.
ROTOR = {"load": {"axial": 400.0}, "rotor": {"mass": 2.0}}
SMALL = {"amplitude": "constant", "force": 2.0}
FIT = {"kind": "impedance_fit", "speeds_rpm": [8000.0, 12000.0, 16000.0, 24000.0]}


#: kg m2, half the rig's disc; ring included it is 8.07e-3 and 4.1e-3.
SPINNING = {"polar_inertia": 8.05e-3, "transverse_inertia": 4.1e-3}


def linear(result, spin_rpm, whirl_rpm):
    """Z [N/m] of a force that turns with the whirl speed on the tangent: ring and rotor with their gyroscopic moments.  +I_p
    W theta_z' about y and -I_p W theta_y' about z, see ``test_rotor_moments``; the rotor's dashpot acts on translations."""
    model, w = result.model, whirl_rpm * np.pi / 30.0
    free = 3 if model.scene.supports.tilt == "locked" else 5
    rates = np.zeros((5, 5))
    rates[:3, :3] = model.scene.rotor.damping * np.eye(3)
    rates[3, 4] = (model.scene.rotor.polar_inertia + ring_inertia(model.scene.bearing)[2]) * spin_rpm * np.pi / 30.0
    rates[4, 3] = -rates[3, 4]
    dynamic = result.equilibrium.stiffness - w**2 * model.system.mass + 1j * w * rates
    force = np.array([0.0, 1.0, -1j, 0.0, 0.0])[:free]
    return 1.0 / np.linalg.solve(dynamic[:free, :free], force)[1]


@pytest.mark.parametrize("integrator", ["newmark", "central_difference", "generalized_alpha"])
@pytest.mark.parametrize("tilt", ["locked", "free"])
def test_fit_is_that_of_the_linear_model(built, integrator, tilt):
    """K, C and misfit are those of the tangent, fitted in the same way, to 1 % of K.  With tilts locked Z is of this form; with
    free ones a rotor with polar inertia makes another Z of every whirl speed: the misfit is 20 % and more."""
    rotor = {"damping": 800.0, **(SPINNING if tilt == "free" else {})}
    tables = steady(
        excitation=SMALL, identifier=FIT, rotor=rotor, integrator={"kind": integrator, "turns": 6}, supports={"tilt": tilt}
    )
    result = run(tables)
    found, m = result.identification, result.model.system.mass[1, 1]
    w = np.array(FIT["speeds_rpm"]) * np.pi / 30.0
    z = np.array([linear(result, 9000.0, rpm) for rpm in FIT["speeds_rpm"]])
    k, c = np.mean(z.real + m * w**2), w @ z.imag / (w @ w)
    assert found.mass_used == m
    assert found.equivalent_stiffness == pytest.approx(k, rel=0.01)
    assert found.equivalent_damping == pytest.approx(c, rel=0.01)
    assert [round(s * 30.0 / np.pi) for s, _ in found.series] == FIT["speeds_rpm"]
    assert np.array([one for _, one in found.series]) == pytest.approx(z, rel=0.01)
    fitted = k - m * w**2 + 1j * w * c
    scale = np.where(w == w[1], np.minimum(abs(z), abs(fitted)), abs(z))  # at the scene's speed both Z are stated
    misfit = (abs(z - fitted) / scale).max()
    told = any("not of the form K - m w^2 + j w C" in text for text in result.warnings)
    if tilt == "locked":
        assert c == pytest.approx(800.0) and misfit < 1e-9 and result.error["identification"] < 1e-3 and not told
    else:
        assert misfit > 0.2 and result.error["identification"] == pytest.approx(misfit, rel=0.05) and told


#: 400 N, 2 kg, free tilts, and a disc.
DISC = {"supports": {"tilt": "free"}, "load": {"axial": 400.0}}
DISC["rotor"] = {"mass": 2.0, "polar_inertia": 5e-3, "transverse_inertia": 3e-3}


@pytest.mark.parametrize(
    "speeds",
    [[11e3, 12e3, 13e3, 14e3, 15e3], [12e3, 14e3], [1e3, 2e3, 3e3], [16e3, 20e3]],
    ids=["around", "between", "above", "below"],
)
def test_error_of_a_fit_covers_its_distance_from_the_steady_motion(speeds):
    excitation = {"kind": "bidirectional", "speed_rpm": 13000.0, "unbalance": 1e-4}
    result = run(
        scene_from_dict(b7206c(**DISC, excitation=excitation, identifier={"kind": FIT["kind"], "speeds_rpm": speeds}))
    )
    one = run(b7206c(**DISC, excitation=excitation, integrator={"kind": "periodic"})).identification
    found = result.identification
    off = abs(found.dynamic_stiffness - one.dynamic_stiffness) / abs(found.dynamic_stiffness)
    # A thousandth: steps in time of the motion that the fit is held against.
    assert off > 5e-3 and 1.001 * result.error["total"] >= off
    assert found.mass_used == one.mass_used
    # K and Z differ by the known m w^2 alone.
    wrong = abs(found.equivalent_stiffness - one.equivalent_stiffness)
    assert wrong <= 1.001 * result.to_dict()["identification"]["equivalent_stiffness_error"]
    told = any("use identifier 'fft_1x' at each" in text for text in result.warnings)
    assert told == (result.error["identification"] > 0.05)


@pytest.mark.parametrize("speeds", [[11000.0, 15000.0], [11000.0, 12000.0, 13000.0, 14000.0, 15000.0]])
@pytest.mark.parametrize("unbalance", [1e-4, 3.2e-4])
def test_fit_does_not_take_what_balls_and_amplitude_change_for_mass(speeds, unbalance):
    """Against K of the same turning force at one speed; the error is that of the amplitude, which falls and rises with the whirl."""
    more = {**ROTOR, "excitation": {"kind": "bidirectional", "speed_rpm": 15000.0, "unbalance": unbalance}}
    result = run(b7206c(**more, identifier={"kind": "impedance_fit", "speeds_rpm": speeds}))
    steady = run(b7206c(**more)).identification
    found, size = result.identification, abs(steady.dynamic_stiffness)
    assert found.mass_used == pytest.approx(steady.mass_used, rel=1e-9)
    assert found.equivalent_stiffness == pytest.approx(steady.equivalent_stiffness, rel=0.02)
    off = abs(found.equivalent_stiffness - steady.equivalent_stiffness) / size
    assert 0.5 * off < result.error["identification"] < 3.0 * off
    assert result.error["total"] >= result.error["identification"]


def test_fit_at_the_middle_of_the_speeds():
    """An independent program's K at 13 000 r/min is 136.5."""
    excitation = {"kind": "bidirectional", "speed_rpm": 13000.0, "unbalance": 3.2e-4}
    identifier = {"kind": "impedance_fit", "speeds_rpm": [11000.0, 12000.0, 13000.0, 14000.0, 15000.0]}
    found = run(b7206c(**ROTOR, excitation=excitation, identifier=identifier)).identification
    assert 1e-6 * found.equivalent_stiffness == pytest.approx(136.5, rel=1e-3)


def test_other_whirl_speeds_have_the_same_force():
    force = built_in("excitation", "bidirectional")(speed_rpm=12000.0, unbalance=3.2e-4, load_share=0.5, phase_lag_deg=30.0)
    other = force.at_whirl(9000.0)
    assert other.amplitude_n == force.amplitude_n and other.speed_rpm == 9000.0 and other.phase_lag_deg == 30.0
    assert other.unused_options() == {}


def test_fit_of_a_series_of_equilibria_has_no_mass():
    found = run(steady(excitation=SMALL, identifier=FIT, integrator={"kind": "quasi_static"})).identification
    assert abs(found.mass_used) < 1e-6 * found.equivalent_stiffness / found.speed**2


@pytest.mark.parametrize(("speeds", "words"), [
    ([9000.0], "at least two speeds"), ([9000.0, 9000.0], "5 % or more above the smallest"),
    ([9000.0, 9001.0, 9449.0], "5 % or more above the smallest: closer ones make K wrong by 20 times"),
    ([0.0, 1.0], "greater than 0"), ([], "two"),
])  # fmt: skip
def test_bad_speeds(speeds, words):
    with pytest.raises(SceneError, match=rf"identifier\.speeds_rpm.*{words}"):
        scene_from_dict(steady(excitation=SMALL, identifier={"kind": "impedance_fit", "speeds_rpm": speeds}))


def rising(first=6000.0, last=9000.0, duration=0.6, **tables):
    excitation = {"kind": "run_up", "first_speed_rpm": first, "speed_rpm": last, "duration_s": duration, "unbalance": 3.2e-4}
    tables["excitation"] = {**excitation, **tables.get("excitation", {})}
    methods = {"identifier": {"kind": "order_tracking", "window_turns": 4.0}, "integrator": {"steps_per_turn": 120}}
    return steady(**{**methods, **tables})


@pytest.mark.parametrize(("first", "last"), [(6000.0, 9000.0), (9000.0, 6000.0)])
@pytest.mark.parametrize("whirl", ["forward", "backward"])
def test_slow_run_up_agrees_with_steady_runs(first, last, whirl):
    """0.2 %: in a window of four turns the speed changes by some 3 %, Z by m w^2 and the amplitude's bend."""
    found = run(rising(first, last, excitation={"whirl": whirl})).identification
    assert len(found.series) > 15
    speeds = np.array([w for w, _ in found.series]) * 30.0 / np.pi
    assert (np.diff(speeds) * np.sign(last - first) > 0.0).all()
    for k in (1, len(speeds) // 2, -2):
        tables = steady(float(speeds[k]), excitation={"unbalance": 3.2e-4, "whirl": whirl}, integrator={"turns": 4})
        expected = run(tables).identification.dynamic_stiffness
        assert abs(found.series[k][1] - expected) < 2e-3 * abs(expected)
    forward, backward = found.forward_amplitude, found.backward_amplitude
    assert (forward > 100.0 * backward) if whirl == "forward" else (backward > 100.0 * forward)


def test_windows_of_a_run_up_that_lag_behind_are_told():
    windows = tuple((rpm * np.pi / 30.0, 1e8 + 0j) for rpm in (6000.0, 7000.0, 8000.0, 9000.0))
    (words,) = series_warnings(SimpleNamespace(series=windows, series_error=(0.01, 0.2, None, 0.06)))
    assert "in 2 of 4 windows, 7000 to 9000 r/min: the error of Z is up to 0.2 of |Z| there (at 7000 r/min)" in words
    assert series_warnings(SimpleNamespace(series=windows, series_error=(0.01, 0.04, None, 0.0))) == []


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
    force = RunUp(first_speed_rpm=3000.0, speed_rpm=9000.0, duration_s=0.1, unbalance=2e-3, load_share=0.5)
    kernel, params, out, h = force.kernel(), force.parameters(), np.zeros(5), 1e-5
    for t in (0.01, 0.05, 0.09):
        phase = force.phase(np.array([t - h, t, t + h]))
        for part, wave in ((1, np.cos(phase)), (2, np.sin(phase))):
            kernel(t, params, out)
            assert out[part] == pytest.approx(-1e-3 * (wave[0] - 2.0 * wave[1] + wave[2]) / h**2, rel=1e-3, abs=0.05)


@pytest.mark.parametrize("identifier", ["fft_1x", "sine_fit", "tangent", "impedance_fit"])
def test_identifiers_of_one_speed_are_refused(identifier):
    tables = rising()
    tables["identifier"] = {"kind": identifier, **({"speeds_rpm": [8e3, 9e3]} if identifier == "impedance_fit" else {})}
    with pytest.raises(SceneError, match=r"identifier\.kind.*order_tracking"):
        make_plan(scene_from_dict(tables))


def test_short_run_up_is_refused_with_the_remedy():
    with pytest.raises(ConvergenceError, match="less than 4 turns.*window_turns"):
        run(rising(duration=0.02))


def test_plan_says_whether_balls_follow_a_run_up(built):
    tables = rising()
    held = built(**tables).plan
    assert any("terms with the speed" in part.part and "9000" in part.why for part in held.left_out)
    followed = built(**{**tables, "kinematics": {}}).plan
    assert any("terms with the speed" in part.part for part in followed.kept)


#: Everything that goes with the speed.
ALL = {"orbiting": True, "gyroscopic": "outer_race", "ring_growth": True, "radial_expansion": 1e-6}


def turning(first, last, **more):
    excitation = {"kind": "run_up", "first_speed_rpm": first, "speed_rpm": last, "duration_s": 0.5, "unbalance": 1e-4}
    identifier = {"kind": "order_tracking", "window_turns": 4.0}
    return b7206c(
        **{**ROTOR, "excitation": excitation, "identifier": identifier, "integrator": {"steps_per_turn": 120}, **more}
    )


@pytest.mark.parametrize("bodies", ["rigid", "condensed"])
def test_constants_of_a_moment_are_those_of_a_steady_scene(built, bodies):
    """Half-way between 6000 and 15 000 r/min, against a bearing built for 10 500; balls have travelled with the phase."""
    more = {"kinematics": ALL, "bodies": {"kind": bodies}, "supports": {"tilt": "free"}}
    more["rotor"] = {"mass": 2.0, "transverse_inertia": 2e-3, "polar_inertia": 1e-3}
    model = built(**turning(6000.0, 15000.0, **more))
    excitation = {"kind": "bidirectional", "speed_rpm": 10500.0, "unbalance": 1e-4}
    still = built(**b7206c(**{**ROTOR, **more}, excitation=excitation)).system
    now = model.system.at_speed(0.25)
    assert now.scalars == pytest.approx(still.scalars, rel=1e-8)
    assert now.damping == pytest.approx(still.damping, rel=1e-8)
    assert now.table[:, layout.CENTRIFUGAL :] == pytest.approx(still.table[:, layout.CENTRIFUGAL :], rel=1e-8)
    direction = now.centre_vectors(np.zeros(5), 0.25)[1]
    turned = 0.25 * 0.5 * (6000.0 + 10500.0) * still.scalars[CAGE] / 10500.0
    expected = np.arctan2(still.table[:, layout.SINE], still.table[:, layout.COSINE]) + turned
    assert direction[:, 0] == pytest.approx(np.cos(expected), abs=1e-7)
    assert direction[:, 1] == pytest.approx(np.sin(expected), abs=1e-7)
    assert now.at_speed(0.4) is now and model.system.scalars[CAGE] > now.scalars[CAGE]


@pytest.mark.parametrize("integrator", ["newmark", "central_difference"])
def test_steps_from_python_follow_the_speed(built, integrator):
    """The loops in Python take the same steps as the compiled ones."""
    model = built(**turning(6000.0, 15000.0, kinematics=ALL, integrator={"kind": integrator, "steps_per_turn": 360}))
    schedule = Schedule(1.0 / 250.0 / 360.0, 360, 1)
    system = model.system.at_speed(0.0)
    q, ball, _ = system.solve_equilibrium(model.guess)
    start = at_rest(system, q, ball, False)
    compiled = integrate(model.scene.integrator.method, model.system, start, schedule)
    stepped = integrate(model.scene.integrator.method, SteppedBearing(model.system), start, schedule)
    # 1e-9 of the step's forces is Newton's tolerance.
    assert np.abs(stepped.displacement - compiled.displacement).max() < 1e-6 * np.abs(compiled.displacement).max()


@pytest.mark.parametrize("tables", [{"bodies": {"kind": "elastic"}}, {"contact": {"discretisation": "nodal"}}])
def test_bodies_whose_forces_do_not_follow_are_refused(tables):
    nodal = {"contact": {"kind": "unilateral", "discretisation": "nodal"}, "bodies": {"kind": "condensed"}}
    whole = {"bodies": {"kind": "elastic"}, "mesh": {"kind": "structured", "element_size": 3.2e-3, "nodes_per_semi_axis": 0}}
    more = whole if "bodies" in tables else nodal
    with pytest.raises(SceneError, match=r"kinematics\.spin_speed_rpm"):
        make_plan(scene_from_dict(turning(6000.0, 15000.0, **more)))
    make_plan(scene_from_dict(turning(6000.0, 15000.0, **more, kinematics={"spin_speed_rpm": 9000.0})))


def test_windows_of_a_slow_run_up_have_small_errors_and_no_warning():
    """Z of each window is within 0.2 % of a steady run's (above), and says so within a factor of 2 of that."""
    result = run(rising())
    assert 0.0 < max(result.identification.series_error) < 4e-3
    assert not any("windows" in text for text in result.warnings)


def test_friction_of_a_run_up_sees_the_growth_of_the_ring():
    """The place of a contact takes the groove's growth at each moment: at the reference speed it is the constant's own."""
    tables = b7206c(
        load={"axial": 400.0},
        excitation={
            "kind": "run_up", "first_speed_rpm": 6000.0, "speed_rpm": 12000.0, "duration_s": 0.02, "unbalance": 1e-5,
        },
        kinematics={"ring_growth": True},
        mounting={"shaft_interference": 4e-6},
        contact={"friction": 0.03},
        integrator={"turns": 2, "steps_per_turn": 60},
        identifier={"kind": "order_tracking", "window_turns": 2.0},
    )  # fmt: skip
    result = run(tables)
    spin = result.model.system.spin
    assert spin.grown(np.array([spin.reference])) == pytest.approx(0.0, abs=1e-15)
    assert abs(spin.grown(np.array([0.5 * spin.reference]))[0]) > 1e-8
    record = result.simulation.record
    stored = friction_energy(result.model.system, record)
    assert stored.lost.shape == record.time.shape and np.isfinite(stored.lost).all()
