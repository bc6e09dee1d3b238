"""Compiled time loops, one a file; the classes with the options are in ``raceway.integrators``.

Every loop has the signature ``raceway.core.signatures.LOOP``, whose records stand there::

    loop(forces, linear, outer, coefficients, steps, state, recording) -> steps done

    linear         damping holds the gyroscopic terms
    coefficients   the method's own numbers
    state          moved on in place, only by accepted steps
    recording      rows (n, 16): t, q, v, outer force; probes (n, 3, 4 or 5, 2 Z): gaps, contact forces, ball positions, slips,
                   structural approaches; counters (8,): see ``COUNTERS``

A loop that returns less than ``steps.total`` failed at the next step; ``state`` is then the last good one.

implicit                 Newmark's method and generalised-alpha
central_difference       explicit in the contacts
quasi_static             a series of equilibria, around the solver that finds one
"""

from numba import float64, int64, void

from raceway.core.jit import jit
from raceway.core.ring.kernels import CONTACT_FORCE as FORCES
from raceway.core.ring.kernels import GAP
from raceway.core.signatures import MATRIX, OUTER, RECORDING, VECTOR

#: evaluations, reason of a failure, residual at the failure, greatest penetration [m], greatest contact force [N], rows
#: recorded, greatest excitation [N].
EVALUATIONS, REASON, RESIDUAL, PENETRATION, CONTACT_FORCE, ROWS, EXCITATION = range(7)
COUNTERS = 8
NO_FAILURE, BALLS, NEWTON, UNBOUNDED = range(4)


@jit(void(OUTER, float64, VECTOR), inline=True)
def outer_force(outer, t, out):
    """out (5,): the excitation at time t, under a ramp 10 s^3 - 15 s^4 + 6 s^5 (twice continuously differentiable)."""
    outer.force(t, outer.params, out)
    if t < outer.ramp:
        s = max(t / outer.ramp, 0.0)
        for i in range(out.size):
            out[i] *= s * s * s * (10.0 - 15.0 * s + 6.0 * s * s)


@jit(void(RECORDING, int64, float64, MATRIX, VECTOR, MATRIX, MATRIX), inline=True)
def note_step(recording, number, t, motion, outer, work, ball):
    """Note a step at time t under the outer force (5,), and the extremes in the counters."""
    stride, rows, probes, counters = recording
    n = work.shape[1]
    lowest, largest = -counters[PENETRATION], counters[CONTACT_FORCE]
    for i in range(n):
        lowest, largest = min(lowest, work[GAP, i]), max(largest, work[FORCES, i])
    counters[PENETRATION], counters[CONTACT_FORCE] = -lowest, largest
    if number % stride != 0:
        return
    row = int64(counters[ROWS])
    if row >= rows.shape[0]:
        return
    counters[ROWS] = row + 1.0
    rows[row, 0] = t
    for i in range(5):
        rows[row, 1 + i] = motion[0, i]
        rows[row, 6 + i] = motion[1, i]
        rows[row, 11 + i] = outer[i]
    for i in range(n):
        probes[row, 0, i] = work[GAP, i]
        probes[row, 1, i] = work[FORCES, i]
    for pair in range(ball.shape[1] // 2):
        for k in range(ball.shape[0]):
            probes[row, 2 + pair, 2 * k] = ball[k, 2 * pair]
            probes[row, 2 + pair, 2 * k + 1] = ball[k, 2 * pair + 1]
