"""A motion by its samples over a span, compiled: derivatives, frames that turn, synchronous components, the linear response."""

from typing import Any, NamedTuple

import numpy as np
from numba import float64, int64, void

from raceway.core.jit import jit
from raceway.core.ring.elimination import solve
from raceway.core.signatures import CUBE, FORCE_POINTER, LINEAR, MATRIX, POINTS, STATES, VECTOR, record

#: Status beside those of equilibria.
SOLVED, NOT_SOLVED, UNRESOLVED = 0, 10, 11


class Turning(NamedTuple):
    """The force of n points and the symmetry of their motion.

    ``force`` (a ``FORCE``) with ``params`` (n, k), ``speed`` (n,) [rad/s], ``damping`` (n, 5, 5) of rotor and gyroscopic moments, ``mass``
    (n, 5); ``sense`` +1 or -1 of the turning frame, 0 where it stands; ``span`` [rad]; ``order`` (Z,) see
    ``raceway.core.periodic.turn.Symmetry``; ``samples`` the least and the largest number of a span, powers of 2; ``tolerance`` of
    the 1x component.
    """

    force: Any
    params: np.ndarray
    speed: np.ndarray
    damping: np.ndarray
    mass: np.ndarray
    sense: float
    span: float
    order: np.ndarray
    least: int
    most: int
    tolerance: float


TURNING = record(
    Turning, FORCE_POINTER, MATRIX, VECTOR, CUBE, MATRIX, float64, float64, int64[::1], int64, int64, float64
)  # fmt: skip


@jit(void(int64, VECTOR), inline=True)
def circle(count, table):
    """Cosines and sines (2 count,) of equidistant angles of a turn."""
    for i in range(count):
        table[i], table[count + i] = np.cos(2.0 * np.pi * i / count), np.sin(2.0 * np.pi * i / count)


@jit(void(int64, float64, VECTOR, VECTOR))
def circulants(n, span, first, second):
    """Columns (n,) of the circulant matrices of the first and second derivative of n samples of a span; n is even."""
    wave = 2.0 * np.pi / span
    first[0], second[0] = 0.0, -wave * wave * (n * n / 12.0 + 1.0 / 6.0)
    for m in range(1, n):
        sign, half = 1.0 - 2.0 * (m % 2), np.pi * m / n
        first[m] = 0.5 * wave * sign / np.tan(half)
        second[m] = -0.5 * wave * wave * sign / np.sin(half) ** 2


@jit(void(float64, float64, VECTOR, VECTOR))
def turn_vector(c, s, vector, out):
    """out (5,) = R vector (5,), of the angle with the cosine c and the sine s."""
    out[0] = vector[0]
    out[1], out[2] = c * vector[1] - s * vector[2], s * vector[1] + c * vector[2]
    out[3], out[4] = c * vector[3] - s * vector[4], s * vector[3] + c * vector[4]


@jit(void(float64, float64, MATRIX, MATRIX, MATRIX))
def turn_matrix(cosine, sine, matrix, half, out):
    """out (5, 5) = R^T matrix R; ``half`` is scratch."""
    for i in range(5):
        turn_vector(cosine, -sine, matrix[i], half[i])  # rows: (R^T m_i) = m_i R
    for j in range(5):
        a, b, c, d, e = half[0, j], half[1, j], half[2, j], half[3, j], half[4, j]
        out[0, j] = a
        out[1, j], out[2, j] = cosine * b + sine * c, cosine * c - sine * b
        out[3, j], out[4, j] = cosine * d + sine * e, cosine * e - sine * d


@jit(void(CUBE, int64[::1], VECTOR, float64, CUBE))
def ball_rates(ball, order, first, speed, rate):
    """rate (n, Z, b) of positions ball (n, Z, b) over the span; ``first`` (2 n m,) is the derivative's column of all m spans of a turn, twice."""
    n, z, columns = ball.shape
    size = first.size // 2
    for k in range(z):
        for j in range(n):
            for c in range(columns):
                rate[j, k, c] = 0.0
        follower = k
        for m in range(size // n):
            for i in range(n):
                behind = size - m * n - i
                for c in range(columns):
                    position = speed * ball[i, follower, c]
                    for j in range(n):
                        rate[j, k, c] += first[behind + j] * position
            follower = order[follower]


@jit(void(TURNING, int64, VECTOR), allocates=True)
def force_line(turning, p, push):
    """Synchronous (1x) component of a point's force, real and imaginary parts (10,)."""
    force = np.empty(5)
    for i in range(10):
        push[i] = 0.0
    for k in range(16):
        angle = 2.0 * np.pi * k / 16.0
        cosine, sine = np.cos(angle) / 8.0, np.sin(angle) / 8.0
        turning.force(angle / turning.speed[p], turning.params[p], force)
        for i in range(5):
            push[i] += force[i] * cosine
            push[5 + i] -= force[i] * sine


@jit(void(MATRIX, float64, VECTOR, VECTOR))
def harmonic_lines(u, sense, mean, line):
    """Mean (5,) and synchronous (1x) component (10,) of the motion u (n, 5)."""
    n = u.shape[0]
    for i in range(5):
        mean[i], line[i], line[5 + i] = 0.0, 0.0, 0.0
    for j in range(n):
        cosine, sine = 0.0, 0.0
        if sense == 0.0:
            cosine, sine = 2.0 * np.cos(2.0 * np.pi * j / n) / n, 2.0 * np.sin(2.0 * np.pi * j / n) / n
        for i in range(5):
            if sense == 0.0:
                mean[i] += u[j, i] / n
                line[i] += u[j, i] * cosine
                line[5 + i] -= u[j, i] * sine
            elif i == 0:
                mean[i] += u[j, i] / n
            else:  # what stands in the frame is the 1x part
                line[i] += u[j, i] / n
    if sense != 0.0:
        for i in (1, 3):
            line[5 + i], line[6 + i] = sense * line[i + 1], -sense * line[i]


@jit(void(LINEAR, POINTS, STATES, TURNING, int64, VECTOR, MATRIX), allocates=True)
def linear_response(linear, points, states, turning, p, push, u):
    """Of a point M q'' + C q' + (K + S) q = F about its equilibrium, seen from the frame: u (n, 5); ``push`` : F, see ``force_line``."""
    A, speed, K, q = np.zeros((10, 11)), turning.speed[p], states.stiffness[p], np.empty(5)
    for i in range(5):
        if linear.free[i] == 0.0:
            A[i, i] = A[5 + i, 5 + i] = 1.0
            continue
        for j in range(5):
            A[i, j] = A[5 + i, 5 + j] = K[i, j] * linear.free[j]
            A[5 + i, j] = speed * turning.damping[p, i, j] * linear.free[j]
            A[i, 5 + j] = -A[5 + i, j]
        dynamic_stiffness = (points.shaft[p] if i > 2 else 0.0) - speed * speed * turning.mass[p, i]
        A[i, i] += dynamic_stiffness
        A[5 + i, 5 + i] += dynamic_stiffness
        A[i, 10], A[5 + i, 10] = push[i], push[5 + i]
    solve(A)
    for j in range(u.shape[0]):
        angle = turning.span * j / u.shape[0]
        cosine, sine = np.cos(angle), np.sin(angle)
        for i in range(5):
            q[i] = states.q[p, i] + A[i, 10] * cosine - A[5 + i, 10] * sine
        turn_vector(cosine if turning.sense != 0.0 else 1.0, -turning.sense * sine, q, u[j])
