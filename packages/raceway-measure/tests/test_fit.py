"""Numbers from measured data: closed forms, the scene's own answers, what is not determined, and bad input."""

import json

import attrs
import numpy as np
import pytest
from raceway_measure.fit.estimate import Free, estimate, free_keys, judged
from raceway_measure.fit.linear import LinearResiduals, free_parts
from raceway_measure.fit.rig import RigResiduals
from raceway_measure.fit.shaft_angle import rotation_of
from raceway_measure.fit.signals import recording_of, signals_of, write_recording
from raceway_measure.fit.spectra import aliasing_error, largest_tone, spectra_of, spectrum_of, uneven_block
from raceway_measure.fit.synchronous import RunOut, synchronous
from raceway_measure.fit.table import TableResiduals, measurements_in
from raceway_measure.rig.signals import record as rig_record
from raceway_measure.rig.signals import response, slow_roll_record, white_noise
from raceway_rotor.rig_table import rig_of
from raceway_rotor.shaft import balance, bearing, rotor

import raceway as rw
from checks.validation.command_line import EXAMPLES, invoke
from checks.validation.shaker import hammer_record, record, turning_record
from raceway import ConvergenceError, RacewayError, SceneError, load_scene
from raceway.extend import NumberTable, with_number
from raceway.testing import b7206c, default_registry

ANGLE = "bearing.contact_angle_deg"
LOADED = b7206c(load={"axial": 500.0})
LOADS = (400.0, 1000.0, 2000.0, 3000.0)
MOVING = {
    **LOADED,
    "rotor": {"mass": 2.0, "damping": 1000.0},
    "excitation": {"kind": "bidirectional", "speed_rpm": 6000.0, "amplitude": "constant", "force": 50.0},
}


def answers(tables, name, **bearing):
    """A quantity of scenes with another bearing over load."""
    scene = {**tables, "bearing": {**tables["bearing"], **bearing}}
    scenes = [rw.evolve(scene, f"load.axial={load}") for load in LOADS]
    if name in ("y", "z"):
        return [float(rw.run(scene).equilibrium.displacement["xyz".index(name)]) for scene in scenes]
    return [rw.sensitivities(scene, ["load.axial"]).values[name] for scene in scenes]


LINE = [Free("a", "", 1.0, 10.0), Free("b", "", 1.0, 10.0)]


@attrs.define
class Straight:
    """y = a + b x with unit errors: the textbook's line."""

    x: np.ndarray
    y: np.ndarray

    def residuals(self, at):
        return at[0] + at[1] * self.x - self.y

    def jacobian(self, _at):
        return np.column_stack([np.ones_like(self.x), self.x])


def test_a_straight_line_is_the_closed_form():
    """Covariance s^2 (X' X)^-1 and Student's half-widths of a regression line."""
    from scipy.stats import linregress, t

    x = np.linspace(0.0, 5.0, 9)
    y = 2.0 + 3.0 * x + np.random.default_rng(2).standard_normal(9)
    found = estimate(Straight(x, y), LINE, stated=False)
    line = linregress(x, y)
    assert found.values == pytest.approx([line.intercept, line.slope], rel=1e-8)
    assert found.half == pytest.approx(t.ppf(0.975, 7) * np.array([line.intercept_stderr, line.stderr]), rel=1e-6)
    known = estimate(Straight(x, y), LINE, stated=True)
    assert known.half[1] == pytest.approx(1.959964 / np.sqrt(((x - x.mean()) ** 2).sum()), rel=1e-6)


def test_errors_that_are_stated_too_small_widen_the_intervals_and_are_told():
    from scipy.stats import linregress, t

    x = np.linspace(0.0, 5.0, 9)
    far = Straight(x, 2.0 + 3.0 * x + 30.0 * np.random.default_rng(2).standard_normal(9))
    found = estimate(far, LINE, stated=True)
    assert found.widened == pytest.approx(found.scatter) and found.widened > 10.0
    x = np.linspace(0.0, 5.0, 900)
    y = 2.0 + 3.0 * x + 5.0 * np.random.default_rng(2).standard_normal(900)
    line = linregress(x, y)
    found = estimate(Straight(x, y), LINE, stated=True)
    assert found.half == pytest.approx(t.ppf(0.975, 898) * np.array([line.intercept_stderr, line.stderr]), rel=1e-6)


