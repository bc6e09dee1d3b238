"""Frequency responses and time histories in universal files: K within its interval, round trips bit for bit, units right or refused."""

import numpy as np
import pytest
from instrument_files import DAMPING, MASS, NEWTONS_PER_VOLT, STIFFNESS, record, write
from raceway_measure.fit.linear import fit_record
from raceway_measure.fit.response import FrequencyResponse, response_of

import raceway as rw
from raceway import SceneError

pyuff = pytest.importorskip("pyuff")

HZ = np.arange(5.0, 600.0, 2.5)
OMEGA = 2.0 * np.pi * HZ
_RANDOM = np.random.default_rng(3)
NOISE = 1.0 + 2e-3 * (_RANDOM.standard_normal(len(HZ)) + 1j * _RANDOM.standard_normal(len(HZ)))
RECEPTANCE = NOISE / (STIFFNESS + 1j * OMEGA * DAMPING - MASS * OMEGA**2)
TRUTH = {"K": STIFFNESS, "C": DAMPING, "mass": MASS}


def function(values, kind, units=("NONE", "NONE"), **more):
    """A function of a universal file, as pyuff writes it."""
    return {
        "type": 58, "func_type": 4, "binary": 1, "id1": "drive point", "abscissa_spacing": 0, "x": HZ, "data": values,
        "rsp_node": 7, "rsp_dir": 3, "ref_node": 7, "ref_dir": 3, "abscissa_spec_data_type": 18, "abscissa_axis_units_lab": "Hz",
        "ordinate_spec_data_type": kind, "orddenom_spec_data_type": 13, "ordinate_axis_units_lab": units[0], "orddenom_axis_units_lab": units[1],
    } | more  # fmt: skip


def units(code, length, force):
    return {"type": 164, "units_code": code, "units_description": "units", "temp_mode": 1, "length": length, "force": force, "temp": 1.0, "temp_offset": 0.0}  # fmt: skip


def file(path, *sets):
    pyuff.UFF(str(path)).write_sets(list(sets))
    return path


#: Files of one receptance, and the words that say how they were read.
FORMS = {
    "receptance": ([function(RECEPTANCE, 8)], "receptance in m (no unit is stated) over N (no unit is stated)"),
    "mobility": ([function(1j * OMEGA * RECEPTANCE, 11, ("m/s", "N"))], "mobility in m/s over N"),
    "accelerance in g": ([function(-(OMEGA**2) * RECEPTANCE / 9.80665, 12, ("g", "N"))], "accelerance in g over N"),
    "inch and pounds force": ([function(-(OMEGA**2) * RECEPTANCE / 0.0254 * 4.4482216152605, 12, ("in/s^2", "lbf"))], "in/s^2 over lbf"),
    "feet": ([function(RECEPTANCE / 0.3048, 8, ("ft", "N"))], "receptance in ft over N"),
    "units of dataset 164": ([units(7, 39.37007874015748, 0.22480894309971), function(RECEPTANCE / 0.0254 * 4.4482216152605, 8)], "dataset 164"),
    "opposite directions": ([function(-RECEPTANCE, 8, rsp_dir=-3)], "opposite directions"),
    "force against its direction": ([function(-RECEPTANCE, 8, ref_dir=-3)], "opposite directions"),
    "reaction force": ([function(RECEPTANCE, 8, orddenom_spec_data_type=9)], "receptance"),
    "a transfer function beside it": ([function(2.0 * RECEPTANCE, 8, rsp_node=8), function(RECEPTANCE, 8)], "receptance"),
}  # fmt: skip


@pytest.mark.parametrize("form", FORMS)
def test_k_of_a_frequency_response_lies_within_its_interval(form, tmp_path):
    sets, words = FORMS[form]
    fitted = rw.fit(file(tmp_path / "frf.uff", *sets), None, "K,C,mass")
    np.testing.assert_allclose(fitted.response.receptance, RECEPTANCE, rtol=1e-9)
    assert words in " ".join(fitted.warnings)
    for name, truth in TRUTH.items():
        assert abs(fitted[name] - truth) < fitted.half_width(name) < 0.01 * truth


@pytest.mark.slow
def test_intervals_of_frequency_responses_hold_what_they_state():
    random, inside = np.random.default_rng(11), 0
    for _ in range(60):
        noise = 5e-3 * np.median(np.abs(RECEPTANCE)) * (random.standard_normal((2, len(HZ))).T @ [1.0, 1j])
        answer = fit_record(FrequencyResponse("frf", HZ, RECEPTANCE / NOISE + noise), ["K", "C"], MASS)
        inside += abs(answer["K"] - STIFFNESS) < answer.half_width("K")
    assert inside >= 53  # of a binomial distribution with 0.95 less are 1 in 100


