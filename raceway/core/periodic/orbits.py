"""Steady orbits of many operating points in one compiled loop, four in lockstep.

Samples are doubled until the 1x line changes by less than the tolerance: that change is the error of the samples before, and an upper
estimate of the error of the last ones.
"""

from typing import NamedTuple

import numpy as np
from numba import boolean, float64, int64, void

from raceway.core.jit import jit
from raceway.core.lanes import WIDTH, live_of, put, where
from raceway.core.periodic import fourier, lockstep
from raceway.core.periodic import steps as at
from raceway.core.periodic.extremes import force_extremes
from raceway.core.periodic.monodromy import span_transfer
from raceway.core.periodic.steps import COLUMNS
from raceway.core.ring.compliances import SHIFT
from raceway.core.ring.elimination import copy_matrix
from raceway.core.ring.kernels import CONTACT_FORCE
from raceway.core.ring.kernels.layout import DAMPING, TILT_ARM, TIME_CONSTANT, are_condensed, work_rows
from raceway.core.ring.lockstep import ARM, DQ, LOAD, PLACE, SHAFT, TANGENT, WORK_ROWS, Q, asks_for_rates, gather
from raceway.core.signatures import CUBE, KERNELS, LINEAR, MATRIX, POINTS, STATES, VECTOR, record

#: Change of the stiffness along a motion, over its mean, beyond which no more samples are tried: balls leave their races.
_WILD = 1.0
#: Last step over the motion: of points, of neighbours whose differences are derivatives, and of samples that are doubled anyway.
_CLOSE, _CLOSER, _NEAR = 1e-11, 1e-13, 1e-6


class Orbits(NamedTuple):
    """What is computed: 1x components of displacement and force (n, 5), real and imaginary parts (n, 10), mean displacement (n, 5), ``error``: change
    of the radial 1x component by the last doubling, over the component (n,), largest change of the stiffness along the motion over its mean (n,), rms of what is not 1x over that of 1x in the radial plane (n,), largest and
    least contact forces (n, 2 Z), of the former an upper bound where the latter are (n, 0), and those at T equidistant times of a turn (n, T, 2 Z), samples and span [rad] (n,), status (n,); where it is asked for, what becomes of a disturbance of the
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


@jit(void(fourier.TURNING, MATRIX, MATRIX, int64, float64, int64, ORBITS), allocates=True)
def _report(turning, u, force, status, error, p, out):
    """One point's answer from its motion u (n, 5) and contact forces (n, 2 Z)."""
    fourier.harmonic_lines(u, turning.sense, out.mean[p], out.line[p])
    out.status[p], out.error[p], out.samples[p], out.span[p] = status, error, u.shape[0], turning.span
    # Rms of what is neither mean nor 1x, over that of 1x, radially
    mean = out.mean[p]
    line = out.line[p]
    n, square, size = u.shape[0], 0.0, 0.0
    for i in range(3):
        size += 0.5 * (line[i] ** 2 + line[5 + i] ** 2)
    for j in range(n):
        angle = 2.0 * np.pi * j / n
        for i in (1, 2):
            synchronous = line[i] if turning.sense != 0.0 else line[i] * np.cos(angle) - line[5 + i] * np.sin(angle)
            square += (u[j, i] - mean[i] - synchronous) ** 2 / n
    out.residual[p] = np.sqrt(square / max(size, 1e-300))
    spans = int(np.round(2.0 * np.pi / turning.span))
    if out.least.shape[1] > 0:
        force_extremes(force, turning.order, spans, out.peak[p], out.least[p], out.turn[p])
        return
    # Between equidistant samples a polynomial is at most Lebesgue's constant times as large.
    z, over = turning.order.size, 1.0 + 2.0 / np.pi * np.log(float(n * spans))
    for race in (0, z):
        out.peak[p, race : race + z] = over * force[:, race : race + z].max()


@jit(void(int64, int64, POINTS, STATES, fourier.TURNING, at.BLOCK), allocates=True)
def _put_loads(n, first, points, states, turning, block):
    """Loads and equilibria of a block's points, seen from the frame, at n samples."""
    force, answer, stride = np.empty(5), np.empty(5), block.rows.shape[0] // n
    for j in range(n):
        angle, row = turning.span * j / n, block.rows[j * stride]
        cosine, sine = np.cos(turning.sense * angle), np.sin(turning.sense * angle)
        for lane in range(WIDTH):
            p = min(first + lane, states.status.size - 1)
            turning.force(angle / turning.speed[p], turning.params[p], force)
            for i in range(5):
                force[i] += points.load[p, i]
            fourier.turn_vector(cosine, -sine, force, answer)
            for i in range(5):
                row[LOAD + i, lane] = answer[i]
            fourier.turn_vector(cosine, -sine, states.q[p], answer)
            for i in range(5):
                row[at.CENTRE + i, lane] = answer[i]


