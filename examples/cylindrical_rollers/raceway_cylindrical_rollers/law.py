"""Palmgren's law of line contacts; light, so that listing plug-ins compiles nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import attrs

from raceway import PluginError, option, optional, positive

if TYPE_CHECKING:
    import numpy as np

    from raceway.framework.contracts import ContactPairs

#: 3.84e-5 mm^1.8 / N^0.9 in SI units.
STEEL = 3.84e-5 * 1e-3 * 1e-3**0.8


@attrs.frozen
class Palmgren:
    """delta = c Q^0.9 / L^0.8, so Q = (delta / c)^(10/9) L^(8/9), of one contact of a roller with a raceway.

    Notes
    -----
    Found by experiment for steel on steel, delta = 3.84e-5 Q^0.9 / L^0.8 in mm and N; the diameters have no influence.

    References
    ----------
    Palmgren, Ball and Roller Bearing Engineering, 3rd ed. (1959); Harris, Rolling Bearing Analysis, 4th ed. (2001), chapters 6
    and 7: Q = 8.06e4 L^(8/9) delta^(10/9).
    """

    name: ClassVar[str] = "palmgren"
    discretisations: ClassVar[frozenset[str]] = frozenset({"resultant"})
    state_size: ClassVar[int] = 0
    dissipative: ClassVar[bool] = False
    #: What ``CylindricalRollers`` asks of a law.
    line_contact: ClassVar[bool] = True

    coefficient: float = option(STEEL, unit="m^1.8/N^0.9", help="c; default: steel on steel", rule=positive())
    length: float | None = option(
        None, unit="m", help="L; default: what the bodies tell of their line contacts", rule=optional(positive())
    )

    @classmethod
    def examples(cls) -> list[Palmgren]:
        """Instances for the conformance suite, whose contacts are ellipses."""
        return [cls(length=9e-3), cls(length=0.03, coefficient=2.0 * STEEL)]

    def build(self, pairs: ContactPairs) -> np.ndarray:
        import numpy as np

        if self.length is None and pairs.length is None:
            raise PluginError("the contacts are no lines: take bodies.kind = 'cylindrical_rollers', or give contact.length")
        length = pairs.length if self.length is None else np.full_like(pairs.hertz_factor, self.length)
        return (length ** (8.0 / 9.0) / self.coefficient ** (10.0 / 9.0))[:, None].copy()

    def kernel(self) -> Any:
        from raceway_cylindrical_rollers.compiled import palmgren

        return palmgren
