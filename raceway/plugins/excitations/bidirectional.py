"""Two orthogonal forces in quadrature: the force of a rotor's unbalance, which turns."""

from __future__ import annotations

from math import radians
from typing import TYPE_CHECKING, Any, ClassVar

import attrs

from raceway.framework.options import one_of, option
from raceway.plugins.excitations.amplitude import Amplitude

if TYPE_CHECKING:
    from typing import Self

    import numpy as np

    from raceway.core.jit import Kernel


@attrs.frozen(kw_only=True)
class Bidirectional(Amplitude):
    """F_y = F0 cos(W t - lag), F_z = F0 sin(W t - lag); backward whirl changes the sign of F_z."""

    name: ClassVar[str] = "bidirectional"

    whirl: str = option("forward", help="sense of turning", rule=one_of("forward", "backward"))

    @classmethod
    def examples(cls, **options: Any) -> list[Self]:
        first, second = (super(Bidirectional, cls).examples(whirl=whirl, **options) for whirl in ("forward", "backward"))
        return first + second

    @property
    def sense(self) -> int:
        return 1 if self.whirl == "forward" else -1

    def parameters(self) -> np.ndarray:
        import numpy as np

        lag = radians(self.phase_lag_deg)
        return np.array([self.amplitude_n, self.whirl_speed, lag, 1.0, 0.0, 0.0, float(self.sense)])

    def kernel(self) -> Kernel:
        from raceway.core.excitations.harmonic import harmonic

        return harmonic
