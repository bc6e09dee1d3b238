"""A hand-fused time loop: the yardstick for the composed one, never used by the package.

One compiled function for each of four cases (balls with or without mass; Newmark or central differences) with Hertz
contacts, contact dampers and a rotating or swinging harmonic force written in: no function pointers, no arrays between
contact law, bodies and integrator, one ball after the other in registers.  It does the same physics with the same
tolerances, the same steps and the same starting state, and keeps the same record (``raceway.core.time.compiled``), so its
displacement must equal the package's to rounding.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import cos, isfinite, sin, sqrt
from typing import Any

import numba
import numpy as np

_compiled = numba.njit(error_model="numpy")
#: Written into its caller, so that what the caller does not use is not computed.
_inlined = numba.njit(error_model="numpy", inline="always")


@_compiled
def hertz(factor: float, damping: float, approach: float, rate: float) -> Any:
    """Force, d(force)/d(approach) and d(force)/d(approach rate) of one contact; rate is that of the approach."""
    if approach <= 0.0:
        return 0.0, 0.0, 0.0
    slope = factor * sqrt(approach)
    force = slope * approach + damping * rate
    if force <= 0.0:
        return 0.0, 0.0, 0.0
    return force, 1.5 * slope, damping


@_inlined
def massless_ball(ea, er, va, vr, li, lo, ki, ko, damping, gain, known, share, guess):  # type: ignore[no-untyped-def]
    """Both races in series: ball position, force, its direction, two tangents in it, the outer approach."""
    length = sqrt(ea * ea + er * er)
    total = length - li - lo
    na, nr = ea / length, er / length
    if total <= 0.0:
        return lo + 0.5 * total, 0.0, na, nr, 0.0, 0.0, 0.0, 0.5 * total
    speed = va * na + vr * nr
    outer = share * total
    low, high = 0.0, total
    fi, di, ri, fo, do, ro = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for _ in range(60):
        own = gain * (lo + outer) + known
        fi, di, ri = hertz(ki, damping, total - outer, speed - own)
        fo, do, ro = hertz(ko, damping, outer, own)
        stiff = di + gain * ri + do + gain * ro
        rest = fi - fo
        if not stiff > 0.0 or rest == 0.0:
            break
        if rest > 0.0:
            low = outer
        else:
            high = outer
        step = rest / stiff
        if abs(step) <= 1e-8 * total:
            fi -= (di + gain * ri) * step
            outer += step
            break
        outer += step
        if outer <= low or outer >= high:
            outer = 0.5 * (low + high)
    stiff = di + gain * ri + do + gain * ro
    part = (do + gain * ro) / stiff if stiff > 0.0 else 0.0
    return lo + outer, fi, na, nr, di * part, ri * part, fi / length, outer


@_inlined
def heavy_ball(ea, er, va, vr, li, lo, ki, ko, damping, gain, known_a, known_r, centrifugal, pa, pr):  # type: ignore[no-untyped-def]
    """Ball position, forces (inner, outer), approaches, force on the ring and its tangents in the meridian plane."""
    da, dr, slope = 0.0, 0.0, 0.0
    for _ in range(200):
        so = sqrt(pa * pa + pr * pr)
        xa, xr = ea - pa, er - pr
        si = sqrt(xa * xa + xr * xr)
        oa, orr = pa / so, pr / so
        ia, ir = xa / si, xr / si
        own_a, own_r = gain * pa + known_a, gain * pr + known_r
        fi, di, ri = hertz(ki, damping, si - li, ia * (va - own_a) + ir * (vr - own_r))
        fo, do, ro = hertz(ko, damping, so - lo, oa * own_a + orr * own_r)
        ga, gr = fo * oa - fi * ia, fo * orr - fi * ir - centrifugal
        if slope < 0.0 and ga * da + gr * dr > -0.9 * slope:
            da, dr, slope = 0.5 * da, 0.5 * dr, 0.5 * slope
            pa, pr = pa - da, pr - dr
            continue
        ci, co = di + gain * ri, do + gain * ro
        wi, wo = fi / si, fo / so
        haa = (ci - wi) * ia * ia + wi + (co - wo) * oa * oa + wo
        har = (ci - wi) * ia * ir + (co - wo) * oa * orr
        hrr = (ci - wi) * ir * ir + wi + (co - wo) * orr * orr + wo
        det = haa * hrr - har * har
        if not det > 1e-14 * (haa + hrr) * (haa + hrr):
            shift = 1e-7 * (haa + hrr) + 1.0
            haa, hrr = haa + shift, hrr + shift
            det = haa * hrr - har * har
        inverse = 1.0 / det
        sa, sr = (har * gr - hrr * ga) * inverse, (har * ga - haa * gr) * inverse
        size = sqrt(sa * sa + sr * sr)
        if size > 0.2 * lo:
            sa, sr = sa * 0.2 * lo / size, sr * 0.2 * lo / size
        pa, pr = pa + sa, pr + sr
        if size <= 1e-8 * max(si - li, so - lo, 1e-12):
            inner, outer = ia * sa + ir * sr, oa * sa + orr * sr
            fi, fo = max(fi - ci * inner, 0.0), max(fo + co * outer, 0.0)
            ia, ir = ia - (sa - ia * inner) / si, ir - (sr - ir * inner) / si
            aa, ar, rr = (di - wi) * ia * ia + wi, (di - wi) * ia * ir, (di - wi) * ir * ir + wi
            paa, par, prr = aa + gain * ri * ia * ia, ar + gain * ri * ia * ir, rr + gain * ri * ir * ir
            taa, tar = (paa * hrr - par * har) * inverse, (par * haa - paa * har) * inverse
            tra, trr = (par * hrr - prr * har) * inverse, (prr * haa - par * har) * inverse
            maa, mar, mrr = ri * ia * ia, ri * ia * ir, ri * ir * ir
            return (
                pa, pr, fi, fo, si - li - inner, so - lo + outer, fi * ia, fi * ir,
                aa - taa * aa - tar * ar, ar - taa * ar - tar * rr, ar - tra * aa - trr * ar, rr - tra * ar - trr * rr,
                maa - taa * maa - tar * mar, mar - taa * mar - tar * mrr,
                mar - tra * maa - trr * mar, mrr - tra * mar - trr * mrr,
            )  # fmt: skip
        da, dr = sa, sr
        slope = ga * sa + gr * sr
    return pa, pr, np.nan, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0


@_compiled
def eliminate(J, x):  # type: ignore[no-untyped-def]
    """x <- J^-1 x for 5 unknowns; J is symmetric to damping and positive: no pivoting."""
    for c in range(5):
        inverse = 1.0 / J[c, c]
        for r in range(c + 1, 5):
            factor = J[r, c] * inverse
            for k in range(c + 1, 5):
                J[r, k] -= factor * J[c, k]
            x[r] -= factor * x[c]
    for r in range(4, -1, -1):
        for k in range(r + 1, 5):
            x[r] -= J[r, k] * x[k]
        x[r] /= J[r, r]


@cache
def fused_loop(inertial: bool, implicit: bool) -> Callable[..., Any]:
    """The loop for one case; the two flags are constants when it is compiled."""

    @_compiled
    def loop(  # type: ignore[no-untyped-def]
        scalars, table, factors, force, mass, damping, stiffness, free, load, beta, gamma, tolerance, dt, steps,
        q0, v0, a0, ball, before, rows, probes,
    ):  # fmt: skip
        z = len(table)
        rest_a, rest_r, li, lo, arm, dashpot = scalars[:6]
        q, v, a, f = np.empty(5), np.empty(5), np.empty(5), np.empty(5)
        outer, x, J = np.zeros(5), np.empty(5), np.empty((5, 5))
        guess, half = np.empty(5), np.empty(5)
        known, trial, kept = np.empty((z, 2)), np.empty((z, 2)), np.empty((2, 2 * z))
        to_a, to_v = 1.0 / (beta * dt * dt), gamma / (beta * dt)
        gain = 1.5 / dt
        if not implicit:
            to_v = 0.0
        inverse = np.zeros(5)
        for i in range(5):
            inverse[i] = free[i] / (mass[i, i] + 0.5 * dt * damping[i, i]) if free[i] > 0.0 else 0.0
        evaluations = 0
        for step in range(steps):
            t = (step + 1) * dt
            phase = force[1] * t - force[2]
            c, s = force[0] * cos(phase), force[0] * sin(phase)
            outer[1], outer[2] = force[3] * c + force[4] * s, force[5] * c + force[6] * s
            for i in range(5):
                half[i] = v0[i] + 0.5 * dt * a0[i]
                q[i] = q0[i] + dt * v0[i] + 0.5 * dt * dt * a0[i]
                guess[i] = v0[i] + dt * a0[i]
            for k in range(z):
                for part in range(2):
                    known[k, part] = (0.5 * before[k, part] - 2.0 * ball[k, part]) / dt
                    trial[k, part] = 2.0 * ball[k, part] - before[k, part]
            found = False
            for _ in range(40):
                if implicit:
                    for i in range(5):
                        a[i] = (q[i] - q0[i] - dt * v0[i] - dt * dt * (0.5 - beta) * a0[i]) * to_a * free[i]
                        v[i] = v0[i] + dt * ((1.0 - gamma) * a0[i] + gamma * a[i])
                else:
                    for i in range(5):
                        v[i] = guess[i]
                evaluations += 1
                for i in range(5):
                    f[i] = 0.0
                    for j in range(5):
                        J[i, j] = 0.0
                contacts = 0.0
                for k in range(z):
                    cosine, sine = table[k, 0], table[k, 1]
                    t3, t4 = arm * sine, -arm * cosine
                    ea = rest_a + q[0] + t3 * q[3] + t4 * q[4]
                    er = rest_r + cosine * q[1] + sine * q[2]
                    va = v[0] + t3 * v[3] + t4 * v[4]
                    vr = cosine * v[1] + sine * v[2]
                    if inertial:
                        (
                            trial[k, 0], trial[k, 1], fi, fo, gi, go, fa, fr, kaa, kar, kra, krr, caa, car, cra, crr,
                        ) = heavy_ball(
                            ea, er, va, vr, li, lo, factors[0], factors[1], dashpot, gain, known[k, 0], known[k, 1],
                            table[k, 2], trial[k, 0], trial[k, 1],
                        )  # fmt: skip
                    else:
                        trial[k, 0], fi, na, nr, normal, viscous, across, go = massless_ball(
                            ea, er, va, vr, li, lo, factors[0], factors[1], dashpot, gain, known[k, 0], table[k, 3],
                            trial[k, 0],
                        )  # fmt: skip
                        fo, gi = fi, sqrt(ea * ea + er * er) - li - lo - go
                        fa, fr = fi * na, fi * nr
                        kaa, krr = (normal - across) * na * na + across, (normal - across) * nr * nr + across
                        kar = kra = (normal - across) * na * nr
                        caa, crr = viscous * na * na, viscous * nr * nr
                        car = cra = viscous * na * nr
                    kept[0, k], kept[0, z + k], kept[1, k], kept[1, z + k] = -gi, -go, fi, fo
                    contacts += fi + fo
                    f[0] += fa
                    f[1] += cosine * fr
                    f[2] += sine * fr
                    f[3] += t3 * fa
                    f[4] += t4 * fa
                    if implicit:
                        kaa, kar, kra, krr = kaa + to_v * caa, kar + to_v * car, kra + to_v * cra, krr + to_v * crr
                        J[0, 0] += kaa
                        J[0, 1] += kar * cosine
                        J[0, 2] += kar * sine
                        J[0, 3] += kaa * t3
                        J[0, 4] += kaa * t4
                        J[1, 0] += kra * cosine
                        J[1, 1] += krr * cosine * cosine
                        J[1, 2] += krr * cosine * sine
                        J[1, 3] += kra * cosine * t3
                        J[1, 4] += kra * cosine * t4
                        J[2, 0] += kra * sine
                        J[2, 2] += krr * sine * sine
                        J[2, 3] += kra * sine * t3
                        J[2, 4] += kra * sine * t4
                        J[3, 1] += kar * cosine * t3
                        J[3, 2] += kar * sine * t3
                        J[3, 3] += kaa * t3 * t3
                        J[3, 4] += kaa * t3 * t4
                        J[4, 1] += kar * cosine * t4
                        J[4, 2] += kar * sine * t4
                        J[4, 4] += kaa * t4 * t4
                if not implicit:
                    for i in range(5):
                        rest = load[i] + outer[i] - f[i]
                        for j in range(5):
                            rest -= damping[i, j] * half[j] + stiffness[i, j] * q[j]
                        a[i] = inverse[i] * rest
                        v[i] = half[i] + 0.5 * dt * a[i]
                    found = True
                    break
                J[2, 1], J[4, 3] = J[1, 2], J[3, 4]
                J[3, 0], J[4, 0] = J[0, 3], J[0, 4]
                norm, scale = 0.0, contacts
                for i in range(5):
                    weight = 1.0 if i < 3 else 1.0 / arm
                    rest, inertia, held = f[i] - load[i] - outer[i], 0.0, 0.0
                    for j in range(5):
                        rest += damping[i, j] * v[j] + stiffness[i, j] * q[j]
                        inertia += mass[i, j] * a[j]
                        held += mass[i, j] * abs(q[j])
                        J[i, j] += to_a * mass[i, j] + stiffness[i, j] + to_v * damping[i, j]
                    x[i] = -(inertia + rest) * free[i]
                    norm = max(norm, abs(x[i]) * weight)
                    scale = max(scale, abs(outer[i] + load[i]) * weight, abs(inertia) * weight, 1e-6 * held * to_a * weight)
                if not isfinite(norm):
                    return -1
                if norm <= tolerance * scale:
                    found = True
                    break
                for i in range(5):
                    if free[i] == 0.0:
                        for j in range(5):
                            J[i, j] = J[j, i] = 0.0
                        J[i, i] = 1.0
                eliminate(J, x)
                for i in range(5):
                    q[i] += x[i]
            if not found:
                return -1
            for i in range(5):
                q0[i], v0[i], a0[i] = q[i], v[i], a[i]
            rows[step, 0] = t
            for i in range(5):
                rows[step, 1 + i], rows[step, 6 + i], rows[step, 11 + i] = q[i], v[i], outer[i]
            for k in range(2 * z):
                probes[step, 0, k], probes[step, 1, k] = kept[0, k], kept[1, k]
            for k in range(z):
                for part in range(2):
                    before[k, part], ball[k, part] = ball[k, part], trial[k, part]
                    probes[step, 2, 2 * k + part] = ball[k, part]
        return evaluations

    return loop
