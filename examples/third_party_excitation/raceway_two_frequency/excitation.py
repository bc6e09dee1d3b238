"""The options of the force; light, so that listing plug-ins compiles nothing."""

from __future__ import annotations

from math import gcd, pi, radians
from typing import TYPE_CHECKING, Any, ClassVar

import attrs

from raceway import at_least, between, finite, one_of, option, positive

if TYPE_CHECKING:
    import numpy as np

_SENSES = {"forward": 1, "backward": -1}


@attrs.frozen(kw_only=True)
class TwoFrequency:
    """F1 turning at the speed W and F2 turning at W ``multiple`` / ``divisor``.

    Notes
    -----
    F_y = F1 cos(W t - lag1) + F2 cos(r W t - lag2), F_z = s1 F1 sin(W t - lag1) + s2 F2 sin(r W t - lag2), with
    r = multiple / divisor and the senses s.  The whole repeats itself after ``divisor`` turns (r in lowest terms).
    A misaligned coupling gives r = 2, a loose seat r = 1/2.
    """

    name: ClassVar[str] = "two_frequency"

    speed_rpm: float = option(unit="r/min", help="speed of the first force = spin speed", rule=positive())
    force: float = option(unit="N", help="first force", rule=positive())
    whirl: str = option("forward", help="sense of the first force", rule=one_of(*_SENSES))
    phase_lag_deg: float = option(0.0, unit="deg", help="lag of the first force", rule=finite())
    second_force: float = option(0.0, unit="N", help="second force", rule=at_least(0.0))
    second_whirl: str = option("forward", help="sense of the second force", rule=one_of(*_SENSES))
    second_phase_lag_deg: float = option(0.0, unit="deg", help="lag of the second force", rule=finite())
    multiple: int = option(2, help="second frequency = multiple / divisor times the first", rule=between(1, 100))
    divisor: int = option(1, help="see multiple", rule=between(1, 100))

    def __attrs_post_init__(self) -> None:
        if self.multiple == self.divisor:
            raise ValueError("`multiple` = `divisor` makes both frequencies the same: add the forces up instead")

    @classmethod
    def examples(cls) -> list[TwoFrequency]:
        """Instances for the conformance suite."""
        first = {"speed_rpm": 12000.0, "force": 300.0, "second_force": 120.0}
        return [
            cls(**first),
            cls(**first, phase_lag_deg=30.0, second_whirl="backward", second_phase_lag_deg=-50.0, multiple=3),
            cls(**first, whirl="backward", multiple=2, divisor=4),
        ]

    def unused_options(self) -> dict[str, str]:
        if self.second_force > 0.0:
            return {}
        defaults = attrs.fields_dict(type(self))
        names = ("second_whirl", "second_phase_lag_deg", "multiple", "divisor")
        return {n: "second_force is 0" for n in names if getattr(self, n) != defaults[n].default}

    @property
    def frequency_hz(self) -> float:
        return self.speed_rpm / 60.0

    @property
    def period_s(self) -> float:
        turns = self.divisor // gcd(self.multiple, self.divisor) if self.second_force > 0.0 else 1
        return turns * 60.0 / self.speed_rpm

    @property
    def amplitude_n(self) -> float:
        """The line at ``frequency_hz``: the first force."""
        return self.force

    @property
    def sense(self) -> int:
        return _SENSES[self.whirl]

    def parameters(self) -> np.ndarray:
        import numpy as np

        w = self.speed_rpm * pi / 30.0
        first = self.force, w, radians(self.phase_lag_deg), _SENSES[self.whirl]
        other = w * self.multiple / self.divisor
        second = self.second_force, other, radians(self.second_phase_lag_deg), _SENSES[self.second_whirl]
        return np.array([*first, *second], dtype=float)

    def kernel(self) -> Any:
        from raceway_two_frequency.compiled import two_frequency

        return two_frequency
