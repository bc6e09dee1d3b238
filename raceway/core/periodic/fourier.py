"""One steady orbit by Fourier collocation, compiled: its imbalances and their derivatives, Newton's steps, its numbers."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import boolean, float64, int64, void

from raceway.core.jit import jit
from raceway.core.ring.kernels import CONTACT_FORCE
from raceway.core.ring.kernels.layout import keep_slips
from raceway.core.ring.states import KERNELS
from raceway.core.signatures import (
    CONSTANTS,
    CUBE,
    FORCE_POINTER,
    MATRIX,
    VECTOR,
    Balls,
    Constants,
    Contacts,
    Response,
    record,
)


class Level(NamedTuple):
    """Arrays of one number of samples n: motion u and its derivatives u1, u2 by the angle, imbalance r (n, 5), in the frame; derivatives
    of r by u and u1, A0, A1 (n, 5, 5); places of balls and their rates (n, Z, b); contact forces (n, 2 Z); columns of the derivatives over the span d1, d2 (n,)
    and over a turn, twice (2 m,); J the scratch of the step."""

    u: np.ndarray
    u1: np.ndarray
    u2: np.ndarray
    r: np.ndarray
    A0: np.ndarray
    A1: np.ndarray
    ball: np.ndarray
    ball_rate: np.ndarray
    force: np.ndarray
    d1: np.ndarray
    d2: np.ndarray
    turn: np.ndarray
    J: np.ndarray


class Numbers(NamedTuple):
    """Of one point: ``constants`` and law's ``params``, load (5,), mass (5,), damping (5, 5), stiffness against tilts, speed of the force and its ``force_params``; whether contacts are
    damped; its equilibrium ``centre`` (5,), and ``weight`` (5,) that makes lengths of coordinates."""

    constants: Constants
    params: np.ndarray
    load: np.ndarray
    mass: np.ndarray
    damping: np.ndarray
    shaft: float
    speed: float
    force_params: np.ndarray
    damped: bool
    centre: np.ndarray
    weight: np.ndarray


LEVEL = record(Level, MATRIX, MATRIX, MATRIX, MATRIX, CUBE, CUBE, CUBE, CUBE, MATRIX, VECTOR, VECTOR, VECTOR, MATRIX)
NUMBERS = record(Numbers, CONSTANTS, MATRIX, VECTOR, VECTOR, MATRIX, float64, float64, VECTOR, boolean, VECTOR, VECTOR)
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


@jit(void(int64, float64, VECTOR, VECTOR))
def circulants(n, span, first, second):
    """Columns (n,) of the circulant matrices of the first and second derivative of n samples of a span; n is even."""
    wave = 2.0 * np.pi / span
    first[0], second[0] = 0.0, -wave * wave * (n * n / 12.0 + 1.0 / 6.0)
    for m in range(1, n):
        sign, half = 1.0 - 2.0 * (m % 2), np.pi * m / n
        first[m] = 0.5 * wave * sign / np.tan(half)
        second[m] = -0.5 * wave * wave * sign / np.sin(half) ** 2


@jit(void(MATRIX, MATRIX))
def at_twice_the_angles(u, out):
    """out (2 n, 5): the trigonometric polynomial through u (n, 5) at twice as many angles."""
    n = u.shape[0]
    for j in range(n):
        for i in range(5):
            out[2 * j, i] = u[j, i]
            out[2 * j + 1, i] = 0.0
        for m in range(n):
            angle = np.pi * (2 * (j - m) + 1) / n
            weight = np.sin(0.5 * n * angle) / (n * np.tan(0.5 * angle))
            for i in range(5):
                out[2 * j + 1, i] += weight * u[m, i]


@jit(void(float64, VECTOR, VECTOR))
def turn_vector(angle, vector, out):
    """out (5,) = R(angle) vector (5,)."""
    c, s = np.cos(angle), np.sin(angle)
    out[0] = vector[0]
    out[1], out[2] = c * vector[1] - s * vector[2], s * vector[1] + c * vector[2]
    out[3], out[4] = c * vector[3] - s * vector[4], s * vector[3] + c * vector[4]


@jit(void(float64, MATRIX, MATRIX, MATRIX))
def turn_matrix(angle, matrix, half, out):
    """out (5, 5) = R(angle)^T matrix R(angle); ``half`` is scratch."""
    for i in range(5):
        turn_vector(-angle, matrix[i], half[i])  # rows: (R^T m_i) = m_i R
    for j in range(5):
        a, b, c, d, e = half[0, j], half[1, j], half[2, j], half[3, j], half[4, j]
        cosine, sine = np.cos(angle), np.sin(angle)
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


@jit(void(MATRIX, VECTOR, MATRIX))
def _differentiate(u, column, out):
    """out (n, 5): the circulant matrix of a column (n,) times u (n, 5)."""
    n = u.shape[0]
    for j in range(n):
        a, b, c, d, e = 0.0, 0.0, 0.0, 0.0, 0.0
        for m in range(n):
            weight = column[(j - m) % n]
            a += weight * u[m, 0]
            b += weight * u[m, 1]
            c += weight * u[m, 2]
            d += weight * u[m, 3]
            e += weight * u[m, 4]
        out[j, 0], out[j, 1], out[j, 2], out[j, 3], out[j, 4] = a, b, c, d, e


@jit(void(VECTOR, VECTOR))
def _generate(u, out):
    """out (5,) = G u."""
    out[0], out[1], out[2], out[3], out[4] = 0.0, -u[2], u[1], -u[4], u[3]


@jit(boolean(KERNELS, TURNING, NUMBERS, LEVEL, MATRIX), allocates=True)
def orbit_imbalances(kernels, turning, numbers, level, work):
    """r, A0 and A1 of all samples, from u; False where balls find no place."""
    n, columns, sense, w = level.u.shape[0], level.ball.shape[2], turning.sense, numbers.speed
    f, force, rate, state, v, q = np.empty(5), np.empty(5), np.empty(5), np.empty(5), np.empty(5), np.empty(5)
    response = Response(f, np.empty((5, 5)), np.empty((5, 5)), work)
    half, viscous, across = np.empty((5, 5)), np.empty((5, 5)), np.empty((5, 5))
    memory, history = np.zeros((numbers.params.shape[0], 0)), np.zeros(level.ball.shape[1:])
    contacts = Contacts(kernels.law, numbers.params, memory, memory, 0.0)
    _differentiate(level.u, level.d1, level.u1)
    _differentiate(level.u, level.d2, level.u2)
    for j in range(n):
        angle = turning.span * j / n
        A0, A1, u, u1 = level.A0[j], level.A1[j], level.u[j], level.u1[j]
        _generate(u, state)
        for i in range(5):
            rate[i] = u1[i] + sense * state[i]  # over w, in the frame
            state[i] = w * rate[i]
        turn_vector(sense * angle, u, q)
        turn_vector(sense * angle, state, v)
        keep_slips(numbers.constants.scalars, level.ball[j], history)
        if numbers.damped:
            for k in range(history.shape[0]):
                for c in range(columns):
                    if columns == kernels.columns or c < 2 or c > 3:  # slips have no rates
                        history[k, c] = level.ball_rate[j, k, c]
        balls = Balls(level.ball[j], 0.0, history)
        if kernels.system(angle / w, q, v, balls, contacts, numbers.constants, response) != 0:
            return False
        for i in range(level.force.shape[1]):
            level.force[j, i] = work[CONTACT_FORCE, i]
        turning.force(angle / w, numbers.force_params, force)
        for i in range(5):
            force[i] = f[i] - numbers.load[i] - force[i]
        turn_vector(-sense * angle, force, level.r[j])
        turn_matrix(sense * angle, response.K, half, A0)
        turn_matrix(sense * angle, response.C, half, viscous)
        _generate(u1, state)
        for i in range(5):
            shaft = numbers.shaft if i > 2 else 0.0
            inertia = w * w * numbers.mass[i]
            centre = u[i] if i > 0 else 0.0  # -G^2 u
            level.r[j, i] += shaft * u[i] + inertia * (level.u2[j, i] + sense * (2.0 * state[i] - sense * centre))
            for k in range(5):
                level.r[j, i] += w * numbers.damping[i, k] * rate[k]
                A1[i, k] = w * (numbers.damping[i, k] + viscous[i, k])
        for i in range(5):
            across[i, 0], across[i, 1], across[i, 2] = 0.0, A1[i, 2], -A1[i, 1]
            across[i, 3], across[i, 4] = A1[i, 4], -A1[i, 3]
        for i in range(5):
            for k in range(5):
                A0[i, k] += sense * across[i, k]
            A0[i, i] += numbers.shaft if i > 2 else 0.0
            A0[i, i] -= sense * sense * w * w * numbers.mass[i] if i > 0 else 0.0
        for i in (1, 3):
            A1[i, i + 1] -= 2.0 * sense * w * w * numbers.mass[i]
            A1[i + 1, i] += 2.0 * sense * w * w * numbers.mass[i]
    return True


@jit(void(LEVEL, VECTOR, float64, int64[::1], MATRIX), inline=True)
def orbit_jacobian(level, mass, speed, dofs, J):
    """Derivatives of all samples' imbalances by u, in the first columns of J."""
    n, d = level.u.shape[0], dofs.size
    for j in range(n):
        for a in range(d):
            i, row = dofs[a], j * d + a
            for m in range(n):
                d1, d2 = level.d1[(j - m) % n], level.d2[(j - m) % n]
                for b in range(d):
                    J[row, m * d + b] = level.A1[j, i, dofs[b]] * d1
                J[row, m * d + a] += speed * speed * mass[i] * d2
            for b in range(d):
                J[row, j * d + b] += level.A0[j, i, dofs[b]]


