"""The orbit as a series of equilibria."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import attrs

from raceway.framework.options import inside, option

if TYPE_CHECKING:
    from raceway.core.ring.advance import OnChunk
    from raceway.core.ring.system import System
    from raceway.core.stepping.record import Motion, Record, Schedule


@attrs.frozen
class QuasiStatic:
    """No inertia and no rates: what the bearing would do if it turned infinitely slowly under the same forces."""

    name: ClassVar[str] = "quasi_static"
    order: ClassVar[int] = 2
    implicit: ClassVar[bool] = True
    inertial: ClassVar[bool] = False
    dissipative: ClassVar[bool] = False

    tolerance: float = option(1e-11, help="residual of an equilibrium over the sum of forces", rule=inside(0.0, 1e-3))

    def advance(self, system: System, start: Motion, schedule: Schedule, on_chunk: OnChunk | None = None) -> Record:
        import numpy as np

        from raceway.core.ring.advance import advance

        if system.conservative:
            from raceway.core.ring.loops.quasi_static import quasi_static as loop
        else:
            from raceway.core.ring.loops.quasi_static_tangential import quasi_static_tangential as loop
        return advance(loop, system, start, schedule, np.array([self.tolerance]), on_chunk)
