"""Central differences."""

from __future__ import annotations

from typing import ClassVar

import attrs

from raceway.core.time.schemes import Explicit


@attrs.frozen
class CentralDifference:
    """Explicit, second order, symplectic; the step must stay below 2 / (largest natural frequency)."""

    name: ClassVar[str] = "central_difference"
    order: ClassVar[int] = 2
    implicit: ClassVar[bool] = False
    inertial: ClassVar[bool] = True
    steady: ClassVar[bool] = False
    dissipative: ClassVar[bool] = False

    @property
    def scheme(self) -> Explicit:
        """Central differences."""
        return Explicit()
