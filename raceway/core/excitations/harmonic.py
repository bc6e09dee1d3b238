"""A force that turns, or swings along one direction, in the radial plane; a load of one frequency in all coordinates of the ring."""

import numpy as np

from raceway.core.jit import jit
from raceway.core.signatures import FORCE

#: params: amplitude [N], speed [rad/s], lag [rad], then the cos and sin parts of F_y and of F_z.
AMPLITUDE, SPEED, LAG, Y_COS, Y_SIN, Z_COS, Z_SIN = range(7)


@jit(FORCE)
def harmonic(t, params, out):
    """out (5,): F_y = F (Y_COS cos + Y_SIN sin)(W t - lag), F_z likewise; F_x, M_y, M_z zero."""
    phase = params[1] * t - params[2]
    c, s = params[0] * np.cos(phase), params[0] * np.sin(phase)
    out[0] = 0.0
    out[1] = params[3] * c + params[4] * s
    out[2] = params[5] * c + params[6] * s
    out[3] = 0.0
    out[4] = 0.0


@jit(FORCE)
def harmonic_load(t, params, out):
    """out (5,) from params (11,): speed [rad/s], then real and imaginary part of F_x, F_y, F_z [N], M_y, M_z [N m] e^{jwt}."""
    c, s = np.cos(params[0] * t), np.sin(params[0] * t)
    for i in range(out.size):
        out[i] = params[1 + 2 * i] * c - params[2 + 2 * i] * s


@jit(FORCE)
def no_force(t, params, out):
    """Nothing acts."""
    for i in range(out.size):
        out[i] = 0.0
