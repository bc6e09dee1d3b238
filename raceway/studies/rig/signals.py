"""Signals of two eddy-current probes and a once-per-turn probe; the article's procedure; errors of K by one cause at a time.

Signals without noise, drift and run-out, read by order tracking and inverted with the beam that made them, are exact.

Notes
-----
The article's section 3.3, as printed: detrend, denoise, whole-turn Fourier transform, shaft correction, impedance:
F_tr = m e w^2 / 2; Z = F_tr / delta, delta = delta_c - delta_s, delta_s = delta_st / (1 - r^2),
delta_st = m e w^2 a (3 L^2 - 16 a^2) / (192 E I), with the distance a of the sensor from the bearing and the span L.  What it
leaves open is chosen here: one channel; a straight line is taken off; a zero-phase Butterworth low-pass of order 4 at five
times the speed; the critical speed of the rotor on the bearings' stiffness at rest; m of K = Re Z + m w^2 is the inner ring's.

A simply supported beam of span L under a force P at mid-span bends by P a (3 L^2 - 4 a^2) / (48 E I) at a (Timoshenko, Strength
of Materials), to which the printed formula is equal for an L of twice the span.  Beyond its supports, it is straight:
-P a L^2 / (16 E I).
"""

from __future__ import annotations

from cmath import exp
from math import pi, radians

import attrs
import numpy as np

from raceway.scene.rig import Rig, Signals
from raceway.studies.fit.identify import identify_recording
from raceway.studies.fit.rig import changed_rotors, invert, with_moment, with_tilt_of
from raceway.studies.fit.shaft_angle import Rotation, rotation_of
from raceway.studies.fit.signals import Recording
from raceway.studies.fit.synchronous import slow_roll
from raceway.studies.shaft.bearing import Bearing, State, balance
from raceway.studies.shaft.rotor import Rotor, rotor, shaft

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


_LOW_PASS_ORDERS = 5.0


@attrs.frozen
class Reading:
    """K [N/m] and C [N s/m] by one way to correct for the shaft."""

    correction: str
    stiffness: float
    damping: float


def amplitude(rotation: Rotation) -> complex:
    """1x line of the y channel [m], phase against the mark, as the article has it."""
    from scipy.signal import butter, sosfiltfilt

    time, y = rotation.recording.time, rotation.recording.y
    mean = float(rotation.angle[-1] - rotation.angle[0]) / float(time[-1] - time[0])
    rate = 1.0 / float(np.median(np.diff(time)))
    straight = y - np.polyval(np.polyfit(time, y, 1), time)
    corner = min(_LOW_PASS_ORDERS * mean / (2.0 * pi), 0.45 * rate)
    denoised = sosfiltfilt(butter(4, corner, fs=rate, output="sos"), straight)
    samples = round(rotation.turns * 2.0 * pi / mean * rate)
    denoised = denoised[:samples]
    line = 2.0 * np.fft.rfft(denoised)[rotation.turns] / len(denoised)
    return complex(line * np.exp(-1j * rotation.angle[0]))


def critical_speed(rig: Rig, held: Bearing | None) -> float:
    """First critical speed [rad/s] on the bearings' stiffness at rest, or on rigid supports that let the shaft tilt."""
    line = shaft(rig)
    radial, tilt = (1e12, 0.0) if held is None else np.diag(np.linalg.inv(held.compliance))
    for place in rig.bearings:
        line = line.with_spring(place, radial, tilt)
    return float(line.critical_speeds()[0])


def readings(rig: Rig, held: Bearing, speed: float, line: complex) -> list[Reading]:
    """K and C from the 1x line at the sensor [m] against the unbalance, by the article's correction and others."""
    inertia = pi / 64.0 * rig.shaft_diameter**4
    whole, a = rig.unbalance * speed**2, rig.sensor_distance

    def printed(span: float) -> float:
        return whole * a * (3.0 * span**2 - 16.0 * a**2) / (192.0 * rig.young * inertia)

    def supported(span: float) -> float:
        if rig.sensor_side == "outside":
            return -whole * a * span**2 / (16.0 * rig.young * inertia)
        return whole * a * (3.0 * span**2 - 4.0 * a**2) / (48.0 * rig.young * inertia)

    def grown(other: Bearing | None) -> float:
        return 1.0 / (1.0 - (speed / critical_speed(rig, other)) ** 2)

    def reading(words: str, bow: float, force: float) -> Reading:
        z = force / (line - bow)
        return Reading(words, z.real + held.mass * speed**2, z.imag / speed)

    half, elastic = 0.5 * whole, grown(held)
    return [
        reading("as printed", printed(rig.span) * elastic, half),
        reading("as printed, critical speed on rigid supports", printed(rig.span) * grown(None), half),
        reading("as printed, with L twice the span", printed(2.0 * rig.span) * elastic, half),
        reading("none", 0.0, half),
        reading("simply supported beam, amplified bow", supported(rig.span) * elastic, half),
        reading("simply supported beam, amplified bow and force", supported(rig.span) * elastic, half * elastic),
    ]


