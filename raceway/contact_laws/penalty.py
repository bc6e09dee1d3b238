"""The penalty of general finite-element programs, at surface points or integrated over the overlap ellipse of a contact."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import attrs

from raceway.framework.options import option, optional, positive

if TYPE_CHECKING:
    import numpy as np

    from raceway.core.jit import Kernel
    from raceway.framework.contracts import ContactPairs


#: Times the pressure per penetration at which two rigid paraboloids approach as far as Hertz's: the largest penetration
#: is then 1.5 / 150 = 1 % of Hertz's approach, because the peak of a Hertz pressure is 1.5 times its mean.
SHARE = 150.0


def point_stiffness(pairs: ContactPairs, load: np.ndarray) -> np.ndarray:
    """(n,) k_n [N/m3] whose penetration under the peak pressure at ``load`` (n,) [N] is 1 % of Hertz's approach.

    Notes
    -----
    Rigid paraboloids A x^2 + B y^2 that overlap by delta carry Q = pi k delta^2 / (2 sqrt(A B)); with Hertz's delta that
    gives k = 2 sqrt(A B) Q / (pi delta^2), which is 2/3 of the peak pressure over delta for any ellipse near a circle.
    """
    import numpy as np

    approach = np.cbrt(load / pairs.hertz_factor) ** 2
    return SHARE * 2.0 * np.sqrt(pairs.curvature_a * pairs.curvature_b) * load / (np.pi * approach**2)


@attrs.frozen
class Penalty:
    """p = k_n max(-g, 0); of rigid bodies Q = pi k_n delta^2 / (2 sqrt(A B)) for a contact of curvatures A and B.

    Notes
    -----
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
        None, unit="N/m3", help="pressure per penetration k_n; excludes calibrate_at", rule=optional(positive())
    )
    calibrate_at: float | None = option(
        None, unit="N", help="ball load at which the approach equals Hertz's (nodal: 1 % of it)", rule=optional(positive())
    )

    @classmethod
    def examples(cls) -> list[Penalty]:
        """Instances for the conformance suite."""
        return [cls(), cls(stiffness=1e15), cls(calibrate_at=150.0)]

    def __attrs_post_init__(self) -> None:
        if self.stiffness is not None and self.calibrate_at is not None:
            raise ValueError("`stiffness` and `calibrate_at` exclude each other: give one of them")

    def build(self, pairs: ContactPairs) -> np.ndarray:
        import numpy as np

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
        from raceway.core.contact.laws import square

        return square


@attrs.frozen
class Unilateral:
    """Pressure p >= 0, gap g >= 0, p g = 0 at every surface point: no penalty and no penetration.

    Notes
    -----
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
        import numpy as np

        stiffness = 100.0 * point_stiffness(pairs, pairs.reference_load)
        return np.column_stack([np.zeros_like(stiffness), stiffness])

    def kernel(self) -> Kernel:
        from raceway.core.contact.laws import square

        return square
