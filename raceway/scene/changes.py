"""A scene with changes."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, TypeAlias, TypeVar

import attrs

from raceway.core.columns import Number, with_values
from raceway.errors import SceneError
from raceway.framework.options import nearest
from raceway.scene.tables import TABLES, SceneTables, told
from raceway.storage.tables import ReadTables, Tables

#: A scene, or what has its tables.
S = TypeVar("S", bound=SceneTables)


def titled(tables: ReadTables, name: str, changes: Iterable[tuple[str, object]]) -> Tables:
    """The tables with a title that says what was changed, in its second line: the first one names the file.

    Parameters
    ----------
    name : the title where the file has none;  changes : keys and values, the last of a key holds

    Notes
    -----
    Keys are sorted: changes in another order make the same scene, and folders are named by the title.
    """
    title = tables.get("title", name)
    words = ", ".join(f"{key} = {told(value)}" for key, value in sorted(dict(changes).items()) if key != "title")
    if words and isinstance(title, str) and title.strip():
        title += (", " if "\n" in title else "\n") + words
    return {**tables, "title": title}


def parse_change(text: str) -> tuple[str, Any]:
    """``a.b=value`` as key and TOML value; what is not TOML is a string."""
    key, sign, value = text.partition("=")
    if not sign or not key.strip():
        raise SceneError.at(text, None, "must have the form table.key=value, for instance load.axial=400")
    return key.strip(), parse_value(value)


def parse_value(text: str) -> Any:
    try:
        return tomllib.loads(f"v = {text.strip()}")["v"]
    except (ValueError, RecursionError):  # no TOML, too deep, or thousands of digits: whatever it is meant for refuses it
        return text.strip()


def with_value(tables: ReadTables, key: str, value: object) -> Tables:
    """A copy of the tables with one value set at a dotted key; tables beside the key's are shared with the original."""
    result = dict(tables)
    *parents, last = key.split(".")
    table: Any = result
    for name in parents:
        inner = table.get(name, {})
        if not isinstance(inner, dict):
            raise SceneError.at(key, value, f"`{name}` is not a table")
        table[name] = dict(inner)
        table = table[name]
    if entry := _ENTRY.fullmatch(last):  # one number of several
        name, k = entry[1], int(entry[2])
        defaults = TABLES.get(parents[0]) if len(parents) == 1 else None
        field = attrs.fields_dict(defaults).get(name) if defaults is not None else None
        numbers = list(table.get(name, field.default if field is not None and isinstance(field.default, tuple) else ()))
        if k >= len(numbers):
            raise SceneError.at(key, value, f"is not there: {name} has {len(numbers)} numbers")
        last, value = name, [*numbers[:k], value, *numbers[k + 1 :]]
    table[last] = value
    return result


def value_at(tables: ReadTables, key: str) -> Any:
    """What stands at a dotted key, or None."""
    value: Any = tables
    for step in _steps(key):
        if isinstance(step, int):
            value = value[step] if isinstance(value, list | tuple) and step < len(value) else None
        else:
            value = value.get(step) if isinstance(value, dict) else None
    return value


def without(tables: ReadTables, key: str) -> Tables:
    """A copy of the tables without what stands at a dotted key; what is not there may be missing."""
    name, _, path = key.partition(".")
    if not path:
        return {word: value for word, value in tables.items() if word != name}
    inner = tables.get(name)
    return {**tables, name: without(inner, path)} if isinstance(inner, dict) else dict(tables)


def leaves(table: ReadTables, before: str = "") -> Iterator[tuple[str, Any]]:
    """Dotted keys and values of a tree; an empty table is a value."""
    for name, value in table.items():
        if isinstance(value, dict) and value:
            yield from leaves(value, f"{before}{name}.")
        else:
            yield before + name, value


#: Tables of plug-ins that are attributes of the scene themselves.
_PLUGINS = ("excitation", "bodies", "quantities")
#: Tables of numerical settings: the answer must not depend on them.
_SETTINGS = ("integrator", "identifier", "mesh")
_ENTRY = re.compile(r"([^\[\]]+)\[(\d+)\]")
_STEP = re.compile(r"([^.\[\]]+)|\[(\d+)\]")
#: Paths into a table, and what is to stand there.
_Changes: TypeAlias = list[tuple[list[str | int], object]]


@attrs.frozen
class Key:
    """A number of a scene.

    Attributes
    ----------
    path : such as "load.radial[0]";  value : in its unit;  unit : of the key, "" for a pure number;  help : one sentence
    """

    path: str
    value: float
    unit: str
    help: str


