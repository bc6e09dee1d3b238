"""The synchronous (1x) component of a record at its mean speed, and the run-out of the measured track in it.

In each block of turns mean, drift, the forward and backward harmonics 1x to 3x and a linear change of the forward 1x component are
fitted to r = y + j z over the shaft's angle, which need not be sampled evenly.  A straight line (or parabola, where the speed changes
by more than 2 %) through the blocks' components over their speeds gives that at the mean speed, and its residuals the standard
error.  The plain Fourier component of the samples, brought to equal angles, is the check.

Run-out is what a slow roll, which bends nothing, shows once per turn, less the small response to the unbalance at that speed.
"""

from __future__ import annotations

from cmath import exp
from collections.abc import Mapping
from math import pi, radians

import attrs
import numpy as np
from raceway_rotor.rig_table import Rig
from raceway_rotor.shaft import Bearing, Rotor, rotor

from raceway import RacewayError, SceneError
from raceway_measure.fit.shaft_angle import Rotation, rotation_of
from raceway_measure.fit.signals import Data, Recording, faults_at, recording_of, signals_of

_BLOCKS = 16
_HARMONICS = 3
#: Range of speed above which the component's change with the speed is fitted: straight, then curved.
_STRAIGHT, _CURVED = 5e-4, 0.02
#: A 1x component below this part of the largest sample is rounding of the fit: some thousand times the spacing of floats.
_ROUNDING = 1e-12


@attrs.frozen(eq=False)
class Synchronous:
    """The forward 1x component at the mean speed."""

    forward: complex  # complex amplitude of e^{j angle} [m]
    error: float  # its standard error [m], of real and imaginary part together
    backward: float  # amplitude of the backward 1x component [m]
    speed: float  # mean [rad/s]
    #: lowest, highest : of the blocks [rad/s]
    lowest: float
    highest: float
    fourier: complex  # the component by a Fourier transform of full turns over equal angles [m]
    residual: float  # rms of the fit's residuals over that of the component
    angle_error: float  # half-width at 95 % of the angle of all pulses together [rad]
    #: turns, blocks, marked : as in ``Rotation``
    turns: int
    blocks: int
    marked: bool


def synchronous(rotation: Rotation) -> Synchronous:
    """The 1x component of a record; RacewayError where the sensor sees no motion once per turn."""
    forward, backward, speeds, residual = _blocks(rotation)
    if max(np.abs(forward).max(), np.abs(backward).max()) <= _ROUNDING * np.abs(rotation.recording.plane).max():
        raise RacewayError("the sensor shows no synchronous motion: y and z are nearly constant. Check its connection")
    whole_turns = rotation
    if not rotation.marked:
        # Angles without a pulse, shifted so that the blocks' components (m,) have no phase: an integrated speed wanders.
        edges = np.round(np.linspace(0, rotation.turns, len(forward) + 1))
        middles = pi * (edges[:-1] + edges[1:])
        phase = np.unwrap(np.angle(forward))
        shift = np.interp(rotation.angle, middles, phase)
        for low, end in ((0, rotation.angle < middles[0]), (-2, rotation.angle > middles[-1])):
            slope = (phase[low + 1] - phase[low]) / (middles[low + 1] - middles[low])
            shift[end] = phase[low] + slope * (rotation.angle[end] - middles[low])
        angle = rotation.angle + shift - shift[0]
        whole_turns = attrs.evolve(rotation, angle=angle, turns=max(int((angle[-1] + 1e-6) / (2.0 * pi)), 1))
        forward, backward, speeds, residual = _blocks(whole_turns)
    # Component at the mean speed and its standard error.
    relative = speeds / speeds.mean() - 1.0
    span = float(np.ptp(relative))
    degree = 0 if span < _STRAIGHT or len(forward) < 4 else 1 if span < _CURVED or len(forward) < 8 else 2
    basis = np.vander(relative, degree + 1, increasing=True)
    solution, *_ = np.linalg.lstsq(basis, forward, rcond=None)
    residuals = forward - basis @ solution
    freedom = max(len(forward) - degree - 1, 1)
    variance = float(np.vdot(residuals, residuals).real) / freedom * np.linalg.inv(basis.T @ basis)[0, 0]
    value, error = complex(solution[0]), float(np.sqrt(variance))
    if len(forward) > 1:  # white noise within the blocks; the spread of a few blocks alone may be small by chance
        error = max(error, residual / np.sqrt(len(whole_turns.angle)))
    return Synchronous(
        forward=value,
        error=error,
        backward=float(np.abs(np.mean(backward))),
        speed=float(np.mean(speeds)),
        lowest=float(speeds.min()),
        highest=float(speeds.max()),
        fourier=_fourier(whole_turns),
        residual=residual / abs(value) if value else np.inf,
        angle_error=rotation.angle_error,
        turns=rotation.turns,
        blocks=len(forward),
        marked=rotation.marked,
    )


