from typing import ClassVar

import attrs
import numpy as np

from raceway import LAW, hookimpl, jit, option, positive


@jit(LAW)
def layer(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    for i in range(gap.size):
        closed = gap[i] < 0.0
        force[i] = -params[i, 0] * gap[i] if closed else 0.0
        d_gap[i], d_rate[i] = -params[i, 0] if closed else 0.0, 0.0


@attrs.frozen
class SoftLayer:
    """p = (E / h) max(-g, 0): a thin elastic layer between the bodies."""

    name: ClassVar[str] = "soft_layer"
    discretisations: ClassVar[frozenset[str]] = frozenset({"nodal"})
    state_size: ClassVar[int] = 0
    dissipative: ClassVar[bool] = False
    bedding: float = option(2e15, unit="N/m3", help="pressure per compression E / h", rule=positive())

    def build(self, pairs):
        return np.full((pairs.hertz_factor.size, 1), self.bedding)

    def kernel(self):
        return layer


@hookimpl
def raceway_contact_laws():
    return [SoftLayer]
