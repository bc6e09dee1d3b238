"""The 1x line of a record against its speed: least squares in blocks of turns.

Notes
-----
In each block mean, drift, the forward and backward lines 1x to 3x and a linear change of the forward 1x line are fitted to
r = y + j z over the shaft's angle, which need not be sampled evenly.  A straight line (or parabola, where the speed changes
by more than 2 %) through the blocks' lines over their speeds gives the line at the mean speed, and its scatter the standard
error.  The plain Fourier line of the samples, brought to equal angles, stands beside it.
"""

from __future__ import annotations

from cmath import exp
from math import pi, radians

import attrs
import numpy as np

from raceway.errors import RacewayError
from raceway.studies.fit.shaft_angle import Turning, turning
from raceway.studies.fit.signals import Recording
from raceway.studies.shaft.bearing import Bearing
from raceway.studies.shaft.rotor import Rotor

_BLOCKS = 16
_HARMONICS = 3
#: Range of speed above which the line's change with the speed is fitted: straight, then curved.
_STRAIGHT, _CURVED = 5e-4, 0.02
#: A 1x line below this part of the largest sample is rounding of the fit: some thousand times the spacing of floats.
_ROUNDING = 1e-12


@attrs.frozen(eq=False)
class Order:
    """The forward 1x line at the mean speed.

    Attributes
    ----------
    line : complex amplitude of e^{j angle} [m];  error : its standard error [m], of real and imaginary part together
    backward : amplitude of the backward 1x line [m]
    speed : mean [rad/s];  lowest, highest : of the blocks [rad/s]
    fourier : the line by a whole-turn Fourier transform over equal angles [m]
    residual : rms of what the fit leaves, over the rms of the line
    doubt : by which all marks together may be off [rad]
    turns, blocks, marked
    """

    line: complex
    error: float
    backward: float
    speed: float
    lowest: float
    highest: float
    fourier: complex
    residual: float
    doubt: float
    turns: int
    blocks: int
    marked: bool


def order(found: Turning) -> Order:
    """The 1x line of a record.

    Raises
    ------
    RacewayError
        The sensor sees no motion once a turn.
    """
    straight = found
    lines, backward, speeds, rest = _blocks(found)
    if max(np.abs(lines).max(), np.abs(backward).max()) <= _ROUNDING * np.abs(found.recording.plane).max():
        raise RacewayError("the sensor sees no motion once a turn: y and z are constant, or as good as. Is it connected?")
    if not found.marked:
        straight = _aligned(found, lines)
        lines, backward, speeds, rest = _blocks(straight)
    angle = straight.angle
    value, error = _at_mean(lines, speeds)
    if len(lines) > 1:  # white noise seen within the blocks; scatter of a few blocks alone may be small by chance
        error = max(error, rest / np.sqrt(len(angle)))
    return Order(
        line=value,
        error=error,
        backward=float(np.abs(np.mean(backward))),
        speed=float(np.mean(speeds)),
        lowest=float(speeds.min()),
        highest=float(speeds.max()),
        fourier=_fourier(straight),
        residual=rest / abs(value) if value else np.inf,
        doubt=found.doubt,
        turns=found.turns,
        blocks=len(lines),
        marked=found.marked,
    )


