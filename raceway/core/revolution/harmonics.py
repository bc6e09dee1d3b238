"""Harmonics of a body of revolution that are solved, and the weights with which their compliances add up at an offset.

A unit force at azimuth 0 is the sum of all harmonics with weight 1/N, N the number of sectors.  The compliance C(n) is a
smooth function of n, so it is solved at few n; (1 + n) C as a function of log(1 + n/8) is interpolated by a spline of degree
5.  The spline is linear in its data, so that sum over n of C(n) cos(2 pi n k / N) is a sum over the solved harmonics alone.
Harmonics 0 and 1, which differ from the others where a body can move rigidly, take no part in the spline.
"""

from __future__ import annotations

import numpy as np

#: All harmonics up to DENSE are solved.  Beyond, each is at most RATIO times the one before, and at most N / 2 / STEPS above
#: it: towards N / 2, where elements are half a wave long, C(n) varies with n / N and not with log n.
DENSE, RATIO, STEPS = 12, 1.2, 24


def solved_harmonics(divisions: int, harmonics: str) -> np.ndarray:
    """(s,) harmonics from 0 to N // 2 that are solved: "sampled", or "all"."""
    last = divisions // 2
    if harmonics == "all":
        return np.arange(last + 1)
    if harmonics != "sampled":
        raise ValueError(f"harmonics {harmonics!r} is neither 'sampled' nor 'all'")
    chosen = list(range(min(DENSE, last) + 1))
    while chosen[-1] < last:
        step = int(min((RATIO - 1.0) * chosen[-1], last / STEPS))
        chosen.append(min(last, chosen[-1] + max(step, 1)))
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
    spread = np.zeros((len(n), len(solved)))
    spread[n[: DENSE + 1], n[: DENSE + 1]] = 1.0
    spread[DENSE + 1 :, 2:] = _spline(solved[2:], n[DENSE + 1 :])
    return even @ spread, odd @ spread


def _spline(solved: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """(wanted, solved) Values of the interpolating spline for unit data."""
    from scipy.interpolate import make_interp_spline

    unit = make_interp_spline(np.log1p(solved / 8.0), np.eye(len(solved)), k=5)(np.log1p(wanted / 8.0))
    return np.asarray(unit * (1.0 + solved)[None, :] / (1.0 + wanted)[:, None])
