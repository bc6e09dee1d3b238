"""A conforming law that is unlike Hertz': the force is 2e17 N/m3 times the cube of the approach."""

from typing import ClassVar

import attrs
import numpy as np

from raceway import LAW, hookimpl, jit, option, positive


@jit(LAW)
def cubic(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    for i in range(gap.size):
        deep = max(-gap[i], 0.0)
        force[i] = params[i, 0] * deep**3
        d_gap[i] = -3.0 * params[i, 0] * deep**2
        d_rate[i] = 0.0


@attrs.frozen
class Cubic:
    name: ClassVar[str] = "cubic"
    discretisations: ClassVar[frozenset[str]] = frozenset({"resultant"})
    state_size: ClassVar[int] = 0
    dissipative: ClassVar[bool] = False

    factor: float = option(2e17, unit="N/m3", help="force over the cube of the approach", rule=positive())

    def build(self, pairs):
        return np.full((len(pairs.curvature_a), 1), self.factor)

    def kernel(self):
        return cubic


@hookimpl
def raceway_contact_laws():
    return [Cubic]
