"""Known K, m, C recovered from synthetic signals; against independent periodic motion: evidence/test_integrators.py."""

import numpy as np
import pytest

from checks.validation.scenes import rotating, small_force
from raceway import run
from raceway.extend import (
    Motion,
    Record,
    Schedule,
    fit_harmonics,
    identification,
    stiffness,
    synchronous_phasor,
    turns_in,
    without_drift,
)
from raceway.testing import model_of, solve_equilibrium

K, M, C, SPEED = 1.7e8, 2.0, 4e3, 400.0 * np.pi
FREQUENCY = SPEED / (2.0 * np.pi)
Z = K - M * SPEED**2 + 1j * SPEED * C


def signals(turns: float, kind: str = "forward", steps: int = 360) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times (n,), force and displacement (n, 5) of a linear K, m, C under 500 N."""
    time = np.arange(1, round(turns * steps) + 1) / (steps * FREQUENCY)
    push = {"forward": [0, 1, -1j, 0, 0], "backward": [0, 1, 1j, 0, 0], "fixed": [0, 0.6, 0.8, 0, 0]}[kind]
    force = 500.0 * np.array(push, dtype=complex) * np.exp(1j * SPEED * time)[:, None]
    return time, force.real, (force / Z).real


def identified(identifier: str, turns: float, force: np.ndarray, displacement: np.ndarray, time: np.ndarray):
    """What a plug-in finds in a record made of given signals."""
    tables = rotating(1000.0, "locked", SPEED * 30.0 / np.pi, False, "newmark")
    tables["identifier"] = {"kind": identifier}
    model = model_of(tables)
    return recorded(model, force, displacement, time, turns), model.mass_used


def recorded(model, force: np.ndarray, displacement: np.ndarray, time: np.ndarray, turns: float = 1):
    """The same of a model."""
    empty, z = np.zeros((len(time), 24)), np.zeros((12, 2))
    still = Motion(np.zeros(5), np.zeros(5), np.zeros(5), z, z)
    record = Record(
        time=time, displacement=displacement, velocity=np.zeros_like(displacement), force=force, gap=empty,
        contact_force=empty, ball=np.zeros((len(time), 12, 2)), final=still,
        schedule=Schedule(time[1] - time[0], 360, max(int(turns), 1)), counts={},
    )  # fmt: skip
    return model.scene.identifier.method.identify([record], solve_equilibrium(model), model)


@pytest.mark.parametrize("kind", ["forward", "backward", "fixed"])
@pytest.mark.parametrize("identifier", ["fft_1x", "sine_fit"])
def test_clean_signals(identifier, kind):
    time, force, displacement = signals(3, kind)
    found, mass = identified(identifier, 3, force, displacement, time)
    assert found.dynamic_stiffness == pytest.approx(Z, rel=1e-11)
    assert found.equivalent_stiffness == pytest.approx(K + (mass - M) * SPEED**2, rel=1e-11)
    assert found.equivalent_damping == pytest.approx(C, rel=1e-8)
    assert found.force_amplitude == pytest.approx(500.0, rel=1e-12)
    assert found.phase_lag_deg == pytest.approx(np.degrees(np.angle(Z)), rel=1e-8)
    assert found.residual < 1e-10 and found.spread < 1e-10 and found.window < 1e-10
    amplitude = 500.0 / abs(Z)
    parts = {"forward": (1.0, 0.0), "backward": (0.0, 1.0), "fixed": (0.5, 0.5)}[kind]
    assert found.forward_amplitude == pytest.approx(parts[0] * amplitude, abs=1e-12 * amplitude)
    assert found.backward_amplitude == pytest.approx(parts[1] * amplitude, abs=1e-12 * amplitude)
    assert found.orbit_major == pytest.approx(amplitude, rel=1e-11)


@pytest.mark.parametrize("identifier", ["fft_1x", "sine_fit"])
def test_mean_drift_and_harmonics(identifier):
    """A mean of ten amplitudes, a drift of one and harmonics of a third leave K to 1e-9 over whole turns."""
    time, force, displacement = signals(6)
    amplitude, phase = 500.0 / abs(Z), SPEED * time[:, None]
    disturbed = displacement + amplitude * (10.0 + np.linspace(0.0, 1.0, len(time))[:, None])
    disturbed += amplitude * (0.3 * np.cos(2.0 * phase + 1.0) + 0.2 * np.sin(3.0 * phase) + 0.1 * np.cos(5.0 * phase))
    found, _ = identified(identifier, 6, force, disturbed, time)
    assert found.dynamic_stiffness == pytest.approx(Z, rel=1e-9)
    assert found.spread < 1e-9
    if identifier == "sine_fit":
        assert found.residual < 1e-9
    else:
        assert found.residual > 0.3  # the line alone leaves the harmonics, and says so


def test_a_window_that_ends_with_the_record_is_tracked():
    time, force, displacement = signals(6)
    found, _ = identified("order_tracking", 6, force, displacement, time)
    assert len(found.series) == 1 and found.dynamic_stiffness == pytest.approx(Z, rel=1e-6)


def test_order_tracking_takes_off_what_the_change_of_speed_does_to_the_inertia():
    """A circle of one size, x = A exp(j phase): F = (K - m w^2 + j (w C + m w')) x, and C is that of F without m w'."""
    run_up = {"kind": "run_up", "first_speed_rpm": 9000.0, "speed_rpm": 12000.0, "duration_s": 0.1, "unbalance": 1e-4}
    changes = {"excitation": run_up, "identifier": {"kind": "order_tracking", "window_turns": 4.0}}
    model = model_of(rotating(1000.0, "locked", 12000.0, False, "newmark") | changes)
    time = np.arange(1, 4001) * 2.5e-5
    mass, rate = model.system.mass[1, 1], 3000.0 * np.pi / 30.0 / 0.1
    w = 9000.0 * np.pi / 30.0 + rate * time
    circle = 1e-6 * np.exp(1j * model.excitation.phase(time))[:, None] * np.array([0, 1, -1j, 0, 0])
    force = (K - mass * w**2 + 1j * (w * 60.0 + mass * rate))[:, None] * circle
    found = recorded(model, force.real, circle.real, time)
    for speed, value in found.series:
        # First order in m w' / K, 1e-4, whose square is left.
        assert value.imag == pytest.approx(60.0 * speed, rel=1e-4)
    assert mass * rate > 0.05 * 60.0 * w.max()


@pytest.mark.parametrize("identifier", ["fft_1x", "sine_fit"])
def test_noise(identifier):
    """White noise of a tenth of the amplitude: the line's error is noise * sqrt(2 / n), here 0.3 %; three of them pass."""
    time, force, displacement = signals(6)
    noise = 0.1 * 500.0 / abs(Z) * np.random.default_rng(4).normal(size=displacement.shape)
    found, _ = identified(identifier, 6, force, displacement + noise, time)
    assert abs(found.dynamic_stiffness / Z - 1.0) < 3.0 * 0.1 * np.sqrt(2.0 / len(time))
    assert found.residual == pytest.approx(0.1 * np.sqrt(2.0), rel=0.05)  # rms of noise over rms of the line


@pytest.mark.parametrize("turns", [1.5, 2.3, 4.71])
def test_windows_that_are_not_whole_turns(turns):
    """Least squares with drift and harmonics does not care where the window ends."""
    time, force, displacement = signals(turns)
    amplitude = 500.0 / abs(Z)
    disturbed = displacement + amplitude * (3.0 + np.linspace(0.0, 0.5, len(time))[:, None])
    disturbed += 0.2 * amplitude * np.cos(2.0 * SPEED * time[:, None])
    found, _ = identified("sine_fit", turns, force, disturbed, time)
    assert found.dynamic_stiffness == pytest.approx(Z, rel=1e-8)


def test_one_turn_has_no_drift_to_fit():
    """Harmonics above those fitted do not leak: over one turn the fit is the Fourier line."""
    time, force, displacement = signals(1)
    displacement = displacement + 500.0 / abs(Z) * 0.3 * np.sin(7.0 * SPEED * time)[:, None]
    lines, _ = fit_harmonics(time, displacement, FREQUENCY, 3)
    assert lines[0] == pytest.approx(synchronous_phasor(time, displacement, FREQUENCY), abs=1e-12 * np.abs(lines[0]).max())
    assert stiffness(fit_harmonics(time, force, FREQUENCY, 3)[0][0], lines[0]) == pytest.approx(Z, rel=1e-12)


def test_many_turns_are_fitted_by_the_columns_of_all_of_their_samples():
    time = np.arange(20 * 360 + 137) / 360.0 / FREQUENCY  # block by block, and a rest of samples in the last one
    basis = np.stack([np.cos(2.0 * np.pi * FREQUENCY * time), np.ones_like(time), time - time.mean()], axis=1)
    signal = np.random.default_rng(7).normal(size=(len(time), 2))
    np.testing.assert_allclose(basis.T @ fit_harmonics(time, signal, FREQUENCY, 1)[1], 0.0, atol=1e-10)


def test_turns_and_drift():
    time, _, displacement = signals(4)
    assert turns_in(time, FREQUENCY) == pytest.approx(4.0)
    slope = 3e-6 * np.arange(len(time))[:, None]
    assert without_drift(time, displacement + slope + 5.0, FREQUENCY) == pytest.approx(displacement, abs=1e-12)


def test_no_work_no_stiffness():
    found = identification("nothing", 100.0, np.array([0, 1.0, 0, 0, 0j]), np.array([0, 0, 1.0, 0, 0j]), 0.0)
    assert np.isnan(found.dynamic_stiffness.real)


@pytest.mark.parametrize("identifier", ["fft_1x", "sine_fit"])
@pytest.mark.parametrize("kind", ["bidirectional", "unidirectional"])
def test_series_of_equilibria_is_one_turn(identifier, kind):
    """One turn is enough, both fits agree to rounding, and no mass is added."""
    tables = rotating(400.0, "locked", 15000.0, True, "quasi_static")
    tables["excitation"]["kind"], tables["identifier"] = kind, {"kind": identifier}
    result = run(tables)
    found = result.identification
    assert len(result.simulation.record.time) == 360
    assert found.window < 1e-12 and found.mass_used == 0.0 and found.spread is None


def test_tangent_identifier_is_the_small_force_limit():
    """A hundredth of the force: the orbit's secant equals the tangent response."""
    tables = rotating(1000.0, "free", 12000.0, True, "newmark")
    tables["excitation"]["load_share"] = 0.005
    orbit = run(tables).identification
    tables["identifier"] = {"kind": "tangent"}
    tangent = run(tables).identification
    assert orbit.dynamic_stiffness.real == pytest.approx(tangent.dynamic_stiffness.real, rel=1e-3)


def response(integrator, share, identifier="fft_1x", kinematics=None, **changes):
    still = {"gyroscopic": "none", "ring_growth": False}
    return small_force(identifier, integrator, share, {"kinematics": still | (kinematics or {}), **changes})


KINDS = [
    {}, {"kinematics": {"ball_inertia": False}}, {"kinematics": {"gyroscopic": "outer_race"}},
    {"kinematics": {"gyroscopic": "traction"}}, {"load": {"radial": [300.0, 0.0]}},
]  # fmt: skip


@pytest.mark.parametrize("changes", KINDS)
@pytest.mark.parametrize("share", [1e-8, 1e-6, 1e-4])
def test_a_periodic_motion_under_a_small_force_has_the_tangents_answer(changes, share):
    """A motion of 2e-14 m on 2e-5 m is resolved to 1e-4 by rounding; its own estimate covers what it is off by."""
    run = response("periodic", share, **changes)
    tangent = response("periodic", share, "tangent", **changes)
    off = abs(run.identification.dynamic_stiffness / tangent.identification.dynamic_stiffness - 1.0)
    assert off < run.error["total"] + 5.0 * share**2
    assert run.error["total"] < max(1e-11 / share, 1e-7)


@pytest.mark.parametrize("integrator", ["newmark", "generalized_alpha"])
def test_steps_are_balanced_against_the_excitation(integrator):
    """The iteration of a step leaves a part of the force that drives it: a force of 1e-6 of the preload is no worse than one of 1e-3."""
    z = {share: response(integrator, share) for share in (1e-6, 1e-3)}
    small, large = (z[share].identification.dynamic_stiffness for share in z)
    assert abs(small / large - 1.0) < 1e-7
    tangent = response(integrator, 1e-6, "tangent").identification.dynamic_stiffness
    assert abs(small / tangent - 1.0) < 3.0 * z[1e-6].error["total"]
