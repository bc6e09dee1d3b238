"""Points on a line whose distances grow from a fine zone outward, never above a largest size."""

from __future__ import annotations

from math import ceil, log

import numpy as np


def growing(length: float, first: float, coarse: float, growth: float) -> np.ndarray:
    """(n + 1,) points from 0 to ``length``: distances start at ``first`` or less, grow by ``growth``, end at ``coarse``.

    Notes
    -----
    The row of distances first * growth^i, cut at ``coarse``, is continued until it is long enough and then shrunk by one
    factor to fit, so that no distance exceeds what was asked.
    """
    if length <= 0.0:
        return np.zeros(1)
    first = min(first, coarse)
    rising = ceil(log(coarse / first) / log(growth)) if first < coarse else 0
    steps = first * growth ** np.arange(rising)
    reach = steps.sum()
    if reach < length:
        steps = np.r_[steps, np.full(max(ceil((length - reach) / coarse - 1e-9), 1), coarse)]
    points = np.r_[0.0, np.cumsum(steps)]
    last = int(np.searchsorted(points, length * (1.0 - 1e-9)))
    return points[: last + 1] * (length / points[last])


def graded(
    low: float, high: float, fine_low: float, fine_high: float, fine: float, coarse: float, growth: float
) -> np.ndarray:
    """Points from ``low`` to ``high``: distance ``fine`` between ``fine_low`` and ``fine_high``, growing outside of them.

    The zone's number of cells is even, so that a point lies in its middle.
    """
    fine = min(fine, coarse)
    fine_low, fine_high = max(fine_low, low), min(fine_high, high)
    cells = 2 * max(ceil((fine_high - fine_low) / (2.0 * fine) - 1e-9), 1)
    zone = np.linspace(fine_low, fine_high, cells + 1)
    size = min(growth * (fine_high - fine_low) / cells, coarse)
    below = fine_low - growing(fine_low - low, size, coarse, growth)[:0:-1]
    above = fine_high + growing(high - fine_high, size, coarse, growth)[1:]
    return np.concatenate([below, zone, above])
