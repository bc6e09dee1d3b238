"""A harmonic force along one fixed radial direction."""

from __future__ import annotations

from math import radians
from typing import TYPE_CHECKING, Any, ClassVar

import attrs

from raceway.framework.options import finite, option
from raceway.plugins.excitations.amplitude import Amplitude

if TYPE_CHECKING:
    from typing import Self

    import numpy as np

    from raceway.core.jit import Kernel


@attrs.frozen(kw_only=True)
class Unidirectional(Amplitude):
    """F0 cos(W t - lag) along a direction in the radial plane."""

    name: ClassVar[str] = "unidirectional"

    direction_deg: float = option(0.0, unit="deg", help="direction of the force, from +y towards +z", rule=finite())

    @classmethod
    def examples(cls, **options: Any) -> list[Self]:
        first, second = (
            super(Unidirectional, cls).examples(direction_deg=direction_deg, **options) for direction_deg in (0.0, 130.0)
        )
        return first + second

    @property
    def sense(self) -> int:
        return 0

    def parameters(self) -> np.ndarray:
        import numpy as np

        lag, direction = radians(self.phase_lag_deg), radians(self.direction_deg)
        return np.array([self.amplitude_n, self.whirl_speed, lag, np.cos(direction), 0.0, np.sin(direction), 0.0])

    def kernel(self) -> Kernel:
        from raceway.core.excitations.harmonic import harmonic

        return harmonic
