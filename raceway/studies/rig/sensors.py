"""The signals of the rig: what two eddy-current probes and a once-per-turn probe write down."""

from __future__ import annotations

from math import pi, radians

import attrs
import numpy as np

from raceway.scene.rig import Rig, Signals
from raceway.studies.fit.signals import Recording
from raceway.studies.shaft.balance import State, balance
from raceway.studies.shaft.bearing import Bearing
from raceway.studies.shaft.rotor import rotor

#: A probe of 5 mm over a notch in a shaft of 30 mm: the mark's flanks [rad], half a cosine each, a third of it.
_MARK = radians(3.0 * 19.0)
#: Range of its probe's voltage.
_VOLTS = 5.0
#: Where in the first turn a record begins [rad]: nobody starts one at the mark.
_BEGIN = 4.0


@attrs.frozen
class Response:
    """Deflection at the sensor [m] over the unbalance's phase, at one to three speeds [rad/s]."""

    speeds: tuple[float, ...]
    lines: tuple[complex, ...]

    def at(self, speed: np.ndarray) -> np.ndarray:
        """By the polynomial through the speeds that are known."""
        middle = self.speeds[len(self.speeds) // 2]
        x = np.array(self.speeds) / middle - 1.0
        return np.polynomial.polynomial.polyval(
            speed / middle - 1.0, np.linalg.solve(np.vander(x, increasing=True), self.lines)
        )


def response(rig: Rig, held: Bearing, state: State, signals: Signals) -> Response:
    """The response around a state's speed, as far as the speed drifts."""
    if signals.speed_drift == 0.0:
        return Response((state.speed,), (state.sensor,))
    speeds = tuple(state.speed * (1.0 + 0.5 * signals.speed_drift * part) for part in (-1.0, 0.0, 1.0))
    first, last = (balance(rotor(rig, speed), held).sensor for speed in (speeds[0], speeds[2]))
    return Response(speeds, (first, state.sensor, last))


def record(rig: Rig, answer: Response, signals: Signals, seed: int, noise: float | None = None) -> Recording:
    """A record at the response's middle speed.

    Parameters
    ----------
    seed : of the noise
    noise : its rms [m], instead of the signal-to-noise ratio: a slow roll has the noise of the other records

    Notes
    -----
    The gap wanders by ``drift``: half of it straight, half as a slow half-wave, along y and z alike.
    """
    random = np.random.default_rng(seed)
    middle = answer.speeds[len(answer.speeds) // 2]
    time = np.arange(int(signals.duration * signals.sampling_hz)) / signals.sampling_hz
    part = time / signals.duration
    speed = middle * (1.0 + signals.speed_drift * (part - 0.5))
    angle = _BEGIN + middle * (time + signals.speed_drift * signals.duration * 0.5 * (part**2 - part))
    line = answer.at(speed)
    motion = line * np.exp(1j * (angle + radians(rig.unbalance_angle_deg)))
    track = signals.run_out * np.exp(1j * (angle + radians(signals.run_out_angle_deg)))
    wandering = 0.5 * signals.drift * (part + np.sin(pi * part)) * (1.0 + 1.0j)
    if noise is None:
        noise = white_noise(answer, signals)
    white = noise * (random.standard_normal(len(time)) + 1j * random.standard_normal(len(time)))
    plane = motion + track + wandering + white
    key = _mark(angle) + _VOLTS * signals.mark_noise * random.standard_normal(len(time))
    return Recording(time, plane.real, plane.imag, key, speed)


def white_noise(answer: Response, signals: Signals) -> float:
    """rms of the noise of each channel [m]."""
    return (
        float(abs(answer.at(np.array(answer.speeds[len(answer.speeds) // 2]))))
        / np.sqrt(2.0)
        * 10.0 ** (-signals.noise_db / 20.0)
    )


def slow_roll_record(rig: Rig, held: Bearing, signals: Signals, seed: int, noise: float) -> Recording:
    """A record at the slow roll's speed, long enough for ten turns."""
    speed = signals.slow_roll_rpm * pi / 30.0
    line = rotor(rig, speed)
    load = np.linalg.solve(held.compliance - line.ring[:, 1:], line.ring[:, 0] * line.unbalance_force)
    slow = attrs.evolve(signals, speed_drift=0.0, duration=max(signals.duration, 11.5 * 2.0 * pi / speed))
    return record(rig, Response((speed,), (line.at_sensor(*load),)), slow, seed, noise)


def _mark(angle: np.ndarray) -> np.ndarray:
    """Voltage of the once-per-turn probe (n,), 0 to ``_VOLTS``: it rises through the middle at whole turns."""
    flank = _MARK / 3.0
    x = (angle + 0.5 * flank) % (2.0 * pi)
    up = np.clip(x / flank, 0.0, 1.0)
    down = np.clip((x - 2.0 * flank) / flank, 0.0, 1.0)
    return 0.5 * _VOLTS * (np.cos(pi * down) - np.cos(pi * up))
