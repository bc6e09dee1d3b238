"""The explicit scheme, which has no numbers of its own."""

from __future__ import annotations

from typing import TYPE_CHECKING

import attrs

if TYPE_CHECKING:
    from raceway.core.ring.system import System
    from raceway.core.stepping.protocol import SteppedSystem
    from raceway.core.stepping.record import Motion, OnChunk, Record, Schedule
    from raceway.core.stepping.recorder import Recorder


@attrs.frozen
class Explicit:
    """Equations in ``raceway.core.schemes.explicit``."""

    def compiled(self, system: System, start: Motion, schedule: Schedule, on_chunk: OnChunk | None = None) -> Record:
        """Steps of a compiled ring."""
        import numpy as np

        from raceway.core.schemes.advance import advance
        from raceway.core.schemes.explicit.compiled import central_difference

        return advance(central_difference, system, start, schedule, np.zeros(1), on_chunk)

    def stepped(self, system: SteppedSystem, recorder: Recorder) -> None:
        """Steps of any system, without matrices."""
        from raceway.core.schemes.explicit.stepped import central_difference

        central_difference(system, recorder)