@jit(void(TURNING, NUMBERS, MATRIX, VECTOR))
def force_line(turning, numbers, push, force):
    """Synchronous (1x) component of the force, real and imaginary part (2, 5); ``force`` (5,) is scratch."""
    for i in range(5):
        push[0, i], push[1, i] = 0.0, 0.0
    for k in range(16):
        angle = 2.0 * np.pi * k / 16.0
        turning.force(angle / numbers.speed, numbers.force_params, force)
        for i in range(5):
            push[0, i] += force[i] * np.cos(angle) / 8.0
            push[1, i] -= force[i] * np.sin(angle) / 8.0


@jit(void(VECTOR, VECTOR, TURNING, MATRIX), allocates=True)
def first_guess(centre, line, turning, u):
    """u (n, 5): the linear response about an equilibrium (5,), seen from the frame."""
    q = np.empty(5)
    for j in range(u.shape[0]):
        angle = turning.span * j / u.shape[0]
        for i in range(5):
            q[i] = centre[i] + line[i] * np.cos(angle) - line[5 + i] * np.sin(angle)
        turn_vector(-turning.sense * angle, q, u[j])


@jit(void(MATRIX, float64, VECTOR, VECTOR))
def harmonic_lines(u, sense, mean, line):
    """Mean (5,) and synchronous (1x) component (10,) of the motion u (n, 5)."""
    n = u.shape[0]
    for i in range(5):
        mean[i], line[i], line[5 + i] = 0.0, 0.0, 0.0
        for j in range(n):
            angle = 2.0 * np.pi * j / n
            if sense == 0.0:
                mean[i] += u[j, i] / n
                line[i] += 2.0 * u[j, i] * np.cos(angle) / n
                line[5 + i] -= 2.0 * u[j, i] * np.sin(angle) / n
            elif i == 0:
                mean[i] += u[j, i] / n
            else:  # what stands in the frame is the 1x part
                line[i] += u[j, i] / n
    if sense != 0.0:
        for i in (1, 3):
            line[5 + i], line[6 + i] = sense * line[i + 1], -sense * line[i]


@jit(float64(VECTOR, VECTOR))
def line_difference(line, before):
    """Of two synchronous (1x) components (10,), radial parts, over the first one."""
    square, size = 0.0, 0.0
    for i in (1, 2, 6, 7):
        square += (line[i] - before[i]) ** 2
        size += line[i] ** 2
    return np.sqrt(square / max(size, 1e-300))


@jit(float64(CUBE))
def stiffness_change(A0):
    """Largest change of the radial stiffness over the samples, over its mean."""
    low, high, n = np.inf, -np.inf, A0.shape[0]
    mean = 0.0
    for j in range(n):
        for i in (1, 2):
            low, high = min(low, A0[j, i, i]), max(high, A0[j, i, i])
            mean += abs(A0[j, i, i]) / (2.0 * n)
    return (high - low) / max(mean, 1e-300)