def test_two_numbers_that_only_add_up_are_told_as_a_combination():
    """Derivatives by two numbers that are alike: their sum is known, their difference is not."""
    free = (Free("a", "N", 10.0, 10.0), Free("b", "N", 5.0, 5.0), Free("c", "m", 1.0, 1.0))
    j = np.column_stack([np.ones(8), np.ones(8), np.linspace(-2.0, 2.0, 8)])
    found = judged(free, np.array([10.0, 5.0, 1.0]), np.resize([0.1, -0.1], 8), j, False, 1)
    (one,) = found.undetermined
    assert set(one.changes) == {"a", "b"} and one.changes["a"] == pytest.approx(-one.changes["b"])
    assert one.moves == pytest.approx(0.0, abs=1e-12)
    assert np.isinf(found.half[:2]).all() and np.isfinite(found.half[2])
    # a + b is as known as c; a alone by its size.
    both, alone = found.half_widths(np.array([[1.0, 1.0, 0.0], [1.0, 0.0, 0.0]]))
    assert both < 1.0 < alone


@pytest.mark.parametrize(("tables", "name", "rel"), [
    (LOADED, "kxx", 1e-6), (LOADED, "x", 1e-6), (MOVING, "K", 1e-5), ({**LOADED, "load": {"axial": 500.0, "radial": [20.0, 90.0]}}, "z", 1e-5),
])  # fmt: skip
def test_exact_answers_of_another_bearing_give_its_angle_back(tables, name, rel):
    unit = "m" if name in "xyz" else "N/m"
    data = {"axial [N]": LOADS, f"{name} [{unit}]": answers(tables, name, contact_angle_deg=17.0)}
    found = rw.fit(data, tables, ANGLE)
    assert found[ANGLE] == pytest.approx(17.0, rel=rel)
    assert found.estimate.parts["noise"] < 1e-2 and found.determined
    at_end = attrs.evolve(found, estimate=attrs.evolve(found.estimate, at_limit=(ANGLE,)))
    assert ["at the end of its range" in " ".join(one.warnings) for one in (found, at_end)] == [False, True]


def test_derivatives_of_residuals_are_those_of_the_residuals():
    """Exact gradients of the scene against central differences of whole answers."""
    scene = rw.Scene.from_dict(MOVING)
    table = NumberTable(
        ["axial [N]", "K [N/µm]", "kxx [N/µm]"], np.array([[400.0, 40.0, 140.0], [900.0, 60.0, 160.0]]), np.arange(2)
    )
    free = free_keys(scene, [ANGLE, "rotor.mass"])
    measured = measurements_in(table, "made up", scene)
    assert [sizes[0] for sizes in measured.weights.values()] == pytest.approx([50e6, 150e6])  # of one relative size
    table = NumberTable(["axial [N]", "K [N/µm]", "K error [N/µm]"], np.array([[400.0, 40.0, 1.96]]), np.arange(1))
    assert measurements_in(table, "", scene).errors["K"] == pytest.approx([1e6], rel=1e-3)  # of half an interval of 95 %
    problem = TableResiduals(measured, free, scene)
    at = np.array([15.5, 2.0])
    problem.residuals(at)
    exact = problem.jacobian(at)
    steps = np.array([1e-3, 1e-3])
    for k, step in enumerate(steps):
        ends = [problem.residuals(at + sign * step * np.eye(2)[k]) for sign in (-1.0, 1.0)]
        # Orbits are solved to 1e-8, over a step of 1e-4 of the number.
        assert exact[:, k] == pytest.approx((ends[1] - ends[0]) / (2.0 * step), rel=1e-3, abs=1e-3 * np.abs(exact).max())


