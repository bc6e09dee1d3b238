"""A row of balls on springs Q = K delta^1.5 under an axial load alone."""

from __future__ import annotations

from math import sqrt
from typing import Any

from raceway.core.columns import Number, is_column
from raceway.core.deferred import deferred

#: Steps at most; a dozen do.
_ITERATIONS = 120


def axial_balance(*numbers: Number) -> tuple[Number, Number]:
    """(x [m], load of a ball [N]), columns (n,) of columns.

    Parameters
    ----------
    numbers : K [N/m^1.5], distance of the groove centres [m], sine and cosine of the free contact angle, balls, axial load [N]
    """
    if not any(map(is_column, numbers)):
        rows: Any = [list(numbers)]
        _balance.__wrapped__(rows)
        return rows[0][0], rows[0][1]
    import numpy as np

    rows = np.empty((max(map(np.size, numbers)), len(numbers)))
    for k, number in enumerate(numbers):
        rows[:, k] = number
    _balance()(rows)
    return rows[:, 0], rows[:, 1]


@deferred("ROWS")
def _balance(rows: Any) -> None:
    for row in rows:
        factor, distance, count, target = row[0], row[1], row[4], row[5]
        along, across, load = distance * row[2], distance * row[3], 0.0
        # From above, where the force grows faster than the displacement, Newton's iteration falls until rounding ends it.
        x = distance + (2.0 * target / (count * factor)) ** (2.0 / 3.0)
        for _ in range(_ITERATIONS):
            a = along + x
            s = sqrt(a * a + across * across)
            press = max(s - distance, 0.0)
            load = factor * press**1.5
            slope = count * (1.5 * factor * sqrt(press) * (a / s) ** 2 + load * across**2 / s**3)
            step = (count * load * a / s - target) / max(slope, 1e-300) if slope > 0.0 else 0.0
            if not 1e-15 * x < step <= x:
                break
            x -= step
        row[0], row[1] = x, load
