"""Balls with tangential contact forces in their meridian plane: gyroscopic moments, Coulomb friction, or both.

Notes
-----
With n = (sin a, cos a) the direction of a contact at its angle a and t = (cos a, -sin a), the inner race gives a ball
g_i = f_i n_i + (tau_i - T_i) t_i and the outer one takes g_o = f_o n_o + (tau_o - T_o) t_o; g_i - g_o + F_c = 0.

*Gyroscopic*: T = share * M / D with M = J w_R w_c sin(beta).  The ball rolls without spin on the outer race:
tan(beta) = sin(a_o) / (cos(a_o) + D/d_m), and its spin w_R follows from rolling on both races.  M follows the angles,
with derivatives.  The inner race carries no more than its normal force, the outer one the rest: so it fades continuously
where the inner contact opens.

*Friction*: a contact that sticks stores k_t u^2 / 2 with u = L a - slip outside, L a - r turn - slip inside: L is the
distance of ball and groove centre at the first touch, r the groove's radius, turn that of the ring's section by its
tilts, the slip is memory.  So tau = k_t u L / s, at most mu f (return mapping), and work is stored or lost, never
gained.  A ball does not roll in this plane, so sticking contacts add a tangential stiffness that rolling balls do not
have.

Both put the couple -r h on the section of the inner ring (of friction -r k_t u, which belongs to the stored energy).
Gyroscopic moments and sliding have no potential: tangents are not symmetric.

References
----------
Harris & Kotzalas, Advanced Concepts of Bearing Technology, 5th ed., chapters 2 and 3 (control of the outer race).
"""

import numpy as np
from numba import float64, types

from raceway.core.contact.damping import add_damping
from raceway.core.jit import jit
from raceway.core.ring.kernels import (
    AXIAL_BY_SHIFT,
    BY_AXIAL,
    BY_AXIAL_SPEED,
    BY_OTHER,
    BY_OWN,
    BY_RADIAL,
    BY_RADIAL_SPEED,
    BY_TURN,
    COUPLE_BY_CENTRE,
    COUPLE_BY_SHIFT,
    FORCE,
    FORCE_BY_CENTRE,
    FORCE_BY_SPEED,
    FORCE_BY_TURN,
    KERNEL_ROWS,
    RADIAL_BY_SHIFT,
    SHIFT,
    SHIFT_RATE,
    WORK_ROWS,
)
from raceway.core.ring.kernels.layout import (
    BALL_OVER_PITCH,
    CENTRIFUGAL,
    DAMPING,
    DIAMETER,
    FRICTION,
    GYROSCOPIC,
    LEVER,
    OFFSET_INNER,
    OFFSET_OUTER,
    OUTER_FACTOR,
    OUTER_SHARE,
    SHARE_INNER,
    SHARE_OUTER,
    SIDE,
    STICK,
    TILT_ARM,
    move_centres,
    place,
)
from raceway.core.ring.kernels.section import add_ball, add_couple
from raceway.core.signatures import SYSTEM

_ITERATIONS = 300
_PATIENCE = 60
#: Step of the difference quotients of the gyroscopic moment [rad]: their error is of the order 1e-10.
_ANGLE_STEP = 1e-5


@jit(float64(float64, float64, float64, float64))
def gyroscopic_moment(inner, outer, ratio, scale):
    """M [N m] at the contact angles; ratio = D / d_m, scale = J * (inner ring's speed) * w_c."""
    beta = np.arctan2(np.sin(outer), np.cos(outer) + ratio)
    tan_beta = np.tan(beta)
    rolling = (np.cos(outer) + tan_beta * np.sin(outer)) / (1.0 + ratio * np.cos(outer))
    rolling += (np.cos(inner) + tan_beta * np.sin(inner)) / (1.0 - ratio * np.cos(inner))
    return scale * np.sin(beta) / (rolling * ratio * np.cos(beta))


@jit(types.UniTuple(float64, 4)(float64, float64, float64, float64, float64, float64, float64, float64))
def _contact_matrix(k, f, h, h_s, h_a, w, na, nr):
    """(aa, ar, ra, rr) of d(f n + h t)/dx for x = s n: k = df/ds, w = 1/s."""
    ta, tr = nr, -na
    tt, nt = (f + h_a) * w, -h * w
    return (
        k * na * na + nt * na * ta + h_s * ta * na + tt * ta * ta,
        k * na * nr + nt * na * tr + h_s * ta * nr + tt * ta * tr,
        k * nr * na + nt * nr * ta + h_s * tr * na + tt * tr * ta,
        k * nr * nr + nt * nr * tr + h_s * tr * nr + tt * tr * tr,
    )


