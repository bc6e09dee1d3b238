"""Blocks of a sweep: thousands of points as columns through the compiled loop, one row of the store each."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator

import attrs
import numpy as np

from raceway.core.threads import usable_cores
from raceway.errors import SceneError
from raceway.framework.registry import Registry
from raceway.out.quantities import COLUMNS, KYY_TILTS_FOLLOW, MODEL_BOUND
from raceway.points.axes import Design, tables_at
from raceway.points.column_quantities import MOVING, QUANTITIES
from raceway.points.derivatives import Columns
from raceway.points.engine import worker
from raceway.points.function import BLOCK, Function, PointStatus
from raceway.points.store import Row, Store
from raceway.scene.changes import continuous_keys
from raceway.scene.reading import scene_from_dict
from raceway.scene.scene import Scene
from raceway.storage.tables import ReadTables, Tables

#: Parts of a block that threads share.
_SHARED = 4


@attrs.frozen
class Block:
    """Callable on ``(first, columns)``, the number of the first point and the columns of the keys; the row of these points.

    Attributes
    ----------
    tables : of the scene at the first point of the sweep;  outputs : names of quantities

    Notes
    -----
    A row's content are the columns of quantities and ``status``, its reason is those of the points, by their numbers, as JSON.
    """

    tables: Tables
    outputs: tuple[str, ...]

    def __call__(self, task: tuple[int, Columns], registry: Registry) -> Row:
        first, columns = task
        wall, cpu = time.perf_counter(), time.process_time()
        function = Function(scene_from_dict(self.tables, registry), tuple(columns), self.outputs, threads=usable_cores())
        answer = function.with_reasons(columns, function.looped(columns))
        reasons = answer.pop("reason")
        times = {"wall_s": time.perf_counter() - wall, "cpu_s": time.process_time() - cpu, "worker": worker()}
        return block_row(first, answer, {first + int(k): reasons[k] for k in np.flatnonzero(reasons != "")}, times)


def block_row(first: int, answer: Columns, reasons: dict[int, str], times: ReadTables) -> Row:
    """The row of finished columns, with the number of points of each status."""
    counts = {status.name: int((answer["status"] == status).sum()) for status in PointStatus}
    return Row(block_key(first, len(answer["status"])), "done", json.dumps(reasons), answer, {**counts, **times})


def block_key(first: int, count: int) -> str:
    """Of the row of a block in the store."""
    return f"{first}:{first + count}"


def block_edges(size: int, length: int) -> Iterator[tuple[int, int]]:
    """First point of each block, and that after its last one; none where points are rows themselves (``length`` 0)."""
    return ((first, min(first + length, size)) for first in (range(0, size, length) if length else ()))


def left_over(store: Store, size: int, length: int) -> list[int]:
    """Numbers of points that the loop has left and that no run has finished."""
    finished, left = store.keys("done") | store.keys("failed"), list[int]()
    for first, last in block_edges(size, length):
        row = store.get(block_key(first, last - first))
        if row.state == "done" and row.cost[PointStatus.FAILED.name]:
            left += (first + np.flatnonzero(row.content["status"] == PointStatus.FAILED)).tolist()
    return [number for number in left if number not in finished]


def block_length(function: Function) -> int:
    """Points of a block: less than a second on one core, and more than a thread takes at a time."""
    return _SHARED * BLOCK[function.moving]


def column_function(tables: ReadTables, scene: Scene, design: Design, registry: Registry) -> Function | None:
    """All columns of a sweep as a function of its keys; None where points need runs of their own.

    Parameters
    ----------
    tables : of the scene;  scene : at the first point
    """
    keys = {key.path for key in continuous_keys(scene)}
    if not all(axis.numeric and axis.key in keys for axis in design.axes):
        return None
    moving, tilts = scene.excitation is not None, scene.supports.tilt != "locked"
    outputs = [name for name in COLUMNS if name in QUANTITIES and (moving or name not in MOVING)]
    left_out = [] if tilts else [KYY_TILTS_FOLLOW.name]
    if any(key.startswith("bearing.") for key in design.keys):  # rings grow by their own sections, each solved for alone
        left_out.append(MODEL_BOUND.name)
    outputs = [name for name in outputs if name not in left_out]
    function = Function(scene, design.keys, tuple(outputs), threads=usable_cores())
    return None if function.why_slow or not _alone(function, tables, design, registry) else function


def _alone(function: Function, tables: ReadTables, design: Design, registry: Registry) -> bool:
    """Whether the numbers of a point change nothing else in the scene, looked at where each is least and largest."""
    for axis in design.axes:
        for number in (int(axis.column.argmin()), int(axis.column.argmax())):
            point = {**design.point(0), axis.key: axis.values[number]}
            try:
                read = scene_from_dict(tables_at(tables, point, registry), registry).to_dict()
                if read != function.scene_at(point).to_dict():
                    return False
            except SceneError:  # seen where all numbers of a point are known
                continue
    return True
