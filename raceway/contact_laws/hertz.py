"""Exact elliptic Hertz."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import attrs

from raceway.contact_laws.penalty import point_stiffness

if TYPE_CHECKING:
    import numpy as np

    from raceway.core.jit import Kernel
    from raceway.framework.contracts import ContactPairs


@attrs.frozen
class Hertz:
    """Q = K delta^1.5 with K from the complete elliptic integrals (``raceway.core.contact.hertz``).

    Notes
    -----
    At points of deforming surfaces the bodies themselves give Hertz's compliance; the law is then a penalty that takes no
    more than 1 % of Hertz's approach at the ball load under the axial load alone.
    """

    name: ClassVar[str] = "hertz"
    discretisations: ClassVar[frozenset[str]] = frozenset({"resultant", "nodal"})
    state_size: ClassVar[int] = 0
    dissipative: ClassVar[bool] = False
    hertzian: ClassVar[bool] = True

    def build(self, pairs: ContactPairs) -> np.ndarray:
        import numpy as np

        if pairs.area is not None:
            return np.column_stack([np.zeros_like(pairs.hertz_factor), point_stiffness(pairs, pairs.reference_load)])
        return pairs.hertz_factor[:, np.newaxis]

    def kernel(self) -> Kernel:
        from raceway.core.contact.laws import three_halves

        return three_halves