def continuous_keys(scene: SceneTables) -> list[Key]:
    """Every number that the scene has along its keys: no counts, words, switches, settings of methods or points of sections.

    Keys that are left out and have no default number are not there.
    """
    tables = [name for name in (*TABLES, *_PLUGINS) if name not in _SETTINGS]
    return [key for name in tables for key in _keys_with_numbers(getattr(scene, name), name)]


def key_of(scene: SceneTables, path: str) -> Key:
    """One of them.

    Raises
    ------
    SceneError
        A path that is no continuous key of this scene.
    """
    keys = {key.path: key for key in continuous_keys(scene)}
    if path in keys:
        return keys[path]
    table = path.partition(".")[0]
    if table in _SETTINGS:
        raise SceneError.at(path, None, f"is a setting of a method: the answer must not depend on [{table}]")
    value = _value(scene, path)
    if isinstance(value, bool | str):
        raise SceneError.at(path, value, "is no continuous key: it takes a word or a switch")
    if isinstance(value, int):
        raise SceneError.at(path, value, "is no continuous key: it takes whole numbers only")
    raise SceneError.at(path, None, f"is no continuous key of this scene, which has no number there{nearest(path, keys)}")


def with_number(scene: S, path: str, value: float) -> S:
    """The scene with another number at a continuous key, checked by the rules of its tables.

    Raises
    ------
    ValueError
        A number that its key's or table's rule refuses.
    """
    return with_numbers(scene, {path: value})


def with_numbers(scene: S, numbers: Mapping[str, float]) -> S:
    """The same with numbers at several keys."""
    answer: S = _with_parts(scene, [(_steps(path), value) for path, value in numbers.items()])
    return answer


def with_columns(scene: S, columns: Mapping[str, Number]) -> S:
    """The scene with columns (n,) at continuous keys, which no rule looks at: one scene of n operating points."""
    answer: S = _with_parts(scene, [(_steps(path), column) for path, column in columns.items()], with_values)
    return answer


def _steps(path: str) -> list[str | int]:
    return [name or int(index) for name, index in _STEP.findall(path)]


def _value(scene: SceneTables, path: str) -> Any:
    """What stands at a path; None where there is nothing."""
    node: Any = scene
    for step in _steps(path):
        if isinstance(step, int):
            node = node[step] if isinstance(node, tuple) and step < len(node) else None
        elif attrs.has(type(node)):
            inside = [getattr(node, f.name) for f in attrs.fields(type(node)) if "plugin" in f.metadata]
            node = next((getattr(part, step) for part in (node, *inside) if hasattr(part, step)), None)
        else:
            return None
    return node


def _keys_with_numbers(part: Any, before: str) -> Iterator[Key]:
    for field in attrs.fields(type(part)) if part is not None else ():
        value = getattr(part, field.name)
        if "plugin" in field.metadata:
            yield from _keys_with_numbers(value, before)
        elif field.init:
            unit, words = field.metadata.get("unit", ""), field.metadata.get("help", "")
            yield from _leaves(value, f"{before}.{field.name}", unit, words)


def _leaves(value: object, path: str, unit: str, words: str) -> Iterator[Key]:
    if isinstance(value, float):
        yield Key(path, value, unit, words)
    elif attrs.has(type(value)):
        yield from _keys_with_numbers(value, path)
    elif isinstance(value, tuple) and not any(isinstance(element, tuple) for element in value):
        for k, element in enumerate(value):
            yield from _leaves(element, f"{path}[{k}]", unit, words)


def _with_parts(part: Any, changes: _Changes, replace: Callable[..., object] = attrs.evolve) -> Any:
    """A table, or an element of one, with values at paths into it."""
    if not all(steps for steps, _ in changes):
        return changes[0][1]
    groups: dict[str | int, _Changes] = {}
    fields = attrs.fields_dict(type(part)) if attrs.has(type(part)) else {}
    for steps, value in changes:
        step, further = steps[0], steps[1:]
        if fields and step not in fields:  # a key of the plug-in that the table names
            step, further = next(name for name, field in fields.items() if "plugin" in field.metadata), steps
        groups.setdefault(step, []).append((further, value))
    if not fields:
        return tuple(_with_parts(value, groups[k], replace) if k in groups else value for k, value in enumerate(part))
    return replace(part, **{str(k): _with_parts(getattr(part, str(k)), group, replace) for k, group in groups.items()})
