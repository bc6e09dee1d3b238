"""Contact without penetration."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import attrs

from raceway.contact_laws.stiffness import point_stiffness

if TYPE_CHECKING:
    import numpy as np

    from raceway.core.jit import Kernel
    from raceway.framework.contracts import ContactPairs


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
        from raceway.core.contact.laws import square_or_linear

        return square_or_linear
