"""Arrays of four points' samples, which their steady orbits are solved in: rows, the first samples' constants, samples between."""

from typing import NamedTuple

import numpy as np
from numba import boolean, float64, int64, void

from raceway.core.jit import jit
from raceway.core.lanes import WIDTH, live_of, put, spread, take
from raceway.core.ring.compliances import SHIFT, SHIFT_BY_E, SHIFT_STEP
from raceway.core.ring.elimination import copy_matrix
from raceway.core.ring.kernels import GAP_RATE
from raceway.core.ring.kernels.tensors import pair_of, put_pair, tensors_of
from raceway.core.ring.lockstep import BY_CENTRE, DIRECTION, DQ, INNER, PLACE, SHAFT, STEP, TANGENT, Q, centre, seats
from raceway.core.signatures import CUBE, MATRIX, record

#: Rows of a sample behind its tangent: that by the velocity, w C; imbalance; u' + G u, u'' + 2 G u' + G^2 u; the equilibrium from the frame.
VISCOUS = TANGENT + 25
IMBALANCE, RATE, BEND, CENTRE = (VISCOUS + 25 + 5 * i for i in range(4))
ROWS = CENTRE + 5
#: Rows of ``shared``, numbers of each point: w^2 mass, w damping; derivatives of the imbalance by u beside the tangent and by u'; means of
#: the tangents by u and u', and those of the harmonics' inverses; which lanes are asked for, and answers of a level; dashpot [N s/m] and
#: time constant [s] of the contacts, speed [rad/s].
MASS, DAMPED, FIXED, BY_RATE, MEAN, KEPT, WANTED, ANSWER = 0, 5, 30, 55, 80, 130, 180, 181
DASHPOT, TIME, SPEED = range(ANSWER + 2, ANSWER + 5)
SHARED_ROWS = SPEED + 1


class Block(NamedTuple):
    """Arrays of four points: their law's ``params`` (W 2 Z, k) and none of its ``memory``; scalars of condensed ``bodies`` (W, s), or (0, s); of each sample ``work`` (N, ..., W 2 Z) and
    ``rows`` (N, ``ROWS``, W), of level n each (N / n)th; ``basis`` (2 m + 3, 5 N, W) of a step; ``shared`` (``SHARED_ROWS``, W); ``own`` for the balls of a kernel."""

    params: np.ndarray
    memory: np.ndarray
    bodies: np.ndarray
    work: np.ndarray
    rows: np.ndarray
    basis: np.ndarray
    shared: np.ndarray
    own: np.ndarray


BLOCK = record(Block, MATRIX, MATRIX, MATRIX, CUBE, CUBE, CUBE, MATRIX, MATRIX)


@jit(void(float64, MATRIX, MATRIX))
def copy_balls(angle, before, after):
    """What an iteration begins with, seen from a frame that has turned by an angle."""
    c, s, live = np.cos(angle), np.sin(angle), live_of(0, WIDTH)
    for k in range(0, before.shape[1], WIDTH):
        put(after, GAP_RATE, k, live, take(before, GAP_RATE, k, live))
        put(after, SHIFT, k, live, take(before, SHIFT, k, live))
        for row in range(DIRECTION + 1, INNER):
            put(after, row, k, live, take(before, row, k, live))
    for k in range(0, before.shape[1] // 2, WIDTH):
        cosine, sine = pair_of(before, DIRECTION, k, live)
        put_pair(after, DIRECTION, k, live, cosine * c + sine * s, sine * c - cosine * s)


@jit(void(float64, MATRIX, MATRIX))
def put_fixed(sense, row, shared):
    """Derivatives of the imbalances by u' and, beside the tangent, by u; mass, damping and shaft are in their rows."""
    live, none = live_of(0, WIDTH), spread(0.0)
    for i in range(5):
        damping = DAMPED + 5 * i
        put(shared, FIXED + 5 * i, 0, live, none)
        for m in (1, 3):
            put(shared, FIXED + 5 * i + m, 0, live, sense * take(shared, damping + m + 1, 0, live))
            put(shared, FIXED + 5 * i + m + 1, 0, live, -sense * take(shared, damping + m, 0, live))
        for m in range(5):
            put(shared, BY_RATE + 5 * i + m, 0, live, take(shared, damping + m, 0, live))
        own = take(shared, FIXED + 6 * i, 0, live) - (sense * sense if i > 0 else 0.0) * take(shared, MASS + i, 0, live)
        put(shared, FIXED + 6 * i, 0, live, own + take(row, SHAFT, 0, live) if i > 2 else own)
    for i in (1, 3):
        twice = 2.0 * sense * take(shared, MASS + i, 0, live)
        across, back = BY_RATE + 6 * i + 1, BY_RATE + 6 * i + 5
        put(shared, across, 0, live, take(shared, across, 0, live) - twice)
        put(shared, back, 0, live, take(shared, back, 0, live) + twice)


@jit(void(int64, boolean, float64, float64, BLOCK), allocates=True)
def double(n, alone, sense, span, block):
    """Samples between those of a level: the trigonometric polynomial there, balls as they follow the ring from the sample before."""
    work, rows, live = block.work, block.rows, live_of(0, WIDTH)
    weight, stride = np.empty(n), rows.shape[0] // n
    for m in range(n):
        angle = np.pi * (2 * m + 1) / n
        weight[m] = np.sin(0.5 * n * angle) / (n * np.tan(0.5 * angle))
    for j in range(n):
        at, between = j * stride, j * stride + stride // 2
        copy_matrix(rows[at], rows[between])
        for i in range(5):
            u = spread(0.0)
            for m in range(n):
                u = u + weight[(j - m) & (n - 1)] * take(rows[m * stride], Q + i, 0, live)
            put(rows[between], Q + i, 0, live, u)
            put(rows[at], DQ + i, 0, live, spread(0.0))
            put(rows[between], DQ + i, 0, live, spread(0.0))
        if alone:
            continue
        copy_balls(sense * span * 0.5 / n, work[at], work[between])
        for k in range(0, work.shape[2] // 2, WIDTH):
            ea, er = centre(seats(k, live, work[at]), rows[at], Q, live)
            fa, fr = centre(seats(k, live, work[between]), rows[between], Q, live)
            ea, er = fa - ea, fr - er
            for place, step, by_centre in ((PLACE, STEP, BY_CENTRE), (SHIFT, SHIFT_STEP, SHIFT_BY_E)):
                t, (a, r) = tensors_of(work[at], by_centre, k, live), pair_of(work[at], place, k, live)
                put_pair(work[between], place, k, live, a + t.aa * ea + t.ar * er, r + t.ra * ea + t.rr * er)
                put_pair(work[between], step, k, live, spread(0.0), spread(0.0))
