"""The shaft's angle at every sample: from the marks of a once-per-turn probe, or from a measured speed."""

from __future__ import annotations

from math import pi

import attrs
import numpy as np

from raceway.errors import RacewayError
from raceway.studies.measured.recording import Recording

#: Change of speed from one turn to the next, and over a record, that the 1x line is followed through.
MOST_PER_TURN, MOST_RANGE = 0.01, 0.10
#: Samples a turn: lines up to 3x are told apart.
LEAST_PER_TURN = 8
#: A mark counts once the probe was below the lower and is above the upper of these parts of its range.
_LOW, _HIGH = 0.4, 0.6
#: The speed of a column is taken as the mean over this many turns.
_SMOOTH_TURNS = 1.0


@attrs.frozen(eq=False)
class Turning:
    """A record of whole turns with its angles.

    Attributes
    ----------
    recording : the samples from the first to the last mark
    angle : (n,) from the first mark [rad];  speed : (n,) [rad/s]
    turns : whole turns;  marked : whether angle 0 is the mark, or just where the record begins
    """

    recording: Recording
    angle: np.ndarray
    speed: np.ndarray
    turns: int
    marked: bool


def turning(recording: Recording) -> Turning:
    """Angles of a record.

    Raises
    ------
    RacewayError
        Fewer than two turns, marks that are missing, or a speed that changes too much.
    """
    found = _by_marks(recording) if recording.key is not None else _by_speed(recording)
    per_turn = len(found.angle) / found.turns
    if per_turn < LEAST_PER_TURN:
        raise RacewayError(f"{per_turn:.1f} samples a turn; at least {LEAST_PER_TURN} are needed: sample faster")
    _refuse_change(found)
    return found


def _by_marks(recording: Recording) -> Turning:
    from scipy.interpolate import CubicSpline

    assert recording.key is not None
    marks = marks_of(recording.time, recording.key)
    if len(marks) < 3:
        raise RacewayError(f"{max(len(marks) - 1, 0)} whole turns between the marks of `key`; at least two are needed")
    lengths = np.diff(marks)
    ratio = lengths / np.median(lengths)
    for place in np.flatnonzero((ratio > 1.6) | (ratio < 0.6))[:1]:
        what = "missing" if ratio[place] > 1.0 else "double"
        raise RacewayError(
            f"a mark of `key` is {what} at {marks[place]:.6g} s: that turn takes {ratio[place]:.2f} of the usual time. "
            "Cut the record there"
        )
    inside = (recording.time >= marks[0]) & (recording.time < marks[-1])
    spline = CubicSpline(marks, 2.0 * pi * np.arange(len(marks)), bc_type="natural" if len(marks) > 3 else "not-a-knot")
    part = recording.part(inside)
    return Turning(part, spline(part.time), spline(part.time, 1), len(marks) - 1, True)


def marks_of(time: np.ndarray, key: np.ndarray) -> np.ndarray:
    """Times [s] at which a probe's voltage (n,) rises through the middle of its range, between samples by a straight line."""
    low, high = float(key.min()), float(key.max())
    if high - low <= 0.0:
        raise RacewayError("`key` never changes: no mark is seen")
    level = (key - low) / (high - low)
    state = np.where(level > _HIGH, 1, np.where(level < _LOW, -1, 0))
    known = np.flatnonzero(state)
    rises = np.flatnonzero((state[known][:-1] < 0) & (state[known][1:] > 0))
    found = []
    for before, after in zip(known[rises], known[rises + 1], strict=True):
        k = before + int(np.argmax(level[before : after + 1] >= 0.5))
        part = (0.5 - level[k - 1]) / (level[k] - level[k - 1])
        found.append(time[k - 1] + part * (time[k] - time[k - 1]))
    return np.array(found)


def _by_speed(recording: Recording) -> Turning:
    assert recording.speed is not None
    speed, time = recording.speed, recording.time
    if speed.min() <= 0.0:
        place = int(np.argmin(speed))
        raise RacewayError(f"`speed` is {speed[place] * 30 / pi:g} r/min at {time[place]:.6g} s: it must be greater than 0")
    turn = 2.0 * pi / float(np.median(speed)) * _SMOOTH_TURNS
    width = max(int(turn / np.median(np.diff(time))), 1)
    smooth = _smooth(speed, width)
    angle = np.concatenate([[0.0], np.cumsum(0.5 * (smooth[1:] + smooth[:-1]) * np.diff(time))])
    turns = int(angle[-1] / (2.0 * pi) + 1e-6)
    if turns < 2:
        raise RacewayError(f"{angle[-1] / (2 * pi):.2f} turns in the record; at least two are needed")
    inside = angle < 2.0 * pi * turns
    return Turning(recording.part(inside), angle[inside], smooth[inside], turns, False)


def _smooth(values: np.ndarray, width: int) -> np.ndarray:
    """Mean over ``width`` samples, over fewer at the ends."""
    total = np.concatenate([[0.0], np.cumsum(values)])
    first = np.maximum(np.arange(len(values)) - width // 2, 0)
    last = np.minimum(np.arange(len(values)) + width // 2 + 1, len(values))
    return (total[last] - total[first]) / (last - first)


def _refuse_change(found: Turning) -> None:
    marks = np.interp(2.0 * pi * np.arange(found.turns + 1), found.angle, found.recording.time)
    marks[-1] = marks[-2] + 2.0 * pi / found.speed[-1]
    speeds = 1.0 / np.diff(marks)
    change = np.abs(np.diff(speeds)) / speeds[1:]
    if change.max() > MOST_PER_TURN:
        k = int(np.argmax(change))
        raise RacewayError(
            f"the speed is not constant: it changes by {100 * change[k]:.2g} % from one turn to the next at {marks[k + 1]:.6g} s; "
            f"order tracking follows up to {100 * MOST_PER_TURN:g} %"
        )
    span = (speeds.max() - speeds.min()) / speeds.mean()
    if span > MOST_RANGE:
        raise RacewayError(
            f"the speed is not constant: it changes by {100 * span:.3g} % over the record; up to {100 * MOST_RANGE:g} % is one "
            "operating point. Cut the record into parts"
        )
