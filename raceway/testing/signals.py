"""Records of a mass on a spring and a dashpot, with everything that measured and computed records are spoilt by."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from raceway.core.stepping.record import Motion, Record, Schedule

#: Stiffness [N/m], mass [kg], damping [N s/m], frequency [Hz], force [N] of the synthetic records.
STIFFNESS, MASS, DAMPING, FREQUENCY, FORCE = 2.0e8, 2.0, 4000.0, 200.0, 300.0
_PER_TURN = 360


def dynamic_stiffness(frequency: float = FREQUENCY) -> complex:
    """Z = K - m w^2 + j w C of the records."""
    w = 2.0 * np.pi * frequency
    return complex(STIFFNESS - MASS * w**2, DAMPING * w)


def synthetic_record(
    turns: float = 8.0,
    sense: int = 1,
    direction: float = 0.0,
    frequency: float = FREQUENCY,
    mean: float = 0.0,
    drift: float = 0.0,
    harmonics: float = 0.0,
    noise: float = 0.0,
    seed: int = 1,
) -> Record:
    """Response to a harmonic force, in shares of its 1x amplitude.

    Parameters
    ----------
    turns : length of the window, whole or not
    sense : +1 forward, -1 backward, 0 along ``direction`` [rad]
    mean, drift, harmonics, noise : a constant, a ramp over the window, 2x and 3x lines, white noise, of the displacement
    """
    dt = 1.0 / (frequency * _PER_TURN)
    n = round(turns * _PER_TURN)
    time = dt * np.arange(1, n + 1)
    turning = np.array([0.0, 1.0, -1j * sense, 0.0, 0.0], dtype=complex)
    along = np.array([0.0, np.cos(direction), np.sin(direction), 0.0, 0.0], dtype=complex)
    shape = turning if sense else along
    wave = np.exp(2j * np.pi * frequency * time)[:, None]
    force = FORCE * np.exp(-0.4j) * shape
    line = force / dynamic_stiffness(frequency)
    size = float(np.abs(line).max())
    displacement = (wave * line).real
    radial = np.array([0.0, 1.0, 1.0, 0.0, 0.0])
    displacement += size * mean * radial + size * drift * ((time - time[0]) / (time[-1] - time[0]))[:, None] * radial
    displacement += size * harmonics * ((wave**2 * (0.6 - 0.8j)).real + (0.5 * wave**3).real) * radial
    displacement += size * noise * np.random.default_rng(seed).standard_normal((n, 5)) * radial
    still = Motion(displacement[-1], np.zeros(5), np.zeros(5), np.zeros((1, 2)), np.zeros((1, 2)))
    return Record(
        time=time,
        displacement=displacement,
        velocity=np.gradient(displacement, dt, axis=0),
        force=(wave * force).real,
        gap=np.full((n, 2), 1.0),
        contact_force=np.zeros((n, 2)),
        ball=np.zeros((n, 1, 2)),
        final=still,
        schedule=Schedule(dt, _PER_TURN, max(int(turns), 1)),
        counts={"steps": n, "evaluations": n, "max_penetration_m": 0.0, "peak_contact_force_n": 0.0},
    )


def model_of(sense: int = 1, direction: float = 0.0) -> SimpleNamespace:
    """A model as identifiers see it, for the same spring, mass and dashpot."""
    from raceway.core.excitations.harmonic import harmonic
    from raceway.testing.systems import linear_system

    radial = np.diag([0.0, 1.0, 1.0, 0.0, 0.0])
    system = linear_system(damped=False)
    system.mass, system.damping, system.stiffness = MASS * np.eye(5), DAMPING * radial, STIFFNESS * radial
    w = 2.0 * np.pi * FREQUENCY
    shape = [1.0, 0.0, 0.0, float(sense)] if sense else [np.cos(direction), 0.0, np.sin(direction), 0.0]
    system.force, system.force_params = harmonic, np.array([FORCE, w, 0.4, *shape])
    excitation = SimpleNamespace(
        frequency_hz=FREQUENCY,
        period_s=1.0 / FREQUENCY,
        amplitude_n=FORCE,
        sense=sense,
        speed_rpm=60.0 * FREQUENCY,
        phase=lambda time: w * time - 0.4,
    )
    return SimpleNamespace(
        system=system, excitation=excitation, mass_used=MASS, scene=SimpleNamespace(excitation=excitation)
    )


def equilibrium_at_rest() -> SimpleNamespace:
    """An equilibrium without displacement."""
    none = np.zeros((5, 5))
    matrices = ("stiffness", "stiffness_rows_held", "damping", "damping_rows_held")
    return SimpleNamespace(displacement=np.zeros(5), ball=np.zeros((1, 2)), **{name: none.copy() for name in matrices})
