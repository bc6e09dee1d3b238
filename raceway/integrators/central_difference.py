"""Central differences."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import attrs

if TYPE_CHECKING:
    from raceway.core.ring.advance import OnChunk
    from raceway.core.ring.system import System
    from raceway.core.stepping.record import Motion, Record, Schedule


@attrs.frozen
class CentralDifference:
    """Explicit, second order, symplectic; the step must stay below 2 / (largest natural frequency)."""

    name: ClassVar[str] = "central_difference"
    order: ClassVar[int] = 2
    implicit: ClassVar[bool] = False
    inertial: ClassVar[bool] = True
    dissipative: ClassVar[bool] = False

    def advance(self, system: System, start: Motion, schedule: Schedule, on_chunk: OnChunk | None = None) -> Record:
        import numpy as np

        from raceway.core.ring.advance import advance
        from raceway.core.ring.loops.central_difference import central_difference

        return advance(central_difference, system, start, schedule, np.zeros(1), on_chunk)
