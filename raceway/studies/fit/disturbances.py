"""What disturbs a record of force and displacement beside white noise: hum, noise of other colours, a force sampled without a filter.

Notes
-----
Power of residuals over their variance is exponential with the mean 1 at each line of a transform, and independent of line to line, where
noise is stationary.  A line far above its neighbours is a tone; blocks of lines whose means differ by more than that allows are not white.

A force sampled at fs has at each frequency w what it truly has at fs - w added.  What its own upper half would add at half the rate, with
signs of lobes and places of pulses, stands for that: spectra of pulses without jumps fall with 1 / w^2 beyond their first lobe.
"""

from __future__ import annotations

import numpy as np

#: A tone's power over the median of its neighbours, which lie within so many lines; lines of a tone to either side; tones at most.
_FAR, _NEIGHBOURS, _OWN, TONES = 30.0, 16, 2, 6
#: Blocks of lines whose powers are compared, and probability below which they are not alike.
_BLOCKS, _UNLIKELY = 16, 1e-3
#: Part of the lines below half the sampling rate whose mean power is held against noise, and by what factor it is more.
_TOP, _ABOVE = 0.1, 4.0


def spectrum(signal: np.ndarray) -> np.ndarray:
    """Discrete Fourier transform of real signals (N, ...) less their means, over N."""
    return np.asarray(np.fft.rfft(signal - signal.mean(axis=0), axis=0) / len(signal))


def tone(residuals: np.ndarray, variance: np.ndarray, omega: np.ndarray) -> float | None:
    """Frequency [rad/s] of the largest tone in complex residuals (n, d) at even frequencies (n,); None without one."""
    power = np.abs(residuals) ** 2 / variance
    peak, axis = np.unravel_index(int(np.argmax(power)), power.shape)
    power, line = power[:, axis], residuals[:, axis]
    away = np.abs(np.arange(len(power)) - peak)
    near = power[(away <= _NEIGHBOURS) & (away > _OWN)]
    if len(near) < _NEIGHBOURS or power[peak] < _FAR * np.median(near) / np.log(2.0):
        return None
    beside = max((k for k in (peak - 1, peak + 1) if 0 <= k < len(power)), key=lambda k: float(power[k]))
    # Lines of a tone fall with the distance from it, their phases alternate.
    place = float(((peak * line[peak] - beside * line[beside]) / (line[peak] - line[beside])).real)
    return float(omega[0] + (omega[1] - omega[0]) * np.clip(place, peak - 1, peak + 1))


def uneven(power: np.ndarray) -> tuple[int, float] | None:
    """Of power (n, d) over variance: the line amid the block that is farthest from the mean, and its factor; None where it is white."""
    from scipy.stats import chi2

    blocks = np.array_split(power, _BLOCKS)
    factors = np.array([block.mean() for block in blocks]) / power.mean()
    off = np.array([block.size for block in blocks]) * (factors - 1.0) ** 2
    if chi2.sf(off.sum(), _BLOCKS - 1) > _UNLIKELY:
        return None
    worst = int(np.argmax(off))
    return sum(len(block) for block in blocks[:worst]) + len(blocks[worst]) // 2, float(factors[worst])


def aliased(signal: np.ndarray, noise: np.ndarray) -> tuple[np.ndarray, float]:
    """Standard error (N / 2 + 1, d), with its phase, that a force (N, d) has by what lies beyond half its sampling rate.

    Parameters
    ----------
    noise : (d,) variance of a line, at most

    Returns
    -------
    as well : size of the lines below half the rate over the largest one; 0 where noise hides them
    """
    count = len(signal)
    quiet = signal - np.median(signal, axis=0)
    # A window takes off what beginning and end of a record add everywhere, and 3 / 8 of the noise stay; pulses are rare, noise is not.
    seen = np.abs(spectrum(np.hanning(count)[:, None] * quiet)) ** 2
    noise = np.minimum(noise, (1.4826 * np.median(np.abs(quiet), axis=0)) ** 2 / count)
    level = seen[-int(_TOP * len(seen)) :].mean(axis=0)
    there = level > _ABOVE * 0.375 * noise
    share = np.linspace(0.0, 1.0, count // 2 + 1)[:, None]  # frequency over half the rate
    folded = spectrum((-1.0) ** np.arange(count)[:, None] * quiet) * ((1.0 - share) / (2.0 - share)) ** 2
    part = float(np.sqrt(np.where(there, level / seen.max(axis=0), 0.0).max()))
    return np.where(there, folded, 0.0) / np.sqrt(2.0), part
