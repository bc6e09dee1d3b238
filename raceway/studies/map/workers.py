"""Curves of a map, here or in processes of their own."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from pathlib import Path
from typing import Any

from raceway.errors import ConvergenceError
from raceway.framework.registry import Registry
from raceway.studies.many.processes import in_processes
from raceway.studies.map.design import Design
from raceway.studies.map.point import point_row

Numbered = list[tuple[int, dict[str, Any]]]


def rows_of(design: Design, points: Numbered, registry: Registry) -> Numbered:
    """Number and row of each point."""
    return [(number, point_row(design.scene(point, registry), registry)) for number, point in points]


def in_parallel(design: Design, tasks: Sequence[Numbered], processes: int, plugins: Sequence[Path]) -> Iterator[Numbered]:
    """Rows of each task as it is finished."""
    try:
        for _, rows in in_processes(partial(rows_of, design), tasks, processes, plugins):
            yield rows
    except BrokenProcessPool:
        message = (
            "a process of the map ended without an answer; finished points are kept. Run it again, or with --processes 0"
        )
        raise ConvergenceError(message) from None
