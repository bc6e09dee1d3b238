"""Load of a whirling shaft on a bearing: a force that turns, and with it a moment."""

from __future__ import annotations

from typing import TYPE_CHECKING

import attrs

from raceway.plugins.excitations import Bidirectional

if TYPE_CHECKING:
    import numpy as np

    from raceway.core.jit import Kernel


@attrs.frozen(kw_only=True)
class ShaftLoad(Bidirectional):
    """The rotating force of ``bidirectional`` as a complex number F_y + j F_z [N], with a moment M_z - j M_y [N m]."""

    turning_force: complex = 0.0
    turning_moment: complex = 0.0

    def parameters(self) -> np.ndarray:
        import numpy as np

        force, moment = complex(self.turning_force), complex(self.turning_moment)
        return np.array([self.whirl_speed, force.real, force.imag, moment.real, moment.imag])

    def kernel(self) -> Kernel:
        from raceway.studies.shaft.shaft_load_kernel import shaft_load

        return shaft_load


def shaft_load(speed_rpm: float, force: complex, moment: complex) -> ShaftLoad:
    """The excitation of a force F_y + j F_z [N] and a moment M_z - j M_y [N m], both at time zero."""
    return ShaftLoad(speed_rpm=speed_rpm, amplitude="constant", force=abs(force), turning_force=force, turning_moment=moment)
