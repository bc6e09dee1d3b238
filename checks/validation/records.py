"""Records of a turning shaft, made up from known lines."""

from math import pi

import numpy as np
from raceway_measure.fit.signals import Recording

#: Speed of the test rig [rad/s]; a forward line [m] and the revolutions a second of `made`.
SPEED = 13000.0 * pi / 30.0
LINE = 3e-6 * np.exp(0.7j)
HZ = 183.3


def made(rate=10e3, duration=0.5, drift=0.0, uneven=0.0, noise=0.0, marked=True, line=LINE, sharp=1.0):
    """A record with a forward line, a backward one, 2x, 3x and a wandering mean; the speed drifts by ``drift``."""
    random = np.random.default_rng(5)
    time = np.arange(int(rate * duration)) / rate
    time = time + uneven / rate * random.uniform(-0.5, 0.5, len(time))
    part = time / duration
    angle = 2.0 * np.pi * HZ * (time + 0.5 * drift * duration * (part**2 - part)) + 1.0
    speed = 2.0 * np.pi * HZ * (1.0 + drift * (part - 0.5))
    turn = np.exp(1j * angle)
    plane = line * turn + 0.1e-6 / turn + 0.2e-6 * turn**2 + 0.1e-6j * turn**3 + 4e-6 * part**2
    plane = plane + noise * (random.standard_normal(len(time)) + 1j * random.standard_normal(len(time)))
    key = 0.5 + 0.5 * np.tanh(6.0 * sharp * np.sin(angle))
    return Recording(time, plane.real, plane.imag, key if marked else None, speed)
