"""The implicit one-step scheme by its numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import attrs

if TYPE_CHECKING:
    from raceway.core.ring.system import System
    from raceway.core.stepping.protocol import SteppedSystem
    from raceway.core.stepping.record import Motion, OnChunk, Record, Schedule
    from raceway.core.stepping.recorder import Recorder


@attrs.frozen
class OneStep:
    """Equations in ``raceway.core.schemes.one_step``.

    Attributes
    ----------
    alpha_m, alpha_f : weights of the old step's inertia and other forces;  beta, gamma : Newmark's
    tolerance : residual of a step's iteration over the largest force of excitation and inertia
    """

    alpha_m: float = 0.0
    alpha_f: float = 0.0
    beta: float = 0.25
    gamma: float = 0.5
    tolerance: float = 1e-9

    def compiled(self, system: System, start: Motion, schedule: Schedule, on_chunk: OnChunk | None = None) -> Record:
        """Steps of a compiled ring."""
        import numpy as np

        from raceway.core.schemes.advance import advance
        from raceway.core.schemes.one_step.compiled import implicit
        from raceway.core.stepping.states import check_start

        check_start(system, start)
        rounding = system.force_rounding(start.q, start.ball)
        numbers = np.array([self.alpha_m, self.alpha_f, self.beta, self.gamma, self.tolerance, rounding])
        return advance(implicit, system, start, schedule, numbers, on_chunk)

    def stepped(self, system: SteppedSystem, recorder: Recorder) -> None:
        """Steps of any system."""
        from raceway.core.schemes.one_step.stepped import implicit

        implicit(system, recorder, (self.alpha_m, self.alpha_f, self.beta, self.gamma), self.tolerance)