@jit(SYSTEM)
def rigid_tangential(t, q, v, balls, contacts, constants, response):
    """See ``raceway.core.ring.kernels``; ball (Z, 4): p [m], slips [m]."""
    ball, ball_gain, ball_known = balls
    law, law_params, law_old, law_new, dt = contacts
    scalars, table = constants
    f, K, C, work = response
    z = table.shape[0]
    arm, li, lo, damping = scalars[TILT_ARM], scalars[OFFSET_INNER], scalars[OFFSET_OUTER], scalars[DAMPING]
    mu, stick, diameter = scalars[FRICTION], scalars[STICK], scalars[DIAMETER]
    groove = li + 0.5 * diameter
    gap, rate, force, d_gap, d_rate = work[0], work[1], work[2], work[3], work[4]
    ea, er, va, vr = work[5][:z], work[5][z:], work[6][:z], work[6][z:]
    da, dr, slope, done = work[7][:z], work[7][z:], work[8][:z], work[8][z:]
    ni_a, ni_r, no_a, no_r = work[9][:z], work[9][z:], work[10][:z], work[10][z:]
    si, so = work[11][:z], work[11][z:]
    keep_f, keep_k, keep_c, h, h_s, h_a = work[12], work[13], work[14], work[15], work[17], work[18]
    cosine, sine = work[16][:z], work[16][z:]
    cross_i, cross_o = work[19][:z], work[19][z:]
    couple, m_s, m_a, m_o, m_t, h_t = work[20][:z], work[20][z:], work[21][:z], work[21][z:], work[22][:z], work[22][z:]
    cross_s, merit = work[23][:z], work[23][z:]
    # Derivatives of tangential forces and couple by the bodies' shifts of the gaps.
    h_w, couple_w = work[24], work[25][:z]
    given, given_rate = work[SHIFT], work[SHIFT_RATE]
    elastic_bodies = work.shape[0] > WORK_ROWS
    for i in range(5):
        f[i] = 0.0
        if K.size > 0:
            for j in range(5):
                K[i, j] = 0.0
                C[i, j] = 0.0
    place(t, q, v, scalars, table, work, 16, 5, 6)
    if elastic_bodies:
        move_centres(work, 5, 6)
    remaining = z
    for k in range(z):
        slope[k], merit[k], done[k], da[k], dr[k] = 0.0, np.inf, 0.0, 0.0, 0.0
        centrifugal = table[k, CENTRIFUGAL]
        length = np.sqrt(ea[k] * ea[k] + er[k] * er[k])
        room = li + lo + given[k] + given[z + k]
        if centrifugal == 0.0 and length <= room:
            # Nothing presses this ball on either race: midway, without forces.
            scale = (lo + given[z + k] + 0.5 * (length - room)) / length
            ball[k, 0], ball[k, 1] = scale * ea[k], scale * er[k]
            angle = np.arctan2(ea[k], er[k])
            ball[k, 2] = li * angle - groove * table[k, SIDE] * (q[3] * sine[k] - q[4] * cosine[k])
            ball[k, 3] = lo * angle
            done[k] = 2.0
            remaining -= 1
            continue
        if ball[k, 0] == 0.0 and ball[k, 1] == 0.0 or ball[k, 0] ** 2 + ball[k, 1] ** 2 <= lo * lo:
            if length > li + lo:
                scale = (lo + table[k, OUTER_SHARE] * (length - li - lo)) / length
                ball[k, 0], ball[k, 1] = scale * ea[k], scale * er[k]
            else:
                ball[k, 0], ball[k, 1] = 0.0, lo + (centrifugal / table[k, OUTER_FACTOR]) ** (2.0 / 3.0)
    for attempt in range(_ITERATIONS):
        if attempt == _PATIENCE:
            # Forces without a potential can lead in circles: once more from the seat on the outer race.
            for k in range(z):
                if done[k] == 0.0:
                    ball[k, 0], ball[k, 1] = 0.0, lo + (table[k, CENTRIFUGAL] / table[k, OUTER_FACTOR]) ** (2.0 / 3.0)
                    slope[k], merit[k], da[k], dr[k] = 0.0, np.inf, 0.0, 0.0
        for k in range(z):
            pa, pr = ball[k, 0], ball[k, 1]
            so[k] = np.sqrt(pa * pa + pr * pr)
            xa, xr = ea[k] - pa, er[k] - pr
            si[k] = np.sqrt(xa * xa + xr * xr)
            no_a[k], no_r[k] = pa / so[k], pr / so[k]
            ni_a[k], ni_r[k] = (xa / si[k], xr / si[k]) if si[k] > 0.0 else (no_a[k], no_r[k])
            gap[k], gap[z + k] = li - si[k] + given[k], lo - so[k] + given[z + k]
            own_a, own_r = ball_gain * pa + ball_known[k, 0], ball_gain * pr + ball_known[k, 1]
            rate[k] = -(ni_a[k] * (va[k] - own_a) + ni_r[k] * (vr[k] - own_r))
            rate[z + k] = -(no_a[k] * own_a + no_r[k] * own_r)
            rate[k] += given_rate[k]
            rate[z + k] += given_rate[z + k]
        law(gap, rate, law_params, law_old, law_new, dt, force, d_gap, d_rate)
        add_damping(damping, gap, rate, force, d_gap, d_rate)
        for k in range(z):
            if done[k] != 0.0:
                continue
            # Tangential forces h and their derivatives by the contact's length (h_s) and angle (h_a).
            couple[k], m_s[k], m_a[k], m_o[k], m_t[k], h_t[k], couple_w[k] = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
            for side in range(2):
                c = k + side * z
                h[c], h_s[c], h_a[c], h_w[c] = 0.0, 0.0, 0.0, 0.0
                if mu == 0.0:
                    continue
                if side == 0:
                    turned = groove * table[k, SIDE] * (q[3] * sine[k] - q[4] * cosine[k])
                    reach, length, place_now = li, si[k], li * np.arctan2(ni_a[k], ni_r[k]) - turned
                else:
                    reach, length, place_now = lo, so[k], lo * np.arctan2(no_a[k], no_r[k])
                lever = reach / length if length > 0.0 else 1.0
                u = place_now - ball_known[k, 2 + side]
                tau, limit = stick * u * lever, mu * force[c]
                if abs(tau) <= limit:
                    h[c], h_a[c], h_s[c] = tau, stick * reach * lever, -tau * lever / reach
                    if side == 0:
                        h_t[k] = -stick * groove * lever
                        m_a[k], m_t[k] = -groove * stick * reach, groove * groove * stick
                else:
                    sign = 1.0 if tau > 0.0 else -1.0
                    h[c] = sign * limit
                    h_w[c] = sign * mu * (d_gap[c] + ball_gain * d_rate[c])
                    h_s[c] = -h_w[c]
                    u = h[c] / (stick * lever)
                    if side == 0:
                        m_s[k] = -groove * (h_s[c] / lever + h[c] / reach)
                        couple_w[k] = -groove * h_w[c] / lever
                ball[k, 2 + side] = place_now - u
                if side == 0:
                    couple[k] = -groove * stick * u
            cross_i[k], cross_o[k], cross_s[k] = 0.0, 0.0, 0.0
            if scalars[GYROSCOPIC] != 0.0:
                inner, outer = np.arctan2(ni_a[k], ni_r[k]), np.arctan2(no_a[k], no_r[k])
                share_i, share_o = scalars[SHARE_INNER] / diameter, scalars[SHARE_OUTER] / diameter
                ratio, scale = scalars[BALL_OVER_PITCH], scalars[GYROSCOPIC]
                moment = gyroscopic_moment(inner, outer, ratio, scale)
                by_i = gyroscopic_moment(inner + _ANGLE_STEP, outer, ratio, scale)
                by_i = (by_i - gyroscopic_moment(inner - _ANGLE_STEP, outer, ratio, scale)) / (2.0 * _ANGLE_STEP)
                by_o = gyroscopic_moment(inner, outer + _ANGLE_STEP, ratio, scale)
                by_o = (by_o - gyroscopic_moment(inner, outer - _ANGLE_STEP, ratio, scale)) / (2.0 * _ANGLE_STEP)
                carried, grows = share_i * moment, 0.0
                if abs(carried) > force[k]:
                    # No more than the normal force; the outer race takes the rest.
                    sign = 1.0 if moment > 0.0 else -1.0
                    carried, grows = sign * force[k], -sign * (d_gap[k] + ball_gain * d_rate[k])
                    share_i, share_o = 0.0, 2.0 / diameter
                    h[z + k] += carried
                h[k] -= carried
                h_s[k] -= grows
                h_w[k] += grows
                couple_w[k] -= groove * grows
                h_a[k] -= share_i * by_i
                h[z + k] -= share_o * moment
                h_a[z + k] -= share_o * by_o
                cross_i[k], cross_o[k], cross_s[k] = -share_i * by_o, -share_o * by_i, grows
                couple[k] += groove * carried
                m_s[k] += groove * grows
                m_a[k] += groove * share_i * by_i
                m_o[k] = groove * share_i * by_o
            fi, fo = force[k], force[z + k]
            ti_a, ti_r, to_a, to_r = ni_r[k], -ni_a[k], no_r[k], -no_a[k]
            ra = fi * ni_a[k] + h[k] * ti_a - fo * no_a[k] - h[z + k] * to_a
            rr = fi * ni_r[k] + h[k] * ti_r - fo * no_r[k] - h[z + k] * to_r + table[k, CENTRIFUGAL]
            size = np.sqrt(ra * ra + rr * rr)
            beyond = slope[k] > 0.0 and -(ra * da[k] + rr * dr[k]) > 0.9 * slope[k]
            if attempt > 2 * _PATIENCE and np.sqrt(da[k] * da[k] + dr[k] * dr[k]) > 1e-13:
                # That failed too: descend at every step instead.
                beyond = size > 0.9999 * merit[k]
            if beyond:
                # Beyond the balance along the last step by more than it began with: go half-way back.
                da[k] *= 0.5
                dr[k] *= 0.5
                slope[k] *= 0.5
                ball[k, 0] -= da[k]
                ball[k, 1] -= dr[k]
                continue
            ki, ko = -d_gap[k] - ball_gain * d_rate[k], -d_gap[z + k] - ball_gain * d_rate[z + k]
            merit[k] = size
            wi, wo = (1.0 / si[k] if si[k] > 0.0 else 0.0), 1.0 / so[k]
            oi_a = cross_o[k] * ti_a * wi + cross_s[k] * ni_a[k]
            oi_r = cross_o[k] * ti_r * wi + cross_s[k] * ni_r[k]
            # dR/dp = -G_i - G_o + cross terms through the moment's dependence on both angles.
            haa, har, hra, hrr = _contact_matrix(ki, fi, h[k], h_s[k], h_a[k], wi, ni_a[k], ni_r[k])
            oaa, oar, ora, orr = _contact_matrix(ko, fo, h[z + k], h_s[z + k], h_a[z + k], wo, no_a[k], no_r[k])
            jaa = -haa - oaa + cross_i[k] * ti_a * to_a * wo + to_a * oi_a
            jar = -har - oar + cross_i[k] * ti_a * to_r * wo + to_a * oi_r
            jra = -hra - ora + cross_i[k] * ti_r * to_a * wo + to_r * oi_a
            jrr = -hrr - orr + cross_i[k] * ti_r * to_r * wo + to_r * oi_r
            det = jaa * jrr - jar * jra
            if not abs(det) > 1e-14 * (jaa + jrr) ** 2:
                shift = -1e-7 * abs(jaa + jrr) - 1.0
                jaa += shift
                jrr += shift
                det = jaa * jrr - jar * jra
            sa, sr = -(jrr * ra - jar * rr) / det, -(jaa * rr - jra * ra) / det
            size = np.sqrt(sa * sa + sr * sr)
            reach = 0.2 * lo
            if size > reach:
                sa *= reach / size
                sr *= reach / size
            ball[k, 0] += sa
            ball[k, 1] += sr
            da[k], dr[k] = sa, sr
            slope[k] = ra * sa + rr * sr
            if size <= 1e-10 * max(-gap[k], -gap[z + k], 1e-12):
                # What this step leaves is of second order; forces and tangents are kept from before it.
                keep_f[k], keep_f[z + k] = fi, fo
                keep_k[k], keep_k[z + k] = d_gap[k], d_gap[z + k]
                keep_c[k], keep_c[z + k] = d_rate[k], d_rate[z + k]
                done[k] = 1.0
                remaining -= 1
        if remaining == 0:
            break
    if remaining > 0:
        return 1
    for k in range(z):
        if elastic_bodies:
            for row in range(WORK_ROWS, WORK_ROWS + KERNEL_ROWS):
                work[row, k], work[row, z + k] = 0.0, 0.0
        if done[k] == 2.0:
            force[k], force[z + k] = 0.0, 0.0
            continue
        fi, fo = keep_f[k], keep_f[z + k]
        force[k], force[z + k] = fi, fo
        if fi == 0.0 and keep_k[k] == 0.0:
            continue
        ti_a, ti_r, to_a, to_r = ni_r[k], -ni_a[k], no_r[k], -no_a[k]
        elastic, viscous = -keep_k[k], -keep_c[k]
        ki, ko = elastic + ball_gain * viscous, -keep_k[z + k] - ball_gain * keep_c[z + k]
        wi, wo = 1.0 / si[k], 1.0 / so[k]
        # Outer tangential force by the inner contact's angle and length.
        oi_a, oi_r = cross_o[k] * ti_a * wi + cross_s[k] * ni_a[k], cross_o[k] * ti_r * wi + cross_s[k] * ni_r[k]
        eaa, ear, era, err = _contact_matrix(elastic, fi, h[k], h_s[k], h_a[k], wi, ni_a[k], ni_r[k])
        paa, par, pra, prr = _contact_matrix(ki, fi, h[k], h_s[k], h_a[k], wi, ni_a[k], ni_r[k])
        oaa, oar, ora, orr = _contact_matrix(ko, fo, h[z + k], h_s[z + k], h_a[z + k], wo, no_a[k], no_r[k])
        # Ring force by the ball's place (P), imbalance by the ball's place (J) and by the ring's motion (E).
        paa, par = -paa + cross_i[k] * ti_a * to_a * wo, -par + cross_i[k] * ti_a * to_r * wo
        pra, prr = -pra + cross_i[k] * ti_r * to_a * wo, -prr + cross_i[k] * ti_r * to_r * wo
        jaa, jar = paa - oaa + to_a * oi_a, par - oar + to_a * oi_r
        jra, jrr = pra - ora + to_r * oi_a, prr - orr + to_r * oi_r
        xaa, xar = eaa - to_a * oi_a, ear - to_a * oi_r
        xra, xrr = era - to_r * oi_a, err - to_r * oi_r
        det = jaa * jrr - jar * jra
        if det == 0.0:
            return 1
        taa, tar = (paa * jrr - par * jra) / det, (par * jaa - paa * jar) / det
        tra, trr = (pra * jrr - prr * jra) / det, (prr * jaa - pra * jar) / det
        # The couple by e (ca, cr) and by the ball's place (ba, br); turning the section moves both forces alike.
        ca = m_s[k] * ni_a[k] + m_a[k] * wi * ti_a
        cr = m_s[k] * ni_r[k] + m_a[k] * wi * ti_r
        ba, br = m_o[k] * wo * to_a - ca, m_o[k] * wo * to_r - cr
        ua, ur = (ba * jrr - br * jra) / det, (br * jaa - ba * jar) / det
        ha, hr = h_t[k] * ti_a, h_t[k] * ti_r
        add_couple(
            cosine[k], sine[k], arm, table[k, SIDE], table[k, LEVER], couple[k],
            ha - taa * ha - tar * hr, hr - tra * ha - trr * hr,
            ca - ua * xaa - ur * xra, cr - ua * xar - ur * xrr, m_t[k] - ua * ha - ur * hr, f, K,
        )  # fmt: skip
        maa, mar, mrr = viscous * ni_a[k] ** 2, viscous * ni_a[k] * ni_r[k], viscous * ni_r[k] ** 2
        if elastic_bodies:
            # dp = -J^-1 (dR/de de + dR/dw dw + dR/dturn dturn);  rows g = dQ/dp J^-1 of both contacts.
            gia, gir = -ki * (ni_a[k] * jrr - ni_r[k] * jra) / det, -ki * (ni_r[k] * jaa - ni_a[k] * jar) / det
            goa, gor = ko * (no_a[k] * jrr - no_r[k] * jra) / det, ko * (no_r[k] * jaa - no_a[k] * jar) / det
            work[BY_AXIAL, k] = elastic * ni_a[k] - gia * xaa - gir * xra
            work[BY_RADIAL, k] = elastic * ni_r[k] - gia * xar - gir * xrr
            work[BY_AXIAL, z + k], work[BY_RADIAL, z + k] = -goa * xaa - gor * xra, -goa * xar - gor * xrr
            work[BY_AXIAL_SPEED, k] = viscous * ni_a[k] - gia * maa - gir * mar
            work[BY_RADIAL_SPEED, k] = viscous * ni_r[k] - gia * mar - gir * mrr
            work[BY_AXIAL_SPEED, z + k], work[BY_RADIAL_SPEED, z + k] = -goa * maa - gor * mar, -goa * mar - gor * mrr
            fia, fir = -ki * ni_a[k] + h_w[k] * ti_a, -ki * ni_r[k] + h_w[k] * ti_r
            wia, wir = fia + cross_s[k] * to_a, fir + cross_s[k] * to_r
            woa, wor = ko * no_a[k] - h_w[z + k] * to_a, ko * no_r[k] - h_w[z + k] * to_r
            work[BY_OWN, k], work[BY_OTHER, k] = -ki - gia * wia - gir * wir, -gia * woa - gir * wor
            work[BY_OTHER, z + k], work[BY_OWN, z + k] = -goa * wia - gor * wir, -ko - goa * woa - gor * wor
            work[BY_TURN, k], work[BY_TURN, z + k] = -gia * ha - gir * hr, -goa * ha - gor * hr
            work[AXIAL_BY_SHIFT, k], work[RADIAL_BY_SHIFT, k] = fia - taa * wia - tar * wir, fir - tra * wia - trr * wir
            work[AXIAL_BY_SHIFT, z + k] = -taa * woa - tar * wor
            work[RADIAL_BY_SHIFT, z + k] = -tra * woa - trr * wor
            work[COUPLE_BY_SHIFT, k] = couple_w[k] - ua * wia - ur * wir
            work[COUPLE_BY_SHIFT, z + k] = -ua * woa - ur * wor
            work[FORCE_BY_CENTRE, k], work[FORCE_BY_CENTRE, z + k] = eaa - taa * xaa - tar * xra, ear - taa * xar - tar * xrr
            work[FORCE_BY_CENTRE + 1, k] = era - tra * xaa - trr * xra
            work[FORCE_BY_CENTRE + 1, z + k] = err - tra * xar - trr * xrr
            work[FORCE_BY_SPEED, k], work[FORCE_BY_SPEED, z + k] = maa - taa * maa - tar * mar, mar - taa * mar - tar * mrr
            work[FORCE_BY_SPEED + 1, k] = mar - tra * maa - trr * mar
            work[FORCE_BY_SPEED + 1, z + k] = mrr - tra * mar - trr * mrr
            work[FORCE_BY_TURN, k], work[FORCE_BY_TURN, z + k] = ha - taa * ha - tar * hr, hr - tra * ha - trr * hr
            work[COUPLE_BY_CENTRE, k], work[COUPLE_BY_CENTRE, z + k] = ca - ua * xaa - ur * xra, cr - ua * xar - ur * xrr
            work[FORCE, k], work[FORCE, z + k] = fi * ni_a[k] + h[k] * ti_a, fi * ni_r[k] + h[k] * ti_r
        add_ball(
            cosine[k], sine[k], arm, table[k, SIDE], table[k, LEVER],
            fi * ni_a[k] + h[k] * ti_a, fi * ni_r[k] + h[k] * ti_r,
            eaa - taa * xaa - tar * xra, ear - taa * xar - tar * xrr,
            era - tra * xaa - trr * xra, err - tra * xar - trr * xrr,
            maa - taa * maa - tar * mar, mar - taa * mar - tar * mrr,
            mar - tra * maa - trr * mar, mrr - tra * mar - trr * mrr, f, K, C,
        )  # fmt: skip
    return 0
