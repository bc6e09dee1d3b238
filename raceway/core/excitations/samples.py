"""A force given by samples at equal intervals of time, interpolated smoothly."""

import numpy as np

from raceway.core.jit import jit
from raceway.core.signatures import FORCE

#: params: interval [s], 1 if the samples repeat, then rows of F_x, F_y, F_z, M_y, M_z one after the other.
INTERVAL, PERIODIC, FIRST = range(3)


@jit(FORCE)
def samples(t, params, out):
    """out (5,): Catmull-Rom cubic through the samples; once continuously differentiable, third order between them.

    Notes
    -----
    Before the first and after the last sample of a record that does not repeat, the end values hold.
    """
    n = (params.size - 2) // 5
    position = t / params[0]
    k = int(np.floor(position))
    u = position - k
    repeat = params[1] != 0.0
    if not repeat:
        if position <= 0.0:
            k, u = 0, 0.0
        elif k >= n - 1:
            k, u = n - 2, 1.0
    w0 = 0.5 * u * (-1.0 + u * (2.0 - u))
    w1 = 1.0 + 0.5 * u * u * (-5.0 + 3.0 * u)
    w2 = 0.5 * u * (1.0 + u * (4.0 - 3.0 * u))
    w3 = 0.5 * u * u * (u - 1.0)
    for i in range(out.size):
        total = 0.0
        for j in range(4):
            row = k - 1 + j
            row = row % n if repeat else min(max(row, 0), n - 1)
            weight = w0 if j == 0 else (w1 if j == 1 else (w2 if j == 2 else w3))
            total += weight * params[2 + 5 * row + i]
        out[i] = total
