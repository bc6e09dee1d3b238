"""The generalised-alpha method."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import attrs

from raceway.framework.options import between, inside, option

if TYPE_CHECKING:
    from raceway.core.ring.advance import OnChunk
    from raceway.core.ring.system import System
    from raceway.core.stepping.record import Motion, Record, Schedule


@attrs.frozen
class GeneralizedAlpha:
    """Second order with dissipation of the highest frequencies, set by the spectral radius at infinity."""

    name: ClassVar[str] = "generalized_alpha"
    order: ClassVar[int] = 2
    implicit: ClassVar[bool] = True
    inertial: ClassVar[bool] = True
    dissipative: ClassVar[bool] = True

    rho_infinity: float = option(
        0.9, help="spectral radius at infinite frequency: 1 none, 0 all dissipated", rule=between(0.0, 1.0)
    )
    tolerance: float = option(1e-9, help="residual of a step's iteration over the largest force", rule=inside(0.0, 1e-3))

    @classmethod
    def examples(cls) -> list[GeneralizedAlpha]:
        """Instances for the conformance suite."""
        return [cls(), cls(rho_infinity=0.5)]

    def advance(self, system: System, start: Motion, schedule: Schedule, on_chunk: OnChunk | None = None) -> Record:
        import numpy as np

        from raceway.core.ring.advance import advance
        from raceway.core.ring.loops.implicit import implicit

        rho = self.rho_infinity
        am, af = (2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0)
        gamma, beta = 0.5 - am + af, 0.25 * (1.0 - am + af) ** 2
        coefficients = np.array([am, af, beta, gamma, self.tolerance])
        return advance(implicit, system, start, schedule, coefficients, on_chunk)
