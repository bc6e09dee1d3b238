"""The points of one batch, computed where an executor wants them: it can be pickled, and takes and gives plain values."""

from __future__ import annotations

import json
import os
import platform
import threading
import time
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs

from raceway.errors import PluginError, RacewayError
from raceway.framework.contracts import Refused
from raceway.framework.registry import Registry
from raceway.scene.file import scene_from_dict
from raceway.studies.many.points import tables_at
from raceway.studies.many.row_store import row_key
from raceway.studies.sweep.identity import differences, identity, used_by
from raceway.studies.sweep.variables import values_of

if TYPE_CHECKING:
    from raceway.pipeline.result import Result

#: One point at a time in a process: kernels may be compiling, and a run's cost is the process's.
_ONE = threading.Lock()
_OWN: dict[tuple[str, ...], Registry] = {}
_FAULTS: dict[tuple[str, ...], str | None] = {}


@attrs.frozen
class Work:
    """Callable on ``[(number, point), ...]``, a chain of neighbours; answers with a list of rows, or ``Refused``.

    Attributes
    ----------
    tables : of the scene;  wanted : identity that a process must have;  plugins : one-off plug-in files

    Notes
    -----
    A row is ``{"number", "state": "done" | "failed", "reason", "key", "values", "warnings", "cost"}``.
    """

    tables: dict[str, Any]
    wanted: dict[str, Any]
    plugins: tuple[str, ...] = ()

    def fault(self) -> str | None:
        """Why this process is not fit for the work; None where it is."""
        mark = (json.dumps(self.wanted, sort_keys=True), *self.plugins)
        if mark not in _FAULTS:
            try:
                there = identity(registry_of(self.plugins), used_by(self.wanted))
                _FAULTS[mark] = "; ".join(differences(self.wanted, there)) or None
            except PluginError as why:
                _FAULTS[mark] = str(why)
        return _FAULTS[mark]

    def __call__(self, points: list[Any]) -> Any:
        with _ONE:
            fault = self.fault()
            if fault is not None:
                return Refused(_worker(), fault)
            registry = registry_of(self.plugins)
            before: Result | None = None
            rows, parts = [], dict[Any, Any]()
            for number, point in points:
                row, before = self._row(number, point, registry, before, parts)
                rows.append(row)
            return rows

    def _row(
        self, number: int, point: dict[str, Any], registry: Registry, before: Result | None, parts: dict[Any, Any]
    ) -> tuple[dict[str, Any], Result | None]:
        from raceway.pipeline.run import run

        wall, cpu = time.perf_counter(), time.process_time()
        row = unfinished_row(number, "")
        result = None
        try:
            scene = scene_from_dict(tables_at(self.tables, point, registry), registry, parts)
            row["key"] = row_key(scene, registry, None, self.wanted["program"])
            result = run(scene, registry, near=before)
            row["values"] = values_of(result)
            row["warnings"] = list(result.warnings)
            row["state"] = "done"
            counted = {name: result.cost[name] for name in ("compile_s", "steps", "newton_iterations")}
            row["cost"] = counted
        except RacewayError as error:
            row["reason"] = str(error)
        except Exception as error:  # a fault of the program or of a plug-in costs its point, not the sweep
            row["reason"] = f"unexpected {type(error).__name__}: {error or 'no message'}"
        row["cost"] |= {
            "wall_s": time.perf_counter() - wall,
            "cpu_s": time.process_time() - cpu,
            "worker": _worker(),
        }
        return row, result


def unfinished_row(number: int, reason: str) -> dict[str, Any]:
    """A row of a point that failed, or that has nothing yet."""
    return {"number": number, "state": "failed", "reason": reason, "key": "", "values": {}, "warnings": [], "cost": {}}


def registry_of(files: tuple[str, ...]) -> Registry:
    """The plug-ins of this process and of one-off files, loaded once."""
    if files not in _OWN:
        registry = Registry()
        for file in files:
            registry.load_file(Path(file))
        _OWN[files] = registry
    return _OWN[files]


@cache
def _worker() -> str:
    return f"{platform.node()}:{os.getpid()}"