def _blocks(rotation: Rotation) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Forward and backward component and speed of each block (m,), and the rms of the residuals."""
    # Two turns tell a curved drift from the component, one does not.
    count = min(_BLOCKS, rotation.turns // 2) if rotation.turns > 3 else rotation.turns
    edges = 2.0 * pi * np.round(np.linspace(0, rotation.turns, count + 1))
    signal, forward, backward, speeds, squares = rotation.recording.plane, [], [], [], 0.0
    for first, last in zip(edges[:-1], edges[1:], strict=True):
        block = (rotation.angle >= first) & (rotation.angle < last)
        p = rotation.angle[block]
        u = (2.0 * p - first - last) / (last - first)
        columns = [np.exp(1j * p), np.exp(-1j * p), np.ones_like(u), u]
        for k in range(2, _HARMONICS + 1):
            columns += [np.exp(1j * k * p), np.exp(-1j * k * p)]
        if last - first > 3.0 * pi:  # within a single turn a changing component and a drift are alike
            columns += [u * u, u * np.exp(1j * p)]
        basis = np.column_stack(columns)
        solution, *_ = np.linalg.lstsq(basis, signal[block], rcond=None)
        residuals = signal[block] - basis @ solution
        squares += float(np.vdot(residuals, residuals).real) * len(p) / max(len(p) - basis.shape[1], 1)
        forward.append(solution[0])
        backward.append(solution[1])
        t = rotation.recording.time[block]
        speeds.append((p[-1] - p[0]) / (t[-1] - t[0]))
    return np.array(forward), np.array(backward), np.array(speeds), float(np.sqrt(squares / len(signal)))


def _fourier(rotation: Rotation) -> complex:
    """Fourier component of full turns after the drift of the turns' means is taken off, from samples at equal angles."""
    from scipy.interpolate import CubicSpline

    per_turn = 64
    grid = 2.0 * pi / per_turn * np.arange(per_turn * rotation.turns)
    spline = CubicSpline(rotation.angle, rotation.recording.plane)
    turns = spline(np.clip(grid, rotation.angle[0], rotation.angle[-1])).reshape(rotation.turns, per_turn)
    means = turns.mean(axis=1)
    slope = np.polyfit(np.arange(rotation.turns), means, 1)[0] if rotation.turns > 2 else 0.0
    straight = turns - means[:, None] - slope * (np.arange(per_turn) / per_turn - 0.5)
    return complex((straight.ravel() * np.exp(-1j * grid)).mean())


@attrs.frozen
class RunOut:
    """The run-out: a complex amplitude of e^{j angle} from the mark, its standard error [m], and its source."""

    vector: complex = 0.0
    error: float = 0.0
    how: str = "none subtracted"


def slow_roll(recording: Recording) -> Synchronous:
    """The 1x component of a slow roll; RacewayError: a record that cannot be used; one without pulses has no phase."""
    try:
        rotation = rotation_of(recording)
        if not rotation.marked:
            raise RacewayError("no `key`: without a mark a vector has no phase and cannot be subtracted")
        return synchronous(rotation)
    except RacewayError as why:
        raise RacewayError(f"slow roll: {why}") from None


def stated_run_out(
    slow: Data | None, vector: tuple[float, float] | None, columns: Mapping[str, str] | None
) -> RunOut | Synchronous | None:
    """The 1x component of a slow roll's signals, or the run-out with an amplitude [m] and the angle [deg] of its high spot.

    SceneError: Signals that cannot be used, or both.
    """
    if vector is not None:
        if slow is not None:
            raise SceneError.at("run_out", vector, "the slow roll contains it already: omit one of them")
        return RunOut(vector[0] * exp(1j * radians(vector[1])), 0.0, "given")
    if slow is None:
        return None
    signals = signals_of(slow, columns)
    with faults_at(signals.source):
        return slow_roll(recording_of(signals))


def slow_roll_run_out(slow: Synchronous, bearing: Bearing, shaft: Rotor, unbalance_angle: float) -> RunOut:
    """The run-out in a slow roll: its 1x component less the response to the unbalance at that speed.

    shaft : the rotor at the slow roll's speed;  unbalance_angle : of the unbalance from the mark [rad]

    The bearing's stiffness at rest is good enough: the response is a thousandth of that at the speed.
    """
    load = np.linalg.solve(bearing.compliance - shaft.ring[:, 1:], shaft.ring[:, 0] * shaft.unbalance_force)
    response = shaft.at_sensor(load[0], load[1]) * exp(1j * unbalance_angle)
    rpm = slow.speed * 30.0 / np.pi
    error = float(np.hypot(slow.error, 0.5 * slow.angle_error * abs(slow.forward)))  # of two standard errors
    return RunOut(slow.forward - response, error, f"slow roll at {rpm:.0f} r/min, {slow.turns} turns")


@attrs.frozen(eq=False)
class _Response:
    """The 1x response at the sensor against the unbalance: of a record, less its run-out."""

    run_out: RunOut  # that was subtracted
    #: deflection, fourier : at the sensor [m], by least squares and by a Fourier transform of full turns; without pulses
    #: their sizes
    deflection: complex
    fourier: complex


def response_of(
    component: Synchronous, rig: Rig, bearing: Bearing, run_out: RunOut | Synchronous | None = None
) -> _Response:
    """The response in a record's 1x component.

    bearing : the scene's, for the response to the unbalance in a slow roll
    run_out : the run-out, or the 1x component of a slow roll

    RacewayError: An orbit that turns against the shaft, or a run-out without pulses.
    """
    if component.backward > abs(component.forward):
        raise RacewayError(
            f"the orbit turns from z towards y, against the shaft ({1e6 * component.backward:.3g} µm backward, "
            f"{1e6 * abs(component.forward):.3g} µm forward): change the sign of one column, or swap y and z"
        )
    angle = radians(rig.unbalance_angle_deg)
    if isinstance(run_out, Synchronous):
        run_out = slow_roll_run_out(run_out, bearing, rotor(rig, run_out.speed), angle)
    run_out = run_out or RunOut()
    if component.marked:
        forward, fourier = ((value - run_out.vector) * exp(-1j * angle) for value in (component.forward, component.fourier))
        return _Response(run_out, forward, fourier)
    if run_out.vector:
        raise RacewayError("no `key`: without a mark the run-out cannot be subtracted; omit it, or record the mark")
    return _Response(run_out, abs(component.forward) + 0j, abs(component.fourier) + 0j)
