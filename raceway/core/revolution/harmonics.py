"""Which harmonics are solved, and with which weights their compliances add up to the compliance at an offset.

A unit force at azimuth 0 is the sum of all harmonics with weight 1/N, N the number of sectors.  The compliance C(n) is a
smooth function of n, so it is solved at few n; (1 + n) C as a function of log(1 + n/8) is interpolated by a cubic spline.
The spline is linear in its data, so that sum over n of C(n) cos(2 pi n k / N) is a sum over the solved harmonics alone.
"""

from __future__ import annotations

import numpy as np

#: All harmonics up to the first number are solved, beyond it each is at most this ratio above the one before.
DENSE, RATIO = 24, 1.12


def solved_harmonics(divisions: int, harmonics: str) -> np.ndarray:
    """(s,) harmonics from 0 to N // 2 that are solved: "sampled", or "all"."""
    last = divisions // 2
    if harmonics == "all":
        return np.arange(last + 1)
    if harmonics != "sampled":
        raise ValueError(f"harmonics {harmonics!r} is neither 'sampled' nor 'all'")
    chosen = list(range(min(DENSE, last) + 1))
    while chosen[-1] < last:
        chosen.append(min(last, max(chosen[-1] + 1, int(chosen[-1] * RATIO))))
    return np.array(chosen)


def offset_weights(divisions: int, solved: np.ndarray, offsets: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Weights of the solved harmonics at offsets in whole sectors.

    Returns
    -------
    even, odd : (offsets, s)
        Of the cosine and of the sine part.
    """
    n = np.arange(divisions // 2 + 1)
    share = np.full(len(n), 2.0 / divisions)
    share[0] = 1.0 / divisions
    if divisions % 2 == 0:
        share[-1] = 1.0 / divisions
    # n k reduced by whole turns in integers, so that large products lose no digits.
    phase = 2.0 * np.pi / divisions * (np.outer(offsets, n) % divisions)
    even, odd = share * np.cos(phase), share * np.sin(phase)
    if len(solved) == len(n):
        return even, odd
    from scipy.interpolate import CubicSpline

    spline = CubicSpline(np.log1p(solved / 8.0), np.eye(len(solved)))(np.log1p(n / 8.0))
    spline *= (1.0 + solved)[None, :] / (1.0 + n)[:, None]
    return even @ spline, odd @ spline
