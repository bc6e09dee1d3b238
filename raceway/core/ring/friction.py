"""Energy that Coulomb friction stores and loses along a recorded motion.

Notes
-----
A contact with the elastic tangential displacement u (``raceway.core.ring.kernels.rigid_tangential``) stores k u^2 / 2.  A step
in which its slip grows by d loses k u d with the u at the step's end: the return mapping lets the slip grow only along
u, so no step of a record that keeps every step can give energy.
"""

from __future__ import annotations

import attrs
import numpy as np

from raceway.core.ring.kernels.layout import (
    CAGE,
    COSINE,
    DIAMETER,
    LEVER,
    OFFSET_INNER,
    OFFSET_OUTER,
    REST_AXIAL,
    REST_RADIAL,
    SHIFT,
    SIDE,
    SINE,
    STICK,
    TILT_ARM,
)
from raceway.core.ring.system import System
from raceway.core.stepping.record import Record


@attrs.frozen(eq=False)
class FrictionEnergy:
    """Energies (n,) [J] of all contacts at each sample: stored by sticking, and lost since the first sample."""

    stored: np.ndarray
    lost: np.ndarray


def friction_energy(system: System, record: Record) -> FrictionEnergy:
    """Energies of friction along a record; zeros where the system has none."""
    n = len(record.time)
    if system.conservative or system.scalars[STICK] == 0.0:
        return FrictionEnergy(np.zeros(n), np.zeros(n))
    slip = record.ball[:, :, 2:4]
    force = system.scalars[STICK] * (_place(system, record) - slip)
    lost = np.zeros(n)
    lost[1:] = np.cumsum((force[1:] * np.diff(slip, axis=0)).sum(axis=(1, 2)))
    return FrictionEnergy(0.5 * (force**2).sum(axis=(1, 2)) / system.scalars[STICK], lost)


def _place(system: System, record: Record) -> np.ndarray:
    """(n, Z, 2) tangential place of the inner and the outer contact [m]; the slip is the place at which nothing pulls."""
    scalars, table = system.scalars, system.table
    travelled, rest = scalars[CAGE] * record.time, scalars[REST_RADIAL]
    if system.spin is not None:
        travelled = system.spin.cage_angle(scalars[CAGE], record.time)
        rest = rest + system.spin.grown(system.spin.speed(record.time))[:, None]
    azimuth = np.arctan2(table[:, SINE], table[:, COSINE]) + travelled[:, None]
    c, s = np.cos(azimuth), np.sin(azimuth)
    shift = np.broadcast_to(table[:, SHIFT], azimuth.shape)
    if system.spin is not None and system.spin.shift is not None:
        second = table[:, SIDE] != table[0, SIDE]
        apart = table[:, SHIFT] - table[second, SHIFT][0]
        shift = np.where(second, system.spin.shift(system.spin.speed(record.time))[:, None] + apart, shift)
    x, y, z, tilt_y, tilt_z = (record.displacement[:, k, None] for k in range(5))
    side, lever = table[:, SIDE], table[:, LEVER]
    turn = side * (tilt_y * s - tilt_z * c)
    axial = scalars[REST_AXIAL] + shift + side * x + scalars[TILT_ARM] * turn
    radial = rest + (y + lever * tilt_z) * c + (z - lever * tilt_y) * s
    p, moved = record.ball, system.groove_displacement(record.ball)
    groove = scalars[OFFSET_INNER] + 0.5 * scalars[DIAMETER]
    inner = (
        scalars[OFFSET_INNER] * np.arctan2(axial + moved[:, :, 0] - p[:, :, 0], radial + moved[:, :, 1] - p[:, :, 1])
        - groove * turn
    )
    outer = scalars[OFFSET_OUTER] * np.arctan2(p[:, :, 0], p[:, :, 1])
    return np.stack([inner, outer], axis=2)
