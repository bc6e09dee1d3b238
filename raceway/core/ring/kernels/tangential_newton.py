"""Where a ball with tangential forces finds its balance: first guess, contacts, Newton's method and what keeps it safe.

Notes
-----
With n = (sin a, cos a) the direction of a contact at its angle a and t = (cos a, -sin a), the imbalance of a ball at p is
R = f_i n_i + h_i t_i - f_o n_o - h_o t_o + F_c.  It has no potential: a step that goes beyond the balance is halved, balls
that run in circles begin anew, and those that fail again have to come closer at every step.
"""

import numpy as np
from numba import boolean, float64, int64, void

from raceway.core.jit import jit
from raceway.core.ring.kernels import (
    FORCE_BY_GAP,
    FORCE_BY_RATE,
    GAP,
    GAP_RATE,
    SHIFT,
    SHIFT_RATE,
)
from raceway.core.ring.kernels import tangential_rows as row
from raceway.core.ring.kernels.columns import SLIPS
from raceway.core.ring.kernels.layout import (
    CENTRIFUGAL,
    DIAMETER,
    OFFSET_INNER,
    OFFSET_OUTER,
    OUTER_FACTOR,
    OUTER_SHARE,
    SIDE,
)
from raceway.core.ring.kernels.planar import PAIR, TENSOR, Pair, Tensor
from raceway.core.ring.kernels.tangential_rows import CONTACT, CONTACTS
from raceway.core.signatures import MATRIX, VECTOR

#: Steps after which a ball begins anew; after twice as many its imbalance has to shrink at every step.
PATIENCE = 60


@jit(boolean(int64, VECTOR, VECTOR, MATRIX, MATRIX, MATRIX), inline=True)
def first_guess(k, q, scalars, table, ball, work):
    """Begin with ball k; False where nothing presses it on either race: it then lies midway, without forces."""
    z = table.shape[0]
    li, lo = scalars[OFFSET_INNER], scalars[OFFSET_OUTER]
    ea, er, shift = work[row.CENTRE, k], work[row.CENTRE, z + k], work[SHIFT, z + k]
    turn = q[3] * work[row.DIRECTION, z + k] - q[4] * work[row.DIRECTION, k]
    turned = (li + 0.5 * scalars[DIAMETER]) * table[k, SIDE] * turn
    length = np.sqrt(ea * ea + er * er)
    room = li + lo + work[SHIFT, k] + shift
    work[row.TURNED, z + k] = turned
    work[row.SLOPE, k], work[row.STATE, z + k], work[row.MERIT, z + k] = 0.0, row.MOVES, np.inf
    work[row.STEP, k], work[row.STEP, z + k] = 0.0, 0.0
    # Of gyroscopic moments alone.
    work[row.BY_OTHER_ANGLE, k], work[row.BY_OTHER_ANGLE, z + k] = 0.0, 0.0
    work[row.COUPLE_BY_ANGLE, z + k], work[row.OUTER_BY_INNER_LENGTH, k] = 0.0, 0.0
    if table[k, CENTRIFUGAL] == 0.0 and length <= room:
        scale, angle = (lo + shift + 0.5 * (length - room)) / length, np.arctan2(ea, er)
        ball[k, 0], ball[k, 1] = scale * ea, scale * er
        ball[k, SLIPS], ball[k, SLIPS + 1] = li * angle - turned, lo * angle
        work[row.STATE, z + k] = row.LOOSE
        return False
    if ball[k, 0] == 0.0 and ball[k, 1] == 0.0 or ball[k, 0] ** 2 + ball[k, 1] ** 2 <= lo * lo:
        if length > li + lo:
            scale = (lo + table[k, OUTER_SHARE] * (length - li - lo)) / length
            ball[k, 0], ball[k, 1] = scale * ea, scale * er
        else:
            seat_outside(k, scalars, table, ball, work)
    return True


