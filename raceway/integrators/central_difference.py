"""Central differences."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import attrs

if TYPE_CHECKING:
    from raceway.core.advance import OnChunk
    from raceway.core.record import Motion, Record, Schedule
    from raceway.core.system import System


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

        from raceway.core.advance import advance
        from raceway.core.integrators.central_difference import central_difference

        return advance(central_difference, system, start, schedule, np.zeros(1), on_chunk)
