"""The steady orbit, solved for directly."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import attrs

from raceway.core.time.schemes import Drivers
from raceway.errors import ConvergenceError
from raceway.framework.options import inside, one_of, option

if TYPE_CHECKING:
    from raceway.core.record import Motion, OnChunk, Record, Schedule
    from raceway.core.ring.system import System


@attrs.frozen
class Periodic:
    """The motion that repeats itself every turn, by collocation at Gauss points; its mesh follows the error.

    Notes
    -----
    No transient, so ``integrator.turns`` and ``start`` count for nothing; ``steps_per_turn`` is the number of samples of the
    answer, not of the method.  A force that turns over equal balls is solved over one ball pitch.  result.json tells the
    Floquet multipliers in ``stability``.
    """

    name: ClassVar[str] = "periodic"
    order: ClassVar[int] = 8
    implicit: ClassVar[bool] = True
    inertial: ClassVar[bool] = True
    dissipative: ClassVar[bool] = False
    steady: ClassVar[bool] = True

    tolerance: float = option(
        1e-7, help="estimated error of the displacement over the amplitude of the motion", rule=inside(1e-12, 1e-2)
    )
    symmetry: str = option(
        "auto", help="'auto': one ball pitch where forces and bodies allow it; 'none': always one turn", rule=one_of("auto", "none")
    )  # fmt: skip

    @classmethod
    def examples(cls) -> list[Periodic]:
        """Instances for the conformance suite."""
        return [cls(), cls(symmetry="none")]

    @property
    def scheme(self) -> Drivers:
        """Collocation needs thousands of evaluations: of compiled forces only."""
        return Drivers(compiled=self.solve)

    def solve(self, system: System, start: Motion, schedule: Schedule, on_chunk: OnChunk | None = None) -> Record:
        """The motion that repeats itself, sampled at the steps of a schedule."""
        from raceway.core.periodic.steady import steady

        try:
            return steady(system, start, schedule, self.tolerance, self.symmetry == "auto", on_chunk)
        except ConvergenceError as why:
            if why.state:
                raise
            # Only the corrector of a branch that fails at its first point, the resting ring, leaves no state.
            raise ConvergenceError(
                "no motion of the period of the force was found: the one that grows out of rest ends at 0 % of the force, where "
                f"its branch begins ({why}). Use integrator.kind = 'quasi_static' for speeds far below the natural frequencies; "
                "at others a transient integrator with start = 'ramp' shows what the ring does.",
                {"q": start.q.copy()},
            ) from why
