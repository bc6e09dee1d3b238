"""Run-up or run-down: the unbalance force under a speed that changes linearly."""

from __future__ import annotations

from math import pi, radians
from typing import TYPE_CHECKING, ClassVar

import attrs

from raceway.framework.options import at_least, between, finite, inside, one_of, option, positive
from raceway.plugins.excitations.bidirectional import Bidirectional
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    import numpy as np

    from raceway.core.jit import Kernel


@attrs.frozen(kw_only=True)
class RunUp:
    """m e w^2 with w from ``first_speed_rpm`` to ``speed_rpm`` over ``duration_s``; identify with 'order_tracking'."""

    name: ClassVar[str] = "run_up"

    first_speed_rpm: float = option(unit="r/min", help="speed at the beginning", rule=inside(0.0, 1e9))
    speed_rpm: float = option(unit="r/min", help="speed at the end", rule=inside(0.0, 1e9))
    duration_s: float = option(unit="s", help="time between the two", rule=positive())
    unbalance: float = option(unit="kg m", help="mass times eccentricity of the whole rotor", rule=at_least(0.0))
    load_share: float = option(1.0, help="share of the rotor's force that this bearing carries", rule=between(0.0, 1.0))
    phase_lag_deg: float = option(0.0, unit="deg", help="lag of the force behind the rotor's mark", rule=finite())
    whirl: str = option("forward", help="sense of turning", rule=one_of("forward", "backward"))

    period_s: ClassVar[None] = None

    @classmethod
    def examples(cls) -> list[RunUp]:
        """Instances for the conformance suite."""
        common: Tables = {"duration_s": 0.5, "unbalance": 3.2e-4, "phase_lag_deg": 20.0}
        return [
            cls(first_speed_rpm=6000.0, speed_rpm=12000.0, **common),
            cls(first_speed_rpm=12000.0, speed_rpm=6000.0, whirl="backward", **common),
        ]

    @property
    def frequency_hz(self) -> float:
        """Frequency at the faster end, which sets the time step."""
        return max(self.speed_rpm, self.first_speed_rpm) / 60.0

    @property
    def amplitude_n(self) -> float:
        """Force at the end [N]."""
        return self.load_share * self.unbalance * (self.speed_rpm * pi / 30.0) ** 2

    @property
    def sense(self) -> int:
        return 1 if self.whirl == "forward" else -1

    def phase(self, time: np.ndarray) -> np.ndarray:
        """Angle of the force (n,) [rad] at times (n,)."""
        import numpy as np

        first, last = self.first_speed_rpm * pi / 30.0, self.speed_rpm * pi / 30.0
        changing = np.minimum(time, self.duration_s)
        turned = first * changing + 0.5 * (last - first) / self.duration_s * changing**2
        return turned + last * (time - changing) - radians(self.phase_lag_deg)

    def steady(self) -> Bidirectional:
        """The same rotor at its first speed."""
        return Bidirectional(
            speed_rpm=self.first_speed_rpm,
            unbalance=self.unbalance,
            load_share=self.load_share,
            phase_lag_deg=self.phase_lag_deg,
            whirl=self.whirl,
        )

    def parameters(self) -> np.ndarray:
        import numpy as np

        first, last = self.first_speed_rpm * pi / 30.0, self.speed_rpm * pi / 30.0
        share = self.load_share * self.unbalance
        return np.array([share, first, last, self.duration_s, radians(self.phase_lag_deg), float(self.sense)])

    def kernel(self) -> Kernel:
        from raceway.core.excitations.run_up import run_up

        return run_up
