"""The shaft's angle at every sample: from the marks of a once-per-turn probe, or from a measured speed."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

import attrs
import numpy as np

from raceway.errors import RacewayError
from raceway.studies.fit.signals import Recording

if TYPE_CHECKING:
    from scipy.interpolate import PPoly


#: A mark counts once the voltage was this part of its range below the middle and then rises to as much above it ...
_LEAST, _MOST = 0.1, 0.35
#: ... or so many standard deviations of its noise, with which it comes back across the middle on no flank.
_SAFE = 4.0
#: Noise that a mean of samples at the same angle may keep, over the range; fewest such means over a turn.
_QUIET, _FEWEST = 0.003, 64
#: Means within so many standard deviations of the lowest or highest one belong to the same plateau.
_PLATEAU = 6.0
#: Median of |second difference| of white noise over its standard deviation: 0.6745 sqrt(1 + 4 + 1); of first differences.
_SECOND, _FIRST = 0.6745 * 6.0**0.5, 0.6745 * 2.0**0.5


@attrs.frozen(eq=False)
class Marks:
    """Times at which a probe's voltage rises through the middle of its range.

    Attributes
    ----------
    times : (n,) [s]
    jump : mean rise from one sample to the next on the flank, over the range, at most 1
    level : standard error of all times together, because noise hides where the middle of the range is [s]
    """

    times: np.ndarray
    jump: float
    level: float


def marks_of(time: np.ndarray, key: np.ndarray) -> Marks:
    """Marks of a voltage.

    Parameters
    ----------
    time : (n,) [s];  key : (n,) voltage, any unit

    Raises
    ------
    RacewayError
        The voltage never changes.

    Notes
    -----
    Each mark is where the least-squares line through the samples of its flank crosses the middle.  The first sample above it
    would be early by noise, and so would the extremes of the samples be off as the range: the plateaus are those of the mean turn.
    """
    low, high = float(key.min()), float(key.max())
    if high - low <= 0.0:
        raise RacewayError("`key` never changes: no mark is seen")
    noise = float(np.median(np.abs(np.diff(key, 2)))) / _SECOND
    times, slopes = _crossings(time, (key - low) / (high - low), noise / (high - low))
    doubt = 0.0
    if len(times) > 1 and noise > 0.0:
        low, high, doubt, noise = _plateaus(time, key, times)
        times, slopes = _crossings(time, (key - low) / (high - low), noise / (high - low))
    if not len(times):
        return Marks(times, 0.0, 0.0)
    slope = float(np.mean(slopes))
    jump = min(slope * float(np.median(np.diff(time))), 1.0)
    return Marks(times, jump, doubt / (high - low) / slope)


def _crossings(time: np.ndarray, level: np.ndarray, noise: float) -> tuple[np.ndarray, np.ndarray]:
    """Times [s] at which a level (n,) rises through 1/2, and its slopes there [1/s]."""
    apart = min(max(_LEAST, _SAFE * noise), _MOST)
    state = np.where(level > 0.5 + apart, 1, np.where(level < 0.5 - apart, -1, 0))
    known = np.flatnonzero(state)
    rises = np.flatnonzero((state[known][:-1] < 0) & (state[known][1:] > 0))
    found, slopes = [], []
    for before, after in zip(known[rises], known[rises + 1], strict=True):
        # Forward in time and upside down the same samples are chosen: noise moves the line neither way.
        t, y = time[before : after + 1], level[before : after + 1]
        off = y - y.mean()
        found.append(t.mean() + (t @ off) / (off @ off) * (0.5 - y.mean()))
        slopes.append((y[-1] - y[0]) / (t[-1] - t[0]))
    return np.array(found), np.array(slopes)


def _plateaus(time: np.ndarray, key: np.ndarray, times: np.ndarray) -> tuple[float, float, float, float]:
    """Lowest and highest voltage of the mean turn, standard error of the middle between them, and the noise of a sample.

    Parameters
    ----------
    times : of the marks as first seen [s]
    """
    inside = (time >= times[0]) & (time < times[-1])
    part = np.interp(time[inside], times, np.arange(len(times))) % 1.0
    turn = key[inside][np.argsort(part, kind="stable")]
    # Of neighbours in angle: in time a voltage that is never flat would count as noise.
    noise = float(np.median(np.abs(np.diff(turn)))) / _FIRST
    wanted = np.ceil((noise / (_QUIET * np.ptp(turn))) ** 2)
    each = int(np.clip(wanted, 1, max(len(turn) // _FEWEST, 1)))
    whole = len(turn) // each
    means = turn[: whole * each].reshape(whole, each).mean(axis=1)
    error = noise / np.sqrt(each)
    low, high = (means[np.abs(means - end) <= _PLATEAU * error] for end in (means.min(), means.max()))
    doubt = 0.5 * error * np.hypot(len(low) ** -0.5, len(high) ** -0.5)
    return float(low.mean()), float(high.mean()), float(doubt), noise


#: Change of speed from one turn to the next, and over a record, that the 1x line is followed through.
MOST_PER_TURN, MOST_RANGE = 0.01, 0.10
#: Samples a turn: lines up to 3x are told apart.
LEAST_PER_TURN = 8
#: Turns between two knots of the angle's spline: a mark is known to a sample only.
_TURNS_PER_KNOT = 12
#: Largest relative difference of the marks' speed and that of a column.
_AGREE = 0.05
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
    doubt : by which the angle of all marks together may be off [rad], half-width at 95 %
    """

    recording: Recording
    angle: np.ndarray
    speed: np.ndarray
    turns: int
    marked: bool
    doubt: float = 0.0


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
    assert recording.key is not None
    seen = marks_of(recording.time, recording.key)
    marks = seen.times
    if len(marks) < 3:
        raise RacewayError(f"{max(len(marks) - 1, 0)} whole turns between the marks of `key`; at least two are needed")
    lengths = np.diff(marks)
    ratio = lengths / np.median(lengths)
    for place in np.flatnonzero((ratio > 1.6) | (ratio < 0.6))[:1]:
        what = "missing" if ratio[place] > 1.0 else "double"
        raise RacewayError(
            f"the turn at {marks[place]:.6g} s takes {ratio[place]:.2f} of the usual time: a mark of `key` is {what} there, or the "
            f"speed is not constant (order tracking follows up to {100 * MOST_RANGE:g} % over the record). Cut the record there"
        )
    mean = 2.0 * pi * (len(marks) - 1) / float(marks[-1] - marks[0])
    if recording.speed is not None and abs(mean / float(recording.speed.mean()) - 1.0) > _AGREE:
        raise RacewayError(
            f"the marks of `key` come at {mean * 30.0 / pi:.6g} r/min, the speed column says "
            f"{recording.speed.mean() * 30.0 / pi:.6g}: marks between samples are missed, or there are several a turn. "
            "Sample faster, or leave one of the columns out"
        )
    spline = _smooth_angle(marks)
    whole = 2.0 * pi * (len(marks) - 1)
    # The smooth angle begins and ends its whole turns a little beside the marks; well beyond them it means nothing.
    beside = 0.25 * float(np.median(lengths))
    part = recording.part((recording.time >= marks[0] - beside) & (recording.time < marks[-1] + beside))
    angle = spline(part.time)
    inside = (angle >= 0.0) & (angle < whole)
    part, angle = part.part(inside), angle[inside]
    return Turning(part, angle, spline(part.time, 1), len(marks) - 1, True, _doubt(recording.time, seen, spline))


