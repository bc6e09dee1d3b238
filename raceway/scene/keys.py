"""Numbers of a scene that change continuously, by their keys."""

from collections.abc import Callable, Iterator, Mapping
from functools import cache
from typing import Any, TypeAlias, TypeVar

import attrs

from raceway.core.columns import Number, with_values
from raceway.errors import SceneError
from raceway.framework.options import nearest
from raceway.scene.inputs import steps_of
from raceway.scene.tables import TABLES, SceneTables

#: A scene, or what has its tables.
S = TypeVar("S", bound=SceneTables)
#: Tables of plug-ins that are attributes of the scene themselves.
_PLUGINS = ("excitation", "bodies", "quantities")
#: Tables of numerical settings: the answer must not depend on them.
_SETTINGS = ("integrator", "identifier", "mesh")
#: Paths into a table, and what is to stand there.
_Changes: TypeAlias = list[tuple[tuple[str | int, ...], object]]


@attrs.frozen
class Key:
    """A number of a scene.

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

    SceneError: A path that is no continuous key of this scene.
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

    ValueError: A number that its key's or table's rule refuses.
    """
    return with_numbers(scene, {path: value})


def with_numbers(scene: S, numbers: Mapping[str, float]) -> S:
    """The same with numbers at several keys."""
    answer: S = _with_parts(scene, [(steps_of(path), value) for path, value in numbers.items()])
    return answer


def with_columns(scene: S, columns: Mapping[str, Number]) -> S:
    """The scene with columns (n,) at continuous keys, which no rule looks at: one scene of n operating points."""
    answer: S = _with_parts(scene, [(steps_of(path), column) for path, column in columns.items()], with_values)
    return answer


def _value(scene: SceneTables, path: str) -> Any:
    """What stands at a path; None where there is nothing."""
    node: Any = scene
    for step in steps_of(path):
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


#: Fields of a table by their names; none of what is no table.
_fields: Callable[[type], dict[str, Any]] = cache(lambda kind: attrs.fields_dict(kind) if attrs.has(kind) else {})


def _with_parts(part: Any, changes: _Changes, replace: Callable[..., object] = attrs.evolve) -> Any:
    """A table, or an element of one, with values at paths into it."""
    if not all(steps for steps, _ in changes):
        return changes[0][1]
    groups: dict[str | int, _Changes] = {}
    fields = _fields(type(part))
    for steps, value in changes:
        step, further = steps[0], steps[1:]
        if fields and step not in fields:  # a key of the plug-in that the table names
            step, further = next(name for name, field in fields.items() if "plugin" in field.metadata), steps
        groups.setdefault(step, []).append((further, value))
    if not fields:
        return tuple(_with_parts(value, groups[k], replace) if k in groups else value for k, value in enumerate(part))
    return replace(part, **{str(k): _with_parts(getattr(part, str(k)), group, replace) for k, group in groups.items()})