def test_what_the_data_do_not_determine_is_said_with_the_combination(tmp_path):
    """kxx at rest knows no mass; K under one load knows angle or load, not both."""
    data = {"axial [N]": LOADS, "kxx [N/m]": answers(MOVING, "kxx", contact_angle_deg=17.0)}
    found = rw.fit(data, MOVING, [ANGLE, "rotor.mass"])
    assert found[ANGLE] == pytest.approx(17.0, rel=1e-5) and np.isinf(found.half_width("rotor.mass"))
    assert "do not determine rotor.mass" in found.warnings[0]
    one = {"kxx [N/m]": [67e6, 67e6, 67e6], "kxx error [N/m]": [1e6, 1e6, 1e6]}
    both = rw.fit(one, LOADED, [ANGLE, "load.axial"])
    assert not both.determined and set(both.estimate.undetermined[0].changes) == {ANGLE, "load.axial"}
    assert "together" in both.warnings[0] and both.to_dict()["free"][0]["error"] is None


TABLE = {"axial [N]": [400.0, 1000.0], "kxx [N/um]": [39.0, 67.0]}
BAD = [
    (TABLE, [], "names no key"), (TABLE, ["bearing.ball_count"], "no continuous key"),
    (TABLE, [ANGLE, ANGLE], "twice"), (TABLE, ["load.axial"], "column of the data"),
    (TABLE, ["integrator.tolerance"], "setting of a method"),
    (TABLE, [ANGLE, "bearing.conformity_inner", "bearing.conformity_outer"], "2 measured numbers do not determine 3 free"),
    ({}, [ANGLE], "is empty"), ({"axial [N]": [], "kxx [N/um]": []}, [ANGLE], "no measurements"),
    ({"axial [N]": [400.0], "kxx": [39.0]}, [ANGLE], "has no unit"),
    ({"axial [N]": [400.0], "kxx [um]": [39.0]}, [ANGLE], "not a unit"),
    ({"axial [m]": [400.0], "kxx [N/um]": [39.0]}, [ANGLE], "not a unit"),
    ({"axial [N]": [400.0], "kxy [N/um]": [39.0]}, [ANGLE], "unknown column 'kxy"),
    ({"axial [N]": [400.0]}, [ANGLE], "no measured quantity"),
    ({"axial [N]": [400.0], "kxx [N/um]": [39.0], "x error [um]": [1.0]}, [ANGLE], "no column x beside it"),
    ({"axial [N]": [400.0] * 2, "kxx [N/um]": [39.0, 60.0], "kxx error [N/um]": [1.0, 1.0]}, [ANGLE], "contradict"),
    ({"axial [N]": [400.0], "kxx [N/um]": [39.0], "kxx error [N/um]": [0.0]}, [ANGLE], "greater than 0"),
    ({"axial [N]": [400.0], "kxx [N/um]": [float("nan")]}, [ANGLE], "finite"),
    ({"axial [N]": [400.0, 500.0], "kxx [N/um]": [39.0]}, [ANGLE], "differ in length"),
    ({"axial [N]": [400.0], "K [N/um]": [39.0]}, [ANGLE], "excitation"),
    ({"conformity_inner": [0.2], "kxx [N/um]": [39.0]}, [ANGLE], "measurement 1"),
    ("no-such-file.csv", [ANGLE], "no such file"), (3.0, [ANGLE], "must be a CSV file"),
]  # fmt: skip


@pytest.mark.parametrize(("data", "free", "words"), BAD)
def test_what_cannot_be_fitted_is_refused_in_one_sentence(data, free, words):
    with pytest.raises(SceneError, match=words) as caught:
        rw.fit(data, LOADED, free)
    assert len(caught.value.mistakes) == 1 and "nan" not in str(caught.value)


