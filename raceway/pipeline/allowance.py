"""How far a run may go beyond its plan, in processor time and memory: a busy machine ends no run."""

from __future__ import annotations

import os
from math import inf
from pathlib import Path

import attrs

from raceway.core.jit import working_processor_time
from raceway.errors import BeyondPlanError
from raceway.planning.plan import Plan

#: A run is stopped beyond so many times its predicted time; predictions are within a factor of three of measured ones.
PATIENCE = 20.0
#: Shorter plans count as this one [s]: start-up and search for orbits are the less predictable the shorter the run.
_LEAST_S = 3.0
#: The same of memory: runs that converge stay within 1.6 times their plan (examples/b7206_elastic_coarse.toml at points, soft to stiff).
_MOST_MEMORY = 3.0
#: What kernels that compile, and libraries that load, may hold beyond the plan in a fresh process [B].
_COMPILING = 0.5e9


@attrs.define
class Allowance:
    """Processor time [s] and memory [B] that a run may take; kernels that compile count for nothing.

    Attributes
    ----------
    planned : predicted time of the whole run;  patience : how many times that may pass;  begun : reading of the clock
    bytes : predicted memory at the peak, 0 where it has no limit;  held : what the process held before the run
    """

    planned: float
    patience: float
    begun: float = attrs.field(factory=lambda: working_processor_time())
    bytes: float = 0.0
    held: float = attrs.field(factory=lambda: resident_bytes())

    @classmethod
    def of(cls, plan: Plan, patience: float) -> Allowance:
        """Without an end where the plan knows no more than what a run takes at least."""
        if plan.at_least or patience == inf:
            return cls(max(plan.predicted_wall_s, _LEAST_S), inf)
        return cls(max(plan.predicted_wall_s, _LEAST_S), patience, bytes=plan.predicted_bytes)

    @property
    def taken(self) -> float:
        return working_processor_time() - self.begun

    @property
    def grown(self) -> bool:
        """Whether the run itself holds far more than planned: what earlier runs left in the process is not its own."""
        return self.bytes > 0.0 and resident_bytes() - self.held > _MOST_MEMORY * self.bytes + _COMPILING

    @property
    def spent(self) -> bool:
        return self.taken > self.patience * self.planned or self.grown

    def words(self, where: str) -> str:
        """What a person is told of a run that is stopped."""
        if self.grown:
            return (
                f"{where}: its memory is far over the planned {self.bytes / 2**30:.2g} GiB: its contacts are far larger than "
                "those of Hertz that the mesh is made for. Take a stiffer law, a smaller load, or `--patience inf`"
            )
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


def resident_bytes() -> float:
    """Memory that this process holds; 0 where the system does not tell."""
    try:
        return float(Path("/proc/self/statm").read_text().split()[1]) * float(os.sysconf("SC_PAGE_SIZE"))
    except (OSError, ValueError):
        return 0.0


def _told(done: int, total: int) -> str:
    return f"{done} of {total}" if total else str(done)
