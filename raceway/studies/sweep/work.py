"""One chain of points, computed wherever an executor wants it."""

from __future__ import annotations

import time
from collections.abc import Hashable
from typing import TYPE_CHECKING, Any

import attrs

from raceway.errors import RacewayError
from raceway.framework.registry import Registry
from raceway.scene.reading import scene_from_dict
from raceway.storage.tables import Tables
from raceway.studies.many.points import tables_at
from raceway.studies.many.row_store import row_key
from raceway.studies.many.work import worker
from raceway.studies.sweep.variables import values_of

if TYPE_CHECKING:
    from raceway.pipeline.result import Result


@attrs.frozen
class Chain:
    """Callable on ``[(number, point), ...]``, neighbours of which each begins from the one before; gives their rows.

    Attributes
    ----------
    tables : of the scene;  program : hash of the sources that compute

    Notes
    -----
    A row is ``{"number", "state": "done" | "failed", "reason", "key", "values", "warnings", "cost"}``.
    """

    tables: Tables
    program: str

    def __call__(self, points: list[tuple[int, Tables]], registry: Registry) -> list[Tables]:
        before: Result | None = None
        rows, parts = [], dict[Hashable, Any]()
        for number, point in points:
            row, before = self._row(number, point, registry, before, parts)
            rows.append(row)
        return rows

    def _row(
        self, number: int, point: Tables, registry: Registry, before: Result | None, parts: dict[Hashable, Any]
    ) -> tuple[Tables, Result | None]:
        from raceway.pipeline.run import run

        wall, cpu = time.perf_counter(), time.process_time()
        row = unfinished_row(number, "")
        result = None
        try:
            scene = scene_from_dict(tables_at(self.tables, point, registry), registry, parts)
            row["key"] = row_key(scene, registry, None, self.program)
            result = run(scene, registry, near=before)
            row["values"] = values_of(result)
            row["warnings"] = list(result.warnings)
            row["state"] = "done"
            row["cost"] = {name: result.cost[name] for name in ("compile_s", "steps", "newton_iterations")}
        except RacewayError as error:
            row["reason"] = str(error)
        except Exception as error:  # a fault of the program or of a plug-in costs its point, not the sweep
            row["reason"] = f"unexpected {type(error).__name__}: {error or 'no message'}"
        row["cost"] |= {
            "wall_s": time.perf_counter() - wall,
            "cpu_s": time.process_time() - cpu,
            "worker": worker(),
        }
        return row, result


def unfinished_row(number: int, reason: str) -> Tables:
    """A row of a point that failed, or that has nothing yet."""
    return {"number": number, "state": "failed", "reason": reason, "key": "", "values": {}, "warnings": [], "cost": {}}
