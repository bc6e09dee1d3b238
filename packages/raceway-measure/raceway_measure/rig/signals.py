"""Signals of two eddy-current probes and a once-per-turn probe; the article's procedure; errors of K by one cause at a time.

Signals without noise, drift and run-out, read by order tracking and inverted with the beam that made them, are exact.

The article's section 3.3, as printed: detrend, denoise, whole-turn Fourier transform, shaft correction, impedance:
F_tr = m e w^2 / 2; Z = F_tr / delta, delta = delta_c - delta_s, delta_s = delta_st / (1 - r^2),
delta_st = m e w^2 a (3 L^2 - 16 a^2) / (192 E I), with the distance a of the sensor from the bearing and the span L.  What it
leaves open is chosen here: one channel; a straight line is taken off; a zero-phase Butterworth low-pass of order 4 at five
times the speed; the critical speed of the rotor on the bearings' stiffness at rest; m of K = Re Z + m w^2 is the inner ring's.

A simply supported beam of span L under a force P at mid-span bends by P a (3 L^2 - 4 a^2) / (48 E I) at a (Timoshenko, Strength
of Materials), to which the printed formula is equal for an L of twice the span.  Beyond its supports, it is straight:
-P a L^2 / (16 E I).
"""

from cmath import exp
from math import pi, radians

import attrs
import numpy as np
from raceway_rotor.rig_table import Rig, Signals
from raceway_rotor.shaft import Bearing, State, balance, rotor, shaft

from raceway.extend import Tables
from raceway_measure.fit.identify import identify_recording
from raceway_measure.fit.rig import changed_rotors, invert, with_moment, with_tilt_of
from raceway_measure.fit.shaft_angle import Rotation, rotation_of
from raceway_measure.fit.signals import Recording
from raceway_measure.fit.synchronous import slow_roll

#: A probe of 5 mm over a notch in a shaft of 30 mm: the mark's flanks [rad], half a cosine each, a third of it.
_MARK = radians(3.0 * 19.0)
#: Range of its probe's voltage.
_VOLTS = 5.0
#: Where in the first turn a record begins [rad]: nobody starts one at the mark.
_BEGIN = 4.0


