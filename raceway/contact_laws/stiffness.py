"""Pressures per penetration that leave a stated part of Hertz's approach to the penalty."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np

    from raceway.framework.contracts import ContactPairs

#: Times the pressure per penetration at which two rigid paraboloids approach as far as Hertz's: the largest penetration
#: is then 1.5 / 150 = 1 % of Hertz's approach, because the peak of a Hertz pressure is 1.5 times its mean.
SHARE = 150.0


def point_stiffness(pairs: ContactPairs, load: np.ndarray) -> np.ndarray:
    """(n,) k_n [N/m3] whose penetration under the peak pressure at ``load`` (n,) [N] is 1 % of Hertz's approach.

    Notes
    -----
    Rigid paraboloids A x^2 + B y^2 that overlap by delta carry Q = pi k delta^2 / (2 sqrt(A B)); with Hertz's delta that
    gives k = 2 sqrt(A B) Q / (pi delta^2), which is 2/3 of the peak pressure over delta for any ellipse near a circle.
    """
    import numpy as np

    approach = np.cbrt(load / pairs.hertz_factor) ** 2
    return SHARE * 2.0 * np.sqrt(pairs.curvature_a * pairs.curvature_b) * load / (np.pi * approach**2)
