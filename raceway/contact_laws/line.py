"""Line contacts of rollers: the constants of ISO/TS 16281 and of Palmgren."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import attrs
import numpy as np

from raceway.errors import PluginError
from raceway.framework.options import option, positive, word_or

if TYPE_CHECKING:
    from raceway.core.jit import Kernel
    from raceway.framework.contracts import ContactPairs

#: c of delta = c Q^0.9 / L^0.8 of one contact [m^1.8 / N^0.9], for steel: half of what c_L = 35948 L^(8/9) of both races leaves
#: (ISO/TS 16281), and 3.84e-5 mm^1.8 / N^0.9 (Palmgren).
_COEFFICIENTS = {"iso_16281": 0.5 * 35948.0**-0.9 * 1e-3 * 1e-3**0.8, "palmgren": 3.84e-5 * 1e-3 * 1e-3**0.8}


@attrs.frozen
class Line:
    """delta = c Q^0.9 / L^0.8, so Q = (delta / c)^(10/9) L^(8/9), of one contact of a steel roller with a raceway.

    Both constants are experience; the diameters have no influence.  ISO's is 3.4 % softer in displacement than Palmgren's.

    References
    ----------
    ISO/TS 16281:2008, section 5: c_L = 35948 L_we^(8/9) N / mm^(10/9) of a roller between both races.  Palmgren, Ball and Roller Bearing
    Engineering, 3rd ed. (1959); Harris, Rolling Bearing Analysis, 4th ed. (2001), chapter 6: Q = 8.06e4 L^(8/9) delta^(10/9).
    """

    name: ClassVar[str] = "line"
    discretisations: ClassVar[frozenset[str]] = frozenset({"resultant"})
    state_size: ClassVar[int] = 0
    dissipative: ClassVar[bool] = False
    #: What ``CylindricalRollers`` asks of a law.
    line_contact: ClassVar[bool] = True

    constant: float | str = option(
        "iso_16281",
        unit="m^1.8/N^0.9",
        help="c: 'iso_16281', 'palmgren' or a number",
        rule=word_or(positive(), *_COEFFICIENTS),
    )
    length: float | None = option(None, unit="m", help="L; default: that of the rollers", rule=positive())

    @classmethod
    def examples(cls) -> list[Line]:
        """Instances for the conformance suite, whose contacts are ellipses."""
        return [cls(length=9e-3, constant=_COEFFICIENTS["iso_16281"]), cls(length=0.03, constant=_COEFFICIENTS["palmgren"])]

    @property
    def coefficient(self) -> float:
        """c [m^1.8 / N^0.9]."""
        return _COEFFICIENTS[self.constant] if isinstance(self.constant, str) else self.constant

    def build(self, pairs: ContactPairs) -> np.ndarray:
        if self.length is None and pairs.length is None:
            why = "the contacts are not line contacts: use bodies.kind = 'cylindrical_rollers', or give contact.length"
            raise PluginError(why)
        length = np.full_like(pairs.hertz_factor, pairs.length if self.length is None else self.length)
        return np.asarray((length ** (8.0 / 9.0) / self.coefficient ** (10.0 / 9.0))[:, None].copy())

    def kernel(self) -> Kernel:
        from raceway.core.ring.kernels.rollers import ten_ninths

        return ten_ninths
