"""Tables of a scene with changes at dotted keys."""

import re
import tomllib
from collections.abc import Iterable, Iterator
from typing import Any

import attrs

from raceway.errors import SceneError
from raceway.scene.tables import TABLES, told
from raceway.storage.tables import ReadTables, Tables

_ENTRY = re.compile(r"([^\[\]]+)\[(\d+)\]")
_STEP = re.compile(r"([^.\[\]]+)|\[(\d+)\]")


def titled(tables: ReadTables, name: str, changes: Iterable[tuple[str, object]]) -> Tables:
    """The tables with a title that says what was changed, in its second line: the first one names the file.

    name : the title where the file has none;  changes : keys and values, the last of a key holds

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
    for step in steps_of(key):
        if isinstance(step, int):
            value = value[step] if isinstance(value, list | tuple) and step < len(value) else None
        else:
            value = value.get(step) if isinstance(value, dict) else None
    return value


def steps_of(path: str) -> list[str | int]:
    """Names and places along a path: "load.radial[0]" is load, radial, 0."""
    return [name or int(index) for name, index in _STEP.findall(path)]


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
