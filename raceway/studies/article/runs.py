"""The runs: one curve over speed at a time, in processes of their own, finished ones kept on disk."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import attrs

from raceway.errors import RacewayError
from raceway.framework.registry import Registry
from raceway.pipeline.run import run
from raceway.pipeline.simulate import OnProgress
from raceway.scene.file import scene_from_dict
from raceway.storage.tables import Tables
from raceway.studies.many.engine import Item, local, work_through
from raceway.studies.many.row_store import RowStore, program_key

Row = Tables


@attrs.frozen
class Task:
    """A piece of work: its name, and the function in this package that computes its rows from ``given``.

    Attributes
    ----------
    function : called as ``function(given, registry)``; it can be sent to another process
    given : plain values, which with the program's sources decide the rows
    """

    name: str
    function: Callable[[Any, Registry], list[Row]]
    given: Any

    def key(self, program: str) -> str:
        text = json.dumps([self.function.__qualname__, self.given, program], sort_keys=True, default=str)
        return hashlib.sha256(text.encode()).hexdigest()[:24]


def curve(points: Sequence[Tables], registry: Registry) -> list[Row]:
    """One row a point, in order; a run that fails or is refused becomes a row with its reason.

    Parameters
    ----------
    points : tables of scenes
    """
    return [_row(tables, registry) for tables in points]


def _row(tables: Tables, registry: Registry) -> Row:
    row: Row = {"speed_rpm": tables["excitation"]["speed_rpm"], "axial_n": tables["load"]["axial"]}
    try:
        result = run(scene_from_dict(tables, registry), registry)
    except RacewayError as why:
        status = "failed" if why.exit_code == 1 else "refused"
        return {**row, "status": status, "reason": " ".join(str(why).split())}
    found, error = result.identification, result.error
    assert found is not None
    fate = result.stability["floquet"]
    unstable = fate is not None and fate["verdict"] == "unstable"
    return {
        **row,
        "status": "unstable" if unstable else "completed",
        "reason": "the steady motion is unstable: a ring does not stay on it" if unstable else "",
        "k": found.equivalent_stiffness,
        "abs_z": abs(found.dynamic_stiffness),
        "force_n": found.force_amplitude,
        "error": None if error["total"] is None else max(error["total"] - (error["bodies"] or 0.0), 0.0),
        "mesh_error": error["mesh"],
    }


def work(
    tasks: Sequence[Task],
    processes: int,
    store: RowStore,
    registry: Registry,
    plugins: Sequence[Path] = (),
    on_progress: OnProgress | None = None,
) -> tuple[list[list[Row]], int]:
    """Rows of every task, in order, and how many tasks were taken from the store; see ``raceway.studies.many.engine``."""
    program = program_key(registry)
    items = [Item(task.key(program), task.name, task) for task in tasks]
    done, reused = work_through(_rows, items, store, local(registry, processes), registry, plugins, on_progress)
    return [row["rows"] for row in done], reused


def _rows(task: Task, registry: Registry) -> Tables:
    return {"rows": task.function(task.given, registry)}
