"""Error against run time: which setting is good enough, and what it costs.

Every row is a plain run of the scene with a few keys changed.  ``design`` chooses the settings,
``measured_run`` runs and times them, ``reference`` finds what they are held against, ``row_store`` keeps what is
finished, ``result`` judges.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from raceway.errors import SceneError
from raceway.framework.registry import Registry, default_registry
from raceway.scene.changes import parse_change
from raceway.scene.given import tidy
from raceway.storage.tables import ReadTables, Tables
from raceway.studies.many.measured_run import measured_once
from raceway.studies.many.row_store import RowStore
from raceway.studies.precision.design import Setting, make_design, needs_motion, setting_at
from raceway.studies.precision.reference import Reference, Runner, find_reference
from raceway.studies.precision.result import Precision, words_of

if TYPE_CHECKING:
    from raceway.pipeline.simulate import OnProgress

#: Runs of each setting, and the longest predicted run [s].
REPEATS = 3
LIMIT_S = 30.0


def precision(
    tables: ReadTables,
    vary: Iterable[str] | Mapping[str, Any] = (),
    reference: Iterable[str] | Mapping[str, Any] = (),
    repeats: int = REPEATS,
    limit_s: float = LIMIT_S,
    store: Path | None = None,
    registry: Registry | None = None,
    on_progress: OnProgress | None = None,
) -> Precision:
    """A work-precision study of one scene.

    Parameters
    ----------
    tables : plain tables of a TOML scene
    vary : axes, ``KEY=a,b,c`` or ``KEY=start:stop:count``, or keys with their values, whose product is run; the default design without them
    reference : changes ``KEY=VALUE``, or keys with values, that make the reference; found by itself without them
    repeats : runs of each setting
    limit_s : settings predicted to take longer are left out [s]
    store : file that finished rows are kept in and taken from
    on_progress : called as ``on_progress(what, done, total)`` before each run; an exception stops the study

    Raises
    ------
    SceneError
        A mistake in the scene, an axis or the reference; nothing has been run.
    RacewayError
        A file of rows that cannot be read.
    """
    registry = registry or default_registry()
    design = make_design(tables, vary, limit_s, registry)
    given = _given(design.settings, reference, registry)
    rows = RowStore(store)
    groups: dict[str, list[Setting]] = {}
    for setting in design.settings:
        if setting.scene is not None:
            groups.setdefault(setting.physics, []).append(setting)
    total = len(design.settings) + len(groups)
    done = 0

    def tell(what: str) -> None:
        if on_progress is not None:
            on_progress(what, done, total)

    found = []
    for setting in design.settings:
        tell(words_of(setting.values))
        found.append(_row(setting, repeats, registry, rows))
        done += 1
    runner = Runner(registry, rows, limit_s, tell)
    references = {design.base: Reference({}, {}, "no setting could be run")}
    for physics, group in groups.items():
        references[physics] = find_reference(group, runner, given)
        done += 1
    return Precision(design.title, tuple(found), references, design.base, design.left_out, design.notes, rows.fault)


def _given(settings: tuple[Setting, ...], changes: Iterable[str] | Mapping[str, Any], registry: Registry) -> Tables:
    """The reference that the user names, checked with the first setting that can run."""
    given = tidy(changes) if isinstance(changes, Mapping) else dict(parse_change(text) for text in changes)
    first = next((setting for setting in settings if setting.scene is not None), None)
    if given and first is not None:
        found = setting_at(first.tables, "reference", given, registry)
        if found.scene is None:
            raise SceneError.at("--reference", None, found.reason)
    return given


def _row(setting: Setting, repeats: int, registry: Registry, store: RowStore) -> Tables:
    """One row: measured now, or taken from what an earlier study has kept."""
    head = {
        "family": setting.family,
        "setting": setting.values,
        "model": setting.model,
        "physics": setting.physics,
        "expected_order": None,
        "reused": False,
    }
    if setting.scene is None:
        lost: Tables = {
            "status": "refused",
            "reason": setting.reason,
            "quantities": {},
            "own_error": None,
            "cost": None,
        }
        return {**head, **lost}
    if needs_motion(setting.scene) and setting.scene.integrator.method.inertial:
        head["expected_order"] = setting.scene.integrator.method.order
    row, reused = measured_once(setting.scene, repeats, repeats, registry, store)
    return {**head, **row, "reused": reused}
