"""The runs: one curve over speed at a time, in processes of their own, finished ones kept on disk."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import attrs

from raceway.errors import ConvergenceError, RacewayError
from raceway.framework.registry import Registry
from raceway.pipeline.run import run
from raceway.pipeline.simulate import OnProgress
from raceway.scene.reading import scene_from_dict
from raceway.storage.tables import Tables
from raceway.studies.follow.instead import FAILED, Instead, from_rest, instead_of
from raceway.studies.many.engine import Item, local, work_through
from raceway.studies.many.row_store import RowStore, program_key

Row = Tables
#: Of a point at which no steady motion is found, and what a ring does instead is known.
UNSTEADY = "unsteady"
#: Turns of the motion that is integrated where no ring stays on a steady one; half of them are judged.
TURNS = 800


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

    Where the steady motion is unstable, or none is found, ``instead`` tells what a ring does, by time integration: from beside
    that motion, or from rest.

    Parameters
    ----------
    points : tables of scenes
    """
    return [_row(tables, registry) for tables in points]


def _row(tables: Tables, registry: Registry) -> Row:
    row: Row = {"speed_rpm": tables["excitation"]["speed_rpm"], "axial_n": tables["load"]["axial"]}
    try:
        scene = scene_from_dict(tables, registry)
        try:
            result = run(scene, registry)
        except ConvergenceError as why:
            if not scene.integrator.method.steady:
                raise
            motion = from_rest(scene, row["speed_rpm"], TURNS)
            if motion.kind == FAILED:
                raise
            reason = f"{' '.join(str(why).split()).partition(': ')[0]}; instead, from rest: {motion.words}"
            return {**row, "status": UNSTEADY, "reason": reason, "instead": _plain(motion)}
    except RacewayError as why:
        status = "failed" if why.exit_code == 1 else "refused"
        return {**row, "status": status, "reason": " ".join(str(why).split())}
    found, error = result.identification, result.error
    assert found is not None
    fate = result.stability["floquet"]
    unstable = fate is not None and fate["verdict"] == "unstable"
    if unstable:
        motion = instead_of(result, row["speed_rpm"], TURNS)
        row["instead"] = _plain(motion)
        grows = f"the steady motion is unstable, disturbances grow {fate['largest']:.4g} times a turn"
    return {
        **row,
        "status": "unstable" if unstable else "completed",
        "reason": f"{grows}; instead: {motion.words}" if unstable else "",
        "found": None if fate is None else fate["found"],
        "k": found.equivalent_stiffness,
        "abs_z": abs(found.dynamic_stiffness),
        "force_n": found.force_amplitude,
        "error": None if error["total"] is None else max(error["total"] - (error["bodies"] or 0.0), 0.0),
        "mesh_error": error["mesh"],
    }


def _plain(motion: Instead) -> Row:
    """Without the section, which a page of hundreds of points has no use for."""
    return {name: value for name, value in motion.to_dict().items() if name != "section"}


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
