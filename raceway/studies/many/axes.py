"""The axes of a study: ``KEY=a,b,c``, ``KEY=start:stop:count``, or keys with their values; checked before anything is run."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import attrs

from raceway.errors import Mistake, SceneError
from raceway.scene.changes import parse_value
from raceway.scene.given import tidy
from raceway.storage.tables import Tables

MOST_POINTS = 10_000
_FORM = "must have the form table.key=a,b,c or table.key=start:stop:count"


@attrs.frozen
class Axis:
    """One key of the scene and the values it takes, in the order given."""

    key: str
    values: tuple[Any, ...]

    @property
    def numeric(self) -> bool:
        return all(is_number(v) for v in self.values)

    @property
    def ends(self) -> tuple[Any, Any]:
        return self.values[0], self.values[-1]

    def to_dict(self) -> Tables:
        return {"key": self.key, "values": list(self.values)}


def is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def shown(value: object) -> str:
    """A value as people write it in a scene file, without quotes."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def parse_axes(
    given: Iterable[str] | Mapping[str, Any], option: str = "--vary", most: int = MOST_POINTS
) -> tuple[Axis, ...]:
    """The axes of the texts of an option, or of a mapping.

    Parameters
    ----------
    given : texts ``KEY=...``; or key -> values: a list, an array (n,), one value, or the text "a,b,c" or "start:stop:count"
    most : points of all axes together

    Raises
    ------
    SceneError
        With every mistake: a malformed or doubled axis, an empty list, a bad range, too many points.
    """
    axes: list[Axis] = []
    mistakes: list[Mistake] = []
    pairs = given.items() if isinstance(given, Mapping) else ((text, None) for text in given)
    for text, values in pairs:
        try:
            axis = parse_axis(text, option, most) if values is None else axis_of(text, values, option, most)
        except SceneError as error:
            mistakes += error.mistakes
            continue
        for other in axes:
            if axis.key == other.key:
                mistakes.append(Mistake(axis.key, None, "is varied twice: put all its values into one axis"))
            elif f"{axis.key}.".startswith(f"{other.key}.") or f"{other.key}.".startswith(f"{axis.key}."):
                mistakes.append(Mistake(axis.key, None, f"overlaps with the axis `{other.key}`: vary one of them"))
        axes.append(axis)
    if not axes and not mistakes:
        raise SceneError.at(option, None, f"nothing is varied; an axis {_FORM}, in Python {{'load.axial': [400, 1000]}}")
    total = math.prod(len(axis.values) for axis in axes)
    if total > most:
        sizes = " x ".join(str(len(axis.values)) for axis in axes)
        where = max(axes, key=lambda axis: len(axis.values)).key
        mistakes.append(Mistake(where, None, f"{sizes} = {total} runs are more than {most}: give fewer values"))
    if mistakes:
        raise SceneError(mistakes)
    return tuple(axes)


def parse_axis(text: str, option: str = "--vary", most: int = MOST_POINTS) -> Axis:
    """One axis.

    Raises
    ------
    SceneError
        Naming the axis and the rule.
    """
    key, sign, values = text.partition("=")
    key = key.strip()
    if not sign or not key or not all(part.strip() for part in key.split(".")):
        raise SceneError.at(key or option, text, f"{_FORM}, for instance load.axial=400,1000")
    items = _split(values)
    if items == [""]:
        raise SceneError.at(key, None, f"has no values: it {_FORM}")
    if "" in items:
        raise SceneError.at(key, values, "has an empty place in its list: remove the comma")
    ranges = [item for item in items if ":" in item and isinstance(parse_value(item), str) and item[0] not in "\"'"]
    if ranges and len(items) > 1:
        raise SceneError.at(key, values, "mixes a list and a range: give one of them")
    return _axis(key, _range(key, items[0], most) if ranges else [parse_value(item) for item in items])


def axis_of(key: str, values: Any, option: str = "--vary", most: int = MOST_POINTS) -> Axis:
    """One axis of a mapping.

    Parameters
    ----------
    values : a list, an array (n,), a range, an iterator, one value, or the text "a,b,c" or "start:stop:count"

    Raises
    ------
    SceneError
        Naming the axis and the rule.
    """
    if isinstance(values, str):
        return parse_axis(f"{key}={values}", option, most)
    found = tidy(list(itertools.islice(values, most + 1)) if isinstance(values, Iterator) else values)
    if not isinstance(found, list):
        found = [found]
    if not found:
        raise SceneError.at(key, None, "has no values: give at least one")
    return _axis(key, found)


def _axis(key: str, found: Sequence[Any]) -> Axis:
    """An axis whose values are all different."""
    names = [(isinstance(v, bool), v if is_number(v) else repr(v)) for v in found]
    for place, name in enumerate(names):
        if name in names[:place]:
            raise SceneError.at(key, found[place], "stands twice in the axis: each value once")
    return Axis(key, tuple(found))


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
            raise SceneError.at(
                key, text, f"the {name} of a range must be a finite number, not {shown(value) or 'nothing'!r}"
            )
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
    for values in itertools.product(*(axis.values for axis in axes)):
        yield dict(zip((axis.key for axis in axes), values, strict=True))
