"""The options of the law; light, so that listing plug-ins compiles nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import attrs

from raceway import at_least, inside, option, optional, positive

if TYPE_CHECKING:
    import numpy as np

    from raceway.extend import ContactPairs


@attrs.frozen
class HuntCrossley:
    """F = K delta^1.5 B(delta / h) max(1 + c ddelta/dt, 0), with K of exact Hertz.

    Notes
    -----
    B(x) = 3 x^2 - 2 x^3 below x = 1, then 1: contact comes about over the depth h of the surfaces' roughness, so force,
    stiffness and dissipation all begin smoothly.  B depends on the approach alone: the elastic part stays conservative
    and the whole law loses energy for every c >= 0, since (max(1 + c v, 0) - 1) v >= 0.

    With ``dissipation`` c is a constant and the law has no memory.  With ``restitution`` e, c = 8 (1 - e) / (5 e v0) and v0
    is the speed of approach at first touch, which is remembered as long as the contact lasts: the one column of state.
    Speeds below ``slowest`` count as ``slowest``.

    References
    ----------
    Hunt, Crossley, J. Appl. Mech. 42 (1975) 440; Flores, Machado, Silva, Martins, Multibody Syst. Dyn. 25 (2011) 357,
    for c from the coefficient of restitution.
    """

    name: ClassVar[str] = "hunt_crossley"
    discretisations: ClassVar[frozenset[str]] = frozenset({"resultant"})

    dissipation: float = option(0.1, unit="s/m", help="c, a constant", rule=at_least(0.0))
    restitution: float | None = option(
        None,
        help="coefficient of restitution that c is computed from, instead of dissipation",
        rule=optional(inside(0.0, 1.0)),
    )
    transition: float = option(1e-7, unit="m", help="depth over which the contact comes about; 0: sharp", rule=at_least(0.0))
    slowest: float = option(1e-3, unit="m/s", help="with restitution: least speed at first touch", rule=positive())

    @classmethod
    def examples(cls) -> list[HuntCrossley]:
        """Instances for the conformance suite."""
        return [cls(), cls(dissipation=5.0, transition=0.0), cls(dissipation=0.0), cls(restitution=0.8)]

    def unused_options(self) -> dict[str, str]:
        """Options that are given and change nothing, each with the reason."""
        name, why = (
            ("slowest", "restitution is not given") if self.restitution is None else ("dissipation", "restitution is given")
        )
        given = getattr(self, name) != attrs.fields_dict(type(self))[name].default
        return {name: why} if given else {}

    @property
    def state_size(self) -> int:
        return 0 if self.restitution is None else 1

    @property
    def dissipative(self) -> bool:
        return self.restitution is not None or self.dissipation != 0.0

    def build(self, pairs: ContactPairs) -> np.ndarray:
        import numpy as np

        e = self.restitution
        gain = 0.0 if e is None else 8.0 * (1.0 - e) / (5.0 * e)
        options = self.dissipation, gain, self.slowest, self.transition
        return np.column_stack([pairs.hertz_factor, *(np.full_like(pairs.hertz_factor, value) for value in options)])

    def kernel(self) -> Any:
        from raceway_hunt_crossley.compiled import hunt_crossley

        return hunt_crossley
