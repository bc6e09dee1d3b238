"""Gyroscopic moment of a ball that rolls without spin on the outer race, and what both contacts carry of it.

Notes
-----
T = share * M / D with M = J w_R w_c sin(beta), tan(beta) = sin(a_o) / (cos(a_o) + D/d_m); the ball's spin w_R follows from
rolling on both races.  M follows the contact angles a, with derivatives.  The inner race carries no more than its normal
force, the outer one the rest: so it fades continuously where the inner contact opens.

References
----------
Harris & Kotzalas, Advanced Concepts of Bearing Technology, 5th ed., chapters 2 and 3 (control of the outer race).
"""

from typing import NamedTuple

import numpy as np
from numba import float64, int64, types, void

from raceway.core.jit import jit
from raceway.core.ring.kernels import tangential_rows as row
from raceway.core.ring.kernels.layout import (
    BALL_OVER_PITCH,
    DIAMETER,
    GYROSCOPIC,
    OFFSET_INNER,
    SHARE_INNER,
    SHARE_OUTER,
)
from raceway.core.ring.kernels.tangential_rows import CONTACTS
from raceway.core.signatures import MATRIX, VECTOR

#: Step of the difference quotients of the moment [rad]: their error is of the order 1e-10.
_ANGLE_STEP = 1e-5


class Rolling(NamedTuple):
    """A ball that rolls without spin on the outer race: its axis beta, and that race's part of the speeds' ratio."""

    tangent: float
    sine: float
    cosine: float
    outer: float


_ROLLING = types.NamedUniTuple(float64, 4, Rolling)


@jit(_ROLLING(float64, float64), inline=True)
def _rolling(outer, ratio):
    """At the outer contact angle."""
    sine, cosine = np.sin(outer), np.cos(outer)
    beta = np.arctan2(sine, cosine + ratio)
    tangent = np.tan(beta)
    return Rolling(tangent, np.sin(beta), np.cos(beta), (cosine + tangent * sine) / (1.0 + ratio * cosine))


@jit(float64(float64, _ROLLING, float64, float64), inline=True)
def _moment(inner, ball, ratio, scale):
    """M [N m] at the inner contact angle."""
    cosine = np.cos(inner)
    rolling = ball.outer + (cosine + ball.tangent * np.sin(inner)) / (1.0 - ratio * cosine)
    return scale * ball.sine / (rolling * ratio * ball.cosine)


@jit(float64(float64, float64, float64, float64))
def gyroscopic_moment(inner, outer, ratio, scale):
    """M [N m] at the contact angles; ratio = D / d_m, scale = J * (inner ring's speed) * w_c."""
    return _moment(inner, _rolling(outer, ratio), ratio, scale)


@jit(void(int64, CONTACTS, VECTOR, MATRIX), inline=True)
def add_gyroscopic(k, contacts, scalars, work):
    """Add what ball k's moment does to its tangential forces and to the couple on the ring's section."""
    z = work.shape[1] // 2
    diameter, ratio, scale = scalars[DIAMETER], scalars[BALL_OVER_PITCH], scalars[GYROSCOPIC]
    groove = scalars[OFFSET_INNER] + 0.5 * diameter
    force, stiffness = contacts[0].force, contacts[0].stiffness
    inner, outer = np.arctan2(contacts[0].axial, contacts[0].radial), np.arctan2(contacts[1].axial, contacts[1].radial)
    share_i, share_o = scalars[SHARE_INNER] / diameter, scalars[SHARE_OUTER] / diameter
    here, step = _rolling(outer, ratio), _ANGLE_STEP
    moment = _moment(inner, here, ratio, scale)
    by_i = (_moment(inner + step, here, ratio, scale) - _moment(inner - step, here, ratio, scale)) / (2.0 * step)
    by_o = _moment(inner, _rolling(outer + step, ratio), ratio, scale)
    by_o = (by_o - _moment(inner, _rolling(outer - step, ratio), ratio, scale)) / (2.0 * step)
    carried, grows = share_i * moment, 0.0
    if abs(carried) > force:
        # No more than the normal force; the outer race takes the rest.
        sign = 1.0 if moment > 0.0 else -1.0
        carried, grows = sign * force, sign * stiffness
        share_i, share_o = 0.0, 2.0 / diameter
        work[row.TANGENTIAL, z + k] += carried
    work[row.TANGENTIAL, k] -= carried
    work[row.BY_LENGTH, k] -= grows
    work[row.BY_SHIFT, k] += grows
    work[row.COUPLE_BY_SHIFT, k] -= groove * grows
    work[row.BY_ANGLE, k] -= share_i * by_i
    work[row.TANGENTIAL, z + k] -= share_o * moment
    work[row.BY_ANGLE, z + k] -= share_o * by_o
    work[row.BY_OTHER_ANGLE, k], work[row.BY_OTHER_ANGLE, z + k] = -share_i * by_o, -share_o * by_i
    work[row.OUTER_BY_INNER_LENGTH, k] = grows
    work[row.COUPLE, k] += groove * carried
    work[row.COUPLE_BY_LENGTH, z + k] += groove * grows
    work[row.COUPLE_BY_ANGLE, k] += groove * share_i * by_i
    work[row.COUPLE_BY_ANGLE, z + k] = groove * share_i * by_o
