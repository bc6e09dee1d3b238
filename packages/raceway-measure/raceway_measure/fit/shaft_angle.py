"""Angle of the shaft at every sample: from the pulses of a keyphasor (once-per-turn probe), or from a measured speed."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

import attrs
import numpy as np

from raceway import RacewayError
from raceway_measure.fit.signals import Recording

if TYPE_CHECKING:
    from scipy.interpolate import PPoly

#: Change of speed from one turn to the next, and over a record, through which the 1x component is followed.
_MOST_PER_TURN, _MOST_RANGE = 0.01, 0.10
#: Samples per turn: harmonics up to 3x are told apart.
_LEAST_PER_TURN = 8
#: Turns between two knots of the angle's spline: the time of a pulse is uncertain by a sample.
_TURNS_PER_KNOT = 12
#: Largest relative difference between the speed of the pulses and that of a column.
_AGREE = 0.05
#: Turns over which the speed of a column is averaged.
_SMOOTH_TURNS = 1.0
#: A pulse counts if the voltage was this part of its range below the middle and then rises to as much above it ...
_LEAST, _MOST = 0.1, 0.35
#: ... or this many standard deviations of its noise, with which it comes back across the middle on no flank.
_SAFE = 4.0
#: Noise over the range that a mean of samples at the same angle may have; fewest such means over a turn.
_QUIET, _FEWEST = 0.003, 64
#: Means within this many standard deviations of the lowest or highest one belong to the same plateau.
_PLATEAU = 6.0
#: Median of |second difference| of white noise over its standard deviation: 0.6745 sqrt(1 + 4 + 1); of first differences.
_SECOND, _FIRST = 0.6745 * 6.0**0.5, 0.6745 * 2.0**0.5


@attrs.frozen(eq=False)
class Rotation:
    """A record of full turns with its angles."""

    recording: Recording  # the samples from the first to the last pulse
    angle: np.ndarray  # (n,) from the first pulse [rad]
    speed: np.ndarray  # (n,) [rad/s]
    turns: int  # full turns
    marked: bool  # whether angle 0 is that of a pulse; else the record's beginning
    angle_error: float = 0.0  # half-width at 95 % of the angle of all pulses together [rad]

    def means(self, values: np.ndarray) -> np.ndarray:
        """Mean over each turn (turns,) of samples (n,)."""
        turn = np.minimum((self.angle / (2.0 * pi)).astype(int), self.turns - 1)
        return np.bincount(turn, values, minlength=self.turns) / np.maximum(np.bincount(turn, minlength=self.turns), 1)


def rotation_of(recording: Recording) -> Rotation:
    """Angles of a record; RacewayError: fewer than two turns, missing pulses, or a speed that changes too much."""
    rotation = _by_pulses(recording, recording.key) if recording.key is not None else _by_speed(recording)
    per_turn = len(rotation.angle) / rotation.turns
    if per_turn < _LEAST_PER_TURN:
        raise RacewayError(f"{per_turn:.1f} samples per turn; at least {_LEAST_PER_TURN} are needed: sample faster")
    speeds = rotation.means(rotation.speed)
    change = np.abs(np.diff(speeds)) / speeds[1:]
    if change.max() > _MOST_PER_TURN:
        k = int(np.argmax(change))
        raise RacewayError(
            f"the speed is not constant: it changes by {100 * change[k]:.2g} % from one turn to the next at "
            f"{rotation.means(rotation.recording.time)[k + 1]:.6g} s; order tracking follows up to {100 * _MOST_PER_TURN:g} %"
        )
    span = (speeds.max() - speeds.min()) / speeds.mean()
    if span > _MOST_RANGE:
        remedy = f"up to {100 * _MOST_RANGE:g} % is one operating point. Cut the record into parts"
        raise RacewayError(f"the speed is not constant: it changes by {100 * span:.3g} % over the record; {remedy}")
    return rotation


def _by_pulses(recording: Recording, key: np.ndarray) -> Rotation:
    pulses = pulses_of(recording.time, key)
    times, turns = pulses.times, len(pulses.times) - 1
    if turns < 2:
        raise RacewayError(f"{max(turns, 0)} whole turns between the pulses of `key`; at least two are needed")
    lengths = np.diff(times)
    ratio = lengths / np.median(lengths)
    for k in np.flatnonzero((ratio > 1.6) | (ratio < 0.6))[:1]:
        fault = "missing" if ratio[k] > 1.0 else "double"
        raise RacewayError(
            f"the turn at {times[k]:.6g} s takes {ratio[k]:.2f} of the usual time: a pulse of `key` is {fault} there, or the "
            f"speed is not constant (order tracking follows up to {100 * _MOST_RANGE:g} % over the record). Cut the record there"
        )
    mean = 2.0 * pi * turns / float(times[-1] - times[0])
    if recording.speed is not None and abs(mean / float(recording.speed.mean()) - 1.0) > _AGREE:
        raise RacewayError(
            f"the pulses of `key` come at {mean * 30.0 / pi:.6g} r/min, the speed column says "
            f"{recording.speed.mean() * 30.0 / pi:.6g}: pulses between samples are missed, or there are several per turn. "
            "Sample faster, or omit one of the columns"
        )
    # The angle over time [rad]: cubic splines with a knot every few turns, through pulses that samples and noise scatter.
    from scipy.interpolate import make_lsq_spline

    count = len(times)
    degree = min(3, count - 1) if count >= 8 else 1 if count < 5 else 2
    pieces = max((count - 1) // _TURNS_PER_KNOT, 1)
    inner = np.interp(np.linspace(0, count - 1, pieces + 1)[1:-1], np.arange(count), times)
    knots = np.concatenate([[times[0]] * (degree + 1), inner, [times[-1]] * (degree + 1)])
    spline = make_lsq_spline(times, 2.0 * pi * np.arange(count), knots, degree)
    # The smooth angle begins and ends its full turns a little beside the pulses; far beyond them it means nothing.
    margin = 0.25 * float(np.median(lengths))
    part = recording.part((recording.time >= times[0] - margin) & (recording.time < times[-1] + margin))
    angle = spline(part.time)
    inside = (angle >= 0.0) & (angle < 2.0 * pi * turns)
    part, angle = part.part(inside), angle[inside]
    return Rotation(part, angle, spline(part.time, 1), turns, True, _angle_error(recording.time, pulses, spline))


def _angle_error(time: np.ndarray, pulses: _Pulses, spline: PPoly) -> float:
    """Error of the angle of all pulses together, half-width at 95 % [rad].

    Pulses scatter about the smooth angle, by noise and by samples that miss them: so does their mean, by Student's distribution.
    What all of them share is apart from that.  A flank that is steeper than the interval of samples determines a pulse to half an
    interval; one that takes n samples to about 1 / n^2 of that.  It averages out where pulses fall anywhere between samples;
    where sampling keeps step with the shaft they all fall on the same place, and the error stays: it is weighed with their
    mean direction on a circle of one interval.
    """
    from scipy.special import stdtrit

    times = pulses.times
    deviation = spline(times) - 2.0 * pi * np.arange(len(times))
    smooth = times - deviation / spline(times, 1)
    after = np.clip(np.searchsorted(time, smooth), 1, len(time) - 1)
    fraction = (smooth - time[after - 1]) / (time[after] - time[after - 1])
    together = max(float(abs(np.exp(2j * pi * fraction).mean())), len(times) ** -0.5)
    speed = 2.0 * pi * (len(times) - 1) / float(times[-1] - times[0])
    common_error = 0.5 * speed * float(np.median(np.diff(time))) * pulses.jump**2 * together
    freedom = len(times) - len(spline.c)
    mean = float(stdtrit(freedom, 0.975)) * float(np.sqrt(deviation @ deviation / freedom / len(times)))
    return float(np.sqrt(common_error**2 + mean**2 + (1.96 * speed * pulses.middle_error) ** 2))


def _by_speed(recording: Recording) -> Rotation:
    assert recording.speed is not None
    speed, time = recording.speed, recording.time
    if speed.min() <= 0.0:
        k = int(np.argmin(speed))
        raise RacewayError(f"`speed` is {speed[k] * 30 / pi:g} r/min at {time[k]:.6g} s: it must be greater than 0")
    turn = 2.0 * pi / float(np.median(speed)) * _SMOOTH_TURNS
    half, index = np.array([[0], [1]]) + max(int(turn / np.median(np.diff(time))), 1) // 2, np.arange(len(speed))
    total = np.concatenate([[0.0], np.cumsum(speed)])
    first, last = np.maximum(index - half[0], 0), np.minimum(index + half[1], len(speed))
    smooth = (total[last] - total[first]) / (last - first)  # mean over the turns, over fewer samples at the ends
    angle = np.concatenate([[0.0], np.cumsum(0.5 * (smooth[1:] + smooth[:-1]) * np.diff(time))])
    turns = int(angle[-1] / (2.0 * pi) + 1e-6)
    if turns < 2:
        raise RacewayError(f"{angle[-1] / (2 * pi):.2f} turns in the record; at least two are needed")
    inside = angle < 2.0 * pi * turns
    return Rotation(recording.part(inside), angle[inside], smooth[inside], turns, False)


@attrs.frozen(eq=False)
class _Pulses:
    """Times at which a keyphasor's voltage rises through the middle of its range."""

    times: np.ndarray  # (n,) [s]
    jump: float  # mean rise from one sample to the next on the flank, over the range, at most 1
    middle_error: float  # standard error of all times together, because noise hides where the middle of the range is [s]