@attrs.frozen
class _Response:
    """Deflection at the sensor [m] over the unbalance's phase, at one to three speeds [rad/s]."""

    speeds: tuple[float, ...]
    components: tuple[complex, ...]

    @property
    def middle(self) -> float:
        return self.speeds[len(self.speeds) // 2]

    def at(self, speed: np.ndarray) -> np.ndarray:
        """By the polynomial through the speeds."""
        x = np.array(self.speeds) / self.middle - 1.0
        weights = np.linalg.solve(np.vander(x, increasing=True), self.components)
        return np.polynomial.polynomial.polyval(speed / self.middle - 1.0, weights)


def response(rig: Rig, bearing: Bearing, state: State, signals: Signals) -> _Response:
    """The response around a state's speed, as far as the speed drifts."""
    if signals.speed_drift == 0.0:
        return _Response((state.speed,), (state.sensor,))
    speeds = tuple(state.speed * (1.0 + 0.5 * signals.speed_drift * part) for part in (-1.0, 0.0, 1.0))
    first, last = (balance(rotor(rig, speed), bearing).sensor for speed in (speeds[0], speeds[2]))
    return _Response(speeds, (first, state.sensor, last))


def record(rig: Rig, answer: _Response, signals: Signals, seed: int, noise: float | None = None) -> Recording:
    """A record at the response's middle speed.

    seed : of the noise
    noise : its rms [m], instead of the signal-to-noise ratio: a slow roll has the noise of the other records

    The gap wanders by ``drift``: half of it straight, half as a slow half-wave, along y and z alike.
    """
    random = np.random.default_rng(seed)
    middle = answer.middle
    time = np.arange(int(signals.duration * signals.sampling_hz)) / signals.sampling_hz
    part = time / signals.duration
    speed = middle * (1.0 + signals.speed_drift * (part - 0.5))
    angle = _BEGIN + middle * (time + signals.speed_drift * signals.duration * 0.5 * (part**2 - part))
    motion = answer.at(speed) * np.exp(1j * (angle + radians(rig.unbalance_angle_deg)))
    track = signals.run_out * np.exp(1j * (angle + radians(signals.run_out_angle_deg)))
    wandering = 0.5 * signals.drift * (part + np.sin(pi * part)) * (1.0 + 1.0j)
    if noise is None:
        noise = white_noise(answer, signals)
    white = noise * (random.standard_normal(len(time)) + 1j * random.standard_normal(len(time)))
    plane = motion + track + wandering + white
    flank = _MARK / 3.0
    mark_angle = (angle + 0.5 * flank) % (2.0 * pi)
    up, down = (np.clip((mark_angle - late * flank) / flank, 0.0, 1.0) for late in (0.0, 2.0))
    mark = 0.5 * _VOLTS * (np.cos(pi * down) - np.cos(pi * up))  # rises through the middle at whole turns
    key = mark + _VOLTS * signals.mark_noise * random.standard_normal(len(time))
    return Recording(time, plane.real, plane.imag, key, speed)


def white_noise(answer: _Response, signals: Signals) -> float:
    """rms of the noise of each channel [m]."""
    return float(abs(answer.at(np.array(answer.middle)))) / np.sqrt(2.0) * 10.0 ** (-signals.noise_db / 20.0)


def slow_roll_record(rig: Rig, bearing: Bearing, signals: Signals, seed: int, noise: float) -> Recording:
    """A record at the slow roll's speed, long enough for ten turns."""
    speed = signals.slow_roll_rpm * pi / 30.0
    free = rotor(rig, speed)
    load = np.linalg.solve(bearing.compliance - free.ring[:, 1:], free.ring[:, 0] * free.unbalance_force)
    slow = attrs.evolve(signals, speed_drift=0.0, duration=max(signals.duration, 11.5 * 2.0 * pi / speed))
    return record(rig, _Response((speed,), (free.at_sensor(*load),)), slow, seed, noise)


_LOW_PASS_ORDERS = 5.0


@attrs.frozen
class Reading:
    """K [N/m] and C [N s/m] by one way to correct for the shaft."""

    correction: str
    stiffness: float
    damping: float


def amplitude(rotation: Rotation) -> complex:
    """1x component of the y channel [m], phase against the mark, as the article has it."""
    from scipy.signal import butter, sosfiltfilt

    time, y = rotation.recording.time, rotation.recording.y
    mean = float(rotation.angle[-1] - rotation.angle[0]) / float(time[-1] - time[0])
    rate = 1.0 / float(np.median(np.diff(time)))
    straight = y - np.polyval(np.polyfit(time, y, 1), time)
    corner = min(_LOW_PASS_ORDERS * mean / (2.0 * pi), 0.45 * rate)
    smooth = sosfiltfilt(butter(4, corner, fs=rate, output="sos"), straight)
    samples = round(rotation.turns * 2.0 * pi / mean * rate)
    smooth = smooth[:samples]
    component = 2.0 * np.fft.rfft(smooth)[rotation.turns] / len(smooth)
    return complex(component * np.exp(-1j * rotation.angle[0]))


def critical_speed(rig: Rig, bearing: Bearing | None) -> float:
    """First critical speed [rad/s] on the bearings' stiffness at rest, or on rigid supports that let the shaft tilt."""
    beam = shaft(rig)
    radial, tilt = (1e12, 0.0) if bearing is None else np.diag(np.linalg.inv(bearing.compliance))
    for position in rig.bearings:
        beam = beam.with_spring(position, radial, tilt)
    return float(beam.critical_speeds()[0])


def readings(rig: Rig, bearing: Bearing, speed: float, component: complex) -> list[Reading]:
    """K and C from the 1x component at the sensor [m] against the unbalance, by the article's correction and others."""
    inertia = pi / 64.0 * rig.shaft_diameter**4
    force, a = rig.unbalance * speed**2, rig.sensor_distance

    def printed_formula(span: float) -> float:
        return force * a * (3.0 * span**2 - 16.0 * a**2) / (192.0 * rig.young * inertia)

    def beam_formula(span: float) -> float:
        if rig.sensor_side == "outside":
            return -force * a * span**2 / (16.0 * rig.young * inertia)
        return force * a * (3.0 * span**2 - 4.0 * a**2) / (48.0 * rig.young * inertia)

    def amplification(supports: Bearing | None) -> float:
        return 1.0 / (1.0 - (speed / critical_speed(rig, supports)) ** 2)

    half, elastic = 0.5 * force, amplification(bearing)
    corrections = {
        "as printed": (printed_formula(rig.span) * elastic, half),
        "as printed, critical speed on rigid supports": (printed_formula(rig.span) * amplification(None), half),
        "as printed, with L twice the span": (printed_formula(2.0 * rig.span) * elastic, half),
        "none": (0.0, half),
        "simply supported beam, amplified bow": (beam_formula(rig.span) * elastic, half),
        "simply supported beam, amplified bow and force": (beam_formula(rig.span) * elastic, half * elastic),
    }
    impedances = {name: share / (component - bow) for name, (bow, share) in corrections.items()}
    return [Reading(name, z.real + bearing.mass * speed**2, z.imag / speed) for name, z in impedances.items()]


#: No noise to speak of: below the rounding of a double.
_SILENT_DB = 300.0
_SPEED_DRIFT = 0.01


@attrs.frozen
class Cause:
    """One cause of error: its kind, what is done, and K over the true one, less 1."""

    kind: str
    what: str
    error: float


def quiet_signals(signals: Signals) -> Signals:
    """The same sampling, nothing that disturbs."""
    return attrs.evolve(signals, noise_db=_SILENT_DB, mark_noise=0.0, drift=0.0, run_out=0.0, speed_drift=0.0)


def split(rig: Rig, bearing: Bearing, state: State) -> list[Cause]:
    """Every cause by itself, for a bearing in a known state."""
    signals, quiet, free = rig.signals, quiet_signals(rig.signals), rotor(rig, state.speed)
    clean = record(rig, response(rig, bearing, state, quiet), quiet, signals.seed)
    component = amplitude(rotation_of(clean)) * exp(-1j * radians(rig.unbalance_angle_deg))
    causes: list[tuple[str, str, State | Reading]] = [
        ("none", "clean signals, order tracking, beam inverted", identify_recording(clean, rig, bearing).state)
    ]
    causes += [("correction", row.correction, row) for row in readings(rig, bearing, state.speed, component)]
    run_out: Tables = {"run_out": signals.run_out}
    disturbances: list[tuple[str, str, Tables, bool]] = [
        ("noise", f"white noise, {signals.noise_db:g} dB below the response", {"noise_db": signals.noise_db}, False),
        ("noise", f"drift of {1e6 * signals.drift:g} µm", {"drift": signals.drift}, False),
        ("run-out", f"{1e6 * signals.run_out:g} µm, slow roll subtracted", run_out, True),
        ("run-out", f"{1e6 * signals.run_out:g} µm, left in", run_out, False),
        ("window", f"speed drifts by {100 * _SPEED_DRIFT:g} %", {"speed_drift": _SPEED_DRIFT}, False),
    ]
    for kind, words, disturbance, rolling in disturbances:
        disturbing = attrs.evolve(quiet, **disturbance)
        answer = response(rig, bearing, state, disturbing)
        noise = white_noise(answer, disturbing)
        run_out_of = slow_roll(slow_roll_record(rig, bearing, disturbing, signals.seed + 1, noise)) if rolling else None
        recording = record(rig, answer, disturbing, signals.seed)
        causes.append((kind, words, identify_recording(recording, rig, bearing, run_out_of).state))
    words = "Fourier transform of all samples, not of whole turns; amplitude of the highest line"
    highest = (
        2.0 * float(np.abs(np.fft.rfft(clean.y - clean.y.mean())).max()) / len(clean.y)
    )  # its phase means nothing over a broken turn
    causes.append(("window", words, invert(free, bearing, highest * state.sensor / abs(state.sensor))))
    thin, sensor = rotor(rig, state.speed, shaft(rig, shear=False)), state.sensor
    # The inversion with the bearing's tilt by its tangent under the axial load alone
    unbalance = np.array([sensor - free.sensor[0] * free.unbalance_force, free.ring[1, 0] * free.unbalance_force])
    matrix = np.array([free.sensor[1:], bearing.compliance[1] - free.ring[1, 1:]])
    rows = np.abs(matrix).max(axis=1)
    moment = np.linalg.solve(matrix / rows[:, None], unbalance / rows)[1]
    models = {
        "bearing without tilt stiffness": with_moment(free, sensor, 0.0, state),
        "tilt stiffness of the bearing at rest": with_moment(free, sensor, moment, bearing),
        "Euler-Bernoulli shaft without rotary inertia": with_tilt_of(thin, state, sensor),
        **{change: with_tilt_of(model, state, sensor) for change, model in changed_rotors(rig, state.speed).items()},
    }
    causes += [("model", words, inversion) for words, inversion in models.items()]
    return [Cause(kind, words, end.stiffness / state.stiffness - 1.0) for kind, words, end in causes]
