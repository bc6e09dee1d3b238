"""Spectral lines of a recorded motion at given frequencies, which need not fit the window."""

from __future__ import annotations

import attrs
import numpy as np


@attrs.frozen
class Line:
    """One line of the motion.

    Attributes
    ----------
    name : "1x", "2x", "ball pass" ...;  frequency_hz : float
    forward, backward, axial : amplitudes [m]: turning with and against the spin, and along the axis
    """

    name: str
    frequency_hz: float
    forward: float
    backward: float
    axial: float


def phasors(time: np.ndarray, signal: np.ndarray, frequencies: list[float]) -> np.ndarray:
    """Complex phasors (len(frequencies), k) of a signal (n, k) by least squares, with mean and drift.

    Notes
    -----
    Frequencies closer than half a line of the window to another one or to zero cannot be told apart and must not be given.
    """
    wt = 2.0 * np.pi * time[:, None] * np.asarray(frequencies)
    span = time - time.mean()
    basis = np.hstack([np.ones((len(time), 1)), (span / np.abs(span).max())[:, None], np.cos(wt), np.sin(wt)])
    solution, *_ = np.linalg.lstsq(basis, signal, rcond=None)
    count = len(frequencies)
    return solution[2 : 2 + count] - 1j * solution[2 + count :]


def lines(time: np.ndarray, displacement: np.ndarray, wanted: dict[str, float]) -> list[Line]:
    """Lines of a displacement (n, >= 3) x, y, z at named frequencies [Hz].

    Notes
    -----
    Of frequencies that the window (time span T) cannot tell apart, |f1 - f2| < 0.5 / T, the first one is kept; those
    above half the sampling rate are left out.
    """
    most = 0.5 * (len(time) - 1) / (time[-1] - time[0])
    least = 0.5 / (time[-1] - time[0])
    kept: dict[str, float] = {}
    for name, frequency in wanted.items():
        if frequency < most and all(abs(frequency - other) >= least for other in (0.0, *kept.values())):
            kept[name] = frequency
    found = phasors(time, displacement[:, :3], list(kept.values()))
    return [
        Line(name, frequency, 0.5 * abs(y + 1j * z), 0.5 * abs(y - 1j * z), abs(x))
        for (name, frequency), (x, y, z) in zip(kept.items(), found, strict=True)
    ]
