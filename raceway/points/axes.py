"""The axes of a study: ``KEY=a,b,c``, ``KEY=start:stop:count``, or keys with their values; checked before anything is run."""

import csv
import itertools
import json
import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any, TypeAlias

import attrs
import numpy as np

from raceway.errors import Mistake, SceneError
from raceway.scene.inputs import parse_value, read_toml, text_of, tidy
from raceway.storage.files import why_unreadable
from raceway.storage.tables import ReadTables, Tables

MOST_POINTS = 10_000
_FORM = "must have the form table.key=a,b,c or table.key=start:stop:count"

#: Axes: texts ``KEY=a,b,c`` or ``KEY=start:stop:count``, or keys with their values.
Vary: TypeAlias = Iterable[str] | Mapping[str, object]


def noun(key: str) -> str:
    """What a key of a scene is called in words: "axial load", "speed", "excitation"."""
    table, _, name = key.rpartition(".")
    if name in ("kind", "preset"):
        return table.replace("_", " ")
    words = re.sub("_(rpm|deg|hz|c)$", "", name).replace("_", " ")
    return f"{words} {table}" if table and words in ("axial", "radial") else words


def axis_label(key: str, unit: str) -> str:
    """Of an axis of a picture: noun and unit."""
    return f"{noun(key)} [{unit}]" if unit not in ("", "1") else noun(key)


@attrs.frozen
class Axis:
    """One key of the scene and the values it takes, in the order given, in a unit."""

    key: str
    values: tuple[Any, ...]
    unit: str = ""

    @property
    def numeric(self) -> bool:
        return all(is_number(v) for v in self.values)

    def words(self, value: object) -> str:
        """One value: "axial load 400 N"."""
        return f"{noun(self.key)} {shown(value)} {self.unit if is_number(value) and self.unit != '1' else ''}".rstrip()

    @property
    def label(self) -> str:
        """Of an axis of a picture: noun and unit."""
        return axis_label(self.key, self.unit if self.numeric else "")

    @cached_property
    def column(self) -> np.ndarray:
        """Values that are numbers, (n,)."""
        return np.array(self.values, dtype=float)

    @property
    def ends(self) -> tuple[Any, Any]:
        return self.values[0], self.values[-1]

    def to_dict(self) -> Tables:
        return {"key": self.key, "values": list(self.values)}


def places_of(axes: Sequence[Axis], most: int) -> tuple[Axis, list[Axis], list[Axis]]:
    """The axis of x, those of the curves and those of the panels of a picture.

    most : panels; axes that do not find room in so many are further ones of the curves

    x is the axis of numbers with most values, of several such that of speed, without such the last axis of words; of the others words
    come first.
    """
    numeric = [axis for axis in axes if axis.numeric]
    x = max(numeric, key=lambda axis: (len(axis.values), axis.key.endswith("speed_rpm"))) if numeric else axes[-1]
    others = sorted((axis for axis in axes if axis is not x), key=lambda axis: axis.numeric)
    curves, panels = others[:1], others[1:]
    while math.prod(len(axis.values) for axis in panels) > most:
        curves.append(panels.pop())
    return x, curves, panels


