"""Exact elliptic Hertz."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import attrs

if TYPE_CHECKING:
    import numpy as np

    from raceway.contracts import ContactPairs


@attrs.frozen
class Hertz:
    """Q = K delta^1.5 with K from the complete elliptic integrals (``raceway.core.hertz``)."""

    name: ClassVar[str] = "hertz"
    discretisations: ClassVar[frozenset[str]] = frozenset({"resultant"})
    state_size: ClassVar[int] = 0
    dissipative: ClassVar[bool] = False

    def build(self, pairs: ContactPairs) -> np.ndarray:
        return pairs.hertz_factor[:, None].copy()

    def kernel(self) -> Any:
        from raceway.core.contact_laws.power import three_halves

        return three_halves
