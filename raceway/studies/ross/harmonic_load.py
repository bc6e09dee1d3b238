"""Load of a rotor on the inner ring at one frequency, along any path: an excitation."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

import attrs
import numpy as np

from raceway.plugins.excitations import Bidirectional

if TYPE_CHECKING:
    from raceway.core.jit import Kernel


@attrs.frozen(kw_only=True)
class HarmonicLoad(Bidirectional):
    """Complex amplitudes (5,) of F_x, F_y, F_z [N], M_y, M_z [N m]; the load is their real part times e^{jwt}."""

    amplitudes: tuple[complex, ...] = (0.0,) * 5

    def parameters(self) -> np.ndarray:
        return np.concatenate([[self.whirl_speed], np.array(self.amplitudes, dtype=complex).view(float)])

    def kernel(self) -> Kernel:
        from raceway.studies.ross.harmonic_load_kernel import harmonic_load

        return harmonic_load


def harmonic_load(speed: float, load: np.ndarray) -> HarmonicLoad:
    """The excitation of a load (5,) [N, N m] at a speed [rad/s]."""
    largest = float(np.abs(load[:3]).max())
    return HarmonicLoad(
        speed_rpm=speed * 30.0 / pi, amplitude="constant", force=largest, amplitudes=tuple(map(complex, load))
    )
