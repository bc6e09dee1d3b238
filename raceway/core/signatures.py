"""The types of the kernels that reach the time loops as function pointers.

A kernel carries one explicit signature of C-contiguous float64 arrays, so that one compiled loop serves every
plug-in of its kind.
"""

from numba import float64, int64, types, void

VECTOR = float64[::1]
MATRIX = float64[:, ::1]

#: law(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate)
LAW = void(VECTOR, VECTOR, MATRIX, MATRIX, MATRIX, float64, VECTOR, VECTOR, VECTOR)
LAW_POINTER = types.FunctionType(LAW)

#: force(t, params, out (5,))
FORCE = void(float64, VECTOR, VECTOR)
FORCE_POINTER = types.FunctionType(FORCE)

#: system(t, dt, q, v, ball, ball_gain, ball_known, law, law_params, law_old, law_new, scalars, table, work,
#:        f (5,), K (5, 5), C (5, 5)) -> status, see raceway.core.ring.kernels
SYSTEM = int64(
    float64, float64, VECTOR, VECTOR, MATRIX, float64, MATRIX,
    LAW_POINTER, MATRIX, MATRIX, MATRIX, VECTOR, MATRIX, MATRIX, VECTOR, MATRIX, MATRIX,
)  # fmt: skip
SYSTEM_POINTER = types.FunctionType(SYSTEM)

CUBE = float64[:, :, ::1]

#: The arguments that every compiled loop shares; see ``raceway.core.schemes.compiled``.
_MODEL = (
    SYSTEM_POINTER, LAW_POINTER, FORCE_POINTER, MATRIX, VECTOR, MATRIX, VECTOR,
    MATRIX, MATRIX, MATRIX, VECTOR, VECTOR,
)  # fmt: skip
_STATE = (MATRIX, MATRIX, MATRIX, MATRIX)
_RECORD = (int64, MATRIX, CUBE, VECTOR)

#: loop(model..., coefficients, dt, ramp, first, count, state..., stride, rows, probes, counters) -> steps done
LOOP = int64(*_MODEL, VECTOR, float64, float64, int64, int64, *_STATE, *_RECORD)

#: settle(system, law, law_params, scalars, table, stiffness, free, load, tolerance, t, q, ball, law_state, work, f, K,
#:        report) -> status
SETTLE = int64(
    SYSTEM_POINTER, LAW_POINTER, MATRIX, VECTOR, MATRIX, MATRIX, VECTOR, VECTOR, float64, float64,
    VECTOR, MATRIX, MATRIX, MATRIX, VECTOR, MATRIX, VECTOR,
)  # fmt: skip