def test_data_that_ask_for_what_is_not_physical_end_with_the_key_and_its_end():
    with pytest.raises(ConvergenceError, match=f"`{ANGLE}` ran to .*unphysical"):
        rw.fit({"axial [N]": [400.0, 1000.0, 2000.0], "kxx [N/um]": [0.1, 0.3, 0.4]}, LOADED, ANGLE)


@pytest.mark.parametrize(("mass", "free", "known"), [(2.0, "K,C,mass", None), (2.0, "K,C", 2.0), (0.0, "K,C", 0.0)])
def test_force_and_displacement_give_stiffness_damping_and_mass_back(mass, free, known):
    """Without noise to the accuracy of the record's transform: leakage of a record that begins at rest and ends anywhere."""
    found = rw.fit(record(5e7, 800.0, mass, 1, noise_db=200.0), free=free, mass=known)
    assert found["K"] == pytest.approx(5e7, rel=1e-3) and found["C"] == pytest.approx(800.0, rel=5e-3)
    if "mass" in free:
        assert found["mass"] == pytest.approx(2.0, rel=1e-3)


@pytest.mark.slow
def test_intervals_of_a_record_hold_what_they_state():
    """30 records with 40 dB of noise: 95 % of 60 intervals within what chance leaves, 50 at least (p = 1e-4)."""
    inside = 0
    for seed in range(30):
        found = rw.fit(record(5e7, 800.0, 2.0, 100 + seed), free="K,C", mass=2.0)
        inside += sum(abs(found[name] - true) <= found.half_width(name) for name, true in (("K", 5e7), ("C", 800.0)))
    assert 50 <= inside < 60  # never outside would be intervals that are too wide: p = 0.05


def test_derivatives_of_a_records_residuals_are_those_of_the_residuals():
    lines = spectra_of(signals_of(turning_record(np.diag([5e7, 4e7]), np.diag([800.0, 600.0]), 1.5, 3)))
    free = free_parts(["K", "C", "mass"], lines, None)
    colours = np.array([1.0, 0.5, 0.2])[:, None]
    noise = np.stack([colours * [1e-18, 2e-18], colours * [1e-4, 2e-4]])
    problem = LinearResiduals(lines, free, 0.0, noise, (2.0 * np.pi * 50.0,))
    sizes = np.array([one.size for one in (*free, *problem.nuisance)])
    at = sizes * np.linspace(0.5, 1.0, len(sizes))
    exact = problem.jacobian(at) * sizes
    for k in range(len(sizes)):
        step = 1e-5 * np.eye(len(sizes))[k] * sizes
        change = (problem.residuals(at + step) - problem.residuals(at - step)) / 2e-5
        assert exact[:, k] == pytest.approx(change, rel=1e-6, abs=1e-6 * np.abs(exact).max())


def test_what_noise_hides_is_not_determined():
    """A slope of 1 under a scatter of 10 over nine points is known to +- 5: less than itself."""
    x = np.linspace(-2.5, 2.5, 9)
    data = Straight(x, 20.0 + x + 10.0 * np.random.default_rng(4).standard_normal(9))
    found = estimate(data, [Free("a", "", 20.0, 20.0), Free("b", "", 1.0, 1.0)], stated=False)
    assert np.isinf(found.half).tolist() == [False, True] and set(found.undetermined[0].changes) == {"b"}
    # A tenth of the slope moves the data by that over the scatter.
    assert found.undetermined[0].moves == pytest.approx(0.1 * np.linalg.norm(x) / found.scatter)


def test_two_directions_give_all_parts():
    k, c = np.array([[5e7, 1e7], [-1e7, 4e7]]), np.array([[800.0, 100.0], [-50.0, 600.0]])
    found = rw.fit(turning_record(k, c, 1.5, 3), free="K,C,mass")
    with pytest.raises(RacewayError, match="of one axis"):
        found.to_uff("both.uff")
    for a, one in enumerate("yz"):
        for b, other in enumerate("yz"):
            assert abs(found[f"k{one}{other}"] - k[a, b]) < 2.0 * found.half_width(f"k{one}{other}")
            assert abs(found[f"c{one}{other}"] - c[a, b]) < 2.0 * found.half_width(f"c{one}{other}")
    assert found["mass"] == pytest.approx(1.5, rel=2e-3)