def is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def shown(value: object) -> str:
    """A value as people write it in a scene file, without quotes."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def parse_axes(definitions: Vary, option: str = "--vary", most: int = MOST_POINTS) -> tuple[Axis, ...]:
    """The axes of the texts of an option, or of a mapping.

    definitions : texts ``KEY=...``; or key -> values: a list, an array (n,), one value, or the text "a,b,c" or "start:stop:count"
    most : points of all axes together

    SceneError: With every mistake: a malformed or doubled axis, an empty list, a bad range, too many points.
    """
    axes: list[Axis] = []
    mistakes: list[Mistake] = []
    pairs = definitions.items() if isinstance(definitions, Mapping) else ((text, None) for text in definitions)
    for text, values in pairs:
        try:
            if values is None or isinstance(values, str):
                axis = parse_axis(text if values is None else f"{text}={values}", option, most)
            else:
                items = tidy(list(itertools.islice(values, most + 1)) if isinstance(values, Iterator) else values)
                items = items if isinstance(items, list) else [items]
                if not items:
                    raise SceneError.at(text, None, "has no values: at least one is needed")
                axis = _axis(text, items)
        except SceneError as error:
            mistakes += error.mistakes
            continue
        for previous in axes:
            if axis.key == previous.key:
                mistakes.append(Mistake(axis.key, None, "is varied twice: put all its values into one axis"))
            elif f"{axis.key}.".startswith(f"{previous.key}.") or f"{previous.key}.".startswith(f"{axis.key}."):
                mistakes.append(Mistake(axis.key, None, f"overlaps with the axis `{previous.key}`: vary one of them"))
        axes.append(axis)
    if not axes and not mistakes:
        raise SceneError.at(option, None, f"nothing is varied; an axis {_FORM}, in Python {{'load.axial': [400, 1000]}}")
    total = math.prod(len(axis.values) for axis in axes)
    if total > most:
        sizes = " x ".join(str(len(axis.values)) for axis in axes)
        where = max(axes, key=lambda axis: len(axis.values)).key
        mistakes.append(Mistake(where, None, f"{sizes} = {total} runs are more than {most}: use fewer values"))
    if mistakes:
        raise SceneError(mistakes)
    return tuple(axes)


def parse_axis(text: str, option: str = "--vary", most: int = MOST_POINTS) -> Axis:
    """One axis.

    SceneError: Naming the axis and the rule.
    """
    key, sign, values = text.partition("=")
    key = key.strip()
    if not sign or not key or not all(part.strip() for part in key.split(".")):
        raise SceneError.at(key or option, text, f"{_FORM}, for instance load.axial=400,1000")
    items = _split(values)
    if items == [""]:
        raise SceneError.at(key, None, f"has no values: it {_FORM}")
    if "" in items:
        raise SceneError.at(key, values, "has an empty entry: remove the comma")
    ranges = [item for item in items if ":" in item and isinstance(parse_value(item), str) and item[0] not in "\"'"]
    if ranges and len(items) > 1:
        raise SceneError.at(key, values, "mixes a list and a range: give one of them")
    return _axis(key, _range(key, items[0], most) if ranges else [parse_value(item) for item in items])


def _axis(key: str, values: Sequence[Any]) -> Axis:
    names = [(isinstance(v, bool), v if is_number(v) else repr(v)) for v in values]
    if len(set(names)) < len(names):
        repeated = next(value for k, value in enumerate(values) if names[k] in names[:k])
        raise SceneError.at(key, repeated, "is duplicated in the axis")
    return Axis(key, tuple(values))


def _split(text: str) -> list[str]:
    """Parts between commas that stand outside brackets and quotes, stripped."""
    parts, depth, quote = [""], 0, ""
    for letter in text:
        if quote:
            quote = "" if letter == quote else quote
        elif letter in "\"'":
            quote = letter
        depth += (letter in "[{") - (letter in "]}") if not quote else 0
        if letter == "," and depth <= 0 and not quote:
            parts.append("")
        else:
            parts[-1] += letter
    return [part.strip() for part in parts]


def _range(key: str, text: str, most: int) -> list[Any]:
    """Equidistant values, both ends included; whole numbers stay whole, because some keys take nothing else."""
    parts = [part.strip() for part in text.split(":")]
    if len(parts) != 3:
        raise SceneError.at(key, text, "is not a range: write start:stop:count, for instance 10980:15000:5")
    start, stop, count = (parse_value(part) for part in parts)
    for name, value in (("start", start), ("stop", stop)):
        if not is_number(value) or not math.isfinite(value):
            why = f"the {name} of a range must be a finite number, not {shown(value) or 'nothing'!r}"
            raise SceneError.at(key, text, why)
    if not is_number(count) or not isinstance(count, int) or count < 1:
        raise SceneError.at(key, text, f"the count of a range must be a whole number of at least 1, not {shown(count)!r}")
    if count > most:
        raise SceneError.at(key, text, f"the count of a range must be at most {most}")
    if count == 1:
        return [start]
    values = [start + (stop - start) * k / (count - 1) for k in range(count)]
    values[-1] = stop
    if isinstance(start, int) and isinstance(stop, int) and all(float(v).is_integer() for v in values):
        return [int(v) for v in values]
    return [float(v) for v in values]


def points(axes: Sequence[Axis]) -> Iterator[Tables]:
    """Every combination, the last axis running fastest."""
    return Design(tuple(axes)).points()


#: Most points of a sweep: beyond it, files of results are no longer something to open.
_MOST_SWEEP_POINTS = 1_000_000
#: Bytes of a list of them at most: 256 for each.
_LONGEST = 256 * _MOST_SWEEP_POINTS
_FILE_FORM = 'must be a TOML file with a table [grid], for instance "load.axial" = [400, 1000], or with tables [[points]]'


@attrs.frozen
class Design:
    """Points of a sweep."""

    axes: tuple[Axis, ...]  # keys with their values, the last one running fastest in the numbering of points
    listed: bool = False  # whether the values of the axes belong together point by point, instead of all their combinations

    @property
    def shape(self) -> tuple[int, ...]:
        return tuple(len(axis.values) for axis in (self.axes[:1] if self.listed else self.axes))

    @property
    def size(self) -> int:
        return math.prod(self.shape)

    @property
    def keys(self) -> tuple[str, ...]:
        return tuple(axis.key for axis in self.axes)

    def point(self, number: int) -> Tables:
        """Key -> value of one point."""
        return {axis.key: axis.values[k] for axis, k in zip(self.axes, self._places(number), strict=True)}

    def points(self) -> Iterator[Tables]:
        return (self.point(number) for number in range(self.size))

    def columns(self, first: int, last: int) -> dict[str, np.ndarray]:
        """Key -> values (n,) of the points from ``first`` until before ``last``, all of them numbers."""
        places = self._places(np.arange(first, last))
        return {axis.key: axis.column[k] for axis, k in zip(self.axes, places, strict=True)}

    def _places(self, numbers: Any) -> Sequence[Any]:
        """Of the values of each axis, at one point or many."""
        return [numbers] * len(self.axes) if self.listed else np.unravel_index(numbers, self.shape)

    def to_dict(self) -> Tables:
        return {"listed": self.listed, "axes": {axis.key: list(axis.values) for axis in self.axes}}

    @classmethod
    def of_points(cls, points: Sequence[ReadTables]) -> "Design":
        """A list of points, all with the same keys."""
        return cls(tuple(Axis(key, tuple(point[key] for point in points)) for key in points[0]), listed=True)

    @classmethod
    def from_dict(cls, tables: ReadTables) -> "Design":
        return cls(tuple(Axis(key, tuple(values)) for key, values in tables["axes"].items()), tables["listed"])


def grid(definitions: Vary) -> Design:
    """A grid of ``KEY=a,b,c`` and ``KEY=start:stop:count``, or of keys with values; SceneError with all mistakes."""
    return Design(axes=parse_axes(definitions, "--grid", _MOST_SWEEP_POINTS))


def sampled(ranges: Vary, design: str, seed: int = 0) -> Design:
    """Points that fill a box of ranges: ``sobol:N``, of Sobol's sequence, scrambled, or ``lhs:N``, a Latin hypercube.

    ranges : texts ``KEY=low:high``, or key -> (low, high) or "low:high";  seed : of the random numbers

    SceneError: Another kind of design or number of points, no ranges, or ends that are no numbers in their order.
    """
    kind, _, number = design.partition(":")
    count = int(number) if number.isdecimal() else 0
    if kind not in ("sobol", "lhs") or not 0 < count <= _MOST_SWEEP_POINTS or (kind == "sobol" and count & (count - 1)):
        message = f"must be sobol:N, N a power of 2 such as 1024, or lhs:N, at most {_MOST_SWEEP_POINTS} points"
        raise SceneError.at("design", design, message)
    ends_of = box(ranges)
    if not ends_of:
        raise SceneError.at("ranges", None, f"are missing: {design} fills ranges, such as load.axial=300:2000")
    from scipy.stats import qmc

    engine = (qmc.Sobol if kind == "sobol" else qmc.LatinHypercube)(len(ends_of), rng=np.random.default_rng(seed))
    columns = qmc.scale(engine.random(count), *zip(*ends_of.values(), strict=True)).T
    return Design(tuple(Axis(key, tuple(x.tolist())) for key, x in zip(ends_of, columns, strict=True)), listed=True)


def box(ranges: Vary) -> dict[str, tuple[float, float]]:
    """Key -> low, high of texts ``KEY=low:high``, or of a mapping of keys to (low, high) or "low:high".

    SceneError: Ends that are no numbers in their order, or a second range of a key.
    """
    pairs = ranges.items() if isinstance(ranges, Mapping) else (text.partition("=")[::2] for text in ranges)
    ends_of: dict[str, tuple[float, float]] = {}
    for key, text in pairs:
        ends = [parse_value(end) for end in text.split(":")] if isinstance(text, str) else tidy(text)
        numbers = isinstance(ends, list) and len(ends) == 2 and all(is_number(end) and math.isfinite(end) for end in ends)
        if not numbers or not ends[0] < ends[1]:
            raise SceneError.at(key, ends, "must be a range low:high of numbers, such as 300:2000")
        if key.strip() in ends_of:
            raise SceneError.at(key.strip(), text, "is a second range of this key: omit one")
        ends_of[key.strip()] = (float(ends[0]), float(ends[1]))
    return ends_of


def listed_points(points: Iterable[Mapping[str, object]]) -> Design:
    """A list of points, each a mapping of the same keys to their values; SceneError: none, or other keys in one of them."""
    return _point_list("points", tidy(list(points)))


def design_file(path: Path) -> Design:
    """The points of a file: CSV with keys in its first line, JSON (a list of objects), or TOML.

    A TOML file has tables ``[[points]]``, or a grid in a table ``[grid]`` with ``"key" = [values]`` or ``"start:stop:count"``.

    SceneError: A file that cannot be read, points that do not have the same keys, or mistakes in its axes.
    """
    readers = {".csv": _csv_points, ".json": _json_points, ".toml": read_toml}
    if path.suffix.lower() not in readers:
        raise SceneError.at(str(path), None, f"must end in one of {', '.join(readers)}")
    content = readers[path.suffix.lower()](path)
    if not isinstance(content, dict):
        return _point_list(path, content)
    if len(content) != 1 or not isinstance(content.get("grid", {}), dict) or not content.keys() <= {"grid", "points"}:
        raise SceneError.at(str(path), None, _FILE_FORM)
    if "points" in content:
        return _point_list(path, content["points"])
    words = ((key, [json.dumps(v) for v in value] if isinstance(value, list) else [str(value)])
             for key, value in _leaves(content["grid"]))  # fmt: skip
    return grid(f"{key}={','.join(values)}" for key, values in words)


def _leaves(table: ReadTables, before: str = "") -> Iterator[tuple[str, object]]:
    """``a.b`` for [grid] "a.b" and for [grid.a] b alike."""
    for key, value in table.items():
        if isinstance(value, dict):
            yield from _leaves(value, f"{before}{key}.")
        else:
            yield f"{before}{key}", value


def _csv_points(path: Path) -> list[Tables]:
    text = _text(path)
    rows = list(csv.reader(line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")))
    if not rows:
        return []
    keys = [key.strip() for key in rows[0]]
    uneven, of_keys = {k: row for k, row in enumerate(rows) if len(row) != len(keys)}, f"values for {len(keys)} keys"
    mistakes = [Mistake(f"{path}, row {k}", ",".join(row), f"has {len(row)} {of_keys}") for k, row in uneven.items()]
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
        return text_of(path, _LONGEST)
    except (OSError, UnicodeDecodeError) as why:
        raise SceneError.at(str(path), None, f"cannot be read: {why_unreadable(why)}") from None


def _point_list(path: Path | str, points: object) -> Design:
    if not isinstance(points, list) or not all(isinstance(point, dict) for point in points):
        raise SceneError.at(str(path), None, "must hold a list of points, each with keys of the scene and their values")
    points = [dict(_leaves(point)) for point in points]
    if not points or not points[0]:
        raise SceneError.at(str(path), None, "has no points: nothing to sweep")
    if len(points) > _MOST_SWEEP_POINTS:
        raise SceneError.at(str(path), None, f"has {len(points)} points, more than {_MOST_SWEEP_POINTS}")
    keys = list(points[0])
    for number, point in enumerate(points, 1):
        if set(point) != set(keys):
            odd = ", ".join(sorted(set(point) ^ set(keys)))
            raise SceneError.at(f"{path}, point {number}", None, f"all points need the same keys; not in all: {odd}")
    for key in keys:
        if not all(part.strip() for part in key.split(".")):
            raise SceneError.at(str(path), key, "is not a key of a scene, such as load.axial")
    return Design.of_points(points)


def point_words(point: ReadTables) -> str:
    return ", ".join(f"{key} = {shown(value)}" for key, value in point.items())
