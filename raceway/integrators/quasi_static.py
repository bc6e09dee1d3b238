"""The orbit as a series of equilibria."""

from __future__ import annotations

from typing import ClassVar

import attrs

from raceway.core.time.schemes import Static
from raceway.framework.options import inside, option


@attrs.frozen
class QuasiStatic:
    """No inertia and no rates: what the bearing would do if it turned infinitely slowly under the same forces."""

    name: ClassVar[str] = "quasi_static"
    order: ClassVar[int] = 2
    implicit: ClassVar[bool] = True
    inertial: ClassVar[bool] = False
    steady: ClassVar[bool] = False
    dissipative: ClassVar[bool] = False

    tolerance: float = option(1e-11, help="residual of an equilibrium over the sum of forces", rule=inside(0.0, 1e-3))

    @property
    def scheme(self) -> Static:
        """Equilibria."""
        return Static(self.tolerance)
