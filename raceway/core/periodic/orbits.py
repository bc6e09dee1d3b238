"""Steady orbits of many operating points in one compiled loop: Fourier collocation and Newton's method.

Notes
-----
The motion is sampled at N equidistant angles of its span, of the force's angle: a turn, or one ball pitch where a turning force acts
on equal balls.  Then it is looked at from the frame that turns with the force, u = R^T q, in which it repeats itself after a pitch
and its 1x part stands still: few samples do.  Derivatives are those of the trigonometric polynomial through the samples,

    M w^2 (u'' + 2 G u' + G^2 u) + C w (u' + G u) + S u + R^T f(R u) = R^T (load + F),

G the generator of R, 0 in a frame that stands.  Samples are doubled until the 1x line changes by less than
the tolerance: that change is the error of the samples before, and an upper estimate of the error of the last ones.

References
----------
Trefethen, Spectral Methods in MATLAB (2000), chapter 3 (differentiation matrices of periodic functions).
Krack, Gross, Harmonic Balance for Nonlinear Vibration Problems (2019), chapters 2 and 4.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import boolean, float64, int64, types, void

from raceway.core.jit import jit
from raceway.core.periodic import fourier
from raceway.core.periodic.extremes import force_extremes
from raceway.core.periodic.monodromy import span_transfer
from raceway.core.ring.elimination import copy_matrix, solve
from raceway.core.ring.kernels.layout import DAMPING, TILT_ARM, TIME_CONSTANT, work_rows
from raceway.core.ring.states import KERNELS, POINTS, STATES
from raceway.core.signatures import CUBE, LINEAR, MATRIX, VECTOR, Constants, record

#: Newton's steps of a level, and the last one's size over the motion's.
_STEPS, _CONVERGED, _ROUNDED = 12, 1e-11, 1e-8
#: What a neighbour's steps may leave of its motion.
_LEFT = 1e-13
#: Change of the stiffness along a motion, over its mean, beyond which no more samples are tried: balls leave their races.
_WILD = 1.0
#: Unknowns up to which all harmonics are solved for at once.
_DENSE = 48


class Orbits(NamedTuple):
    """What is computed: 1x components of displacement and force (n, 5), real and imaginary parts (n, 10), mean displacement (n, 5), ``error``: change
    of the radial 1x component by the last doubling, over the component (n,), largest change of the stiffness along the motion over its mean (n,), rms of what is not 1x over that of 1x in the radial plane (n,), largest and
    least contact forces (n, 2 Z), and those at T equidistant times of a turn (n, T, 2 Z), samples and span [rad] (n,), status (n,); where it is asked for, what becomes of a disturbance of the
    unknowns and their derivatives by the angle over a span, in the frame (n, 2 d, 2 d), else (n, 0, 0)."""

    line: np.ndarray
    force: np.ndarray
    mean: np.ndarray
    error: np.ndarray
    change: np.ndarray
    residual: np.ndarray
    peak: np.ndarray
    least: np.ndarray
    turn: np.ndarray
    samples: np.ndarray
    status: np.ndarray
    span: np.ndarray
    transfer: np.ndarray


ORBITS = record(
    Orbits, MATRIX, MATRIX, MATRIX, VECTOR, VECTOR, VECTOR, MATRIX, MATRIX, CUBE, int64[::1], int64[::1], VECTOR, CUBE
)


@jit(
    types.Tuple((int64, float64, fourier.LEVEL))(KERNELS, LINEAR, fourier.TURNING, fourier.NUMBERS, MATRIX, MATRIX, MATRIX),
    allocates=True,
)
def _orbit(kernels, linear, turning, numbers, K, ball, work):
    """Status, change of the 1x line by the last doubling, and samples of the orbit about an equilibrium with the tangent K."""
    spans, dofs = int(np.round(2.0 * np.pi / turning.span)), np.flatnonzero(linear.free > 0.0)
    d = dofs.size
    push, line, before, mean, error = np.empty((2, 5)), np.empty(10), np.zeros(10), np.empty(5), np.inf
    fourier.force_line(turning, numbers, push, mean)
    # The 1x line of M q'' + C q' + (K + S) q = F
    A, speed = np.zeros((10, 11)), numbers.speed
    for i in range(5):
        if linear.free[i] == 0.0:
            A[i, i] = A[5 + i, 5 + i] = 1.0
            continue
        for j in range(5):
            A[i, j] = A[5 + i, 5 + j] = K[i, j] * linear.free[j]
            A[5 + i, j] = speed * numbers.damping[i, j] * linear.free[j]
            A[i, 5 + j] = -A[5 + i, j]
        dynamic_stiffness = (numbers.shaft if i > 2 else 0.0) - speed * speed * numbers.mass[i]
        A[i, i] += dynamic_stiffness
        A[5 + i, 5 + i] += dynamic_stiffness
        A[i, 10], A[5 + i, 10] = push[0, i], push[1, i]
    solve(A)
    for i in range(10):
        line[i] = A[i, 10]
    n, u = turning.least, np.empty((turning.least, 5))
    fourier.first_guess(numbers.centre, line, turning, u)
    while True:
        start, dense = u.copy(), n * d <= _DENSE
        level = _level(u, ball, spans, turning.span, dense, d)
        status, step, _ = _solve_orbit(kernels, turning, numbers, level, work, dofs)
        if status != fourier.SOLVED and not dense and n * d <= 4 * _DENSE:
            copy_matrix(start, u)
            level = _level(u, ball, spans, turning.span, True, d)
            status, step, _ = _solve_orbit(kernels, turning, numbers, level, work, dofs)
        if status != fourier.SOLVED:
            break
        fourier.harmonic_lines(level.u, turning.sense, mean, line)
        error = max(fourier.line_difference(line, before), step)
        if error <= turning.tolerance:
            break
        before[:] = line
        if 2 * n > turning.most or fourier.stiffness_change(level.A0) > _WILD:
            status = fourier.UNRESOLVED
            break
        u = np.empty((2 * n, 5))
        fourier.at_twice_the_angles(level.u, u)
        n *= 2
    return status, error, level


@jit(void(fourier.TURNING, fourier.NUMBERS, fourier.LEVEL, int64, float64, int64, ORBITS), allocates=True)
def _report(turning, numbers, level, status, error, p, out):
    """One point's answer."""
    push, force = np.empty((2, 5)), np.empty(5)
    fourier.force_line(turning, numbers, push, force)
    fourier.harmonic_lines(level.u, turning.sense, out.mean[p], out.line[p])
    out.status[p], out.error[p], out.samples[p], out.change[p] = (
        status,
        error,
        level.u.shape[0],
        fourier.stiffness_change(level.A0),
    )
    out.span[p] = turning.span
    # Rms of what is neither mean nor 1x, over that of 1x, radially
    mean = out.mean[p]
    line = out.line[p]
    n, square, size = level.u.shape[0], 0.0, 0.0
    for i in range(3):
        size += 0.5 * (line[i] ** 2 + line[5 + i] ** 2)
    for j in range(n):
        angle = 2.0 * np.pi * j / n
        for i in (1, 2):
            synchronous = line[i] if turning.sense != 0.0 else line[i] * np.cos(angle) - line[5 + i] * np.sin(angle)
            square += (level.u[j, i] - mean[i] - synchronous) ** 2 / n
    out.residual[p] = np.sqrt(square / max(size, 1e-300))
    force_extremes(
        level.force, turning.order, int(np.round(2.0 * np.pi / turning.span)), out.peak[p], out.least[p], out.turn[p]
    )
    for i in range(5):
        out.force[p, i], out.force[p, 5 + i] = push[0, i], push[1, i]


