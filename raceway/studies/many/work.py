"""The function of a study, wherever an executor calls it: it can be pickled, and takes and gives plain values."""

from __future__ import annotations

import json
import os
import platform
import threading
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import attrs

from raceway.errors import PluginError
from raceway.framework.contracts import Refused
from raceway.framework.registry import Registry
from raceway.storage.tables import Tables
from raceway.studies.many.identity import differences, identity, used_by

#: One at a time in a process: kernels may be compiling, and a run's cost is the process's.
_ONE = threading.Lock()
_OWN: dict[tuple[str, ...], Registry] = {}
_FAULTS: dict[tuple[str, ...], str | None] = {}


@attrs.frozen
class Work:
    """Callable on a list of what ``function`` takes; answers with a list of what it gives, or ``Refused``.

    Attributes
    ----------
    function : called as ``function(given, registry)``
    plugins : one-off plug-in files, which each process loads
    wanted : identity that a process must have; None where all are of this machine
    own : registry in the process that the work was made in; others have one of their own
    """

    function: Callable[[Any, Registry], Any]
    plugins: tuple[str, ...] = ()
    wanted: Tables | None = None
    own: Registry | None = None

    def __reduce__(self) -> tuple[object, ...]:
        return Work, (self.function, self.plugins, self.wanted)

    def fault(self) -> str | None:
        """Why this process is not fit for the work; None where it is."""
        if self.wanted is None:
            return None
        mark = (json.dumps(self.wanted, sort_keys=True), *self.plugins)
        if mark not in _FAULTS:
            try:
                there = identity(registry_of(self.plugins), used_by(self.wanted))
                _FAULTS[mark] = "; ".join(differences(self.wanted, there)) or None
            except PluginError as why:
                _FAULTS[mark] = str(why)
        return _FAULTS[mark]

    def __call__(self, some: list[Any]) -> Any:
        with _ONE:
            fault = self.fault()
            if fault is not None:
                return Refused(worker(), fault)
            registry = self.own or registry_of(self.plugins)
            return [self.function(one, registry) for one in some]


def registry_of(files: tuple[str, ...]) -> Registry:
    """The plug-ins of this process and of one-off files, loaded once."""
    if files not in _OWN:
        registry = Registry()
        for file in files:
            registry.load_file(Path(file))
        _OWN[files] = registry
    return _OWN[files]


@cache
def worker() -> str:
    """Name of this process."""
    return f"{platform.node()}:{os.getpid()}"
