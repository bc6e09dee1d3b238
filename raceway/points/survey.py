"""A look over all points before any is computed: mistakes, the plug-ins and files that they use."""

import hashlib
from collections.abc import Collection, Iterator
from itertools import chain
from pathlib import Path

import attrs

from raceway.errors import Mistake, SceneError
from raceway.framework.registry import Registry
from raceway.points.axes import Design, tables_at
from raceway.points.engine import plugins_of
from raceway.points.store import files_of
from raceway.scene.keys import continuous_keys
from raceway.scene.scene import Scene, scene_from_dict
from raceway.scene.tables import PLUGIN_TABLES, TABLES
from raceway.storage.tables import ReadTables, Tables

_MOST_MISTAKES = 10


@attrs.frozen
class _Survey:
    """Requirements of a sweep."""

    scene: Scene  # at the first point
    used: frozenset[tuple[str, str]]  # (kind, name) of plug-ins
    files: dict[str, str]  # path -> hash of its content
    notes: tuple[str, ...]  # options that are left out where another kind does not know them


def survey(tables: ReadTables, design: Design, registry: Registry) -> _Survey:
    """Check every value of a grid, each at the first values of the others, or every point of a list.

    SceneError: The scene's mistakes, and those of the values: an unknown key, a wrong type.  What only two values together make
        impossible is a failed point.
    """
    notes: list[str] = []
    first = scene_from_dict(tables_at(tables, design.point(0), registry, notes), registry)
    plugins, files, mistakes = set(plugins_of(first)), set(files_of(first)), []
    numbers = {key.path for key in continuous_keys(first)} & {axis.key for axis in design.axes if axis.numeric}
    for where, axis_key, point in _others(design, numbers):
        try:
            scene = scene_from_dict(tables_at(tables, point, registry, notes), registry)
        except SceneError as error:
            own = list[Mistake](error.mistakes if design.listed else ())
            # Of a grid those that the value makes by itself: of a swept key, or of its whole table where no other axis has a part.
            for mistake in () if design.listed else error.mistakes:
                if mistake.path in point:
                    own.append(mistake)
                elif [key for key in point if key.startswith(f"{mistake.path}.")] == [axis_key]:
                    own.append(Mistake(axis_key, point[axis_key], f"{mistake.path}: {mistake.message}"))
            mistakes += [Mistake(f"{where}{m.path}", m.value, m.message) for m in own]
            if len(mistakes) >= _MOST_MISTAKES:
                break
            continue
        plugins |= set(plugins_of(scene))
        files |= set(files_of(scene))
    if mistakes:
        raise SceneError(mistakes)
    paths = {name: Path(name) for name in sorted(files)}
    digests = {k: hashlib.sha256(p.read_bytes()).hexdigest()[:24] if p.is_file() else "missing" for k, p in paths.items()}
    return _Survey(first, frozenset(plugins), digests, tuple(notes))


def _others(design: Design, continuous: Collection[str]) -> Iterator[tuple[str, str, Tables]]:
    """(where, key that differs from the first point, point); of numbers at continuous keys the ends: rules are intervals."""
    first = design.point(0)
    ends = {a.key: (int(a.column.argmin()), int(a.column.argmax())) for a in design.axes if a.key in continuous}
    if design.listed:
        numbers = chain(*ends.values()) if len(ends) == len(design.axes) else range(design.size)
        yield from ((f"point {n + 1}: ", "", design.point(n)) for n in dict.fromkeys(numbers) if n)
        return
    for axis in design.axes:
        for n in ends.get(axis.key, range(len(axis.values))):
            if n:
                yield "", axis.key, {**first, axis.key: axis.values[n]}


def key_facts(scene: Scene, key: str) -> tuple[str, str]:
    """(unit, words) of a key of the scene; empty for one that declares none."""
    table, _, path = key.partition(".")
    names = path.split(".")
    parts: list[type | None] = [TABLES.get(table), type(getattr(scene, table, None))]
    if table in PLUGIN_TABLES and table in TABLES:
        frame = getattr(scene, table)
        slot = next(f.name for f in attrs.fields(type(frame)) if "plugin" in f.metadata)
        parts.append(type(getattr(frame, slot)))
    for cls in parts:
        holder = cls
        for name in names[:-1]:
            holder = type(getattr(getattr(scene, table), name, None)) if holder is not None else None
        field = attrs.fields_dict(holder).get(names[-1]) if holder is not None and attrs.has(holder) else None
        if field is not None:
            return str(field.metadata.get("unit", "")), str(field.metadata.get("help", ""))
    return "", ""
