"""The runs: one curve over speed at a time, in processes of their own, finished ones kept on disk."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any

import attrs

from raceway.errors import RacewayError
from raceway.framework.registry import Registry
from raceway.pipeline.run import run
from raceway.pipeline.simulate import OnProgress
from raceway.scene.file import scene_from_dict
from raceway.studies.many.processes import in_processes
from raceway.studies.many.row_store import RowStore, program_key

Row = dict[str, Any]


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


def curve(points: Sequence[dict[str, Any]], registry: Registry) -> list[Row]:
    """One row a point, in order; a run that fails or is refused becomes a row with its reason.

    Parameters
    ----------
    points : tables of scenes
    """
    return [_row(tables, registry) for tables in points]


def _row(tables: dict[str, Any], registry: Registry) -> Row:
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
    """Rows of every task, in order, and how many tasks were taken from the store.

    Parameters
    ----------
    processes : how many work at a time; 0 works in this process
    plugins : one-off plug-in files, which each process loads

    Raises
    ------
    KeyboardInterrupt
        Finished tasks are in the store.
    """
    program = program_key(registry)
    keys = [task.key(program) for task in tasks]
    found = {k: kept["rows"] for k, key in enumerate(keys) if (kept := store.get(key)) is not None}
    reused = len(found)
    waiting = [k for k in range(len(tasks)) if k not in found]
    finished = _here(tasks, waiting, registry) if processes == 0 else _apart(tasks, waiting, processes, plugins)
    for k, rows in finished:
        found[k] = rows
        store.put(keys[k], {"rows": rows})
        if on_progress is not None:
            on_progress(tasks[k].name, len(found), len(tasks))
    return [found[k] for k in range(len(tasks))], reused


def _here(tasks: Sequence[Task], waiting: Sequence[int], registry: Registry) -> Iterator[tuple[int, list[Row]]]:
    return ((k, _rows(tasks[k], registry)) for k in waiting)


def _apart(
    tasks: Sequence[Task], waiting: Sequence[int], processes: int, plugins: Sequence[Path]
) -> Iterator[tuple[int, list[Row]]]:
    try:
        for place, rows in in_processes(_rows, [tasks[k] for k in waiting], processes, plugins):
            yield waiting[place], rows
    except BrokenProcessPool:
        raise RacewayError(
            "a process of the study was ended from outside, perhaps for want of memory; finished curves are kept: run the "
            "command again, with --processes 1"
        ) from None


def _rows(task: Task, registry: Registry) -> list[Row]:
    return task.function(task.given, registry)
