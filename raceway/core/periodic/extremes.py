"""Contact forces along a steady orbit, between its samples: largest, least, and at equidistant times of a turn.

Notes
-----
The force of a contact over a turn is the trigonometric polynomial through its samples, in further spans those of the ball that stands
there then.  Newton's method leads from the largest sample to the largest value; forces do not pull.
"""

from __future__ import annotations

import numpy as np
from numba import float64, int64, void

from raceway.core.jit import jit
from raceway.core.signatures import MATRIX, VECTOR

_ITERATIONS = 6


@jit(float64(VECTOR, VECTOR, VECTOR, float64))
def _extreme(curve, re, im, sign):
    """Largest (sign 1) or least (-1) value of the polynomial near the largest or least of the samples."""
    n, best = curve.size, 0
    for i in range(n):
        if sign * curve[i] > sign * curve[best]:
            best = i
    start = 2.0 * np.pi * best / n
    angle, value = start, curve[best]
    for _ in range(_ITERATIONS):
        first, second, value = 0.0, 0.0, 0.0
        c, s, cosine, sine = 1.0, 0.0, np.cos(angle), np.sin(angle)
        for h in range(n // 2 + 1):
            value += re[h] * c - im[h] * s
            first -= h * (re[h] * s + im[h] * c)
            second -= h * h * (re[h] * c - im[h] * s)
            c, s = c * cosine - s * sine, s * cosine + c * sine
        if sign * second >= 0.0:
            break
        angle -= first / second
        if abs(angle - start) > 2.0 * np.pi / n:
            break
    return max(sign * value, sign * curve[best]) * sign


@jit(void(VECTOR, VECTOR, VECTOR, VECTOR))
def _force_values(re, im, cosine, values):
    """Of the polynomial at m equidistant angles of a turn, whose cosines and sines (2 m,) are given; forces do not pull."""
    m = values.size
    for i in range(m):
        value, at = 0.0, 0
        for h in range(re.size):
            value += re[h] * cosine[at] - im[h] * cosine[at + m]
            at += i
            if at >= m:
                at -= m
        values[i] = max(value, 0.0)


@jit(void(MATRIX, int64[::1], int64, VECTOR, VECTOR, MATRIX), allocates=True)
def force_extremes(force, order, spans, peak, least, turn):
    """``peak`` and ``least`` (2 Z,) of forces (n, 2 Z) at the samples of a span; ``order`` (Z,) the ball that stands where each one stood.
    ``turn`` (T, 2 Z): forces at T equidistant times of a turn."""
    n, z = force.shape[0], order.size
    curve, re, im = np.empty(n * spans), np.empty(n * spans // 2 + 1), np.empty(n * spans // 2 + 1)
    known, times = np.zeros(z), turn.shape[0]
    fine = times
    while fine % spans:
        fine += times
    values = np.empty(fine)
    angle = 2.0 * np.pi * np.arange(fine) / max(fine, 1)
    cosine = np.concatenate((np.cos(angle), np.sin(angle)))
    for k in range(z):
        if known[k] > 0.0:
            continue
        for race in range(2):
            ball = k
            for m in range(spans):
                for i in range(n):
                    curve[m * n + i] = force[i, race * z + ball]
                ball = order[ball]
            # Harmonics: curve = sum re cos - im sin
            samples = curve.size
            for h in range(samples // 2 + 1):
                re[h], im[h] = 0.0, 0.0
                weight = (1.0 if h in (0, samples // 2) else 2.0) / samples
                turn_step = 2.0 * np.pi * h / samples
                c, s, cos_step, sin_step = 1.0, 0.0, np.cos(turn_step), np.sin(turn_step)
                for i in range(samples):
                    re[h] += weight * curve[i] * c
                    im[h] -= weight * curve[i] * s
                    c, s = c * cos_step - s * sin_step, s * cos_step + c * sin_step
            largest, smallest = _extreme(curve, re, im, 1.0), max(_extreme(curve, re, im, -1.0), 0.0)
            _force_values(re, im, cosine, values)
            ball = k
            for m in range(spans):
                at, step = m * (fine // spans), fine // max(times, 1)
                for i in range(times):
                    turn[i, race * z + ball] = values[at]
                    at += step
                    if at >= fine:
                        at -= fine
                peak[race * z + ball], least[race * z + ball] = largest, smallest
                known[ball] = 1.0
                ball = order[ball]