@jit(void(int64, VECTOR, MATRIX, MATRIX, MATRIX))
def seat_outside(k, scalars, table, ball, work):
    """Put ball k where its centrifugal force alone holds it, on the outer race, and forget its steps."""
    z = table.shape[0]
    depth = (table[k, CENTRIFUGAL] / table[k, OUTER_FACTOR]) ** (2.0 / 3.0)
    ball[k, 0], ball[k, 1] = 0.0, scalars[OFFSET_OUTER] + depth
    work[row.SLOPE, k], work[row.MERIT, z + k] = 0.0, np.inf
    work[row.STEP, k], work[row.STEP, z + k] = 0.0, 0.0


@jit(void(int64, VECTOR, MATRIX, float64, MATRIX, MATRIX), inline=True)
def approach(k, scalars, ball, ball_gain, ball_known, work):
    """Directions, lengths, gaps and gap rates of both contacts of ball k."""
    z = ball.shape[0]
    pa, pr = ball[k, 0], ball[k, 1]
    xa, xr = work[row.CENTRE, k] - pa, work[row.CENTRE, z + k] - pr
    so, si = np.sqrt(pa * pa + pr * pr), np.sqrt(xa * xa + xr * xr)
    no_a, no_r = pa / so, pr / so
    ni_a, ni_r = (xa / si, xr / si) if si > 0.0 else (no_a, no_r)
    own_a, own_r = ball_gain * pa + ball_known[k, 0], ball_gain * pr + ball_known[k, 1]
    rate_i = -(ni_a * (work[row.VELOCITY, k] - own_a) + ni_r * (work[row.VELOCITY, z + k] - own_r))
    rate_o = -(no_a * own_a + no_r * own_r)
    gap_i, gap_o = scalars[OFFSET_INNER] - si + work[SHIFT, k], scalars[OFFSET_OUTER] - so + work[SHIFT, z + k]
    rate_i, rate_o = rate_i + work[SHIFT_RATE, k], rate_o + work[SHIFT_RATE, z + k]
    work[row.LENGTH, k], work[row.LENGTH, z + k] = si, so
    work[row.INNER, k], work[row.INNER, z + k] = ni_a, ni_r
    work[row.OUTER, k], work[row.OUTER, z + k] = no_a, no_r
    work[GAP, k], work[GAP, z + k], work[GAP_RATE, k], work[GAP_RATE, z + k] = gap_i, gap_o, rate_i, rate_o


@jit(TENSOR(CONTACT, int64, MATRIX), inline=True)
def contact_matrix(contact, c, work):
    """d(f n + h t)/dx of contact c for x = s n."""
    k, f = contact.stiffness, contact.force
    h, h_s, h_a = work[row.TANGENTIAL, c], work[row.BY_LENGTH, c], work[row.BY_ANGLE, c]
    w = 1.0 / contact.length if contact.length > 0.0 else 0.0
    na, nr = contact.axial, contact.radial
    ta, tr = nr, -na
    tt, nt = (f + h_a) * w, -h * w
    return Tensor(
        k * na * na + nt * na * ta + h_s * ta * na + tt * ta * ta,
        k * na * nr + nt * na * tr + h_s * ta * nr + tt * ta * tr,
        k * nr * na + nt * nr * ta + h_s * tr * na + tt * tr * ta,
        k * nr * nr + nt * nr * tr + h_s * tr * nr + tt * tr * tr,
    )


