"""Hertz' law at pairs and at points by one kernel, told apart by the columns of ``params``.

One column: the factor of a pair's force.  A second column: the stiffness k [N/m3] of the pressure p = k delta at a point,
beside a factor that ``build`` then sets to zero.
"""

import numpy as np

from raceway.core.jit import jit
from raceway.core.signatures import LAW


@jit(LAW)
def three_halves(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    """Hertz: Q = K delta^1.5 of a pair, or p = k delta at a point."""
    if params.shape[1] == 1:
        # Rows of one number lie side by side: this loop is vectorised, the one below is not.
        for i in range(gap.size):
            approach = max(-gap[i], 0.0)
            slope = params[i, 0] * np.sqrt(approach)
            force[i] = slope * approach
            d_gap[i] = -1.5 * slope
            d_rate[i] = 0.0
        return
    for i in range(gap.size):
        approach = max(-gap[i], 0.0)
        linear = params[i, 1] if gap[i] < 0.0 else 0.0
        slope = params[i, 0] * np.sqrt(approach)
        force[i] = (slope + linear) * approach
        d_gap[i] = -1.5 * slope - linear
        d_rate[i] = 0.0


@jit(LAW)
def square(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    """Penalty: p = k delta at a point, or, integrated over the overlap of a paraboloid, Q = c delta^2 of a pair."""
    if params.shape[1] == 1:
        for i in range(gap.size):
            approach = max(-gap[i], 0.0)
            slope = params[i, 0] * approach
            force[i] = slope * approach
            d_gap[i] = -2.0 * slope
            d_rate[i] = 0.0
        return
    for i in range(gap.size):
        approach = max(-gap[i], 0.0)
        linear = params[i, 1] if gap[i] < 0.0 else 0.0
        slope = params[i, 0] * approach
        force[i] = (slope + linear) * approach
        d_gap[i] = -2.0 * slope - linear
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


@jit(LAW)
def ten_ninths(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    """Line contacts: Q = k delta^(10/9)."""
    for i in range(gap.size):
        approach = max(-gap[i], 0.0)
        slope = params[i, 0] * approach ** (1.0 / 9.0)
        force[i], d_gap[i], d_rate[i] = slope * approach, -10.0 / 9.0 * slope, 0.0
