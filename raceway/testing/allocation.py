"""Count of memory blocks that compiled code allocates."""

from __future__ import annotations

from importlib import import_module
from typing import Self


class counted:
    """Counts the blocks that compiled code allocates inside a ``with``; numba's own switch is put back.

    Attributes
    ----------
    blocks : int, set at the end of the ``with``
    """

    blocks: int

    def __enter__(self) -> Self:
        # numba's statistics of its own runtime: the only place where allocations of compiled code are seen.
        runtime = import_module("numba.core.runtime")
        target = import_module("numba.core.registry").cpu_target
        runtime.rtsys.initialize(target.target_context)
        self._counters = runtime._nrt_python
        self._was_on = self._counters.memsys_stats_enabled()
        self._counters.memsys_enable_stats()
        self._before = int(self._counters.memsys_get_stats_alloc())
        return self

    def __exit__(self, *_: object) -> None:
        self.blocks = int(self._counters.memsys_get_stats_alloc()) - self._before
        if not self._was_on:
            self._counters.memsys_disable_stats()
