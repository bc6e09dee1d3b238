"""The scheme of equilibria by its tolerance."""

from __future__ import annotations

from typing import TYPE_CHECKING

import attrs

if TYPE_CHECKING:
    from raceway.core.ring.system import System
    from raceway.core.stepping.protocol import SteppedSystem
    from raceway.core.stepping.record import Motion, OnChunk, Record, Schedule
    from raceway.core.stepping.recorder import Recorder


@attrs.frozen
class Static:
    """Equations in ``raceway.core.schemes.static``; ``tolerance``: residual of an equilibrium over the sum of forces."""

    tolerance: float = 1e-11

    def compiled(self, system: System, start: Motion, schedule: Schedule, on_chunk: OnChunk | None = None) -> Record:
        """Equilibria of a compiled ring."""
        import numpy as np

        from raceway.core.schemes.advance import advance
        from raceway.core.schemes.static.compiled import quasi_static

        if system.conservative:
            from raceway.core.ring.equilibrium import settle as solver
        else:
            from raceway.core.ring.root import find_root as solver
        return advance(quasi_static(solver), system, start, schedule, np.array([self.tolerance]), on_chunk)

    def stepped(self, system: SteppedSystem, recorder: Recorder) -> None:
        """Equilibria of any system."""
        from raceway.core.schemes.static.stepped import quasi_static

        quasi_static(system, recorder, self.tolerance)
