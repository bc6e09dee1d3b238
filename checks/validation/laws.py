"""Contact laws as third parties write them, for comparisons of the compiled loops with runs."""

from typing import ClassVar

import attrs
import numpy as np

from checks.validation.scenes import built_in
from raceway import LAW, hookimpl, jit, option, positive
from raceway.extend import ContactPairs

Hertz = built_in("contact_law", "hertz")


@jit(LAW)
def stiffening(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    for i in range(gap.size):
        deep = max(-gap[i], 0.0)
        root = np.sqrt(deep)
        force[i] = params[i, 0] * deep * root + params[i, 1] * deep**3
        d_gap[i] = -1.5 * params[i, 0] * root - 3.0 * params[i, 1] * deep**2
        d_rate[i] = 0.0


@attrs.frozen
class Stiffening:
    """Hertz and a cubic force beside it."""

    name: ClassVar[str] = "stiffening"
    discretisations: ClassVar[frozenset[str]] = frozenset({"resultant"})
    state_size: ClassVar[int] = 0
    dissipative: ClassVar[bool] = False

    cubic: float = option(1e17, unit="N/m3", help="force over the cube of the approach", rule=positive())

    def build(self, pairs: ContactPairs) -> np.ndarray:
        return np.column_stack([pairs.hertz_factor, np.full(len(pairs.hertz_factor), self.cubic)])

    def kernel(self):
        return stiffening


@attrs.frozen
class OilLayer(Hertz):
    """Hertz behind a layer that grows with the entraining speed and thins with the load."""

    name: ClassVar[str] = "oil_layer"
    discretisations: ClassVar[frozenset[str]] = frozenset({"resultant"})
    renewed: ClassVar[bool] = True

    thickness: float = option(2e-7, unit="m", help="at 1 m/s and 100 N", rule=positive())

    def reach(self, pairs: ContactPairs) -> np.ndarray:
        assert pairs.entraining_speed is not None and pairs.load is not None, "bodies that renew laws give them"
        return self.thickness * np.cbrt(pairs.entraining_speed) ** 2 * (pairs.load / 100.0) ** -0.1


@hookimpl
def raceway_contact_laws():
    return [Stiffening, OilLayer]
