"""Plain tables with values changed at dotted keys, as ``--set`` says them."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterable
from typing import Any

from raceway.errors import SceneError
from raceway.storage.tables import ReadTables, Tables


def titled(tables: ReadTables, name: str, changes: Iterable[tuple[str, object]]) -> Tables:
    """The tables with a title that says what was changed, in its second line: the first one tells of the file.

    Parameters
    ----------
    name : the title where the file has none;  changes : keys and values, the last of a key holds

    Notes
    -----
    Keys are sorted: changes in another order make the same scene, and folders are named by the title.
    """
    title = tables.get("title", name)
    made = ", ".join(f"{key} = {told(value)}" for key, value in sorted(dict(changes).items()) if key != "title")
    if made and isinstance(title, str) and title.strip():
        title += (", " if "\n" in title else "\n") + made
    return {**tables, "title": title}


def told(value: object) -> str:
    """A value as it stands in a scene file, words without quotes; 400.0 is 400."""
    if value is None:
        return "none"
    if isinstance(value, str):
        return value
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
        value = int(value)
    return json.dumps(value, default=str)


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
    table[last] = value
    return result


def value_at(tables: ReadTables, key: str) -> Any:
    """What stands at a dotted key, or None."""
    found: Any = tables
    for name in key.split("."):
        found = found.get(name) if isinstance(found, dict) else None
    return found


def without(tables: ReadTables, key: str) -> Tables:
    """A copy of the tables without what stands at a dotted key; what is not there may be missing."""
    name, _, rest = key.partition(".")
    if not rest:
        return {word: value for word, value in tables.items() if word != name}
    inner = tables.get(name)
    return {**tables, name: without(inner, rest)} if isinstance(inner, dict) else dict(tables)
