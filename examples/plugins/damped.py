from typing import ClassVar

import attrs

from raceway import between, hookimpl, option
from raceway.extend import OneStep


@attrs.frozen
class Damped:
    """Newmark's method with gamma > 1/2: high frequencies die out, at the price of an order."""

    name: ClassVar[str] = "damped"
    order: ClassVar[int] = 1
    implicit: ClassVar[bool] = True
    inertial: ClassVar[bool] = True
    steady: ClassVar[bool] = False
    dissipative: ClassVar[bool] = True
    excess: float = option(0.01, help="gamma - 1/2", rule=between(0.001, 0.5))

    @property
    def scheme(self):
        gamma = 0.5 + self.excess
        return OneStep(beta=0.25 * (gamma + 0.5) ** 2, gamma=gamma)


@hookimpl
def raceway_integrators():
    return [Damped]
