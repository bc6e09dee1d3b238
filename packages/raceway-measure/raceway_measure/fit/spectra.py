"""Spectra of measured signals, with their noise, tones that belong to no model, and what sampling folds into them.

Power of residuals over their variance is exponential with the mean 1 at each frequency, independent from one to the next, where noise is
stationary.  A peak far above its neighbours is a tone; blocks of frequencies whose means differ by more than that allows are not white.
A force sampled at fs has at each frequency w its true spectrum at fs - w added.  What its upper half would add at half the rate, with
signs of lobes and times of pulses, stands for that: spectra of pulses without jumps fall with 1 / w^2 beyond their first lobe.
"""

import attrs
import numpy as np

from raceway import SceneError
from raceway_measure.fit.signals import Signals

#: A tone's power over the median of its neighbours, which lie within this many frequencies; frequencies of a tone to either side; tones at most.
_FAR, _NEIGHBOURS, _WIDTH, TONES = 30.0, 16, 2, 6
#: Blocks of frequencies whose powers are compared, and probability below which they are not alike.
_BLOCKS, _UNLIKELY = 16, 1e-3
#: Part of the frequencies below half the sampling rate whose mean power is compared with noise, and the factor by which it is more.
_TOP, _LOUDER = 0.1, 4.0


def spectrum_of(signal: np.ndarray) -> np.ndarray:
    """Discrete Fourier transform of real signals (N, ...) less their means, over N."""
    return np.asarray(np.fft.rfft(signal - signal.mean(axis=0), axis=0) / len(signal))


def largest_tone(residuals: np.ndarray, variance: np.ndarray, omega: np.ndarray) -> float | None:
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


def uneven_block(power: np.ndarray) -> tuple[int, float] | None:
    """Index amid the block of power (n, d) over variance that is farthest from the mean, and its factor; None for white residuals."""
    from scipy.stats import chi2

    blocks = np.array_split(power, min(_BLOCKS, len(power)))
    factors = np.array([block.mean() for block in blocks]) / power.mean()
    deviations = np.array([block.size for block in blocks]) * (factors - 1.0) ** 2
    if chi2.sf(deviations.sum(), max(len(blocks) - 1, 1)) > _UNLIKELY:
        return None
    worst = int(np.argmax(deviations))
    return sum(len(block) for block in blocks[:worst]) + len(blocks[worst]) // 2, float(factors[worst])


def aliasing_error(signal: np.ndarray, noise: np.ndarray) -> tuple[np.ndarray, float]:
    """Standard error (N / 2 + 1, d), with its phase, of a force (N, d) by its spectrum beyond half the sampling rate.

    noise : (d,) variance at a frequency, at most
    Returns as well : largest amplitude just below half the rate over that of all frequencies; 0 where noise hides it
    """
    count = len(signal)
    quiet = signal - np.median(signal, axis=0)
    # A window removes what beginning and end of a record add everywhere, and leaves 3 / 8 of the noise; pulses are rare, noise is not.
    window_power = np.abs(spectrum_of(np.hanning(count)[:, None] * quiet)) ** 2
    noise = np.minimum(noise, (1.4826 * np.median(np.abs(quiet), axis=0)) ** 2 / count)
    level = window_power[-int(_TOP * len(window_power)) :].mean(axis=0)
    visible = level > _LOUDER * 0.375 * noise
    share = np.linspace(0.0, 1.0, count // 2 + 1)[:, None]  # frequency over half the rate
    alias = spectrum_of((-1.0) ** np.arange(count)[:, None] * quiet) * ((1.0 - share) / (2.0 - share)) ** 2
    part = float(np.sqrt(np.where(visible, level / window_power.max(axis=0), 0.0).max()))
    return np.where(visible, alias, 0.0) / np.sqrt(2.0), part


#: Part of the force's power below and above the band of frequencies that are used, and how far these reach beyond it.
_OUTSIDE, _WIDER = 5e-4, 0.5
#: Intervals of a record may differ by this part: transforms need even ones.
_EVEN = 1e-3
_TWO = (("y", "force_y"), ("z", "force_z"))
#: Derivatives of the displacement that stand for it, by order.
_ORDERS = {"velocity": 1, "acceleration": 2}
_ONE = (("y", "force"), *_TWO, *((name, "force") for name in _ORDERS))


@attrs.frozen(eq=False)
class Spectra:
    """Spectra of a record: ``omega`` (n,) [rad/s]; force [N] and displacement [m], (n, d) each; ``axes``: the directions.

    A frequency response has a force of 1, and no samples over time.
    ``indices`` (n,) of the frequencies in the full transform;  ``time`` (N,) [s] and ``signal`` (N, d) of the force [N].
    ``order`` of the measured derivative of the displacement.
    """

    omega: np.ndarray
    force: np.ndarray
    displacement: np.ndarray
    axes: tuple[str, ...]
    indices: np.ndarray
    time: np.ndarray
    signal: np.ndarray
    order: int = 0


def spectra_of(signals: Signals) -> Spectra:
    """Spectra in the excited band; force and displacement along one axis, even intervals and a force that changes are needed."""
    columns, source = signals.columns, signals.source
    present = [pair for pair in _ONE if columns.keys() >= {*pair}]
    pairs = _TWO if columns.keys() >= {*_TWO[0], *_TWO[1]} else present[:1]
    if not pairs or columns.keys() >= {"force", "y", "z"}:
        missing = "displacement along its axis" if any(name.startswith("force") for name in columns) else "force"
        raise SceneError.at(
            source, None,
            "force and displacement along the same axis are needed: time_s, force_n, x_um, or force_y_n, force_z_n, y_um, z_um of two axes. "
            f"It was read ({signals}), missing is {missing}; --map \"HEADER=ignore\" leaves a column out, --map \"HEADER=force_n\" names one. The signals of "
            "a rig, without a force, need --scene",
        )  # fmt: skip
    steps = np.diff(columns["time"])
    if np.ptp(steps) > 2.0 * _EVEN * steps.mean():
        text = f"intervals from {steps.min():.6g} to {steps.max():.6g} s: a Fourier transform needs even ones. Record at a fixed rate"
        raise SceneError.at(source, None, text)
    for name in (*(force for _, force in pairs), *(of_axis for of_axis, _ in pairs)):
        if np.ptp(columns[name]) <= 1e-12 * np.abs(columns[name]).max():
            raise SceneError.at(source, None, f"'{name}' is constant. Check its connection")
    displacement, force = (np.column_stack([columns[name] for name in names]) for names in zip(*pairs, strict=True))
    count, interval = len(force), float(steps.mean())
    omega = 2.0 * np.pi * np.fft.rfftfreq(count, interval)
    of_force, of_displacement = spectrum_of(force), spectrum_of(displacement)
    power = np.cumsum((np.abs(of_force) ** 2).sum(axis=1))
    low, high = (omega[int(np.searchsorted(power, part * power[-1]))] for part in (_OUTSIDE, 1.0 - _OUTSIDE))
    band = (omega > 0.0) & (omega >= (1.0 - _WIDER) * low) & (omega <= (1.0 + _WIDER) * high) & (omega < omega[-1])
    order, time = _ORDERS.get(pairs[0][0], 0), interval * np.arange(count)
    axes = ("y",) if order else tuple(name for name, _ in pairs)
    of_axis = of_displacement[band] / (1j * omega[band, None]) ** order
    return Spectra(omega[band], of_force[band], of_axis, axes, np.flatnonzero(band), time, force, order)
