"""The generalised-alpha method."""

from __future__ import annotations

from typing import ClassVar

import attrs

from raceway.core.time.schemes import OneStep
from raceway.framework.options import between, inside, option


@attrs.frozen
class GeneralizedAlpha:
    """Second order with dissipation of the highest frequencies, set by the spectral radius at infinity."""

    name: ClassVar[str] = "generalized_alpha"
    order: ClassVar[int] = 2
    implicit: ClassVar[bool] = True
    inertial: ClassVar[bool] = True
    steady: ClassVar[bool] = False
    dissipative: ClassVar[bool] = True

    rho_infinity: float = option(
        0.9, help="spectral radius at infinite frequency: 1 none, 0 all dissipated", rule=between(0.0, 1.0)
    )
    tolerance: float = option(1e-9, help="residual of a step's iteration over the largest force", rule=inside(0.0, 1e-3))

    @classmethod
    def examples(cls) -> list[GeneralizedAlpha]:
        """Instances for the conformance suite."""
        return [cls(), cls(rho_infinity=0.5)]

    @property
    def scheme(self) -> OneStep:
        """Chung and Hulbert's numbers: second order, and as little dissipation of low frequencies as can be."""
        rho = self.rho_infinity
        am, af = (2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0)
        return OneStep(am, af, 0.25 * (1.0 - am + af) ** 2, 0.5 - am + af, self.tolerance)
