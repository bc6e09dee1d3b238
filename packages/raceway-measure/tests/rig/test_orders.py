"""Angles and 1x lines of made-up records."""

from cmath import exp
from math import pi

import attrs
import numpy as np
import pytest
from raceway_measure.fit.shaft_angle import pulses_of, rotation_of
from raceway_measure.fit.synchronous import RunOut, Synchronous, slow_roll_run_out, stated_run_out, synchronous
from raceway_rotor.shaft import rotor

from checks.validation.records import HZ, LINE, made
from raceway import RacewayError


@pytest.mark.parametrize("case", [{}, {"uneven": 0.8}, {"drift": 0.01}, {"drift": 0.01, "uneven": 0.8}])
def test_the_line_is_found(case):
    found = synchronous(rotation_of(made(**case)))
    # Marks are known to a part of a sample, which is 2 % of a turn.
    assert abs(found.forward) == pytest.approx(abs(LINE), rel=2e-3)
    assert np.angle(found.forward / LINE) == pytest.approx(0.0, abs=5e-3)
    assert found.backward == pytest.approx(0.1e-6, rel=0.1)
    assert found.speed == pytest.approx(2.0 * np.pi * HZ, rel=1e-3)
    assert abs(found.fourier) == pytest.approx(abs(LINE), rel=5e-3)


def test_three_turns_will_do():
    found = synchronous(rotation_of(made(duration=0.0215)))
    # The mean wanders by more than the line's amplitude in them, along a parabola: blocks of one turn know straight lines.
    assert (found.turns, found.blocks) == (3, 3)
    assert abs(found.forward - LINE) < 0.02 * abs(LINE)


def test_without_marks_the_amplitude_is_found_though_the_speed_is_a_little_off():
    record = made(marked=False)
    found = synchronous(rotation_of(attrs.evolve(record, speed=1.001 * record.speed)))
    assert not found.marked
    assert abs(found.forward) == pytest.approx(abs(LINE), rel=2e-3)


def test_the_standard_error_is_that_of_white_noise():
    noise = 0.1e-6
    found = synchronous(rotation_of(made(noise=noise, duration=1.0)))
    # Least squares of n samples with noise in two channels: noise * sqrt(2 / n); 16 blocks know it to some 20 %.
    assert found.error == pytest.approx(noise * np.sqrt(2.0 / 1e4), rel=0.6)
    assert abs(found.forward - LINE) < 4.0 * found.error + 5e-3 * abs(LINE)
    assert found.residual == pytest.approx(np.sqrt(2.0) * noise / abs(LINE), rel=0.05)


def test_the_doubt_of_marks_stays_where_sampling_keeps_step(monkeypatch):
    apart = rotation_of(made(rate=10e3, sharp=100.0)).angle_error
    in_step = rotation_of(made(rate=50 * HZ, sharp=100.0)).angle_error
    # Flanks within one sample: half of it, 1/50 of a turn.
    assert in_step == pytest.approx(np.pi / 50, rel=0.1)
    assert apart < 0.2 * in_step
    record = made()
    doubtful = attrs.evolve(pulses_of(record.time, record.key), middle_error=1e-3 / HZ)
    monkeypatch.setattr("raceway_measure.fit.shaft_angle.pulses_of", lambda *_: doubtful)
    assert rotation_of(record).angle_error == pytest.approx(1.96 * 2e-3 * np.pi, rel=0.1)  # of the range's middle alone


BAD = {
    "one turn": ({"duration": 1.5 / HZ}, "0 whole turns|1 whole turns"),
    "one turn by the speed": ({"duration": 1.5 / HZ, "marked": False}, "1.4. turns in the record; at least two"),
    "few samples": ({"rate": 1000.0, "marked": False}, "5.5 samples per turn; at least 8"),
    "a run-up": ({"drift": 0.3}, "the speed is not constant: it changes by 2.* % over the record"),
}


@pytest.mark.parametrize(("options", "words"), BAD.values(), ids=BAD)
def test_records_that_cannot_be_used(options, words):
    with pytest.raises(RacewayError, match=words):
        rotation_of(made(**options))


def noisy(record, part, seed):
    """The record with white noise of so many parts of the range on the probe's voltage."""
    random = np.random.default_rng(seed)
    white = part * np.ptp(record.key) * random.standard_normal(len(record.key))
    return attrs.evolve(record, key=record.key + white)


