"""Types of what files hold before it is checked: a scene's TOML, a result's JSON, a study's rows."""

from collections.abc import Iterable, Mapping
from typing import Any

#: Tables of a TOML or JSON file as it has them: numbers, words, lists and tables in them, which are checked where they are read.
Tables = dict[str, Any]
#: The same, only looked at.
ReadTables = Mapping[str, Any]


def nested(values: Iterable[tuple[str, object]]) -> Tables:
    """Values at dotted keys, as tables in tables."""
    tables: Tables = {}
    for path, value in values:
        *parents, key = path.split(".")
        table = tables
        for parent in parents:
            table = table.setdefault(parent, {})
        table[key] = value
    return tables
