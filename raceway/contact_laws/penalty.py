"""The penalty of general finite-element programs, at surface points or integrated over the overlap ellipse of a contact."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import attrs
import numpy as np

from raceway.contact_laws.hertz import point_stiffness
from raceway.core.deferred import deferred
from raceway.framework.options import option, positive

if TYPE_CHECKING:
    from raceway.core.jit import Kernel
    from raceway.framework.contracts import ContactPairs


@deferred("LAW")
def square(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    """Penalty: p = k delta at a point, or, integrated over the overlap of a paraboloid, Q = c delta^2 of a pair."""
    if params.shape[1] == 1:
        for i in range(gap.size):
            approach = max(-gap[i], 0.0)
            slope = params[i, 0] * approach
            force[i] = slope * approach
            d_gap[i] = -2.0 * slope
            d_rate[i] = 0.0
        return
    for i in range(gap.size):
        approach = max(-gap[i], 0.0)
        linear = params[i, 1] if gap[i] < 0.0 else 0.0
        slope = params[i, 0] * approach
        force[i] = (slope + linear) * approach
        d_gap[i] = -2.0 * slope - linear
        d_rate[i] = 0.0


@deferred("LAW")
def linear(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    """A nodal penalty: p = k_n delta."""
    for i in range(gap.size):
        closed = gap[i] < 0.0
        slope = params[i, 0] if closed else 0.0
        force[i] = -slope * gap[i]
        d_gap[i] = -slope
        d_rate[i] = 0.0


@attrs.frozen
class Penalty:
    """p = k_n max(-g, 0); of rigid bodies Q = pi k_n delta^2 / (2 sqrt(A B)) for a contact of curvatures A and B.

    Without ``stiffness`` the penalty is scaled at ``calibrate_at`` (by default the ball load under the axial load alone):
    as a resultant so that the approach equals Hertz's there (at other loads it does not), at surface points, where the
    bodies deform, so that its penetration is 1 % of Hertz's approach.
    """

    name: ClassVar[str] = "penalty"
    discretisations: ClassVar[frozenset[str]] = frozenset({"resultant", "nodal"})
    state_size: ClassVar[int] = 0
    dissipative: ClassVar[bool] = False
    foundation: ClassVar[bool] = True

    stiffness: float | None = option(
        None, unit="N/m3", help="pressure per penetration k_n; excludes calibrate_at", rule=positive()
    )
    calibrate_at: float | None = option(
        None, unit="N", help="ball load at which the approach equals Hertz's (nodal: 1 % of it)", rule=positive()
    )

    @classmethod
    def examples(cls) -> list[Penalty]:
        """Instances for the conformance suite."""
        return [cls(), cls(stiffness=1e15), cls(calibrate_at=150.0)]

    def __attrs_post_init__(self) -> None:
        if self.stiffness is not None and self.calibrate_at is not None:
            raise ValueError("`stiffness` and `calibrate_at` exclude each other: give one of them")

    def build(self, pairs: ContactPairs) -> np.ndarray:
        none = np.zeros_like(pairs.hertz_factor)
        load = pairs.reference_load if self.calibrate_at is None else np.full_like(none, self.calibrate_at)
        if pairs.area is not None:
            fixed = self.stiffness is not None
            return np.column_stack([none, none + self.stiffness if fixed else point_stiffness(pairs, load)])
        if self.stiffness is not None:
            factor = np.pi * self.stiffness / (2.0 * np.sqrt(pairs.curvature_a * pairs.curvature_b))
        else:
            factor = load / np.cbrt(load / pairs.hertz_factor) ** 4
        return np.asarray(factor)[:, np.newaxis]

    def kernel(self) -> Kernel:
        return square()


@attrs.frozen
class Unilateral:
    """Pressure p >= 0, gap g >= 0, p g = 0 at every surface point: no penalty and no penetration.

    Not a function of the gap: bodies that can hold the constraint exactly (condensed ones, by an active set) read
    ``constraint`` and do not call the kernel.  The kernel is the stiffest of the penalties that stand for it, a hundredth
    of the penetration that the law ``hertz`` leaves at points.
    """

    name: ClassVar[str] = "unilateral"
    discretisations: ClassVar[frozenset[str]] = frozenset({"nodal"})
    state_size: ClassVar[int] = 0
    dissipative: ClassVar[bool] = False
    constraint: ClassVar[bool] = True

    def build(self, pairs: ContactPairs) -> np.ndarray:
        stiffness = 100.0 * point_stiffness(pairs, pairs.reference_load)
        return np.column_stack([np.zeros_like(stiffness), stiffness])

    def kernel(self) -> Kernel:
        return square()
