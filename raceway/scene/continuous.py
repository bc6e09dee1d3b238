"""Keys of a scene whose numbers can change a little: found from the declarations of its tables, not from a list of names."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import attrs

from raceway.errors import SceneError
from raceway.framework.options import nearest
from raceway.scene.scene import Scene
from raceway.scene.tables import TABLES

#: Tables of plug-ins that are attributes of the scene themselves.
_PLUGINS = ("excitation", "bodies")
#: Tables of numerical settings: the answer must not depend on them.
SETTINGS = ("integrator", "identifier", "mesh")
_STEP = re.compile(r"([^.\[\]]+)|\[(\d+)\]")


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


def continuous_keys(scene: Scene) -> list[Key]:
    """Every number that the scene has along its keys: no counts, words, switches, settings of methods or points of sections.

    Keys that are left out and have no default number are not there.
    """
    tables = [name for name in (*TABLES, *_PLUGINS) if name not in SETTINGS]
    return [key for name in tables for key in _numbers(getattr(scene, name), name)]


def key_of(scene: Scene, path: str) -> Key:
    """One of them.

    Raises
    ------
    SceneError
        A path that is no continuous key of this scene.
    """
    known = {key.path: key for key in continuous_keys(scene)}
    if path in known:
        return known[path]
    table = path.partition(".")[0]
    if table in SETTINGS:
        raise SceneError.at(path, None, f"is a setting of a method: the answer must not depend on [{table}]")
    found = _value(scene, path)
    if isinstance(found, bool | str):
        raise SceneError.at(path, found, "is no continuous key: it takes a word or a switch")
    if isinstance(found, int):
        raise SceneError.at(path, found, "is no continuous key: it takes whole numbers only")
    raise SceneError.at(path, None, f"is no continuous key of this scene, which has no number there{nearest(path, known)}")


def with_number(scene: Scene, path: str, value: float) -> Scene:
    """The scene with another number at a continuous key, checked by the rules of its tables.

    Raises
    ------
    ValueError
        A number that its key's or table's rule refuses.
    """
    found: Scene = _replaced(scene, _steps(path), value)
    return found


def _steps(path: str) -> list[str | int]:
    return [name or int(index) for name, index in _STEP.findall(path)]


def _value(scene: Scene, path: str) -> Any:
    """What stands at a path; None where there is nothing."""
    found: Any = scene
    for step in _steps(path):
        if isinstance(step, int):
            found = found[step] if isinstance(found, tuple) and step < len(found) else None
        elif attrs.has(type(found)):
            inside = [getattr(found, f.name) for f in attrs.fields(type(found)) if "plugin" in f.metadata]
            found = next((getattr(part, step) for part in (found, *inside) if hasattr(part, step)), None)
        else:
            return None
    return found


def _numbers(part: Any, before: str) -> Iterator[Key]:
    for field in attrs.fields(type(part)) if part is not None else ():
        value = getattr(part, field.name)
        if "plugin" in field.metadata:
            yield from _numbers(value, before)
        elif field.init:
            unit, words = field.metadata.get("unit", ""), field.metadata.get("help", "")
            yield from _leaves(value, f"{before}.{field.name}", unit, words)


def _leaves(value: Any, path: str, unit: str, words: str) -> Iterator[Key]:
    if isinstance(value, float):
        yield Key(path, value, unit, words)
    elif attrs.has(type(value)):
        yield from _numbers(value, path)
    elif isinstance(value, tuple) and not any(isinstance(one, tuple) for one in value):
        for k, one in enumerate(value):
            yield from _leaves(one, f"{path}[{k}]", unit, words)


def _replaced(part: Any, steps: list[str | int], value: float) -> Any:
    if not steps:
        return value
    step, rest = steps[0], steps[1:]
    if isinstance(step, int):
        return (*part[:step], _replaced(part[step], rest, value), *part[step + 1 :])
    fields = attrs.fields_dict(type(part))
    if step not in fields:  # a key of the plug-in that the table names
        step, rest = next(name for name, field in fields.items() if "plugin" in field.metadata), steps
    return attrs.evolve(part, **{step: _replaced(getattr(part, step), rest, value)})
