"""Error of K by its causes: one is switched on at a time, all others off.

Signals without noise, drift and run-out, read by order tracking and inverted with the beam that made them, are exact.
"""

from __future__ import annotations

from cmath import exp
from math import radians

import attrs
import numpy as np

from raceway.scene.rig import Rig, Signals
from raceway.studies.fit.identification import changed_rotors, identify, invert, with_moment, with_tilt_of
from raceway.studies.fit.shaft_angle import turning
from raceway.studies.fit.signals import Recording
from raceway.studies.fit.synchronous import slow_roll
from raceway.studies.rig.as_printed import amplitude, readings
from raceway.studies.rig.sensors import record, response, slow_roll_record, white_noise
from raceway.studies.shaft.balance import State
from raceway.studies.shaft.bearing import Bearing
from raceway.studies.shaft.rotor import Rotor, rotor, shaft

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
    causes = [Cause("none", "clean signals, order tracking, beam inverted", _error(identify(clean, rig, held).state, state))]
    causes += _correction(rig, held, state, clean)
    causes += _disturbed(rig, held, state, quiet)
    causes += _window(line, held, state, clean)
    causes += _model(rig, line, held, state)
    return causes


def _error(found: State, true: State) -> float:
    return found.stiffness / true.stiffness - 1.0


def _correction(rig: Rig, held: Bearing, state: State, clean: Recording) -> list[Cause]:
    line = amplitude(turning(clean)) * exp(-1j * radians(rig.unbalance_angle_deg))
    found = readings(rig, held, state.speed, line)
    return [Cause("correction", one.correction, one.stiffness / state.stiffness - 1.0) for one in found]


def _disturbed(rig: Rig, held: Bearing, state: State, quiet: Signals) -> list[Cause]:
    own = rig.signals

    def read(kind: str, what: str, signals: Signals, roll: bool = False) -> Cause:
        answer = response(rig, held, state, signals)
        noise = white_noise(answer, signals)
        slow = slow_roll(slow_roll_record(rig, held, signals, own.seed + 1, noise)) if roll else None
        return Cause(kind, what, _error(identify(record(rig, answer, signals, own.seed), rig, held, slow=slow).state, state))

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
