"""Compiled loops of the suites: kernels are called here the way that the time loops call them, as function pointers."""

# Kernels: numba types them by their explicit signatures.
# mypy: ignore-errors

import numpy as np
from numba import float64, int64, void

from raceway.core.jit import jit
from raceway.core.ring.kernels import CONTACT_FORCE, FORCE_BY_GAP, FORCE_BY_RATE, GAP, GAP_RATE
from raceway.core.ring.kernels.layout import DIAMETER
from raceway.core.signatures import FORCE, FORCE_POINTER, LAW, LAW_POINTER, MATRIX, SYSTEM, VECTOR


@jit(void(int64, LAW_POINTER, VECTOR, VECTOR, MATRIX, MATRIX, MATRIX, float64, VECTOR, VECTOR, VECTOR))
def repeat_law(count, law, gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    """Call a law ``count`` times with the same arguments."""
    for _ in range(count):
        law(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate)


@jit(void(LAW_POINTER, MATRIX, MATRIX, MATRIX, float64, MATRIX, MATRIX, MATRIX, MATRIX))
def along_path(law, gaps, rates, params, dt, state_old, state_new, scratch, forces):
    """Drive n contacts along paths (steps, n) of gap and rate; the state is committed after each step.

    ``scratch`` is (2, n); ``forces`` (steps, n) is the answer.
    """
    for step in range(gaps.shape[0]):
        law(gaps[step], rates[step], params, state_old, state_new, dt, forces[step], scratch[0], scratch[1])
        for i in range(state_old.shape[0]):
            for j in range(state_old.shape[1]):
                state_old[i, j] = state_new[i, j]


@jit(void(int64, FORCE_POINTER, VECTOR, VECTOR, MATRIX))
def sample_force(repeats, force, params, times, out):
    """out (n, 5): the force at times (n,); the whole row of samples is taken ``repeats`` times."""
    for _ in range(repeats):
        for i in range(times.size):
            force(times[i], params, out[i])


@jit(FORCE)
def along_x(t, params, out):
    """Force params[0] cos(params[1] t) along the axis."""
    for i in range(out.size):
        out[i] = 0.0
    out[0] = params[0] * np.cos(params[1] * t)


#: Gap of contacts that stay open [m].
_OPEN = 1.0


@jit(SYSTEM)
def one_contact(t, q, v, balls, contacts, constants, response):
    """See ``raceway.core.ring.kernels``."""
    law, law_params, law_old, law_new, dt = contacts
    scalars, _ = constants
    f, K, C, work = response
    gap, rate, force = work[GAP], work[GAP_RATE], work[CONTACT_FORCE]
    d_gap, d_rate = work[FORCE_BY_GAP], work[FORCE_BY_RATE]
    for i in range(gap.size):
        gap[i] = _OPEN
        rate[i] = 0.0
    gap[0] = scalars[DIAMETER] - q[0]
    rate[0] = -v[0]
    law(gap, rate, law_params, law_old, law_new, dt, force, d_gap, d_rate)
    for i in range(5):
        f[i] = 0.0
        for j in range(5):
            K[i, j] = 0.0
            C[i, j] = 0.0
    f[0] = force[0]
    K[0, 0] = -d_gap[0]
    C[0, 0] = -d_rate[0]
    return 0


@jit(LAW)
def counting(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    """Hertz in the first contact; in the second, which is open, the "force" says how often its memory was committed."""
    for i in range(gap.size):
        approach = max(-gap[i], 0.0)
        root = params[i, 0] * np.sqrt(approach)
        state_new[i, 0] = state_old[i, 0] + 1.0
        force[i] = root * approach if i == 0 else state_new[i, 0]
        d_gap[i] = -1.5 * root
        d_rate[i] = 0.0