@jit(PAIR(int64, CONTACTS, float64, float64, float64, MATRIX), inline=True)
def _newton_step(k, contacts, ra, rr, longest, work):
    """-J^-1 R [m], regular where J is not, and no longer than ``longest``.

    Notes
    -----
    J = dR/dp = -G_i - G_o + cross terms through the moment's dependence on both angles.
    """
    z = work.shape[1] // 2
    inner, outer = contacts
    ti_a, ti_r, to_a, to_r = inner.radial, -inner.axial, outer.radial, -outer.axial
    wi, wo = (1.0 / inner.length if inner.length > 0.0 else 0.0), 1.0 / outer.length
    cross_i, cross_o = work[row.BY_OTHER_ANGLE, k], work[row.BY_OTHER_ANGLE, z + k]
    grows = work[row.OUTER_BY_INNER_LENGTH, k]
    oi_a, oi_r = cross_o * ti_a * wi + grows * inner.axial, cross_o * ti_r * wi + grows * inner.radial
    gi, go = contact_matrix(inner, k, work), contact_matrix(outer, z + k, work)
    jaa = -gi.aa - go.aa + cross_i * ti_a * to_a * wo + to_a * oi_a
    jar = -gi.ar - go.ar + cross_i * ti_a * to_r * wo + to_a * oi_r
    jra = -gi.ra - go.ra + cross_i * ti_r * to_a * wo + to_r * oi_a
    jrr = -gi.rr - go.rr + cross_i * ti_r * to_r * wo + to_r * oi_r
    det = jaa * jrr - jar * jra
    if not abs(det) > 1e-14 * (jaa + jrr) ** 2:
        shift = -1e-7 * abs(jaa + jrr) - 1.0
        jaa += shift
        jrr += shift
        det = jaa * jrr - jar * jra
    axial, radial = -(jrr * ra - jar * rr) / det, -(jaa * rr - jra * ra) / det
    size = np.sqrt(axial * axial + radial * radial)
    scale = longest / size if size > longest else 1.0
    return Pair(axial * scale, radial * scale)


@jit(boolean(int64, int64, CONTACTS, float64, MATRIX, MATRIX, MATRIX), inline=True)
def settles(k, attempt, contacts, lo, table, ball, work):
    """Move ball k by one step; whether that was the last one, small enough to leave nothing but second order."""
    z = table.shape[0]
    inner, outer = contacts
    hi, ho = work[row.TANGENTIAL, k], work[row.TANGENTIAL, z + k]
    ra = inner.force * inner.axial + hi * inner.radial - outer.force * outer.axial - ho * outer.radial
    rr = inner.force * inner.radial - hi * inner.axial - outer.force * outer.radial + ho * outer.axial
    rr += table[k, CENTRIFUGAL]
    size = np.sqrt(ra * ra + rr * rr)
    da, dr, slope = work[row.STEP, k], work[row.STEP, z + k], work[row.SLOPE, k]
    too_far = slope > 0.0 and -(ra * da + rr * dr) > 0.9 * slope
    if attempt > 2 * PATIENCE and np.sqrt(da * da + dr * dr) > 1e-13:
        # Twice in circles: descend at every step instead.
        too_far = size > 0.9999 * work[row.MERIT, z + k]
    if too_far:
        # Beyond the balance along the last step by more than it began with: go half-way back.
        da, dr = 0.5 * da, 0.5 * dr
        work[row.STEP, k], work[row.STEP, z + k], work[row.SLOPE, k] = da, dr, 0.5 * slope
        ball[k, 0] -= da
        ball[k, 1] -= dr
        return False
    da, dr = _newton_step(k, contacts, ra, rr, 0.2 * lo, work)
    ball[k, 0] += da
    ball[k, 1] += dr
    work[row.STEP, k], work[row.STEP, z + k], work[row.SLOPE, k] = da, dr, ra * da + rr * dr
    work[row.MERIT, z + k] = size
    if not np.sqrt(da * da + dr * dr) <= 1e-10 * max(-work[GAP, k], -work[GAP, z + k], 1e-12):
        return False
    # Forces and tangents are kept from before this step, which ``add_settled`` adds to the forces.
    work[row.KEPT_FORCE, k], work[row.KEPT_FORCE, z + k] = inner.force, outer.force
    work[row.KEPT_BY_GAP, k], work[row.KEPT_BY_GAP, z + k] = work[FORCE_BY_GAP, k], work[FORCE_BY_GAP, z + k]
    work[row.KEPT_BY_RATE, k], work[row.KEPT_BY_RATE, z + k] = work[FORCE_BY_RATE, k], work[FORCE_BY_RATE, z + k]
    work[row.STATE, z + k] = row.SETTLED
    return True
