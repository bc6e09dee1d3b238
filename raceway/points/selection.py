"""The part of a sweep that a picture or a table is made of: chosen values, axes that still vary."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from raceway import __version__
from raceway.errors import Mistake, RacewayError, SceneError
from raceway.framework.options import nearest
from raceway.points.axes import is_number, shown
from raceway.points.dataset import FINISHED, open_store
from raceway.scene.inputs import parse_value
from raceway.storage.tables import ReadTables, Tables

if TYPE_CHECKING:
    from xarray import Dataset

#: The dimension of a sweep over a list of points; a grid has one dimension for each key instead.
LIST = "point"
#: Numbers of an axis that differ by less are one value [relative].
_SAME = 1e-9
_SHOWN = 8


@attrs.frozen(eq=False)
class Selection:
    """Results on the axes that still vary.

    dataset : with one dimension for each key of ``axes``, in that order, or ``point`` where the list is no grid
    axes : keys that vary, with their values in rising order (numbers) or in the order of the sweep
    fixed : keys of the sweep that do not vary here, and their values
    unfinished : status -> number of points that have no result
    """

    dataset: Dataset
    axes: Tables
    fixed: Tables
    unfinished: dict[str, int]

    @property
    def title(self) -> str:
        return str(self.scene.get("title", "sweep"))

    @property
    def scene(self) -> Tables:
        """The scene that was swept; keys of ``axes`` and ``fixed`` have other values."""
        tables = json.loads(self.dataset.attrs.get("scene", "{}"))
        return tables if isinstance(tables, dict) else {}

    def value(self, key: str, default: object = None) -> Any:
        """What a key of the scene is at all points of the selection; ``default`` where it is not given.

        KeyError: For a key that varies.
        """
        if key in self.axes:
            raise KeyError(key)
        if key in self.fixed:
            return self.fixed[key]
        table: Any = self.scene
        for name in key.split("."):
            if not isinstance(table, Mapping) or table.get(name) is None:
                return default
            table = table[name]
        return table

    @property
    def gaps(self) -> str:
        """The points without result in words; empty when there are none."""
        return ", ".join(f"{count} {state}" for state, count in self.unfinished.items())


def parse_at(texts: Iterable[str]) -> Tables:
    """``KEY=VALUE`` texts as a mapping.

    SceneError: With every text that is not of this form, and every key that stands twice.
    """
    values: Tables = {}
    mistakes = []
    for text in texts:
        key, sign, value = (part.strip() for part in text.partition("="))
        if not sign or not key or not value:
            mistakes.append(Mistake("--at", text, "must have the form KEY=VALUE, for instance load.axial=1000"))
        elif key in values:
            mistakes.append(Mistake(f"--at {key}", value, "is chosen twice: omit one"))
        else:
            values[key] = parse_value(value)
    if mistakes:
        raise SceneError(mistakes)
    return values


def swept_keys(dataset: Dataset) -> list[str]:
    """The keys of the scene that a sweep varied, in its order."""
    if LIST in dataset.dims:
        return [str(name) for name, coordinate in dataset.coords.items() if coordinate.dims == (LIST,) and name != LIST]
    return [str(name) for name in dataset.dims if name in dataset.coords and "." in str(name)]


def select(dataset: Dataset, at: ReadTables) -> Selection:
    """The results at chosen values.

    dataset : as a sweep gives it: a dimension for each key, or ``point`` with the keys as coordinates
    at : key -> value; it must be one of the axis' values

    SceneError: An unknown key, or a value that the sweep does not hold; the nearest one is named.
    """
    keys = swept_keys(dataset)
    mistakes, fixed_values = [], Tables()
    for key, wanted_value in at.items():
        if key not in keys:
            message = f"is not an axis of this sweep{nearest(key, keys)}; axes: {', '.join(keys)}"
            mistakes.append(Mistake(f"--at {key}", wanted_value, message))
            continue
        values = _values(dataset[key].values)
        matches = [value for value in values if same(value, wanted_value)]
        if matches:
            fixed_values[key] = matches[0]
        else:
            mistakes.append(Mistake(f"--at {key}", wanted_value, f"is not in the sweep, which has {listed(values)}"))
    if mistakes:
        raise SceneError(mistakes)
    if LIST in dataset.dims:
        choice = np.ones(dataset.sizes[LIST], dtype=bool)
        for key, value in fixed_values.items():
            choice &= np.array([same(coordinate, value) for coordinate in dataset[key].values.tolist()])
        if not choice.any():
            words = ", ".join(f"{key} = {shown(value)}" for key, value in fixed_values.items())
            raise RacewayError(f"no point of the sweep has {words} together")
        part = dataset.isel({LIST: np.flatnonzero(choice)})
    else:
        part = dataset.sel(fixed_values)
    axes, constants = Tables(), Tables()
    for key in keys:
        values = _values(part[key].values)
        if key in fixed_values or len(values) == 1:
            constants[key] = values[0] if values else fixed_values[key]
        else:
            axes[key] = values
    states = Counter(part["status"].values.astype(str).ravel().tolist() if "status" in part else ())
    gaps = {state: count for state, count in sorted(states.items()) if state not in FINISHED}
    return Selection(_as_grid(part, axes, constants), axes, constants, gaps)


def same(a: Any, b: Any) -> bool:
    """Whether two values of a key are equal, numbers to rounding."""
    if is_number(a) and is_number(b):
        return math.isclose(a, b, rel_tol=_SAME, abs_tol=0.0)
    return _value_text(a) == _value_text(b)


def _value_text(value: object) -> str:
    return value if isinstance(value, str) else json.dumps(value)


def listed(values: Sequence[object]) -> str:
    """Values for a message; long lists are shortened in the middle."""
    texts = [shown(value) for value in values]
    if len(texts) > _SHOWN:
        texts = [*texts[: _SHOWN - 3], "...", *texts[-2:]]
    return ", ".join(texts)


def _values(array: np.ndarray) -> list[Any]:
    """Different values as plain Python objects, numbers in rising order."""
    different = list(dict.fromkeys(np.atleast_1d(array).ravel().tolist()))
    return sorted(different) if all(map(is_number, different)) else different


def _as_grid(part: Dataset, axes: ReadTables, constants: ReadTables) -> Dataset:
    """Axes that do not vary dropped, the others sorted; a list becomes a grid where it fills one."""
    keys = list(axes)
    if LIST not in part.dims:
        part = part.isel({key: 0 for key in constants if key in part.dims})
        return _in_order(part, axes)
    part = part.drop_vars([key for key in constants if key in part.coords])
    if not keys:
        return part.isel({LIST: 0})
    points = list(zip(*(part[key].values.tolist() for key in keys), strict=True))
    if len(set(points)) != len(points) or len(points) != math.prod(len(values) for values in axes.values()):
        return part
    attributes_of = {key: dict(part[key].attrs) for key in keys}
    part = part.drop_vars([LIST], errors="ignore")
    part = part.swap_dims({LIST: keys[0]}) if len(keys) == 1 else part.set_index(point=keys).unstack(LIST)
    part = _in_order(part, axes)
    for key, attributes in attributes_of.items():
        part[key].attrs.update(attributes)
    return part


def _in_order(part: Dataset, axes: ReadTables) -> Dataset:
    """Values of the axes in their order, by place: a list of booleans would be a mask."""
    places = {key: [part[key].values.tolist().index(value) for value in values] for key, values in axes.items()}
    return part.isel(places).transpose(*axes, ...)


def selection_of(store: Path, at: Iterable[str]) -> Selection:
    """Of a store on disk; ``at``: texts KEY=VALUE."""
    return select(open_store(store).to_xarray(), parse_at(at))


def head(selection: Selection) -> tuple[str, ...]:
    """Where the numbers come from, for the first lines of a file."""
    bearing = selection.value("bearing.preset", "")
    constants = ", ".join(f"{key} = {shown(value)}" for key, value in selection.fixed.items())
    words = (f"Raceway {__version__}: {selection.title}", f"bearing {bearing}" if bearing else "", constants)
    return tuple(word.replace("\n", "; ") for word in words if word)