def _blocks(found: Turning) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Forward and backward line and speed of each block (m,), and the rms of what is left."""
    # Two turns tell a curved drift from the line, one does not.
    count = min(_BLOCKS, found.turns // 2) if found.turns > 3 else found.turns
    edges = 2.0 * pi * np.round(np.linspace(0, found.turns, count + 1))
    signal, lines, backward, speeds, squares = found.recording.plane, [], [], [], 0.0
    for first, last in zip(edges[:-1], edges[1:], strict=True):
        chosen = (found.angle >= first) & (found.angle < last)
        p = found.angle[chosen]
        u = (2.0 * p - first - last) / (last - first)
        columns = [np.exp(1j * p), np.exp(-1j * p), np.ones_like(u), u]
        for k in range(2, _HARMONICS + 1):
            columns += [np.exp(1j * k * p), np.exp(-1j * k * p)]
        if last - first > 3.0 * pi:  # within a single turn a changing line and a drift are alike
            columns += [u * u, u * np.exp(1j * p)]
        basis = np.column_stack(columns)
        solution, *_ = np.linalg.lstsq(basis, signal[chosen], rcond=None)
        rest = signal[chosen] - basis @ solution
        squares += float(np.vdot(rest, rest).real) * len(p) / max(len(p) - basis.shape[1], 1)
        lines.append(solution[0])
        backward.append(solution[1])
        t = found.recording.time[chosen]
        speeds.append((p[-1] - p[0]) / (t[-1] - t[0]))
    return np.array(lines), np.array(backward), np.array(speeds), float(np.sqrt(squares / len(signal)))


def _at_mean(lines: np.ndarray, speeds: np.ndarray) -> tuple[complex, float]:
    """Line at the mean speed and its standard error."""
    off = speeds / speeds.mean() - 1.0
    span = float(np.ptp(off))
    degree = 0 if span < _STRAIGHT or len(lines) < 4 else 1 if span < _CURVED or len(lines) < 8 else 2
    basis = np.vander(off, degree + 1, increasing=True)
    solution, *_ = np.linalg.lstsq(basis, lines, rcond=None)
    rest = lines - basis @ solution
    freedom = max(len(lines) - degree - 1, 1)
    variance = float(np.vdot(rest, rest).real) / freedom * np.linalg.inv(basis.T @ basis)[0, 0]
    return complex(solution[0]), float(np.sqrt(variance))


def _aligned(found: Turning, lines: np.ndarray) -> Turning:
    """Angles without a mark, shifted so that the blocks' forward lines (m,) have no phase: an integrated speed wanders."""
    edges = np.round(np.linspace(0, found.turns, len(lines) + 1))
    middles = pi * (edges[:-1] + edges[1:])
    phase = np.unwrap(np.angle(lines))
    shift = np.interp(found.angle, middles, phase)
    for low, chosen in ((0, found.angle < middles[0]), (-2, found.angle > middles[-1])):
        slope = (phase[low + 1] - phase[low]) / (middles[low + 1] - middles[low])
        shift[chosen] = phase[low] + slope * (found.angle[chosen] - middles[low])
    angle = found.angle + shift - shift[0]
    return attrs.evolve(found, angle=angle, turns=max(int((angle[-1] + 1e-6) / (2.0 * pi)), 1))


def _fourier(found: Turning) -> complex:
    """Whole-turn Fourier line after the drift of the turns' means is taken off, from samples at equal angles."""
    from scipy.interpolate import CubicSpline

    per_turn = 64
    grid = 2.0 * pi / per_turn * np.arange(per_turn * found.turns)
    signal = CubicSpline(found.angle, found.recording.plane)(np.clip(grid, found.angle[0], found.angle[-1]))
    turns = signal.reshape(found.turns, per_turn)
    means = turns.mean(axis=1)
    middles = np.arange(found.turns)
    slope = np.polyfit(middles, means, 1)[0] if found.turns > 2 else 0.0
    straight = turns - means[:, None] - slope * (np.arange(per_turn) / per_turn - 0.5)
    return complex((straight.ravel() * np.exp(-1j * grid)).mean())


@attrs.frozen
class RunOut:
    """The run-out: a complex amplitude of e^{j angle} from the mark, its standard error [m], and where it is from."""

    vector: complex = 0.0
    error: float = 0.0
    how: str = "none subtracted"


def given(amplitude: float, angle_deg: float) -> RunOut:
    """A run-out that is known: amplitude [m] and angle of its high spot from the mark."""
    return RunOut(amplitude * exp(1j * radians(angle_deg)), 0.0, "given")


def slow_roll(recording: Recording) -> Order:
    """The 1x line of a slow roll.

    Raises
    ------
    RacewayError
        What is wrong with the record; a record without marks has no phase.
    """
    try:
        found = turning(recording)
        if not found.marked:
            raise RacewayError("no `key`: without a mark a vector has no phase and cannot be subtracted")
        return order(found)
    except RacewayError as why:
        raise RacewayError(f"slow roll: {why}") from None


def less_response(found: Order, held: Bearing, line: Rotor, unbalance_angle: float) -> RunOut:
    """The run-out in a slow roll: its 1x line less what the unbalance does at that speed already.

    Parameters
    ----------
    line : the rotor at the slow roll's speed;  unbalance_angle : of the unbalance from the mark [rad]

    Notes
    -----
    The bearing's stiffness at rest is good enough: the response is a thousandth of that at the speed.
    """
    load = np.linalg.solve(held.compliance - line.ring[:, 1:], line.ring[:, 0] * line.unbalance_force)
    response = line.at_sensor(load[0], load[1]) * exp(1j * unbalance_angle)
    rpm = found.speed * 30.0 / np.pi
    error = float(np.hypot(found.error, 0.5 * found.doubt * abs(found.line)))  # the doubt is a bound: two standard errors
    return RunOut(found.line - response, error, f"slow roll at {rpm:.0f} r/min, {found.turns} turns")
