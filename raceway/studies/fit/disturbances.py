"""Disturbances of a record of force and displacement beside white noise: hum, coloured noise, a force sampled without a filter.

Notes
-----
Power of residuals over their variance is exponential with the mean 1 at each frequency of a transform, and independent from one to the
next, where noise is stationary.  A peak far above its neighbours is a tone; blocks of frequencies whose means differ by more than that
allows are not white.

A force sampled at fs has at each frequency w its true spectrum at fs - w added.  What its upper half would add at half the rate, with
signs of lobes and times of pulses, stands for that: spectra of pulses without jumps fall with 1 / w^2 beyond their first lobe.
"""

from __future__ import annotations

import numpy as np

#: A tone's power over the median of its neighbours, which lie within this many frequencies; frequencies of a tone to either side; tones at most.
_FAR, _NEIGHBOURS, _WIDTH, TONES = 30.0, 16, 2, 6
#: Blocks of frequencies whose powers are compared, and probability below which they are not alike.
_BLOCKS, _UNLIKELY = 16, 1e-3
#: Part of the frequencies below half the sampling rate whose mean power is compared with noise, and the factor by which it is more.
_TOP, _ABOVE = 0.1, 4.0


def spectrum(signal: np.ndarray) -> np.ndarray:
    """Discrete Fourier transform of real signals (N, ...) less their means, over N."""
    return np.asarray(np.fft.rfft(signal - signal.mean(axis=0), axis=0) / len(signal))


def tone(residuals: np.ndarray, variance: np.ndarray, omega: np.ndarray) -> float | None:
    """Frequency [rad/s] of the largest tone in complex residuals (n, d) at even frequencies (n,); None without one."""
    power = np.abs(residuals) ** 2 / variance
    peak, axis = np.unravel_index(int(np.argmax(power)), power.shape)
    power, residual = power[:, axis], residuals[:, axis]
    distance = np.abs(np.arange(len(power)) - peak)
    near = power[(distance <= _NEIGHBOURS) & (distance > _WIDTH)]
    if len(near) < _NEIGHBOURS or power[peak] < _FAR * np.median(near) / np.log(2.0):
        return None
    beside = max((k for k in (peak - 1, peak + 1) if 0 <= k < len(power)), key=lambda k: float(power[k]))
    # The components of a tone fall with the distance from it, their phases alternate.
    index = float(((peak * residual[peak] - beside * residual[beside]) / (residual[peak] - residual[beside])).real)
    return float(omega[0] + (omega[1] - omega[0]) * np.clip(index, peak - 1, peak + 1))


def uneven(power: np.ndarray) -> tuple[int, float] | None:
    """Index amid the block of power (n, d) over variance that is farthest from the mean, and its factor; None for white residuals."""
    from scipy.stats import chi2

    blocks = np.array_split(power, _BLOCKS)
    factors = np.array([block.mean() for block in blocks]) / power.mean()
    deviations = np.array([block.size for block in blocks]) * (factors - 1.0) ** 2
    if chi2.sf(deviations.sum(), _BLOCKS - 1) > _UNLIKELY:
        return None
    worst = int(np.argmax(deviations))
    return sum(len(block) for block in blocks[:worst]) + len(blocks[worst]) // 2, float(factors[worst])


def aliased(signal: np.ndarray, noise: np.ndarray) -> tuple[np.ndarray, float]:
    """Standard error (N / 2 + 1, d), with its phase, of a force (N, d) by its spectrum beyond half the sampling rate.

    Parameters
    ----------
    noise : (d,) variance at a frequency, at most

    Returns
    -------
    as well : largest amplitude just below half the rate over that of all frequencies; 0 where noise hides it
    """
    count = len(signal)
    quiet = signal - np.median(signal, axis=0)
    # A window removes what beginning and end of a record add everywhere, and leaves 3 / 8 of the noise; pulses are rare, noise is not.
    windowed = np.abs(spectrum(np.hanning(count)[:, None] * quiet)) ** 2
    noise = np.minimum(noise, (1.4826 * np.median(np.abs(quiet), axis=0)) ** 2 / count)
    level = windowed[-int(_TOP * len(windowed)) :].mean(axis=0)
    visible = level > _ABOVE * 0.375 * noise
    share = np.linspace(0.0, 1.0, count // 2 + 1)[:, None]  # frequency over half the rate
    folded = spectrum((-1.0) ** np.arange(count)[:, None] * quiet) * ((1.0 - share) / (2.0 - share)) ** 2
    part = float(np.sqrt(np.where(visible, level / windowed.max(axis=0), 0.0).max()))
    return np.where(visible, folded, 0.0) / np.sqrt(2.0), part
