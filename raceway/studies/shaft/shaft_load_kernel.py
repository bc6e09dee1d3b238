"""A force and a moment that turn together, each with an amplitude and a lag of its own."""

import numpy as np

from raceway.core.jit import jit
from raceway.core.signatures import FORCE


@jit(FORCE)
def shaft_load(t, params, out):
    """out (5,) from params: speed [rad/s], real and imaginary part of F_y + j F_z [N] and of M_z - j M_y [N m] at t = 0."""
    c, s = np.cos(params[0] * t), np.sin(params[0] * t)
    out[0] = 0.0
    out[1] = params[1] * c - params[2] * s
    out[2] = params[1] * s + params[2] * c
    out[3] = -(params[3] * s + params[4] * c)
    out[4] = params[3] * c - params[4] * s
