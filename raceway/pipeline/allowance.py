"""How far a run may go beyond its plan, in processor time: a busy machine ends no run."""

from __future__ import annotations

from math import inf

import attrs

from raceway.core.jit import working_processor_time
from raceway.errors import BeyondPlanError
from raceway.planning.plan import Plan

#: A run is stopped beyond so many times its predicted time; predictions are within a factor of three of measured ones.
PATIENCE = 20.0
#: Shorter plans count as this one [s]: start-up and search for orbits are the less predictable the shorter the run.
_LEAST_S = 3.0


@attrs.define
class Allowance:
    """Processor time [s] that a run may take; kernels that compile count for nothing.

    Attributes
    ----------
    planned : predicted time of the whole run;  patience : how many times that may pass;  begun : reading of the clock
    """

    planned: float
    patience: float
    begun: float = attrs.field(factory=lambda: working_processor_time())

    @classmethod
    def of(cls, plan: Plan, patience: float) -> Allowance:
        """Without an end where the plan knows no more than what a run takes at least."""
        return cls(max(plan.predicted_wall_s, _LEAST_S), inf if plan.at_least else patience)

    @property
    def taken(self) -> float:
        return working_processor_time() - self.begun

    @property
    def spent(self) -> bool:
        return self.taken > self.patience * self.planned

    def words(self, where: str) -> str:
        """What a person is told of a run that is stopped."""
        return (
            f"{where}: {self.taken:.3g} s of processor time are over {self.patience:g} times the planned {self.planned:.3g} s. "
            "`raceway run --patience` takes another factor, or inf"
        )

    def check(self, what: str, done: int, total: int) -> None:
        """Stop a run between its steps.

        Raises
        ------
        BeyondPlanError
            Much more than the plan's time is gone, and steps are left.
        """
        if self.spent and not 0 < total <= done:
            raise BeyondPlanError(self.words(f"stopped far beyond the plan, in {what}, {_told(done, total)} done"))


def _told(done: int, total: int) -> str:
    return f"{done} of {total}" if total else str(done)
