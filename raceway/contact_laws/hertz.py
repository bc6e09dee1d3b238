"""Exact elliptic Hertz."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import attrs
import numpy as np

from raceway.core.deferred import deferred
from raceway.framework.contracts import ContactPairs

if TYPE_CHECKING:
    from raceway.core.jit import Kernel

#: Times the pressure per penetration at which two rigid paraboloids approach as far as Hertz's: the largest penetration
#: is then 1.5 / 150 = 1 % of Hertz's approach, because the peak of a Hertz pressure is 1.5 times its mean.
SHARE = 150.0


def point_stiffness(pairs: ContactPairs, load: np.ndarray) -> np.ndarray:
    """(n,) k_n [N/m3] whose penetration under the peak pressure at ``load`` (n,) [N] is 1 % of Hertz's approach.

    Rigid paraboloids A x^2 + B y^2 that overlap by delta carry Q = pi k delta^2 / (2 sqrt(A B)); with Hertz's delta that
    gives k = 2 sqrt(A B) Q / (pi delta^2), which is 2/3 of the peak pressure over delta for any ellipse near a circle.
    """
    approach = np.cbrt(load / pairs.hertz_factor) ** 2
    return SHARE * 2.0 * np.sqrt(pairs.curvature_a * pairs.curvature_b) * load / (np.pi * approach**2)


@deferred("LAW")
def three_halves(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    """Q = K delta^1.5 of a pair, by one column of ``params``; p = k delta at a point, by a second one beside a factor of zero, k in N/m3."""
    if params.shape[1] == 1:
        # Rows of one number lie side by side: this loop is vectorised, the one below is not.
        for i in range(gap.size):
            approach = max(-gap[i], 0.0)
            slope = params[i, 0] * np.sqrt(approach)
            force[i] = slope * approach
            d_gap[i] = -1.5 * slope
            d_rate[i] = 0.0
        return
    for i in range(gap.size):
        approach = max(-gap[i], 0.0)
        linear = params[i, 1] if gap[i] < 0.0 else 0.0
        slope = params[i, 0] * np.sqrt(approach)
        force[i] = (slope + linear) * approach
        d_gap[i] = -1.5 * slope - linear
        d_rate[i] = 0.0


@attrs.frozen
class Hertz:
    """Q = K delta^1.5 with K from the complete elliptic integrals (``raceway.core.contact.hertz``).

    At points of deforming surfaces the bodies themselves give Hertz's compliance; the law is then a penalty that takes no
    more than 1 % of Hertz's approach at the ball load under the axial load alone.
    """

    name: ClassVar[str] = "hertz"
    discretisations: ClassVar[frozenset[str]] = frozenset({"resultant", "nodal"})
    state_size: ClassVar[int] = 0
    dissipative: ClassVar[bool] = False
    hertzian: ClassVar[bool] = True

    def build(self, pairs: ContactPairs) -> np.ndarray:
        if pairs.area is not None:
            return np.column_stack([np.zeros_like(pairs.hertz_factor), point_stiffness(pairs, pairs.reference_load)])
        return pairs.hertz_factor[:, np.newaxis]

    def kernel(self) -> Kernel:
        return three_halves()