def test_a_single_frequency_does_not_tell_stiffness_from_mass():
    random, t = np.random.default_rng(0), np.arange(2000) / 8000.0
    w = 2.0 * np.pi * 200.0
    data = {
        "time_s": t,
        "force_n": 10.0 * np.cos(w * t) + 0.01 * random.standard_normal(2000),
        "x_um": 0.2 * np.cos(w * t - 0.1) + 0.002 * random.standard_normal(2000),
    }
    both = rw.fit(data, free="K,C,mass")
    assert np.isinf(both.half_width("K")) and np.isinf(both.half_width("mass")) and np.isfinite(both.half_width("C"))
    alone = rw.fit(data, free="K,C", mass=0.0)
    assert abs(alone["K"] - 5e7 * np.cos(0.1)) < 2.0 * alone.half_width("K")


def test_a_model_that_misses_the_record_is_told():
    found = rw.fit(record(5e7, 800.0, 2.0, 1), free="K,C", mass=0.0)
    assert any("leaves" in text and "free mass or cut the record" in text for text in found.warnings)
    alone = rw.fit(record(5e7, 800.0, 2.0, 1), free="mass").warnings
    assert "K and C are not free: taken as 0" in alone and any("free K and C or cut the record" in text for text in alone)


def test_a_mass_that_is_neither_free_nor_stated_is_freed_and_named():
    """0.1 % noise of a mass of 2 kg moves K by less than 0.1 %; without inertia K would be that of the record's frequencies."""
    found = rw.fit(record(5e7, 800.0, 2.0, 1), free="K,C")
    assert found["mass"] == pytest.approx(2.0, rel=3e-3) and abs(found["K"] - 5e7) < 2.0 * found.half_width("K")
    assert any("mass was neither free nor given" in text for text in found.warnings)
    only = rw.fit(record(5e7, 800.0, 2.0, 1), free="K,mass")
    assert "C is not free: taken as 0" in only.warnings
    assert not any("neither" in text for text in only.warnings)


def disturbed(hum=0.0, bump=0.0, seed=3):
    """The record of a shaker with 50 Hz in its displacement, or with noise about 700 Hz on both channels, over their sizes."""
    made, random = record(5e7, 800.0, 2.0, seed), np.random.default_rng(seed)
    t = made["time_s"]
    made["x_m"] = made["x_m"] + hum * made["x_m"].std() * np.cos(2.0 * np.pi * 50.0 * t + 1.0)
    shape = np.exp(-0.5 * ((np.fft.rfftfreq(len(t), t[1]) - 700.0) / 100.0) ** 2)
    for name in ("force_n", "x_m"):
        noise = np.fft.irfft(shape * np.fft.rfft(random.standard_normal(len(t))))
        made[name] = made[name] + bump * made[name].std() * noise / noise.std()
    return made


def test_hum_is_found_by_its_frequency_and_taken_off():
    """A tenth of the displacement would put K 0.3 % off, which has +- 0.07 % without hum."""
    found, clean = (rw.fit(disturbed(hum), free="K,C,mass") for hum in (0.14, 0.0))
    assert any("concentrated at 50" in text or "concentrated at 49.9" in text for text in found.warnings)
    assert abs(found["K"] - clean["K"]) < clean.half_width("K")
    assert found.half_width("K") == pytest.approx(clean.half_width("K"), rel=0.2)
    assert not clean.warnings


def test_noise_that_is_not_white_is_named_and_its_own_scatter_makes_the_interval():
    found = rw.fit(disturbed(bump=0.03), free="K,C,mass")
    assert any("not white" in text for text in found.warnings)
    assert abs(found["C"] - 800.0) < found.half_width("C") and found.half_width("C") > 0.003 * 800.0