#: No noise to speak of: below the rounding of a double.
_SILENT_DB = 300.0
_SPEED_DRIFT = 0.01


@attrs.frozen
class Cause:
    """One cause of error: its kind, what is done, and K over the true one, less 1."""

    kind: str
    what: str
    error: float


def silent(signals: Signals) -> Signals:
    """The same sampling, nothing that disturbs."""
    return attrs.evolve(signals, noise_db=_SILENT_DB, mark_noise=0.0, drift=0.0, run_out=0.0, speed_drift=0.0)


def split(rig: Rig, held: Bearing, state: State) -> list[Cause]:
    """Every cause by itself, for a bearing in a known state."""
    quiet, line = silent(rig.signals), rotor(rig, state.speed)
    clean = record(rig, response(rig, held, state, quiet), quiet, rig.signals.seed)
    causes = [
        Cause(
            "none", "clean signals, order tracking, beam inverted", _error(identify_recording(clean, rig, held).state, state)
        )
    ]
    causes += _correction(rig, held, state, clean)
    causes += _disturbed(rig, held, state, quiet)
    causes += _window(line, held, state, clean)
    causes += _model(rig, line, held, state)
    return causes


def _error(found: State, true: State) -> float:
    return found.stiffness / true.stiffness - 1.0


def _correction(rig: Rig, held: Bearing, state: State, clean: Recording) -> list[Cause]:
    line = amplitude(rotation_of(clean)) * exp(-1j * radians(rig.unbalance_angle_deg))
    found = readings(rig, held, state.speed, line)
    return [Cause("correction", one.correction, one.stiffness / state.stiffness - 1.0) for one in found]


def _disturbed(rig: Rig, held: Bearing, state: State, quiet: Signals) -> list[Cause]:
    own = rig.signals

    def read(kind: str, what: str, signals: Signals, roll: bool = False) -> Cause:
        answer = response(rig, held, state, signals)
        noise = white_noise(answer, signals)
        slow = slow_roll(slow_roll_record(rig, held, signals, own.seed + 1, noise)) if roll else None
        return Cause(
            kind, what, _error(identify_recording(record(rig, answer, signals, own.seed), rig, held, slow).state, state)
        )

    run_out = attrs.evolve(quiet, run_out=own.run_out)
    size = f"{1e6 * own.run_out:g} µm"
    return [
        read("noise", f"white noise, {own.noise_db:g} dB below the response", attrs.evolve(quiet, noise_db=own.noise_db)),
        read("noise", f"drift of {1e6 * own.drift:g} µm", attrs.evolve(quiet, drift=own.drift)),
        read("run-out", f"{size}, slow roll subtracted", run_out, roll=True),
        read("run-out", f"{size}, left in", run_out),
        read("window", f"speed drifts by {100 * _SPEED_DRIFT:g} %", attrs.evolve(quiet, speed_drift=_SPEED_DRIFT)),
    ]


def _window(line: Rotor, held: Bearing, state: State, clean: Recording) -> list[Cause]:
    """The line by a Fourier transform of all samples, whole turns or not."""
    y = clean.y - clean.y.mean()
    lines = 2.0 * np.fft.rfft(y) / len(y)
    found = complex(lines[int(np.argmax(np.abs(lines)))])
    size = abs(found) * state.sensor / abs(state.sensor)  # its phase means nothing over a broken turn
    what = "Fourier transform of all samples, not of whole turns; amplitude of the highest line"
    return [Cause("window", what, _error(invert(line, held, size), state))]


def _model(rig: Rig, line: Rotor, held: Bearing, state: State) -> list[Cause]:
    sensor = state.sensor
    thin = rotor(rig, state.speed, shaft(rig, shear=False))
    moved = changed_rotors(rig, state.speed)
    found = {
        "bearing taken to resist no tilt": with_moment(line, sensor, 0.0, state),
        "tilt stiffness of the bearing at rest": _at_rest(line, held, sensor),
        "Euler-Bernoulli shaft without rotary inertia": with_tilt_of(thin, state, sensor),
        **{words: with_tilt_of(other, state, sensor) for words, other in moved.items()},
    }
    return [Cause("model", words, _error(other, state)) for words, other in found.items()]


def _at_rest(line: Rotor, held: Bearing, sensor: complex) -> State:
    """The inversion with the bearing's tilt by its tangent under the axial load alone."""
    slope = held.compliance[1] - line.ring[1, 1:]
    known = np.array([sensor - line.sensor[0] * line.unbalance_force, line.ring[1, 0] * line.unbalance_force])
    matrix = np.array([line.sensor[1:], slope])
    rows = np.abs(matrix).max(axis=1)
    moment = np.linalg.solve(matrix / rows[:, None], known / rows)[1]
    return with_moment(line, sensor, moment, held)
