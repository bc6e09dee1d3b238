"""The marks of a once-per-turn probe: when its voltage rises through the middle of its range, through noise."""

from __future__ import annotations

import attrs
import numpy as np

from raceway.errors import RacewayError

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
