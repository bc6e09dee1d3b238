"""Variations of one scene under otherwise identical settings; ``comparison`` and ``explain`` say what changes what.

Only ``raceway.pipeline.run.run`` is called.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from raceway.errors import RacewayError, SceneError
from raceway.framework.registry import Registry, default_registry
from raceway.pipeline.run import run
from raceway.pipeline.simulate import OnProgress
from raceway.scene.reading import scene_from_dict
from raceway.storage.tables import ReadTables, Tables
from raceway.studies.compare.comparison import Comparison
from raceway.studies.compare.findings import Row
from raceway.studies.many.axes import Axis, points
from raceway.studies.many.engine import Item, local, work_through
from raceway.studies.many.points import axes_of, refuse_mistakes, tables_at
from raceway.studies.many.row_store import RowStore, row_key, tables_key


class StudyInterrupt(KeyboardInterrupt):
    """Ctrl-C in a study; ``partial``: the comparison of the runs that are finished."""

    def __init__(self, partial: Comparison) -> None:
        super().__init__()
        self.partial = partial


def compare(
    scene_tables: ReadTables,
    vary: Iterable[str] | Mapping[str, Any],
    registry: Registry | None = None,
    on_progress: OnProgress | None = None,
    store: Path | None = None,
) -> Comparison:
    """Run a scene at every combination of the axes' values.

    Parameters
    ----------
    scene_tables : plain tables of a TOML scene
    vary : axes, ``KEY=a,b,c`` or ``KEY=start:stop:count``, or keys with their values
    on_progress : called as ``on_progress(what, done, total)`` after each run; an exception stops the study
    store : file that finished runs are kept in and taken from

    Raises
    ------
    SceneError
        A mistake in an axis or in the scene; nothing has been run.
    StudyInterrupt
        On Ctrl-C, with the finished rows; they are in ``store``, too.

    Notes
    -----
    A point that is refused or that fails is kept with its reason, and the study goes on.
    """
    registry = registry or default_registry()
    axes = axes_of(vary, scene_tables, registry)
    notes: list[str] = []
    title = refuse_mistakes(scene_tables, axes, registry)
    kept, places = RowStore(store), list(points(axes))
    items = [_item(tables_at(scene_tables, point, registry, notes), registry) for point in places]
    try:
        work_through(_result, items, kept, local(registry, 0), registry, on_progress=on_progress)
    except KeyboardInterrupt as stop:
        raise StudyInterrupt(_comparison(title, axes, places, items, kept, notes)) from stop
    return _comparison(title, axes, places, items, kept, notes)


def _comparison(
    title: str, axes: tuple[Axis, ...], places: list[Tables], items: list[Item], kept: RowStore, notes: list[str]
) -> Comparison:
    """Of the points that are finished."""
    found = [(point, kept.get(item.key)) for point, item in zip(places, items, strict=True)]
    rows = tuple(Row(point, result) for point, result in found if result is not None)
    return Comparison(title, axes, rows, tuple(notes), kept.fault)


def _item(tables: ReadTables, registry: Registry) -> Item:
    try:
        key = row_key(scene_from_dict(tables, registry), registry, "compare")
    except SceneError:  # refused as it is run
        key = tables_key(tables, registry, "compare")
    return Item(key, "runs", tables)


def _result(tables: ReadTables, registry: Registry) -> Tables:
    try:
        return run(scene_from_dict(tables, registry), registry).to_dict()
    except RacewayError as error:
        return {"status": error.status, "reason": str(error)}
