"""The points of a sweep: a grid over keys of the scene, or a list of points; addressed by number, never held as a whole."""

from __future__ import annotations

import csv
import itertools
import json
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import attrs

from raceway.errors import Mistake, SceneError
from raceway.scene.changes import parse_value
from raceway.scene.file import read_toml
from raceway.scene.given import tidy
from raceway.storage.tables import ReadTables, Tables
from raceway.storage.user_files import size_of, why_unreadable
from raceway.studies.many.axes import Axis, parse_axes, shown

#: Most points of a sweep: beyond it, files of results are no longer something to open.
MOST_POINTS = 1_000_000
#: Bytes of a list of them at most: 256 for each.
_LONGEST = 256 * MOST_POINTS
#: Values of an axis that a message names one by one.
_MOST_SHOWN = 9
_FORM = 'must be a TOML file with a table [grid], for instance "load.axial" = [400, 1000], or with tables [[points]]'


@attrs.frozen
class Design:
    """Points of a sweep.

    Attributes
    ----------
    axes : of a grid, the last one running fastest in the numbering of points; empty for a list
    listed : the points of a list, all with the same keys; empty for a grid
    """

    axes: tuple[Axis, ...] = ()
    listed: tuple[Tables, ...] = ()

    @property
    def shape(self) -> tuple[int, ...]:
        return tuple(len(axis.values) for axis in self.axes) if self.axes else (len(self.listed),)

    @property
    def size(self) -> int:
        return math.prod(self.shape)

    @property
    def keys(self) -> tuple[str, ...]:
        return tuple(axis.key for axis in self.axes) if self.axes else tuple(self.listed[0])

    def point(self, number: int) -> Tables:
        """Key -> value of one point."""
        if not self.axes:
            return dict(self.listed[number])
        found = {}
        for axis in reversed(self.axes):
            number, place = divmod(number, len(axis.values))
            found[axis.key] = axis.values[place]
        return {axis.key: found[axis.key] for axis in self.axes}

    def points(self) -> Iterator[Tables]:
        return (self.point(number) for number in range(self.size))

    def chains(self, length: int) -> Iterator[list[int]]:
        """Numbers of points, cut into chains of neighbours of at most ``length``.

        Notes
        -----
        Chains run along the axis of numbers with the most values, so that a point differs least from the one before.
        They depend on the design alone: a sweep that is resumed computes the same ones.
        """
        along = self._along()
        sizes = self.shape
        strides = [math.prod(sizes[k + 1 :]) for k in range(len(sizes))]
        others = [range(size) if k != along else range(1) for k, size in enumerate(sizes)]
        for place in itertools.product(*others):
            first = sum(i * stride for i, stride in zip(place, strides, strict=True))
            for start in range(0, sizes[along], length):
                yield [first + strides[along] * k for k in range(start, min(start + length, sizes[along]))]

    def _along(self) -> int:
        if not self.axes:
            return 0
        return max(range(len(self.axes)), key=lambda k: (self.axes[k].numeric, len(self.axes[k].values), k))

    def to_dict(self) -> Tables:
        if self.axes:
            return {"axes": [axis.to_dict() for axis in self.axes]}
        return {"points": list(self.listed)}

    @classmethod
    def from_dict(cls, tables: ReadTables) -> Design:
        axes = tuple(Axis(one["key"], tuple(one["values"])) for one in tables.get("axes", ()))
        return cls(axes, tuple(tables.get("points", ())))

    def differences(self, other: Design) -> list[str]:
        """In words what this design has and the other one has not: axes with their values, or listed points."""
        if self == other:
            return []
        if not self.axes or not other.axes:
            changed = [k for k, (a, b) in enumerate(zip(self.listed, other.listed, strict=False), 1) if a != b]
            if self.keys != other.keys or self.size != other.size or not changed:
                return [f"{self.in_words()} there, {other.in_words()} here"]
            first, k = changed[0], changed[0] - 1
            return [f"point {first}: {point_words(self.listed[k])} there, {point_words(other.listed[k])} here"]
        old, new = ({axis.key: axis.values for axis in design.axes} for design in (self, other))
        words = []
        for key in [*old, *(key for key in new if key not in old)]:
            if key not in new:
                words.append(f"{key} = {_few(old[key])} there, no axis here")
            elif key not in old:
                words.append(f"{key} = {_few(new[key])} here, no axis there")
            elif old[key] != new[key]:
                words.append(f"{key}: {_few(old[key])} there, {_few(new[key])} here")
        return words or [f"axes {', '.join(old)} there, {', '.join(new)} here"]

    def in_words(self) -> str:
        if not self.axes:
            return f"{self.size} listed points over {', '.join(self.keys)}"
        return f"{' x '.join(str(n) for n in self.shape)} points over {', '.join(self.keys)}"


def _few(values: Sequence[object]) -> str:
    """Values of an axis; of a long one the ends and how many."""
    if len(values) <= _MOST_SHOWN:
        return ", ".join(shown(value) for value in values)
    return f"{shown(values[0])}, {shown(values[1])}, ..., {shown(values[-1])} ({len(values)} values)"


