"""A force and a moment of one frequency in all coordinates of the ring."""

import numpy as np

from raceway.core.jit import jit
from raceway.core.signatures import FORCE


@jit(FORCE)
def harmonic_load(t, params, out):
    """out (5,) from params (11,): speed [rad/s], then real and imaginary part of F_x, F_y, F_z [N], M_y, M_z [N m] e^{jwt}."""
    c, s = np.cos(params[0] * t), np.sin(params[0] * t)
    for i in range(out.size):
        out[i] = params[1 + 2 * i] * c - params[2 + 2 * i] * s
