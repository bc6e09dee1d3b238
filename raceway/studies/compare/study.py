"""Variations of one scene under otherwise identical settings; ``comparison`` and ``explain`` say what changes what.

Only ``raceway.pipeline.run.run`` is called.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

from raceway.errors import RacewayError
from raceway.framework.registry import Registry, default_registry
from raceway.pipeline.run import run
from raceway.pipeline.simulate import OnProgress
from raceway.scene.file import scene_from_dict
from raceway.studies.compare.comparison import Comparison
from raceway.studies.compare.findings import Row
from raceway.studies.many.axes import parse_axes, points
from raceway.studies.many.points import refuse_mistakes, tables_at


def compare(
    scene_tables: Mapping[str, Any],
    vary: Iterable[str],
    registry: Registry | None = None,
    on_progress: OnProgress | None = None,
) -> Comparison:
    """Run a scene at every combination of the axes' values.

    Parameters
    ----------
    scene_tables : plain tables of a TOML scene
    vary : axes, ``KEY=a,b,c`` or ``KEY=start:stop:count``
    on_progress : called as ``on_progress(what, done, total)`` after each run; an exception stops the study

    Raises
    ------
    SceneError
        A mistake in an axis or in the scene; nothing has been run.
    KeyboardInterrupt
        Passed on, with the finished rows as a ``Comparison`` in its attribute ``partial``.

    Notes
    -----
    A point that is refused or that fails is kept with its reason, and the study goes on.
    """
    registry = registry or default_registry()
    axes = parse_axes(vary)
    notes: list[str] = []
    title = refuse_mistakes(scene_tables, axes, registry)
    rows: list[Row] = []
    total = math.prod(len(axis.values) for axis in axes)
    try:
        for point in points(axes):
            rows.append(Row(point, _result(tables_at(scene_tables, point, registry, notes), registry)))
            if on_progress is not None:
                on_progress("runs", len(rows), total)
    except KeyboardInterrupt as stop:
        stop.partial = Comparison(title, axes, tuple(rows), tuple(notes))  # type: ignore[attr-defined]
        raise
    return Comparison(title, axes, tuple(rows), tuple(notes))


def _result(tables: Mapping[str, Any], registry: Registry) -> dict[str, Any]:
    try:
        return run(scene_from_dict(tables, registry), registry).as_dict()
    except RacewayError as error:
        return {"status": "failed" if error.exit_code == 1 else "refused", "reason": str(error)}