def test_power_that_is_not_even_is_found_where_it_is():
    """Exponential power with four times the mean over a 16th of the lines, and none of the kind where it is even."""
    power = np.random.default_rng(4).exponential(size=(1600, 1))
    assert uneven_block(power) is None
    power[700:800] *= 4.0
    where, factor = uneven_block(power)
    assert 700 <= where < 800 and factor == pytest.approx(4.0 / (1.0 + 3.0 / 16.0), rel=0.3)


def test_a_tone_between_lines_is_found_at_its_frequency():
    """20.3 lines: the transform of a cosine is that of its window, which falls with the distance."""
    n, random = 2048, np.random.default_rng(5)
    noise, t = random.standard_normal(n), np.arange(n)
    lines = spectrum_of(np.cos(20.3 * 2.0 * np.pi * t / n + 1.0)[:, None])
    white, omega = np.full((200, 1), 1.0 / n), 2.0 * np.pi * np.arange(1, 201) / n
    small = spectrum_of(noise[:, None])[1:201]
    assert largest_tone(small, white, omega) is None
    assert largest_tone(lines[1:201] + small, white, omega) == pytest.approx(20.3 * 2.0 * np.pi / n, rel=2e-3)


def test_what_is_folded_back_is_of_the_size_of_what_sampling_adds():
    """Half sines of 2 to 4 samples, whose transform is known: w0 (1 + e^(-jwT)) / (w0^2 - w^2) with w0 = pi / T."""
    random, n, ratios = np.random.default_rng(1), 4096, []
    t, w = np.arange(n), 2.0 * np.pi * np.arange(n // 2 + 1) / n
    for _ in range(16):
        sampled, exact = np.zeros(n), np.zeros(n // 2 + 1, dtype=complex)
        for begin, width, size in zip(
            random.uniform(0, 0.9 * n, 4), random.uniform(2, 4, 4), random.uniform(1, 2, 4), strict=True
        ):
            phase, w0 = (t - begin) / width, np.pi / width
            sampled += np.where((phase > 0.0) & (phase < 1.0), size * np.sin(np.pi * phase), 0.0)
            exact += size * np.exp(-1j * w * begin) * w0 * (1.0 + np.exp(-1j * w * width)) / (w0**2 - w**2) / n
        error = spectrum_of(sampled[:, None])[20:1000, 0] - exact[20:1000]
        said, part = aliasing_error(sampled[:, None], np.array([1e-12]))
        assert 0.0 < part < 1.0
        ratios.append(np.sqrt((np.abs(error) ** 2).mean() / (np.abs(said[20:1000]) ** 2).mean()))
    assert 0.8 < np.exp(np.mean(np.log(ratios))) < 1.25


def test_pulses_sampled_without_a_filter_widen_the_interval_by_what_is_folded_back():
    found = rw.fit(hammer_record(5e7, 800.0, 2.0, 1), free="K,C,mass")
    parts = {cause: one[0] for cause, one in found.estimate.parts.items()}
    assert parts["aliasing"] > 3.0 * parts["noise"] and any("half the sampling rate" in text for text in found.warnings)
    assert abs(found["K"] - 5e7) < found.half_width("K") == pytest.approx(np.hypot(*parts.values()))


def test_grooves_that_are_off_by_what_the_catalogue_allows_lie_within_the_interval_and_are_named():
    """True grooves of 0.5235 D where the preset has 0.522 +- 0.2 %: 1.4 standard errors."""
    data = {
        "axial [N]": LOADS,
        "kxx [N/m]": answers(LOADED, "kxx", contact_angle_deg=17.0, conformity_inner=0.5235, conformity_outer=0.5235),
    }
    found = rw.fit(data, LOADED, ANGLE)
    parts = found.to_dict()["free"][0]["parts"]
    assert 0.3 < abs(found[ANGLE] - 17.0) < found.half_width(ANGLE) and max(parts, key=parts.get) == "groove conformities"
    # To first order a half-width is what the fit with grooves of a quarter of a standard error more moves by, four times.
    off = {
        **LOADED,
        "bearing": {**LOADED["bearing"], "conformity_inner": 0.522 * 1.0005, "conformity_outer": 0.522 * 1.0005},
    }
    moved = rw.fit(data, off, ANGLE)
    assert list(moved.estimate.parts) == ["noise"]  # numbers of one's own have no scatter, and that is said
    assert any("groove conformities are taken as exact" in text for text in moved.warnings)
    assert not any("groove" in text for text in found.warnings)
    assert parts["groove conformities"] == pytest.approx(4.0 * 1.96 * abs(moved[ANGLE] - found[ANGLE]), rel=0.05)


def test_tolerances_of_what_is_not_free_widen_the_interval():
    scene = {**LOADED, "tolerances": {"load.axial": "±2 %", ANGLE: "±1 deg"}}
    data = {"axial [N]": LOADS, "kxx [N/m]": answers(LOADED, "kxx", contact_angle_deg=17.0)}
    found = rw.fit(data, scene, ANGLE)
    assert set(found.estimate.parts) == {"noise", "load.axial", "groove conformities"}
    # All loads 2 % / sqrt(3) more, which the ranges' standard errors are.
    more = rw.fit({**data, "axial [N]": np.array(LOADS) * (1.0 + 0.02 / np.sqrt(3.0))}, LOADED, ANGLE)
    assert found.estimate.parts["load.axial"][0] == pytest.approx(1.96 * abs(more[ANGLE] - 17.0), rel=0.05)
    assert 1.96 * np.sqrt(found.to_dict()["covariance"][0][0]) == pytest.approx(found.half_width(ANGLE), rel=1e-3)


RECORD = record(5e7, 800.0, 2.0, 1)
BAD_RECORDS = [
    (RECORD, {"free": "stiffness"}, "no number of the linear model"), (RECORD, {"free": ""}, "names no number"),
    (RECORD, {"free": "K,mass", "mass": 1.0}, "either known or fitted"),
    (RECORD, {"free": "K", "mass": -1.0}, "at least 0 kg"), (RECORD, {"free": "K", "scene": LOADED}, "omit it"),
    (RECORD, {"free": "K", "slow_roll": "a.csv"}, "belongs to the signals of a rig"),
    ({**RECORD, "time_s": np.cumsum(1.0 + 0.5 * (np.arange(4096) % 2))}, {"free": "K"}, "even ones"),
    ({**RECORD, "force_n": np.ones(4096)}, {"free": "K"}, "is constant"),
    ({"time_s": RECORD["time_s"], "force_y_n": RECORD["force_n"],
        "z_m": RECORD["x_m"]}, {"free": "K"}, "along the same axis"),
    ({"time_s": RECORD["time_s"], "force_n": RECORD["force_n"]}, {"free": "K"}, "along the same axis"),
]  # fmt: skip


@pytest.mark.parametrize(("data", "given", "words"), BAD_RECORDS)
def test_records_that_cannot_be_fitted_are_refused(data, given, words):
    given = dict(given)
    with pytest.raises(SceneError, match=words):
        rw.fit(data, given.pop("scene", None), **given)


@pytest.fixture(scope="module")
def signals(tmp_path_factory):
    """Record and slow roll of a rig whose bearings have 17 deg, where the scene says 15."""
    folder = tmp_path_factory.mktemp("rig")
    scene = with_number(load_scene(EXAMPLES / "test_rig.toml"), "load.axial", 2000.0)
    rig = rig_of(scene)
    held = bearing(with_number(scene, ANGLE, 17.0), 2000.0, default_registry())
    state = balance(rotor(rig, 13000.0 * np.pi / 30.0), held)
    short = attrs.evolve(rig.signals, duration=0.25)
    answer = response(rig, held, state, short)
    write_recording(rig_record(rig, answer, short, 3), folder / "signals.csv")
    write_recording(slow_roll_record(rig, held, short, 4, white_noise(answer, short)), folder / "slow.csv")
    return folder, scene, state


def test_the_rigs_record_gives_the_angle_that_its_scene_does_not_say(signals):
    folder, scene, state = signals
    found = rw.fit(folder / "signals.csv", scene, ANGLE, slow_roll=folder / "slow.csv")
    assert abs(found[ANGLE] - 17.0) < 0.2  # issue
    assert abs(found[ANGLE] - 17.0) < 2.0 * found.half_width(ANGLE)
    assert found["K"] == pytest.approx(state.stiffness, rel=0.01)
    unlike = rw.identify(folder / "signals.csv", scene, slow_roll=folder / "slow.csv")
    missed = abs(unlike.equivalent_stiffness - state.stiffness)
    assert abs(found["K"] - state.stiffness) < 0.2 * missed
    # The tilt stiffness that identify assumes is another bearing's: its interval says so, and is no wild guess.
    assert 0.3 < missed / unlike.equivalent_stiffness_error < 1.0


def test_a_rigs_residuals_are_weighed_by_all_that_disturbs_them(signals):
    """A vector's variance lies half along the response and half across it; an angle turns it across alone."""
    folder, scene, _ = signals
    component, free = synchronous(rotation_of(recording_of(signals_of(folder / "signals.csv")))), free_keys(scene, [ANGLE])

    def variances(run_out=0.0, angle=0.0):
        turned = attrs.evolve(component, angle_error=angle)
        problem = RigResiduals(scene, rig_of(scene), default_registry(), free, turned, RunOut(0j, run_out))
        return np.square(problem._balance_at(scene, np.array([free[0].start])).errors)

    assert (variances(run_out=1e-6) - variances()) / 1e-12 == pytest.approx([0.5, 0.5])
    across = (0.02 * abs(component.forward) / 1.96) ** 2
    assert (variances(angle=0.02) - variances()) / across == pytest.approx([0.0, 1.0], rel=1e-3, abs=1e-9)


@pytest.mark.parametrize(("free", "words"), [
    ("excitation.unbalance", "is defined by the rig"), ("load.radial[0]", "circular whirl"),
    (f"{ANGLE},load.axial,bearing.conformity_inner", "2 measured"),
])  # fmt: skip
def test_keys_that_a_rig_does_not_tell_are_refused(signals, free, words):
    folder, scene, _ = signals
    with pytest.raises(SceneError, match=words):
        rw.fit(folder / "signals.csv", scene, free)


def test_the_command_writes_what_it_shows(tmp_path):
    table = tmp_path / "measured.csv"
    rows = zip(LOADS, answers(LOADED, "kxx", contact_angle_deg=17.0), strict=True)
    table.write_text("Load;Stiffness;note\n" + "".join(f"{load:g};{1e-6 * k:.6g};1\n" for load, k in rows))
    scene = tmp_path / "scene.toml"
    scene.write_text('[bearing]\npreset = "B7206C"\n[load]\naxial = 500.0\n')
    names = ("--map", "Load=load.axial [N]", "--map", "Stiffness=kxx [N/µm]", "--map", "note=ignore")
    words = ["fit", table, "--scene", scene, "--free", ANGLE, *names, "--out", tmp_path]
    shown = invoke(*words)
    assert shown.exit_code == 0, shown.output
    assert "17" in shown.output and (tmp_path / "fit.png").stat().st_size > 1000
    content = json.loads((tmp_path / "fit.json").read_text())
    assert content["free"][0]["value"] == pytest.approx(17.0, abs=1e-3) and content["series"][0]["x"] == list(LOADS)
    (number,) = json.loads(invoke(*words, "--json", "--no-pictures").stdout)["free"]
    assert [number] == content["free"] and number["low"] < number["value"] < number["high"]
    assert number["high"] - number["low"] == pytest.approx(2.0 * number["error"], rel=1e-3)
    wrong = invoke("fit", table, "--free", ANGLE)
    assert wrong.exit_code == 2 and "`--scene`" in wrong.output
