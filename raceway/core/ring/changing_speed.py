"""A spin speed that changes: what of a system follows it."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

import attrs
import numpy as np

from raceway.core.ring.kernels.layout import CAGE, CENTRIFUGAL, COSINE, GYROSCOPIC, REST_RADIAL, SHIFT, SIDE, SINE

if TYPE_CHECKING:
    from raceway.core.ring.ring import Ring

R = TypeVar("R", bound="Ring")  # ChangingSpeed is a Spin of it
#: Half the interval over which a phase is differentiated [s]: its rounding then makes 1e-9 of the speed.
_INTERVAL = 1e-5


@attrs.frozen(eq=False)
class ChangingSpeed:
    """The speed w(t) of the inner ring, and the parts of a system that belong to a reference speed w_r.

    Attributes
    ----------
    phase : function of times (n,) [s] -> angle of the rotor (n,) [rad]
    reference : w_r that the system's constants were made for [rad/s]
    growth : of the inner raceway [m]: at w_r by speed, by its fit at standstill, and what w_r takes from that fit, down to none
    gyroscopic : (5, 5) part of the system's damping at w_r that goes with w
    shift : function of speeds (n,) [rad/s] -> shift of the first sprung row (n,) [m], with which all on the spring slide; None
        where rows stay

    Notes
    -----
    Centrifugal forces, gyroscopic moments of the balls and centrifugal growth go with w^2, the cage speed and gyroscopic moments
    of the rotor with w.  A sprung row slides to where the spring's force is met at w, as in a steady run.
    """

    phase: Callable[[np.ndarray], np.ndarray]
    reference: float
    growth: tuple[float, float, float]
    gyroscopic: np.ndarray
    shift: Callable[[np.ndarray], np.ndarray] | None = None
    law: Callable[[Any, float], Any] | None = None

    def speed(self, time: np.ndarray) -> np.ndarray:
        """w (n,) [rad/s] at times (n,) [s] from zero on."""
        before, after = np.maximum(time - _INTERVAL, 0.0), time + _INTERVAL
        return np.asarray((self.phase(after) - self.phase(before)) / (after - before))

    def grown(self, speed: np.ndarray) -> np.ndarray:
        """Growth of the inner raceway (n,) [m] at speeds (n,) [rad/s] beyond that at w_r."""
        (free, fit, lost), squared = self.growth, (speed / self.reference) ** 2
        return np.asarray(free * (squared - 1.0) + np.maximum(fit - lost * squared, 0.0) - max(fit - lost, 0.0))

    def cage_angle(self, cage: float, time: np.ndarray) -> np.ndarray:
        """(n,) [rad] by which balls have travelled since time zero; ``cage``: their speed at w_r [rad/s]."""
        return np.asarray(cage / self.reference * (self.phase(time) - self.phase(np.zeros(1))))

    def at(self, system: R, t: float) -> R:
        """The system with the constants of one moment; its kernels take a steady speed, so the azimuths at time zero are those
        from which balls at the speed of now would have come to their places of now."""
        now = np.array([t])
        speed = float(self.speed(now)[0])
        found = self.constants(system, speed)
        if system.scalars[CAGE] != 0.0:
            ahead = float(self.cage_angle(system.scalars[CAGE], now)[0]) - found.scalars[CAGE] * t
            c, s = np.cos(ahead), np.sin(ahead)
            found.table[:, COSINE], found.table[:, SINE] = (
                system.table[:, COSINE] * c - system.table[:, SINE] * s,
                system.table[:, SINE] * c + system.table[:, COSINE] * s,
            )
        return found

    def constants(self, system: R, speed: float) -> R:
        """The system at a steady speed [rad/s]."""
        ratio = speed / self.reference
        if self.law is not None:
            system = self.law(system, speed)
        scalars, table = system.scalars.copy(), system.table.copy()
        scalars[REST_RADIAL] += float(self.grown(np.array([speed]))[0])
        scalars[GYROSCOPIC] *= ratio**2
        scalars[CAGE] *= ratio
        table[:, CENTRIFUGAL] *= ratio**2
        if self.shift is not None:
            second = table[:, SIDE] != table[0, SIDE]
            apart = table[second, SHIFT] - table[second, SHIFT][0]
            table[second, SHIFT] = self.shift(np.array([speed]))[0] + apart
        damping = system.damping + (ratio - 1.0) * self.gyroscopic
        return attrs.evolve(system, scalars=scalars, table=table, damping=damping, spin=None)
