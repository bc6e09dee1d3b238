"""Compiled loops of the suites: kernels are called here the way that the time loops call them, as function pointers."""

from typing import Self

from numba import float64, int64, void

from raceway.core.jit import jit
from raceway.core.signatures import FORCE_POINTER, LAW_POINTER, MATRIX, VECTOR


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


def allocations() -> int:
    """Blocks of memory that compiled code has allocated so far, counted while counting is switched on."""
    from numba.core.runtime import _nrt_python

    return int(_nrt_python.memsys_get_stats_alloc())


class counted:
    """Counts the blocks that compiled code allocates inside a ``with``; numba's own switch is put back."""

    def __enter__(self) -> Self:
        from numba.core.registry import cpu_target
        from numba.core.runtime import _nrt_python, rtsys

        rtsys.initialize(cpu_target.target_context)
        self._runtime, self._was_on = _nrt_python, _nrt_python.memsys_stats_enabled()
        _nrt_python.memsys_enable_stats()
        self._before = allocations()
        return self

    def __exit__(self, *_: object) -> None:
        self.blocks = allocations() - self._before
        if not self._was_on:
            self._runtime.memsys_disable_stats()