@jit(void(KERNELS, LINEAR, POINTS, STATES, fourier.TURNING, ORBITS), allocates=True, releases=True)
def orbits(kernels, linear, points, states, turning, out):
    """The steady orbit of every point whose equilibrium in ``states`` has the status 0."""
    z, dofs, weight = points.table.shape[1], np.flatnonzero(linear.free > 0.0), np.empty(5)
    work = np.zeros((work_rows(points.scalars[0], points.table[0]), 2 * z))
    for p in range(points.table.shape[0]):
        out.status[p] = states.status[p]
        if states.status[p] != 0:
            continue
        numbers = _orbit_numbers(linear, points, states, turning, p, weight)
        status, error, level = _orbit(kernels, linear, turning, numbers, states.stiffness[p], states.ball[p], work)
        _report(turning, numbers, level, status, error, p, out)
        if status == fourier.SOLVED and out.transfer.shape[1] > 0:
            mass = numbers.speed**2 * numbers.mass
            if not span_transfer(level.A0, level.A1, mass, dofs, turning.span, out.transfer[p]):
                out.status[p] = fourier.NOT_SOLVED


@jit(
    types.Tuple((int64, float64))(KERNELS, fourier.TURNING, fourier.NUMBERS, fourier.LEVEL, MATRIX, MATRIX, int64[::1]),
    allocates=True,
)
def _by_chords(kernels, turning, numbers, level, inverse, work, dofs):
    """Status and last step over the motion, from a neighbour's motion in a level with the inverse of its derivatives."""
    n, d, before = level.u.shape[0], dofs.size, 0.0
    right = np.empty(n * d)
    for count in range(4 * _STEPS):
        if not fourier.orbit_imbalances(kernels, turning, numbers, level, work):
            return fourier.NOT_SOLVED, np.inf
        for j in range(n):
            for a in range(d):
                right[j * d + a] = -level.r[j, dofs[a]]
            for i in range(5):
                level.r[j, i] = 0.0
        for row in range(n * d):
            total = 0.0
            for column in range(n * d):
                total += inverse[row, column] * right[column]
            level.r[row // d, dofs[row % d]] = total
        step, size = _apply_step(level, turning, numbers)
        if not step < 1e-2:
            return fourier.NOT_SOLVED, np.inf
        if numbers.damped:
            fourier.ball_rates(level.ball, turning.order, level.turn, numbers.speed, level.ball_rate)
        # What is left is the last step times the rate at which steps fall.
        left = step if count == 0 else min(step, step * step / before)
        converged = left <= _LEFT * size or (count > 0 and step <= _ROUNDED * size and step > 0.5 * before)
        if converged and (count > 2 or not numbers.damped):
            return fourier.SOLVED, step / max(size, 1e-300)
        before = step
    return fourier.NOT_SOLVED, np.inf


@jit(void(KERNELS, LINEAR, POINTS, STATES, fourier.TURNING, ORBITS), allocates=True, releases=True)
def neighbours(kernels, linear, points, states, turning, out):
    """The same of points next to the first one: its samples, and steps by the derivatives of its imbalance."""
    z, dofs, weight = points.table.shape[1], np.flatnonzero(linear.free > 0.0), np.empty(5)
    work = np.zeros((work_rows(points.scalars[0], points.table[0]), 2 * z))
    out.status[:] = fourier.NOT_SOLVED
    numbers = _orbit_numbers(linear, points, states, turning, 0, weight)
    status, error, level = _orbit(kernels, linear, turning, numbers, states.stiffness[0], states.ball[0], work)
    n, d = level.u.shape[0], dofs.size
    if status != fourier.SOLVED or n * d > 4 * _DENSE:
        return
    _report(turning, numbers, level, status, error, 0, out)
    inverse, J = np.empty((n * d, n * d)), np.zeros((n * d, 2 * n * d))
    fourier.orbit_jacobian(level, numbers.mass, numbers.speed, dofs, J)
    for row in range(n * d):
        J[row, n * d + row] = 1.0
    if not solve(J):
        return
    inverse[:] = J[:, n * d :]
    u, ball, rate, shift, answer = level.u.copy(), level.ball.copy(), level.ball_rate.copy(), np.empty(5), np.empty(5)
    for p in range(1, points.table.shape[0]):
        if states.status[p] != 0:
            continue
        numbers = _orbit_numbers(linear, points, states, turning, p, weight)
        for i in range(5):
            shift[i] = states.q[p, i] - states.q[0, i]
        for j in range(n):  # along with the equilibrium
            fourier.turn_vector(-turning.sense * turning.span * j / n, shift, answer)
            for i in range(5):
                level.u[j, i] = u[j, i] + answer[i]
        level.ball[:], level.ball_rate[:] = ball, rate
        status, error = _by_chords(kernels, turning, numbers, level, inverse, work, dofs)
        _report(turning, numbers, level, status, error, p, out)


@jit(boolean(fourier.LEVEL, VECTOR, float64, int64[::1]))
def _orbit_step(level, mass, speed, dofs):
    """u of all samples by Newton's method; False where the matrix is singular."""
    n, d, J = level.u.shape[0], dofs.size, level.J
    fourier.orbit_jacobian(level, mass, speed, dofs, J)
    for j in range(n):
        for a in range(d):
            J[j * d + a, n * d] = -level.r[j, dofs[a]]
    if not solve(J):
        return False
    for j in range(n):
        for i in range(5):
            level.r[j, i] = 0.0
        for a in range(d):
            level.r[j, dofs[a]] = J[j * d + a, n * d]
    return True


@jit(boolean(fourier.LEVEL, VECTOR, float64, float64, int64[::1]), allocates=True)
def _harmonic_step(level, mass, speed, wave, dofs):
    """The same with the mean of A0 and A1 over the samples: each harmonic by itself.  ``wave`` : 2 pi over the span."""
    n, d = level.u.shape[0], dofs.size
    A0, A1, step = np.zeros((5, 5)), np.zeros((5, 5)), np.zeros((n, 5))
    for j in range(n):
        for i in range(5):
            for k in range(5):
                A0[i, k] += level.A0[j, i, k] / n
                A1[i, k] += level.A1[j, i, k] / n
    cosine, sine, M = np.empty(n), np.empty(n), np.empty((2 * d, 2 * d + 1))
    for j in range(n):
        cosine[j], sine[j] = np.cos(2.0 * np.pi * j / n), np.sin(2.0 * np.pi * j / n)
    for h in range(n // 2 + 1):
        along = 0.0 if h == n // 2 else wave * h
        for a in range(d):
            i = dofs[a]
            for b in range(d):
                k = dofs[b]
                M[a, b] = M[d + a, d + b] = A0[i, k] - (speed * speed * mass[i] * (wave * h) ** 2 if i == k else 0.0)
                M[a, d + b], M[d + a, b] = -along * A1[i, k], along * A1[i, k]
            re, im = 0.0, 0.0
            for j in range(n):
                re -= cosine[h * j % n] * level.r[j, i]
                im += sine[h * j % n] * level.r[j, i]
            M[a, 2 * d], M[d + a, 2 * d] = re / n, im / n
        if not solve(M):
            return False
        times = 1.0 if h in (0, n // 2) else 2.0
        for j in range(n):
            for a in range(d):
                step[j, dofs[a]] += times * (cosine[h * j % n] * M[a, 2 * d] - sine[h * j % n] * M[d + a, 2 * d])
    copy_matrix(step, level.r)
    return True


@jit(fourier.LEVEL(MATRIX, MATRIX, int64, float64, boolean, int64), allocates=True)
def _level(u, ball, spans, span, dense, d):
    """Arrays for the samples u (n, 5), balls beginning at their places (Z, b) of the equilibrium."""
    n, (z, columns) = u.shape[0], ball.shape
    level = fourier.Level(
        u, np.empty((n, 5)), np.empty((n, 5)), np.empty((n, 5)), np.empty((n, 5, 5)), np.empty((n, 5, 5)),
        np.empty((n, z, columns)), np.zeros((n, z, columns)), np.empty((n, 2 * z)), np.empty(n), np.empty(n), np.empty(2 * n * spans),
        np.zeros((n * d, n * d + 1) if dense else (1, 2)),
    )  # fmt: skip
    fourier.circulants(n, span, level.d1, level.d2)
    fourier.circulants(n * spans, 2.0 * np.pi, level.turn[: n * spans], np.empty(n * spans))
    level.turn[n * spans :] = level.turn[: n * spans]
    for j in range(n):
        copy_matrix(ball, level.ball[j])
    return level


@jit(types.UniTuple(float64, 2)(fourier.LEVEL, fourier.TURNING, fourier.NUMBERS))
def _apply_step(level, turning, numbers):
    """Add the step in r to u; size of the step, and of the motion about the equilibrium."""
    centre, weight = numbers.centre, numbers.weight
    n, step, size = level.u.shape[0], 0.0, 0.0
    for j in range(n):
        angle = -turning.sense * turning.span * j / n
        c, s = np.cos(angle), np.sin(angle)
        for i in range(5):
            level.u[j, i] += level.r[j, i]
            step = max(step, abs(level.r[j, i]) * weight[i]) if np.isfinite(level.r[j, i]) else np.inf
        for i in (1, 3):  # the equilibrium seen from the frame
            y, z = c * centre[i] - s * centre[i + 1], s * centre[i] + c * centre[i + 1]
            size = max(size, max(abs(level.u[j, i] - y), abs(level.u[j, i + 1] - z)) * weight[i])
    return step, size


@jit(
    types.Tuple((int64, float64, float64))(KERNELS, fourier.TURNING, fourier.NUMBERS, fourier.LEVEL, MATRIX, int64[::1]),
    allocates=True,
)
def _solve_orbit(kernels, turning, numbers, level, work, dofs):
    """Status, last step over the motion, and the motion's size [m], of the orbit with a level's samples."""
    dense, before, size = level.J.shape[0] > 1, np.inf, 0.0
    wave = 2.0 * np.pi / turning.span
    for count in range(_STEPS if dense else 4 * _STEPS):
        if not fourier.orbit_imbalances(kernels, turning, numbers, level, work):
            return fourier.NOT_SOLVED, np.inf, size
        if dense:
            fine = _orbit_step(level, numbers.mass, numbers.speed, dofs)
        else:
            fine = _harmonic_step(level, numbers.mass, numbers.speed, wave, dofs)
        step, size = _apply_step(level, turning, numbers)
        if not fine or not step < 1e-2 or not size < 1e-2:
            return fourier.NOT_SOLVED, np.inf, size
        if numbers.damped:
            fourier.ball_rates(level.ball, turning.order, level.turn, numbers.speed, level.ball_rate)
        converged = step <= _CONVERGED * size or (step <= _ROUNDED * size and step > 0.5 * before)
        if converged and (count > 2 or not numbers.damped):
            return fourier.SOLVED, step / max(size, 1e-300), size
        before = step
    return fourier.NOT_SOLVED, np.inf, size


@jit(fourier.NUMBERS(LINEAR, POINTS, STATES, fourier.TURNING, int64, VECTOR), allocates=True)
def _orbit_numbers(linear, points, states, turning, p, weight):
    """Of one point; ``weight`` is filled in."""
    constants = Constants(points.scalars[p], points.table[p])
    weight[:3] = 1.0
    weight[3] = weight[4] = constants.scalars[TILT_ARM]
    damping = constants.scalars[DAMPING] != 0.0 or constants.scalars[TIME_CONSTANT] != 0.0
    return fourier.Numbers(
        constants, points.params[p], points.load[p], turning.mass[p], turning.damping[p], points.shaft[p], turning.speed[p],
        turning.params[p], damping, states.q[p], weight,
    )  # fmt: skip