@jit(boolean(KERNELS, boolean, LINEAR, int64, POINTS, STATES, fourier.TURNING, MATRIX, MATRIX, at.BLOCK), allocates=True)
def _begin(kernels, alone, linear, first, points, states, turning, push, like, block):
    """The least samples of a block's points, to which balls follow from the equilibrium; whether the law lets them, which has no rates.

    push : 1x components of the forces (n, 10)
    like : motion (n, 5) about the first point's equilibrium that all begin with, or (0, 5): each with its linear response
    """
    n, sense, work, rows, shared = turning.least, turning.sense, block.work, block.rows, block.shared
    line, u, stride, moved = np.empty(10), np.empty((turning.least, 5)), block.rows.shape[0] // turning.least, np.empty(5)
    if not alone:
        gather(first, points, block.params, block.bodies, work[0], rows[0])
    for lane in range(WIDTH):
        p = min(first + lane, states.status.size - 1)
        rows[0, SHAFT, lane], rows[0, ARM, lane] = points.shaft[p], points.scalars[p, TILT_ARM]
        for i in range(5):
            rows[0, Q + i, lane], rows[0, DQ + i, lane] = states.q[p, i], 0.0
        if not alone:
            for k in range(points.table.shape[1]):
                for c in range(2):
                    column = (c * points.table.shape[1] + k) * WIDTH + lane  # the last columns are those of elastic bodies
                    work[0, PLACE, column], work[0, SHIFT, column] = states.ball[p, k, c], states.ball[p, k, c - 2]
        for i in range(50):
            rows[0, TANGENT + i, lane] = 0.0
    if not alone:
        lockstep.forces(kernels.law, False, 1.0, 1, block)
        if asks_for_rates(work[0]):
            return False
        for p in range(first, min(first + WIDTH, states.status.size) if len(block.bodies) > 0 else first):
            if lockstep.dampers(points, p):  # structural approaches have no rates in lanes
                return False
    for j in range(1, n):
        copy_matrix(rows[0], rows[j * stride])
        if not alone:
            at.copy_balls(sense * turning.span * j / n, work[0], work[j * stride])
    _put_loads(n, first, points, states, turning, block)
    for lane in range(WIDTH):
        p = min(first + lane, states.status.size - 1)
        w = turning.speed[p]
        if len(like) == 0:
            fourier.linear_response(linear, points, states, turning, p, push[p], u)
        for j in range(n):
            if len(like) > 0:
                for i in range(5):
                    line[i] = states.q[p, i] - states.q[0, i]
                angle = sense * turning.span * j / n
                fourier.turn_vector(np.cos(angle), -np.sin(angle), line, moved)
                for i in range(5):
                    u[j, i] = like[j, i] + moved[i]
            for i in range(5):
                rows[j * stride, Q + i, lane] = u[j, i]
                rows[j * stride, DQ + i, lane] = u[j, i] - rows[j * stride, at.CENTRE + i, lane]
        shared[at.DASHPOT, lane], shared[at.TIME, lane] = points.scalars[p, DAMPING], points.scalars[p, TIME_CONSTANT]
        shared[at.SPEED, lane] = w
        for i in range(5):
            shared[at.MASS + i, lane] = w * w * turning.mass[p, i]
            for m in range(5):
                shared[at.DAMPED + 5 * i + m, lane] = w * turning.damping[p, i, m]
    at.put_fixed(sense, rows[0], shared)
    return True