@pytest.mark.parametrize("rate", [10e3, 400e3])
@pytest.mark.parametrize("part", [0.01, 0.02, 0.05])
def test_noise_on_the_probe_moves_no_mark_on_the_whole(rate, part):
    record = made(rate=rate, duration=0.1)
    true = (np.arange(1, 19) - 1.0 / (2.0 * np.pi)) / HZ  # the angle begins at 1 rad
    off = []
    for seed in range(20):
        marks = pulses_of(record.time, noisy(record, part, seed).key).times
        assert len(marks) == len(true)
        off.append((marks - true).mean())
    # 20 means: their own mean is known to 1 / sqrt(20) of their scatter; 3.5 of that, and what 55 samples per turn leave of a flank.
    assert abs(np.mean(off)) < 3.5 * np.std(off) / np.sqrt(20) + 0.02 / rate


FAULTY = {
    "a mark that is missing": (lambda r: attrs.evolve(r, key=np.where((r.time > 0.2) & (r.time < 0.2 + 1.0 / HZ), 0.0, r.key)),
        "the turn at 0.195.* s takes 2.00 .* a pulse of `key` is missing there"),
    "a speed that jumps": (lambda r: attrs.evolve(r, key=None, speed=r.speed * np.where(r.time > 0.25, 1.05, 1.0)),
        "% from one turn to the next at 0.2.* s"),
    "a probe that sees nothing": (lambda r: attrs.evolve(r, key=0.0 * r.key, speed=None), "it has no pulse"),
    "noise of a fifth of the range": (lambda r: noisy(made(rate=400e3), 0.2, 1), "a pulse of `key` is double there"),
}  # fmt: skip


@pytest.mark.parametrize(("fault", "words"), FAULTY.values(), ids=FAULTY)
def test_faults_of_a_record_are_told(fault, words):
    with pytest.raises(RacewayError, match=words):
        rotation_of(fault(made()))


def test_angles_of_noisy_marks_grow_from_sample_to_sample():
    for seed in range(20):
        found = rotation_of(noisy(made(rate=100e3, duration=0.06), 0.05, seed))
        assert np.diff(found.angle).min() > 0.0
        assert found.angle[0] >= 0.0 and found.angle[-1] < 2.0 * np.pi * found.turns


#: Of the unbalance from the mark [rad].
ANGLE = 0.6


def rolled(line: complex, speed: float) -> Synchronous:
    return Synchronous(line, 0.0, 0.0, speed, speed, speed, line, 0.0, 0.0, 40, 16, True)


@pytest.mark.parametrize("rpm", [600.0, 3000.0])
@pytest.mark.parametrize("true", [0.0, 5e-6 * exp(1.1j)])
def test_the_response_is_taken_out(rig, held, rpm, true):
    """The response from the whole rotor on the bearings' springs: load and deflection in one system, not by compliances."""
    line = rotor(rig, rpm * pi / 30.0)
    # Unknowns: deflection and slope of the ring, force and moment on the bearing.
    stiffness = np.linalg.inv(held.compliance)
    system = np.block([[np.eye(2), -line.ring[:, 1:].astype(complex)], [stiffness, -np.eye(2)]])
    load = np.concatenate([line.ring[:, 0] * line.unbalance_force, np.zeros(2)])
    force, moment = np.linalg.solve(system, load)[2:]
    response = line.at_sensor(force, moment) * exp(1j * ANGLE)
    assert abs(response) > 1e-9  # there is something to take out
    found = slow_roll_run_out(rolled(true + response, line.speed), held, line, ANGLE)
    assert found.vector == pytest.approx(true, abs=1e-6 * abs(response))
    slow = attrs.evolve(rolled(true + response, line.speed), error=3e-9, angle_error=8e-9 / abs(true + response))
    assert slow_roll_run_out(slow, held, line, ANGLE).error == pytest.approx(
        5e-9
    )  # half of an interval is two standard errors
    stated = stated_run_out(None, (abs(true), np.degrees(np.angle(true))), None)  # its size, and the angle of its high spot
    assert isinstance(stated, RunOut) and stated.vector == pytest.approx(true)
