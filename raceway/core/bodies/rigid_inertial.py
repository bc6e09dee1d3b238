"""Rigid rings and balls with centrifugal force: each ball centre finds its place in its meridian plane.

Notes
-----
The ball centre p (axial, radial, from the outer groove centre) minimises the convex potential
U_i(|e - p| - L_i) + U_o(|p| - L_o) - F_c p_radial; a damped Newton iteration finds it for all balls at once.  The
ring's tangent is A - A H^-1 A with A the inner contact's and H = A + B both contacts' 2x2 stiffness.  The ball's own
acceleration in its meridian plane is left out: its slowest mode, along the groove, lies at some kHz.
"""

import numpy as np

from raceway.core.bodies.ring import (
    CENTRIFUGAL,
    DAMPING,
    LEVER,
    OFFSET_INNER,
    OFFSET_OUTER,
    OUTER_FACTOR,
    OUTER_SHARE,
    SIDE,
    TILT_ARM,
    add_ball,
    place,
)
from raceway.core.contact import add_damping
from raceway.core.jit import jit
from raceway.core.signatures import SYSTEM

_ITERATIONS = 200


@jit(SYSTEM)
def rigid_inertial(
    t, dt, q, v, ball, ball_gain, ball_known, law, law_params, law_old, law_new, scalars, table, work, f, K, C
):
    """See ``raceway.core.bodies``; ball (Z, 2) holds p [m]; a row of zeros asks for a first guess."""
    z = table.shape[0]
    arm, li, lo, damping = scalars[TILT_ARM], scalars[OFFSET_INNER], scalars[OFFSET_OUTER], scalars[DAMPING]
    gap, rate, force, d_gap, d_rate = work[0], work[1], work[2], work[3], work[4]
    ea, er, va, vr = work[5][:z], work[5][z:], work[6][:z], work[6][z:]
    da, dr, slope, done = work[7][:z], work[7][z:], work[8][:z], work[8][z:]
    ni_a, ni_r, no_a, no_r = work[9][:z], work[9][z:], work[10][:z], work[10][z:]
    si, so = work[11][:z], work[11][z:]
    cosine, sine = work[16][:z], work[16][z:]
    for i in range(5):
        f[i] = 0.0
        for j in range(5):
            K[i, j] = 0.0
            C[i, j] = 0.0
    place(t, q, v, scalars, table, ea, er, va, vr, cosine, sine)
    for k in range(z):
        slope[k] = 0.0
        done[k] = 0.0
        seat = lo + (table[k, CENTRIFUGAL] / table[k, OUTER_FACTOR]) ** (2.0 / 3.0)
        if ball[k, 0] == 0.0 and ball[k, 1] == 0.0:
            length = np.sqrt(ea[k] * ea[k] + er[k] * er[k])
            if length > li + lo:
                scale = (lo + table[k, OUTER_SHARE] * (length - li - lo)) / length
                ball[k, 0], ball[k, 1] = scale * ea[k], scale * er[k]
            else:
                ball[k, 1] = seat
        elif ball[k, 0] * ball[k, 0] + ball[k, 1] * ball[k, 1] <= lo * lo:
            ball[k, 0], ball[k, 1] = 0.0, seat
    remaining = z
    for _ in range(_ITERATIONS):
        for k in range(z):
            pa, pr = ball[k, 0], ball[k, 1]
            so[k] = np.sqrt(pa * pa + pr * pr)
            xa, xr = ea[k] - pa, er[k] - pr
            si[k] = np.sqrt(xa * xa + xr * xr)
            no_a[k], no_r[k] = pa / so[k], pr / so[k]
            if si[k] > 0.0:
                ni_a[k], ni_r[k] = xa / si[k], xr / si[k]
            else:
                ni_a[k], ni_r[k] = no_a[k], no_r[k]
            gap[k] = li - si[k]
            gap[z + k] = lo - so[k]
            own_a = ball_gain * pa + ball_known[k, 0]
            own_r = ball_gain * pr + ball_known[k, 1]
            rate[k] = -(ni_a[k] * (va[k] - own_a) + ni_r[k] * (vr[k] - own_r))
            rate[z + k] = -(no_a[k] * own_a + no_r[k] * own_r)
        law(gap, rate, law_params, law_old, law_new, dt, force, d_gap, d_rate)
        add_damping(damping, gap, rate, force, d_gap, d_rate)
        for k in range(z):
            if done[k] != 0.0:
                continue
            fi, fo = force[k], force[z + k]
            ga = -fi * ni_a[k] + fo * no_a[k]
            gr = -fi * ni_r[k] + fo * no_r[k] - table[k, CENTRIFUGAL]
            if slope[k] < 0.0:
                # Beyond the minimum along the last step by more than it began with: go half-way back.
                along = ga * da[k] + gr * dr[k]
                if along > -0.9 * slope[k]:
                    da[k] *= 0.5
                    dr[k] *= 0.5
                    slope[k] *= 0.5
                    ball[k, 0] -= da[k]
                    ball[k, 1] -= dr[k]
                    continue
            ki = -d_gap[k] - ball_gain * d_rate[k]
            ko = -d_gap[z + k] - ball_gain * d_rate[z + k]
            wi, wo = fi / si[k] if si[k] > 0.0 else 0.0, fo / so[k]
            haa = (ki - wi) * ni_a[k] * ni_a[k] + wi + (ko - wo) * no_a[k] * no_a[k] + wo
            har = (ki - wi) * ni_a[k] * ni_r[k] + (ko - wo) * no_a[k] * no_r[k]
            hrr = (ki - wi) * ni_r[k] * ni_r[k] + wi + (ko - wo) * no_r[k] * no_r[k] + wo
            det = haa * hrr - har * har
            if not det > 1e-14 * (haa + hrr) * (haa + hrr):
                shift = 1e-7 * (haa + hrr) + 1.0
                haa += shift
                hrr += shift
                det = haa * hrr - har * har
            sa, sr = -(hrr * ga - har * gr) / det, -(haa * gr - har * ga) / det
            size = np.sqrt(sa * sa + sr * sr)
            reach = 0.2 * lo
            if size > reach:
                sa *= reach / size
                sr *= reach / size
            deep = max(-gap[k], -gap[z + k])
            if size <= 1e-8 * max(deep, 1e-12):
                # One linear correction ends the iteration: what it leaves is of second order.
                inner = ni_a[k] * sa + ni_r[k] * sr
                outer = no_a[k] * sa + no_r[k] * sr
                force[k] = max(fi - ki * inner, 0.0)
                force[z + k] = max(fo + ko * outer, 0.0)
                gap[k] += inner
                gap[z + k] -= outer
                if si[k] > 0.0:
                    ni_a[k] -= (sa - ni_a[k] * inner) / si[k]
                    ni_r[k] -= (sr - ni_r[k] * inner) / si[k]
                ball[k, 0] += sa
                ball[k, 1] += sr
                # Kept for the tangent below, since the law is called again for the balls that still move.
                work[12, k], work[12, z + k] = force[k], force[z + k]
                work[13, k], work[13, z + k] = d_gap[k], d_gap[z + k]
                work[14, k], work[14, z + k] = d_rate[k], d_rate[z + k]
                work[15, k], work[15, z + k] = ni_a[k], ni_r[k]
                done[k] = 1.0
                remaining -= 1
                continue
            da[k], dr[k] = sa, sr
            slope[k] = ga * sa + gr * sr
            ball[k, 0] += sa
            ball[k, 1] += sr
        if remaining == 0:
            break
    if remaining > 0:
        return 1
    for k in range(z):
        fi, fo = work[12, k], work[12, z + k]
        force[k], force[z + k] = fi, fo
        if fi == 0.0 and work[13, k] == 0.0:
            continue
        na, nr = work[15, k], work[15, z + k]
        elastic, viscous = -work[13, k], -work[14, k]
        ki = elastic + ball_gain * viscous
        ko = -work[13, z + k] - ball_gain * work[14, z + k]
        wi, wo = fi / si[k], fo / so[k]
        # A by the ring's motion (elastic part), P by the ball's motion, H = P + the outer contact's.
        aa, ar, rr = (elastic - wi) * na * na + wi, (elastic - wi) * na * nr, (elastic - wi) * nr * nr + wi
        paa, par, prr = (ki - wi) * na * na + wi, (ki - wi) * na * nr, (ki - wi) * nr * nr + wi
        haa = paa + (ko - wo) * no_a[k] * no_a[k] + wo
        har = par + (ko - wo) * no_a[k] * no_r[k]
        hrr = prr + (ko - wo) * no_r[k] * no_r[k] + wo
        det = haa * hrr - har * har
        if not det > 0.0:
            return 1
        taa, tar = (paa * hrr - par * har) / det, (par * haa - paa * har) / det
        tra, trr = (par * hrr - prr * har) / det, (prr * haa - par * har) / det
        maa, mar, mrr = viscous * na * na, viscous * na * nr, viscous * nr * nr
        add_ball(
            cosine[k], sine[k], arm, table[k, SIDE], table[k, LEVER], fi * na, fi * nr,
            aa - taa * aa - tar * ar, ar - taa * ar - tar * rr, ar - tra * aa - trr * ar, rr - tra * ar - trr * rr,
            maa - taa * maa - tar * mar, mar - taa * mar - tar * mrr,
            mar - tra * maa - trr * mar, mrr - tra * mar - trr * mrr, f, K, C,
        )  # fmt: skip
    return 0
