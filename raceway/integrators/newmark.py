"""Newmark's method."""

from __future__ import annotations

from typing import ClassVar

import attrs

from raceway.core.time.schemes import OneStep
from raceway.framework.options import between, inside, option


@attrs.frozen
class Newmark:
    """Average acceleration by default: second order, no dissipation, unconditionally stable on linear systems."""

    name: ClassVar[str] = "newmark"
    order: ClassVar[int] = 2
    implicit: ClassVar[bool] = True
    inertial: ClassVar[bool] = True
    steady: ClassVar[bool] = False
    dissipative: ClassVar[bool] = False

    gamma: float = option(0.5, help="0.5: second order, no dissipation", rule=between(0.5, 1.0))
    beta: float = option(0.25, help="0.25: average acceleration", rule=inside(0.0, 1.0))
    tolerance: float = option(1e-9, help="residual of a step's iteration over the largest force", rule=inside(0.0, 1e-3))

    def __attrs_post_init__(self) -> None:
        if 2.0 * self.beta < self.gamma:
            raise ValueError(
                f"`beta` = {self.beta:g} must be at least gamma / 2 = {self.gamma / 2:g}: else steps are not "
                "unconditionally stable"
            )

    @property
    def scheme(self) -> OneStep:
        """The implicit one-step scheme without weights of the old step."""
        return OneStep(beta=self.beta, gamma=self.gamma, tolerance=self.tolerance)
