from math import pi
from typing import ClassVar

import attrs
import numpy as np

from raceway import FORCE, hookimpl, jit, option, positive


@jit(FORCE)
def pulse(t, params, out):
    for i in range(out.size):
        out[i] = 0.0
    out[1] = params[0] * np.cos(params[1] * t) ** 3


@attrs.frozen(kw_only=True)
class Pulse:
    """F cos^3(W t) along y: a line at W with 3/4 of the peak and one at 3 W with 1/4."""

    name: ClassVar[str] = "pulse"
    sense: ClassVar[int] = 0
    speed_rpm: float = option(unit="r/min", help="repetition", rule=positive())
    peak: float = option(unit="N", help="largest force", rule=positive())

    @classmethod
    def examples(cls):
        return [cls(speed_rpm=12000.0, peak=200.0)]

    @property
    def frequency_hz(self):
        return self.speed_rpm / 60.0

    @property
    def period_s(self):
        return 60.0 / self.speed_rpm

    @property
    def amplitude_n(self):
        return 0.75 * self.peak

    def parameters(self):
        return np.array([self.peak, self.speed_rpm * pi / 30.0])

    def kernel(self):
        return pulse


@hookimpl
def raceway_excitations():
    return [Pulse]
