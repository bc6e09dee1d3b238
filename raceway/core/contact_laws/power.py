"""force = params[:, 0] * max(-gap, 0) ** exponent, for the three exponents that the built-in laws need."""

import numpy as np

from raceway.core.jit import jit
from raceway.core.signatures import LAW


@jit(LAW)
def three_halves(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    """Hertz: Q = K delta^1.5."""
    for i in range(gap.size):
        approach = max(-gap[i], 0.0)
        slope = params[i, 0] * np.sqrt(approach)
        force[i] = slope * approach
        d_gap[i] = -1.5 * slope
        d_rate[i] = 0.0


@jit(LAW)
def square(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    """A nodal penalty integrated over the overlap of a paraboloid: Q = c delta^2."""
    for i in range(gap.size):
        approach = max(-gap[i], 0.0)
        slope = params[i, 0] * approach
        force[i] = slope * approach
        d_gap[i] = -2.0 * slope
        d_rate[i] = 0.0


@jit(LAW)
def linear(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    """A nodal penalty: p = k_n delta."""
    for i in range(gap.size):
        closed = gap[i] < 0.0
        slope = params[i, 0] if closed else 0.0
        force[i] = -slope * gap[i]
        d_gap[i] = -slope
        d_rate[i] = 0.0