@jit(void(KERNELS, boolean, LINEAR, int64, int64, POINTS, STATES, fourier.TURNING, MATRIX, at.BLOCK, ORBITS), allocates=True)
def _solve_block(kernels, alone, linear, first, end, points, states, turning, like, block, out):
    """The orbits of those of ``WIDTH`` points from ``first`` on, before ``end``, that are not solved; alone: see ``lockstep.forces_alone``."""
    n, live, dofs, shared = turning.least, live_of(0, WIDTH), np.flatnonzero(linear.free > 0.0), block.shared
    line, mean, before, pending = np.empty(10), np.empty(5), np.zeros((WIDTH, 10)), np.zeros(WIDTH)
    closeness = _CLOSE if len(like) == 0 else _CLOSER
    for p in range(first, min(first + WIDTH, end)):
        pending[p - first] = states.status[p] == 0 and out.status[p] != 0
        if pending[p - first] > 0.0:
            fourier.force_line(turning, p, out.force[p])
    if pending.max() == 0.0 or not _begin(kernels, alone, linear, first, points, states, turning, out.force, like, block):
        return
    while True:
        for lane in range(WIDTH):
            shared[at.WANTED, lane] = pending[lane]
        # The first level is never the last one: its motion is compared with the next one's.
        enough = _NEAR if n == turning.least and 2 * n <= turning.most and len(like) == 0 else closeness
        done, steps, change = lockstep.solve_level(kernels, alone, n, first, points, states, turning, dofs, enough, block)
        put(shared, at.ANSWER, 0, live, where(done, steps, np.inf))
        put(shared, at.ANSWER + 1, 0, live, change)
        u, stride = np.empty((n, 5)), block.rows.shape[0] // n
        for lane in range(WIDTH):
            if pending[lane] == 0.0:
                continue
            p, error = first + lane, shared[at.ANSWER, lane]
            for j in range(n):
                for i in range(5):
                    u[j, i] = block.rows[j * stride, Q + i, lane]
            solved = error < np.inf
            if solved and len(like) == 0:
                fourier.harmonic_lines(u, turning.sense, mean, line)
                square, size = 0.0, 1e-300
                for i in range(10):
                    if i in (1, 2, 6, 7):
                        square, size = square + (line[i] - before[lane, i]) ** 2, size + line[i] ** 2
                    before[lane, i] = line[i]
                error = max(np.sqrt(square / size), error)
            out.change[p] = shared[at.ANSWER + 1, lane]
            if solved and error > turning.tolerance and 2 * n <= turning.most and out.change[p] <= _WILD:
                continue
            pending[lane] = 0.0
            force = np.empty((n, 2 * points.table.shape[1]))
            for j in range(n):
                for k in range(force.shape[1]):
                    force[j, k] = max(block.work[j * stride, CONTACT_FORCE, k * WIDTH + lane], 0.0)
            status = fourier.SOLVED if error <= turning.tolerance else fourier.UNRESOLVED if solved else fourier.NOT_SOLVED
            _report(turning, u, force, status, error, p, out)
            if status == fourier.SOLVED and out.transfer.shape[1] > 0:
                A0, A1, mass = np.empty((n, 5, 5)), np.empty((n, 5, 5)), turning.speed[p] ** 2 * turning.mass[p]
                for j in range(n):
                    row = block.rows[j * stride]
                    for m in range(25):
                        A0[j, m // 5, m % 5] = row[TANGENT + m, lane] + shared[at.FIXED + m, lane]
                        A1[j, m // 5, m % 5] = row[at.VISCOUS + m, lane] + shared[at.BY_RATE + m, lane]
                if not span_transfer(A0, A1, mass, dofs, turning.span, out.transfer[p]):
                    out.status[p] = fourier.NOT_SOLVED
        if pending.max() == 0.0:
            break
        at.double(n, alone, turning.sense, turning.span, block)
        n *= 2
        _put_loads(n, first, points, states, turning, block)


@jit(void(KERNELS, LINEAR, POINTS, STATES, fourier.TURNING, boolean, ORBITS), allocates=True, releases=True)
def orbits(kernels, linear, points, states, turning, near, out):
    """The steady orbit of every point whose equilibrium in ``states`` has the status 0; others keep theirs.

    near : all points lie next to the first one, and begin from its motion with its samples: their differences are derivatives
    """
    count, most = states.status.size, turning.most
    for p in range(count):
        out.status[p] = states.status[p] if states.status[p] != 0 else fourier.NOT_SOLVED
    z, like, own = points.table.shape[1], np.empty((0, 5)), turning
    block = at.Block(
        np.empty((2 * z * WIDTH, points.params.shape[2])), np.zeros((2 * z * WIDTH, 0)),
        np.zeros((WIDTH * are_condensed(points.scalars[0]), points.scalars.shape[1])), np.zeros((most, WORK_ROWS, 2 * z * WIDTH)),
        np.zeros((most, at.ROWS, WIDTH)), np.zeros((2 * COLUMNS + 3, 5 * most, WIDTH)),
        np.zeros((at.SHARED_ROWS, WIDTH)), np.zeros((work_rows(points.scalars[0], points.table[0]), 2 * z)),
    )  # fmt: skip
    # One loop for the first point and its neighbours: each call of ``_solve_block`` is compiled anew, in seconds.
    first, end = 0, 1 if near else count
    while first < count:
        for p in range(first, end, WIDTH):
            for mode in range(0 if kernels.lanes else 1, 2):
                _solve_block(kernels, mode > 0, linear, p, end, points, states, own, like, block, out)
        if near and out.status[0] != fourier.SOLVED:
            break
        if first < end < count:
            n = out.samples[0]
            like = np.empty((n, 5))
            for j in range(n):
                for i in range(5):
                    like[j, i] = block.rows[j * (most // n), Q + i, 0]
            own = fourier.Turning(
                turning.force, turning.params, turning.speed, turning.damping, turning.mass, turning.sense, turning.span,
                turning.order, n, most, 1e300,
            )  # fmt: skip
        first, end = end, count
