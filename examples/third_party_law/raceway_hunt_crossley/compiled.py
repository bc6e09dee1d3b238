"""The compiled law."""

import numpy as np

from raceway import LAW, jit


@jit(LAW)
def hunt_crossley(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    """params (n, 5): K, c, c v0 of the restitution, slowest speed, transition; state (n, 0 or 1): v0, 0 when open.

    Notes
    -----
    On the step of first touch v0 is the speed of that step, so c v0 / v0 * v = c v0 above the slowest speed: the force
    does not depend on the rate there, and its derivative is zero.
    """
    remembers = state_old.shape[1] == 1
    for i in range(gap.size):
        approach = max(-gap[i], 0.0)
        speed = -gap_rate[i]
        c = params[i, 1]
        first = 0.0
        slope = c
        if remembers:
            slowest = params[i, 3]
            if state_old[i, 0] > 0.0:
                first = state_old[i, 0]
                c = params[i, 2] / first
                slope = c
            else:
                first = max(speed, slowest)
                c = params[i, 2] / first
                slope = c if speed < slowest else 0.0
            state_new[i, 0] = first if approach > 0.0 else 0.0
        factor = 1.0 + c * speed
        if factor <= 0.0:
            factor, slope = 0.0, 0.0
        x, blend, d_blend = 1.0, 1.0, 0.0
        if approach < params[i, 4]:
            x = approach / params[i, 4]
            blend = x * x * (3.0 - 2.0 * x)
            d_blend = 6.0 * x * (1.0 - x) / params[i, 4]
        root = params[i, 0] * np.sqrt(approach)
        elastic = root * approach * blend
        force[i] = elastic * factor
        d_gap[i] = -(1.5 * root * blend + root * approach * d_blend) * factor
        d_rate[i] = -elastic * slope
