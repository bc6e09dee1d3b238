"""The compiled force."""

import numpy as np

from raceway import FORCE, jit


@jit(FORCE)
def two_frequency(t, params, out):
    """params: force [N], speed [rad/s], lag [rad] and sense of the first force, then of the second."""
    for i in range(out.size):
        out[i] = 0.0
    for k in range(0, 8, 4):
        phase = params[k + 1] * t - params[k + 2]
        out[1] += params[k] * np.cos(phase)
        out[2] += params[k + 3] * params[k] * np.sin(phase)