def pulses_of(time: np.ndarray, key: np.ndarray) -> _Pulses:
    """Pulses of a voltage.

    time : (n,) [s];  key : (n,) voltage, any unit
    RacewayError: the voltage never changes.

    Each pulse is where the least-squares line through the samples of its flank crosses the middle.  The first sample above it
    would be early by noise, and so would the extremes of the samples be off as the range: the plateaus are those of the mean turn.
    """
    low, high = float(key.min()), float(key.max())
    if high - low <= 0.0:
        raise RacewayError("`key` never changes: it has no pulse")
    noise = float(np.median(np.abs(np.diff(key, 2)))) / _SECOND
    times, slopes = _crossings(time, (key - low) / (high - low), noise / (high - low))
    error = 0.0
    if len(times) > 1 and noise > 0.0:
        # The plateaus of the mean turn, and the standard error of the middle between them.
        inside = (time >= times[0]) & (time < times[-1])
        part = np.interp(time[inside], times, np.arange(len(times))) % 1.0
        turn = key[inside][np.argsort(part, kind="stable")]
        # Of neighbours in angle: in time a voltage that is never flat would count as noise.
        noise = float(np.median(np.abs(np.diff(turn)))) / _FIRST
        size = np.ceil((noise / (_QUIET * np.ptp(turn))) ** 2)
        size = int(np.clip(size, 1, max(len(turn) // _FEWEST, 1)))
        count = len(turn) // size
        means = turn[: count * size].reshape(count, size).mean(axis=1)
        error = noise / np.sqrt(size)
        plateaus = [means[np.abs(means - end) <= _PLATEAU * error] for end in (means.min(), means.max())]
        error = float(0.5 * error * np.hypot(len(plateaus[0]) ** -0.5, len(plateaus[1]) ** -0.5))
        low, high = (float(plateau.mean()) for plateau in plateaus)
        times, slopes = _crossings(time, (key - low) / (high - low), noise / (high - low))
    if not len(times):
        return _Pulses(times, 0.0, 0.0)
    slope = float(np.mean(slopes))
    jump = min(slope * float(np.median(np.diff(time))), 1.0)
    return _Pulses(times, jump, error / (high - low) / slope)


def _crossings(time: np.ndarray, level: np.ndarray, noise: float) -> tuple[np.ndarray, np.ndarray]:
    """Times [s] at which a level (n,) rises through 1/2, and its slopes there [1/s]."""
    band = min(max(_LEAST, _SAFE * noise), _MOST)
    state = np.where(level > 0.5 + band, 1, np.where(level < 0.5 - band, -1, 0))
    outside = np.flatnonzero(state)
    rises = np.flatnonzero((state[outside][:-1] < 0) & (state[outside][1:] > 0))
    times, slopes = [], []
    for before, after in zip(outside[rises], outside[rises + 1], strict=True):
        # Forward in time and upside down the same samples are chosen: noise moves the line neither way.
        t, y = time[before : after + 1], level[before : after + 1]
        deviation = y - y.mean()
        times.append(t.mean() + (t @ deviation) / (deviation @ deviation) * (0.5 - y.mean()))
        slopes.append((y[-1] - y[0]) / (t[-1] - t[0]))
    return np.array(times), np.array(slopes)
