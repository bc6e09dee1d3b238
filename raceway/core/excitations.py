"""Compiled forces of the built-in excitations; the classes with the options are in ``raceway.plugins.excitations.harmonic``."""

import numpy as np

from raceway.core.jit import jit
from raceway.core.signatures import FORCE


@jit(FORCE)
def harmonic(t, params, out):
    """A force that rotates, or oscillates along one direction: out (5,), F_y = F (p3 cos + p4 sin)(W t - lag), F_z likewise with p5, p6.

    params: amplitude F [N], speed W [rad/s], lag [rad], then the cos and sin parts p3 to p6 of F_y and of F_z.
    """
    phase = params[1] * t - params[2]
    c, s = params[0] * np.cos(phase), params[0] * np.sin(phase)
    out[0] = 0.0
    out[1] = params[3] * c + params[4] * s
    out[2] = params[5] * c + params[6] * s
    out[3] = 0.0
    out[4] = 0.0


@jit(FORCE)
def harmonic_load(t, params, out):
    """A load of one frequency: out (5,) from params (11,), speed [rad/s], then real and imaginary part of F_x, F_y, F_z [N], M_y, M_z [N m] e^{jwt}."""
    c, s = np.cos(params[0] * t), np.sin(params[0] * t)
    for i in range(out.size):
        out[i] = params[1 + 2 * i] * c - params[2 + 2 * i] * s


@jit(FORCE)
def no_force(t, params, out):
    """Nothing acts."""
    for i in range(out.size):
        out[i] = 0.0


@jit(FORCE)
def run_up(t, params, out):
    """Unbalance while the speed changes linearly: out (5,), m e (w^2 n + w' n_perpendicular), w the momentary speed.

    params: unbalance on this bearing m e [kg m], first and last speed [rad/s], duration [s], lag [rad], sense.

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


@jit(FORCE)
def samples(t, params, out):
    """Samples at equal intervals: out (5,), a Catmull-Rom cubic, once continuously differentiable, third order between them.

    params: interval [s], 1 if the samples repeat, then rows of F_x, F_y, F_z, M_y, M_z one after the other.

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
