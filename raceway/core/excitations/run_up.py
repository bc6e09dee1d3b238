"""The force of an unbalance while the speed changes linearly from one value to another."""

import numpy as np

from raceway.core.jit import jit
from raceway.core.signatures import FORCE

#: params: unbalance on this bearing [kg m], first and last speed [rad/s], duration [s], lag [rad], sense.
UNBALANCE, FIRST, LAST, DURATION, LAG, SENSE = range(6)


@jit(FORCE)
def run_up(t, params, out):
    """out (5,): m e (w^2 n + w' n_perpendicular) with w the momentary speed; the tangential part belongs to w'.

    Notes
    -----
    The centre of mass at e (cos phi, sin phi) accelerates by -e w^2 along the radius and by e w' across it; the force on
    the ring is the reaction.  Beyond the duration the speed stays.
    """
    duration = params[3]
    rate = (params[2] - params[1]) / duration
    if t < duration:
        w = params[1] + rate * t
        phase = params[1] * t + 0.5 * rate * t * t
    else:
        w = params[2]
        phase = 0.5 * (params[1] + params[2]) * duration + w * (t - duration)
        rate = 0.0
    phase -= params[4]
    c, s = np.cos(phase), np.sin(phase)
    radial, across = params[0] * w * w, params[0] * rate
    out[0] = 0.0
    out[1] = radial * c + across * s
    out[2] = params[5] * (radial * s - across * c)
    out[3] = 0.0
    out[4] = 0.0
