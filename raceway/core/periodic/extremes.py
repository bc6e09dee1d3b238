"""Contact forces along a steady orbit, between its samples: largest, least, and at equidistant times of a turn.

The force of a contact over a turn is the trigonometric polynomial through its samples, in further spans those of the ball that stands
there then.  Newton's method leads from the largest sample to the largest value; forces do not pull.
"""

import numpy as np
from numba import float64, int64, void

from raceway.core.jit import jit
from raceway.core.lanes import WIDTH, any_of, larger, live_of, put, spread, take, where
from raceway.core.periodic.fourier import circle
from raceway.core.signatures import MATRIX, VECTOR

_ITERATIONS, _SETTLED, _TERMS = 6, 1e-9, 18


@jit(void(MATRIX, int64, VECTOR, MATRIX, MATRIX))
def _harmonics(curves, count, cosine, re, im):
    """Of ``count`` curves (N, c): curve = sum re cos - im sin of N // 2 + 1 harmonics; ``cosine`` (2 N,) of the samples' angles, and sines."""
    samples, half = curves.shape[0], curves.shape[0] // 2
    for k in range(0, count, WIDTH):
        live = live_of(k, count)
        for h in range(half // 2 + 1):
            a, b, c, d, at = spread(0.0), spread(0.0), spread(0.0), spread(0.0), 0
            for i in range(0, samples, 2):
                even, odd, after = take(curves, i, k, live), take(curves, i + 1, k, live), at + h
                after -= samples if after >= samples else 0
                a, b = a + cosine[at] * even, b - cosine[at + samples] * even
                c, d = c + cosine[after] * odd, d - cosine[after + samples] * odd
                at += 2 * h
                at -= samples if at >= samples else 0
            # Of the harmonic N / 2 - h odd samples have the other sign.
            weight = (1.0 if h == 0 else 2.0) / samples
            put(re, half - h, k, live, weight * (a - c))
            put(im, half - h, k, live, weight * (d - b))
            put(re, h, k, live, weight * (a + c))
            put(im, h, k, live, weight * (b + d))


@jit(void(MATRIX, int64, VECTOR, MATRIX, MATRIX, float64, MATRIX, int64))
def _extreme(curves, count, cosines, re, im, sign, out, row):
    """Largest (sign 1) or least (-1) value of each polynomial near the largest or least of its samples, into a row of ``out`` (2, c)."""
    samples = curves.shape[0]
    longest = 2.0 * np.pi / samples
    for k in range(0, count, WIDTH):
        live = live_of(k, count)
        best, at_c, at_s = spread(-np.inf), spread(1.0), spread(0.0)
        for i in range(samples):
            value = sign * take(curves, i, k, live)
            more = value > best
            at_c, at_s, best = where(more, cosines[i], at_c), where(more, cosines[i + samples], at_s), larger(value, best)
        angle, value, moves = spread(0.0), best, live
        for _ in range(_ITERATIONS):
            # By their series: beside a sample an angle is below one.
            square, cosine, sine = angle * angle, spread(1.0), spread(1.0)
            for i in range(_TERMS, 0, -2):
                cosine, sine = 1.0 - cosine * square * (1.0 / (i * (i - 1))), 1.0 - sine * square * (1.0 / (i * (i + 1)))
            sine = sine * angle
            cosine, sine = at_c * cosine - at_s * sine, at_s * cosine + at_c * sine
            here, first, second, c, s = spread(0.0), spread(0.0), spread(0.0), spread(1.0), spread(0.0)
            for h in range(samples // 2 + 1):
                a, b = take(re, h, k, live), take(im, h, k, live)
                along = a * c - b * s
                here, first, second = here + along, first - float(h) * (a * s + b * c), second - float(h * h) * along
                c, s = c * cosine - s * sine, s * cosine + c * sine
            value = where(moves, sign * here, value)
            moves = moves & (sign * second < 0.0)
            step = first / where(moves, second, 1.0)
            angle = where(moves, angle - step, angle)
            moves = moves & (larger(step, -step) > _SETTLED) & (larger(angle, -angle) <= longest)
            if not any_of(moves):
                break
        put(out, row, k, live, sign * larger(value, best))


@jit(void(MATRIX, int64[::1], int64, VECTOR, VECTOR, MATRIX), allocates=True)
def force_extremes(force, order, spans, peak, least, turn):
    """``peak`` and ``least`` (2 Z,) of forces (n, 2 Z) at the samples of a span; ``order`` (Z,) the ball that stands where each one stood.
    ``turn`` (T, 2 Z): forces at T equidistant times of a turn."""
    n, z, count, times = force.shape[0], order.size, 0, turn.shape[0]
    samples, curve_of, first_of, curves = n * spans, np.full(z, -1), np.empty(z, np.int64), np.zeros((n * spans, 2 * z))
    table = np.empty(2 * samples)
    circle(samples, table)
    # Balls that come to stand where the first one stood have its curve, later.
    for k in range(z):
        if curve_of[k] >= 0:
            continue
        ball, first_of[count // 2] = k, k
        for m in range(spans):
            for i in range(n):
                for race in range(2):
                    curves[m * n + i, count + race] = force[i, race * z + ball]
            curve_of[ball] = count
            ball = order[ball]
        count += 2
    re, im, extremes = np.empty((samples // 2 + 1, 2 * z)), np.empty((samples // 2 + 1, 2 * z)), np.empty((2, 2 * z))
    _harmonics(curves, count, table, re, im)
    for least_of in range(2):
        _extreme(curves, count, table, re, im, 1.0 - 2.0 * least_of, extremes, least_of)
    for k in range(z):
        for race in range(2):
            peak[race * z + k] = extremes[0, curve_of[k] + race]
            least[race * z + k] = max(extremes[1, curve_of[k] + race], 0.0)
    fine = times
    while fine % spans:
        fine += times
    values, table = np.empty(fine), np.empty(2 * fine)
    circle(fine, table)
    for curve in range(count if times > 0 else 0):
        for i in range(fine):
            value, at = 0.0, 0
            for h in range(samples // 2 + 1):
                value += re[h, curve] * table[at] - im[h, curve] * table[at + fine]
                at += i
                at -= fine if at >= fine else 0
            values[i] = max(value, 0.0)
        ball = first_of[curve // 2]
        for m in range(spans):
            at, step = m * (fine // spans), fine // times
            for i in range(times):
                turn[i, curve % 2 * z + ball] = values[at]
                at += step
                if at >= fine:
                    at -= fine
            ball = order[ball]
