"""The scene at one point of a study, for all studies.

Swapping a plug-in's kind leaves out the options that only the other kind knows.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import attrs

from raceway.errors import PluginError, SceneError
from raceway.framework.registry import Registry
from raceway.scene.changes import value_at, with_value
from raceway.scene.reading import numbers_only, scene_from_dict
from raceway.scene.tables import PLUGIN_TABLES, TABLES
from raceway.scene.units import is_quantity
from raceway.scene.unused import without_inherited
from raceway.storage.tables import ReadTables, Tables
from raceway.studies.many.axes import Axis, parse_axes, shown


def tables_at(tables: ReadTables, point: ReadTables, registry: Registry, notes: list[str] | None = None) -> Tables:
    """The scene's tables at one point; what is left out with a change of kind is said in ``notes``, once each.

    Keys of the scene that the point takes their effect from are left out without a word.
    """
    changed = dict(tables)
    # Kinds first: what another axis sets must not be taken for an option of the old kind.
    for key, value in sorted(point.items(), key=lambda item: not item[0].endswith(".kind")):
        name, _, last = key.rpartition(".")
        if last == "kind" and name in PLUGIN_TABLES and isinstance(value, str):
            for option in _strange_options(changed, name, value, registry):
                given = changed[name][option]
                changed[name] = {k: v for k, v in changed[name].items() if k != option}
                note = f"{name}.{option} = {shown(given)} is left out for kind '{value}', which does not know it"
                if notes is not None and note not in notes:
                    notes.append(note)
        changed = with_value(changed, key, value)
    return without_inherited(tables, changed, point, registry)


def numbers_at(tables: ReadTables, point: ReadTables, registry: Registry) -> Tables:
    """A point whose values with a unit as text are numbers in the unit of their key."""
    texts = [key for key, value in point.items() if isinstance(value, str) and is_quantity(value)]
    if not texts:
        return dict(point)
    changed = numbers_only(tables_at(tables, point, registry), registry)
    return {**point, **{key: value_at(changed, key) for key in texts}}


def axes_of(given: Iterable[str] | Mapping[str, Any], tables: ReadTables, registry: Registry) -> tuple[Axis, ...]:
    """``parse_axes`` with values in the units of the scene's keys."""
    return tuple(in_units(axis, tables, registry) for axis in parse_axes(given))


def in_units(axis: Axis, tables: ReadTables, registry: Registry) -> Axis:
    """An axis whose values with a unit as text are numbers in the unit of the key."""
    return Axis(axis.key, tuple(numbers_at(tables, {axis.key: value}, registry)[axis.key] for value in axis.values))


def _strange_options(tables: ReadTables, name: str, kind: str, registry: Registry) -> list[str]:
    """Options in a table that its present kind knows and the new kind does not; typing mistakes are not among them."""
    table = tables.get(name)
    role, default = PLUGIN_TABLES[name]
    if not isinstance(table, dict):
        return []
    words = (str(table.get("kind", default)), kind)
    try:
        old, new = ({field.name for field in attrs.fields(registry.find(role, word).plugin)} for word in words)
    except PluginError:
        return []  # the scene's own check names the unknown kind
    core = {field.name for field in attrs.fields(TABLES[name])} if name in TABLES else set()
    return [option for option in table if option in old - new - core]


def refuse_mistakes(tables: ReadTables, axes: tuple[Axis, ...], registry: Registry) -> str:
    """Check the first point whole, and each further value as far as it concerns an axis; the scene's title."""
    first = {axis.key: axis.values[0] for axis in axes}
    title = scene_from_dict(tables_at(tables, first, registry), registry).title
    keys = {axis.key for axis in axes}
    mistakes = []
    for axis in axes:
        for value in axis.values[1:]:
            try:
                scene_from_dict(tables_at(tables, {**first, axis.key: value}, registry), registry)
            except SceneError as error:
                # What two axes refuse together may run at other points: such a point is kept as refused.
                mistakes += [m for m in error.mistakes if m.path in keys]
    if mistakes:
        raise SceneError(mistakes)
    return title