def _doubt(time: np.ndarray, seen: Marks, spline: PPoly) -> float:
    """By which all marks together may be off, half-width at 95 % [rad].

    Notes
    -----
    Marks scatter about the smooth angle, by noise and by samples that miss them: so does their mean, by Student's distribution.
    What all of them share is apart from that.  A flank that is steeper than the samples are apart tells a mark to half an
    interval; one that takes n samples to about 1 / n^2 of that.  It averages out where marks fall anywhere between samples;
    where sampling keeps step with the shaft they all fall on the same place, and the doubt stays: it is weighed with their
    mean direction on a circle of one interval.
    """
    from scipy.special import stdtrit

    marks = seen.times
    apart = spline(marks) - 2.0 * pi * np.arange(len(marks))
    smooth = marks - apart / spline(marks, 1)
    after = np.clip(np.searchsorted(time, smooth), 1, len(time) - 1)
    places = (smooth - time[after - 1]) / (time[after] - time[after - 1])
    together = max(float(abs(np.exp(2j * pi * places).mean())), len(marks) ** -0.5)
    speed = 2.0 * pi * (len(marks) - 1) / float(marks[-1] - marks[0])
    shared = 0.5 * speed * float(np.median(np.diff(time))) * seen.jump**2 * together
    free = len(marks) - len(spline.c)
    scatter = float(stdtrit(free, 0.975)) * float(np.sqrt(apart @ apart / free / len(marks)))
    return float(np.sqrt(shared**2 + scatter**2 + (1.96 * speed * seen.level) ** 2))


def _smooth_angle(marks: np.ndarray) -> PPoly:
    """The angle over time [rad]: cubic splines with a knot every few turns, through the scatter of marks between samples."""
    from scipy.interpolate import make_lsq_spline

    count = len(marks)
    degree = min(3, count - 1) if count >= 8 else 1 if count < 5 else 2
    pieces = max((count - 1) // _TURNS_PER_KNOT, 1)
    inner = np.interp(np.linspace(0, count - 1, pieces + 1)[1:-1], np.arange(count), marks)
    knots = np.concatenate([[marks[0]] * (degree + 1), inner, [marks[-1]] * (degree + 1)])
    return make_lsq_spline(marks, 2.0 * pi * np.arange(count), knots, degree)


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
    turn = np.minimum((found.angle / (2.0 * pi)).astype(int), found.turns - 1)
    counts = np.maximum(np.bincount(turn, minlength=found.turns), 1)
    speeds = np.bincount(turn, found.speed, minlength=found.turns) / counts
    begins = np.bincount(turn, found.recording.time, minlength=found.turns) / counts
    change = np.abs(np.diff(speeds)) / speeds[1:]
    if change.max() > MOST_PER_TURN:
        k = int(np.argmax(change))
        raise RacewayError(
            f"the speed is not constant: it changes by {100 * change[k]:.2g} % from one turn to the next at {begins[k + 1]:.6g} s; "
            f"order tracking follows up to {100 * MOST_PER_TURN:g} %"
        )
    span = (speeds.max() - speeds.min()) / speeds.mean()
    if span > MOST_RANGE:
        raise RacewayError(
            f"the speed is not constant: it changes by {100 * span:.3g} % over the record; up to {100 * MOST_RANGE:g} % is one "
            "operating point. Cut the record into parts"
        )
