"""Compiled time loops, one a file; the classes with the options are in ``raceway.integrators``.

Every loop has the signature ``raceway.core.signatures.LOOP``::

    loop(system, law, force, law_params, scalars, table, force_params,
         mass, damping, stiffness, free, load, coefficients, dt, ramp, first, count,
         motion, ball, ball_before, law_state, stride, rows, probes, counters) -> steps done

    mass, damping, stiffness (5, 5)   linear parts, damping with the gyroscopic terms
    free (5,)           1 for unknowns, 0 for coordinates that are held;  load (5,) the constant load
    coefficients        the method's own numbers
    dt, first, count    step [s]; number of the step that the motion stands at; steps to take
    ramp [s]            time over which the excitation grows smoothly from zero; 0 for none
    motion (4, 5)       q, v, a and the rest force at step ``first``; moved on in place, only by accepted steps
    ball, ball_before (Z, 2, 4 or 6), law_state (2 Z, m)   committed with the motion
    stride, rows (n, 16), probes (n, 3, 4 or 5, 2 Z)   every ``stride``-th step: t, q, v, outer force; gaps, contact
                        forces, ball positions, slips, structural approaches
    counters (8,)       see ``COUNTERS``

A loop that returns less than ``count`` failed at the next step; ``motion`` is then the last good state.

implicit                 Newmark's method and generalised-alpha
central_difference       explicit in the contacts
quasi_static             a series of equilibria;  quasi_static_tangential: of forces without a potential
"""

from numba import float64, int64, void

from raceway.core.jit import jit
from raceway.core.signatures import CUBE, FORCE_POINTER, MATRIX, VECTOR

#: evaluations, reason of a failure, residual at the failure, greatest penetration [m], greatest contact force [N].
EVALUATIONS, REASON, RESIDUAL, PENETRATION, CONTACT_FORCE, ROWS = range(6)
COUNTERS = 8
NO_FAILURE, BALLS, NEWTON, UNBOUNDED = range(4)


@jit(void(FORCE_POINTER, float64, VECTOR, float64, VECTOR), inline=True)
def outer_force(force, t, params, ramp, out):
    """out (5,): the excitation at time t, under a ramp 10 s^3 - 15 s^4 + 6 s^5 (twice continuously differentiable)."""
    force(t, params, out)
    if t < ramp:
        s = max(t / ramp, 0.0)
        for i in range(out.size):
            out[i] *= s * s * s * (10.0 - 15.0 * s + 6.0 * s * s)


@jit(void(int64, MATRIX, CUBE, int64, VECTOR, MATRIX, VECTOR, MATRIX, MATRIX, VECTOR), inline=True)
def note_step(number, rows, probes, stride, t, motion, outer, work, ball, counters):
    """Keep a step in the record (t is (1,)) and the extremes in the counters."""
    n = work.shape[1]
    lowest, largest = -counters[3], counters[4]
    for i in range(n):
        lowest, largest = min(lowest, work[0, i]), max(largest, work[2, i])
    counters[3], counters[4] = -lowest, largest
    if number % stride != 0:
        return
    row = int64(counters[5])
    if row >= rows.shape[0]:
        return
    counters[5] = row + 1.0
    rows[row, 0] = t[0]
    for i in range(5):
        rows[row, 1 + i] = motion[0, i]
        rows[row, 6 + i] = motion[1, i]
        rows[row, 11 + i] = outer[i]
    for i in range(n):
        probes[row, 0, i] = work[0, i]
        probes[row, 1, i] = work[2, i]
    for pair in range(ball.shape[1] // 2):
        for k in range(ball.shape[0]):
            probes[row, 2 + pair, 2 * k] = ball[k, 2 * pair]
            probes[row, 2 + pair, 2 * k + 1] = ball[k, 2 * pair + 1]
