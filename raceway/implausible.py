"""Numbers of a scene that are possible and unlikely: as a rule a unit was mistaken."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import attrs

from raceway.scene import Scene

#: Above this a length [m] and below this a Young's modulus [Pa] is told: bearings of 2 m exist, and cages of soft plastics.
_LENGTH, _YOUNG = 1.0, 1e9
_TABLES = ("bearing", "kinematics", "mesh", "supports")


def implausible(scene: Scene) -> tuple[str, ...]:
    """A sentence for each value that is likely to be in another unit."""
    found = []
    for table in _TABLES:
        for path, unit, value in _numbers(getattr(scene, table), table):
            if unit == "m" and abs(value) > _LENGTH:
                found.append(f"`{path}` = {value:g} m is more than {_LENGTH:g} m: lengths are in metres")
            if unit == "Pa" and value < _YOUNG:
                found.append(f"`{path}` = {value:g} Pa is less than {1e-9 * _YOUNG:g} GPa: steel has 2.1e11 Pa")
    return tuple(found)


def _numbers(table: Any, path: str) -> Iterator[tuple[str, str, float]]:
    """Path, unit and value of every number in a table and the tables in it."""
    if table is None or not attrs.has(type(table)):
        return
    for field in attrs.fields(type(table)):
        value = getattr(table, field.name)
        if attrs.has(type(value)):
            yield from _numbers(value, f"{path}.{field.name}")
        elif isinstance(value, float) and "unit" in field.metadata:
            yield f"{path}.{field.name}", field.metadata["unit"], value
