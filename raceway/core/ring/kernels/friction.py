"""Coulomb friction of a ball in its meridian plane: both contacts stick on a spring or slide.

Notes
-----
A contact that sticks stores k_t u^2 / 2 with u = L a - slip outside, L a - r turn - slip inside: L is the distance of ball
and groove centre at the first touch, a the contact's angle, r the groove's radius, turn that of the ring's section by its
tilts, the slip is memory.  So tau = k_t u L / s, at most mu f (return mapping), and work is stored or lost, never gained.
A ball does not roll in this plane, so sticking contacts add a tangential stiffness that rolling balls do not have.  The
couple on the section is -r k_t u.
"""

from typing import NamedTuple

import numpy as np
from numba import float64, int64, types, void

from raceway.core.jit import jit
from raceway.core.ring.kernels import tangential_rows as row
from raceway.core.ring.kernels.columns import SLIPS
from raceway.core.ring.kernels.layout import DIAMETER, FRICTION, OFFSET_INNER, OFFSET_OUTER, STICK
from raceway.core.ring.kernels.tangential_rows import CONTACT, CONTACTS
from raceway.core.signatures import MATRIX, VECTOR


class Grip(NamedTuple):
    """Tangential force of a contact [N], its derivatives by angle (zero where it slides), length and shift, and u [m]."""

    force: float
    by_angle: float
    by_length: float
    by_shift: float
    stretch: float


_GRIP = types.NamedUniTuple(float64, 5, Grip)


@jit(_GRIP(CONTACT, float64, float64, float64, float64), inline=True)
def _grip(contact, reach, stretch, mu, stick):
    """The return map: what sticks at the elastic displacement ``stretch``, or slides; reach = L."""
    lever = reach / contact.length if contact.length > 0.0 else 1.0
    tau, limit = stick * stretch * lever, mu * contact.force
    if abs(tau) <= limit:
        return Grip(tau, stick * reach * lever, -tau * lever / reach, 0.0, stretch)
    sign = 1.0 if tau > 0.0 else -1.0
    by_shift = -sign * mu * contact.stiffness
    return Grip(sign * limit, 0.0, -by_shift, by_shift, sign * limit / (stick * lever))


@jit(void(int64, MATRIX), inline=True)
def roll(k, work):
    """No tangential forces of ball k and no couple."""
    z = work.shape[1] // 2
    work[row.TANGENTIAL, k], work[row.BY_ANGLE, k], work[row.BY_LENGTH, k], work[row.BY_SHIFT, k] = 0.0, 0.0, 0.0, 0.0
    o = z + k
    work[row.TANGENTIAL, o], work[row.BY_ANGLE, o], work[row.BY_LENGTH, o], work[row.BY_SHIFT, o] = 0.0, 0.0, 0.0, 0.0
    work[row.COUPLE, k], work[row.COUPLE_BY_ANGLE, k], work[row.COUPLE_BY_TURN, k] = 0.0, 0.0, 0.0
    work[row.BY_TURN, o], work[row.COUPLE_BY_LENGTH, o], work[row.COUPLE_BY_SHIFT, k] = 0.0, 0.0, 0.0


@jit(void(int64, CONTACTS, VECTOR, MATRIX, MATRIX, MATRIX), inline=True)
def rub(k, contacts, scalars, ball, ball_known, work):
    """Tangential forces of ball k by friction, its couple on the ring's section, and its slips in ``ball``."""
    z, mu, stick = work.shape[1] // 2, scalars[FRICTION], scalars[STICK]
    li, lo = scalars[OFFSET_INNER], scalars[OFFSET_OUTER]
    inner, outer = contacts
    at_i = li * np.arctan2(inner.axial, inner.radial) - work[row.TURNED, z + k]
    at_o = lo * np.arctan2(outer.axial, outer.radial)
    gi = _grip(inner, li, at_i - ball_known[k, SLIPS], mu, stick)
    go = _grip(outer, lo, at_o - ball_known[k, SLIPS + 1], mu, stick)
    ball[k, SLIPS], ball[k, SLIPS + 1] = at_i - gi.stretch, at_o - go.stretch
    work[row.TANGENTIAL, k], work[row.TANGENTIAL, z + k] = gi.force, go.force
    work[row.BY_ANGLE, k], work[row.BY_ANGLE, z + k] = gi.by_angle, go.by_angle
    work[row.BY_LENGTH, k], work[row.BY_LENGTH, z + k] = gi.by_length, go.by_length
    work[row.BY_SHIFT, k], work[row.BY_SHIFT, z + k] = gi.by_shift, go.by_shift
    _couple(k, inner, gi, scalars, work)


@jit(void(int64, CONTACT, _GRIP, VECTOR, MATRIX), inline=True)
def _couple(k, contact, grip, scalars, work):
    """What the grip of the inner contact does to the section, and turning the section to the grip."""
    z, stick, reach = work.shape[1] // 2, scalars[STICK], scalars[OFFSET_INNER]
    groove = reach + 0.5 * scalars[DIAMETER]
    lever = reach / contact.length if contact.length > 0.0 else 1.0
    work[row.COUPLE, k] = -groove * stick * grip.stretch
    if grip.by_angle != 0.0:
        work[row.COUPLE_BY_ANGLE, k], work[row.COUPLE_BY_TURN, k] = -groove * stick * reach, groove * groove * stick
        work[row.BY_TURN, z + k], work[row.COUPLE_BY_LENGTH, z + k] = -stick * groove * lever, 0.0
        work[row.COUPLE_BY_SHIFT, k] = 0.0
    else:
        work[row.COUPLE_BY_ANGLE, k], work[row.COUPLE_BY_TURN, k], work[row.BY_TURN, z + k] = 0.0, 0.0, 0.0
        work[row.COUPLE_BY_LENGTH, z + k] = -groove * (grip.by_length / lever + grip.force / reach)
        work[row.COUPLE_BY_SHIFT, k] = -groove * grip.by_shift / lever
