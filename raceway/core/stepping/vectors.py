"""The passes of an explicit step over long vectors, a share of them at a time: equations in ``raceway.core.schemes.explicit``."""

from numba import boolean, float64, int64, void

from raceway.core.jit import jit
from raceway.core.signatures import VECTOR


@jit(void(int64, int64, float64, VECTOR, VECTOR, VECTOR, VECTOR, VECTOR, VECTOR), releases=True)
def predict(first, last, dt, u, v, a, half, moved, guess):  # type: ignore[no-untyped-def]
    """Entries ``first`` to ``last - 1`` of the velocity at half a step, the displacement and the guessed velocity at its end.

    Parameters
    ----------
    u, v, a : (size,) of the step before;  half, moved, guess : (size,) out
    """
    for i in range(first, last):
        half[i] = v[i] + 0.5 * dt * a[i]
        moved[i] = u[i] + dt * half[i]
        guess[i] = v[i] + dt * a[i]


@jit(boolean(int64, int64, float64, VECTOR, VECTOR), releases=True)
def finish(first, last, dt, a, v):  # type: ignore[no-untyped-def]
    """The velocity v (size,), at first that at half the step, at its end; whether all accelerations a (size,) are finite."""
    bad = 0
    for i in range(first, last):
        v[i] = v[i] + 0.5 * dt * a[i]
        # Less itself it is zero, or no number.
        bad += 0 if a[i] - a[i] == 0.0 else 1
    return bad == 0


@jit(float64(int64, int64, VECTOR, VECTOR, VECTOR, VECTOR), releases=True)
def work(first, last, outer_before, outer, u_before, u):  # type: ignore[no-untyped-def]
    """Work of the mean outer force over a step, of the entries ``first`` to ``last - 1`` [J]: four sums that do not wait."""
    a, b, c, d = 0.0, 0.0, 0.0, 0.0
    fours = first + (last - first) // 4 * 4
    for i in range(first, fours, 4):
        a += (outer_before[i] + outer[i]) * (u[i] - u_before[i])
        b += (outer_before[i + 1] + outer[i + 1]) * (u[i + 1] - u_before[i + 1])
        c += (outer_before[i + 2] + outer[i + 2]) * (u[i + 2] - u_before[i + 2])
        d += (outer_before[i + 3] + outer[i + 3]) * (u[i + 3] - u_before[i + 3])
    for i in range(fours, last):
        a += (outer_before[i] + outer[i]) * (u[i] - u_before[i])
    return 0.5 * ((a + b) + (c + d))


@jit(boolean(int64, int64, float64, VECTOR), releases=True)
def bounded(first, last, bound, u):  # type: ignore[no-untyped-def]
    """Whether the entries ``first`` to ``last - 1`` are numbers below the bound in size."""
    beyond = 0
    for i in range(first, last):
        beyond += 0 if abs(u[i]) < bound else 1
    return beyond == 0


@jit(void(int64, int64, VECTOR, VECTOR, VECTOR), releases=True)
def divide(first, last, outer, inner, masses):  # type: ignore[no-untyped-def]
    """Accelerations of the entries ``first`` to ``last - 1``, in place of the inner forces: (outer - inner) / masses."""
    for i in range(first, last):
        inner[i] = (outer[i] - inner[i]) / masses[i]