def grid(given: Iterable[str] | Mapping[str, Any]) -> Design:
    """A grid of ``KEY=a,b,c`` and ``KEY=start:stop:count``, or of keys with their values.

    Raises
    ------
    SceneError
        With every mistake in them.
    """
    return Design(axes=parse_axes(given, "--grid", MOST_POINTS))


def listed_points(points: Iterable[Mapping[str, Any]]) -> Design:
    """A list of points, each a mapping of the same keys to their values.

    Raises
    ------
    SceneError
        No points, or other keys in one of them.
    """
    return _listed("points", tidy(list(points)))


def point_list(path: Path) -> Design:
    """The points of a file: CSV with keys in its first line, JSON (a list of objects), or TOML (tables [[points]]).

    Raises
    ------
    SceneError
        A file that cannot be read, or points that do not have the same keys.
    """
    readers = {".csv": _csv_points, ".json": _json_points, ".toml": lambda p: read_toml(p).get("points")}
    if path.suffix.lower() not in readers:
        raise SceneError.at(str(path), None, f"must end in one of {', '.join(readers)}")
    return _listed(path, readers[path.suffix.lower()](path))


def design_file(path: Path) -> Design:
    """A grid or a list from a TOML file: table ``[grid]`` with ``"key" = [values]`` or ``"start:stop:count"``, or ``[[points]]``.

    Raises
    ------
    SceneError
        A file of another form, or mistakes in its axes.
    """
    tables = read_toml(path)
    strange = sorted(set(tables) - {"grid", "points"})
    if strange or ("grid" in tables) == ("points" in tables):
        raise SceneError.at(str(path), None, f"{_FORM}{', not both' if not strange else ', not ' + strange[0]}")
    if "points" in tables:
        return _listed(path, tables["points"])
    given = tables["grid"]
    if not isinstance(given, dict):
        raise SceneError.at(f"{path}: grid", given, _FORM)
    words = (
        (key, [json.dumps(v) for v in value] if isinstance(value, list) else [str(value)]) for key, value in _dotted(given)
    )
    return grid(f"{key}={','.join(values)}" for key, values in words)


def _dotted(table: ReadTables, before: str = "") -> Iterator[tuple[str, object]]:
    """``a.b`` for [grid] "a.b" and for [grid.a] b alike."""
    for key, value in table.items():
        if isinstance(value, dict):
            yield from _dotted(value, f"{before}{key}.")
        else:
            yield f"{before}{key}", value


def _csv_points(path: Path) -> list[Tables]:
    text = _text(path)
    rows = list(csv.reader(line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")))
    if not rows:
        return []
    keys = [key.strip() for key in rows[0]]
    mistakes = [
        Mistake(f"{path}, row {k}", ",".join(row), f"has {len(row)} values for {len(keys)} keys")
        for k, row in enumerate(rows[1:], 1)
        if len(row) != len(keys)
    ]
    if mistakes:
        raise SceneError(mistakes[:10])
    return [{key: parse_value(value) for key, value in zip(keys, row, strict=True)} for row in rows[1:]]


def _json_points(path: Path) -> object:
    try:
        return json.loads(_text(path))
    except ValueError as why:
        raise SceneError.at(str(path), None, f"is not valid JSON: {why}") from None


def _text(path: Path) -> str:
    try:
        size_of(path, _LONGEST)
    except ValueError as why:
        raise SceneError.at(str(path), None, str(why)) from None
    except OSError as why:
        raise SceneError.at(str(path), None, f"cannot be read: {why.strerror or why}") from None
    try:
        return path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as why:
        raise SceneError.at(str(path), None, f"cannot be read: {why_unreadable(why)}") from None


def _listed(path: Path | str, points: object) -> Design:
    if not isinstance(points, list) or not all(isinstance(point, dict) for point in points):
        raise SceneError.at(str(path), None, "must hold a list of points, each with keys of the scene and their values")
    points = [dict(_dotted(point)) for point in points]
    if not points or not points[0]:
        raise SceneError.at(str(path), None, "has no points: nothing to sweep")
    if len(points) > MOST_POINTS:
        raise SceneError.at(str(path), None, f"has {len(points)} points, more than {MOST_POINTS}")
    keys = list(points[0])
    for number, point in enumerate(points, 1):
        if set(point) != set(keys):
            odd = sorted(set(point) ^ set(keys))
            raise SceneError.at(
                f"{path}, point {number}", None, f"all points need the same keys; not in all: {', '.join(odd)}"
            )
    bad = [key for key in keys if not key or not all(part.strip() for part in key.split("."))]
    if bad:
        raise SceneError.at(str(path), bad[0], "is not a key of a scene, such as load.axial")
    return Design(listed=tuple({key: point[key] for key in keys} for point in points))


def point_words(point: ReadTables, keys: Sequence[str] | None = None) -> str:
    return ", ".join(f"{key} = {shown(point[key])}" for key in keys or point)