def test_a_written_frequency_response_is_read_bit_for_bit(tmp_path):
    path, columns = write("picoscope", tmp_path)
    record = rw.fit(path, None, "K,C,mass", columns=columns)
    response = response_of(record.to_uff(tmp_path / "record.uff"))
    for name in ("hz", "receptance"):
        np.testing.assert_array_equal(getattr(response, name), getattr(record.response, name))
    again = rw.fit(tmp_path / "record.uff", None, "K,C,mass", columns={"1": "receptance"})
    np.testing.assert_array_equal(response_of(again.to_uff(tmp_path / "again.uff")).receptance, response.receptance)
    assert abs(again["K"] - STIFFNESS) < again.half_width("K")


def history(values, kind, unit="NONE", **more):
    """A time history, as test laboratories save it."""
    clock = {"x": record()[0], "abscissa_spec_data_type": 17, "abscissa_axis_units_lab": "s"}
    clock |= {"func_type": 1, "binary": 0, "abscissa_spacing": int(kind != 11)}
    return function(values, kind, (unit, "NONE"), **(clock | more))


#: Response to the record's force: data type, order of the derivative, unit, direction and the factor that both make.
RESPONSES = {"displacement": (8, 0, "um", 3, 1e6), "acceleration": (12, 2, "g", -3, -0.1019716)}


@pytest.mark.slow
@pytest.mark.parametrize("response", ["displacement", "acceleration"])
def test_k_of_time_histories_lies_within_its_interval(response, tmp_path):
    kind, order, unit, direction, size = RESPONSES[response]
    random, inside, time = np.random.default_rng(2), [], record()[0]
    force = NEWTONS_PER_VOLT * record()[1]
    omega = 2.0 * np.pi * np.fft.rfftfreq(2 * len(force), time[1])
    twice = np.fft.rfft(np.concatenate([force[::-1], force]))  # moving before the record begins
    moved = np.fft.irfft(twice * (1j * omega) ** order / (STIFFNESS + 1j * omega * DAMPING - MASS * omega**2))[len(force) :]
    for trial in range(10):
        noisy = (values + 1e-3 * values.std() * random.standard_normal(len(values)) for values in (force, size * moved))
        driven = history(next(noisy), 13, "N")
        beside = [history(moved, kind, rsp_node=8), history(next(noisy), kind, unit, rsp_dir=direction)]
        fitted = rw.fit(file(tmp_path / f"record{trial}.uff", driven, *beside), None, "K,C,mass")
        inside += [abs(fitted[name] - truth) < fitted.half_width(name) < 0.01 * truth for name, truth in TRUTH.items()]
    assert f"function 3 is read as {response} in {unit}" in " ".join(fitted.warnings)
    assert sum(inside) >= 24  # of 30 with the probability 0.95; less are 1 in 1000


#: Files that are refused, and the words of the rule and the remedy.
REFUSED = {
    "unknown unit": ([function(RECEPTANCE, 8, ("furlong", "N"))], ["unit 'furlong'", '--map "1=receptance*FACTOR"']),
    "label against dataset 164": ([units(1, 1.0, 1.0), function(RECEPTANCE, 12, ("g", "N"))], ["unit 'g'", "dataset 164", "say which"]),
    "two drive points": ([function(RECEPTANCE, 8), function(RECEPTANCE, 8, id1="other")], ["1: drive point", "2: other", '--map "NUMBER=ignore"']),
    "no frequency": ([function(RECEPTANCE, 8, abscissa_spec_data_type=17)], ["is not over frequency"]),
    "frequencies that do not grow": ([function(RECEPTANCE, 8, x=HZ[::-1].copy())], ["frequencies must grow"]),
    "no form": ([function(RECEPTANCE, 0)], ['--map "1=FORM", one of receptance, mobility, accelerance']),
    "spectra": ([function(np.abs(RECEPTANCE), 12, func_type=2)] * 2, ["holds 2 x auto spectrum of acceleration", "time histories"]),
    "two responses": ([history(OMEGA, 13, x=HZ), *[history(OMEGA, 8, x=HZ, rsp_node=k) for k in (8, 9)]], ["y is duplicated", '--map "3=ignore"', "response 9:3"]),
    "a history of what": ([history(OMEGA, 13, x=HZ), history(OMEGA, 0, x=HZ)], ["missing: displacement", '--map "2=y_um"', "an unknown quantity"]),
    "no force": ([history(OMEGA, 12, x=HZ)], ["238 samples", "missing is force"]),
    "real numbers": ([function(np.abs(RECEPTANCE), 8)], ["complex numbers"]),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_no_frequency_response_is_refused_with_a_remedy(case, tmp_path):
    sets, words = REFUSED[case]
    path = file(tmp_path / "frf.uff", *sets)
    with pytest.raises(SceneError) as refusal:
        rw.fit(path, None, "K")
    for word in (str(path), *words):
        assert word in str(refusal.value)
