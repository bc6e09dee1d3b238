"""A part of a sweep's results: values chosen on some axes, what still varies, what is not finished."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from raceway.errors import Mistake, RacewayError, SceneError
from raceway.framework.options import nearest
from raceway.scene.changes import parse_value
from raceway.storage.tables import ReadTables, Tables
from raceway.studies.many.axes import is_number, shown

if TYPE_CHECKING:
    from xarray import Dataset

#: The dimension of a sweep over a list of points; a grid has one dimension for each key instead.
LIST = "point"
DONE = "done"
#: Numbers of an axis that differ by less are one value [relative].
_SAME = 1e-9
_SHOWN = 8


@attrs.frozen(eq=False)
class Selection:
    """Results on the axes that still vary.

    Attributes
    ----------
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
        found = json.loads(self.dataset.attrs.get("scene", "{}"))
        return found if isinstance(found, dict) else {}

    def value(self, key: str, default: object = None) -> Any:
        """What a key of the scene is at all points of the selection; ``default`` where it is not given.

        Raises
        ------
        KeyError
            For a key that varies.
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

    Raises
    ------
    SceneError
        With every text that is not of this form, and every key that stands twice.
    """
    chosen: Tables = {}
    mistakes = []
    for text in texts:
        key, sign, value = (part.strip() for part in text.partition("="))
        if not sign or not key or not value:
            mistakes.append(Mistake("--at", text, "must have the form KEY=VALUE, for instance load.axial=1000"))
        elif key in chosen:
            mistakes.append(Mistake(f"--at {key}", value, "is chosen twice: leave one out"))
        else:
            chosen[key] = parse_value(value)
    if mistakes:
        raise SceneError(mistakes)
    return chosen


def keys_of(dataset: Dataset) -> list[str]:
    """The keys of the scene that a sweep varied, in its order."""
    if LIST in dataset.dims:
        return [str(name) for name, found in dataset.coords.items() if found.dims == (LIST,) and name != LIST]
    return [str(name) for name in dataset.dims if name in dataset.coords and "." in str(name)]


def select(dataset: Dataset, at: ReadTables) -> Selection:
    """The results at chosen values.

    Parameters
    ----------
    dataset : as a sweep gives it: a dimension for each key, or ``point`` with the keys as coordinates
    at : key -> value; it must be one of the axis' values

    Raises
    ------
    SceneError
        An unknown key, or a value that the sweep does not hold; the nearest one is named.
    """
    keys = keys_of(dataset)
    mistakes, chosen = [], Tables()
    for key, wanted in at.items():
        if key not in keys:
            message = f"is not an axis of this sweep{nearest(key, keys)}; axes: {', '.join(keys)}"
            mistakes.append(Mistake(f"--at {key}", wanted, message))
            continue
        values = _values(dataset[key].values)
        found = [value for value in values if same(value, wanted)]
        if found:
            chosen[key] = found[0]
        else:
            mistakes.append(Mistake(f"--at {key}", wanted, f"is not in the sweep, which has {listed(values)}"))
    if mistakes:
        raise SceneError(mistakes)
    part = _list_at(dataset, chosen) if LIST in dataset.dims else dataset.sel(chosen)
    axes, fixed = Tables(), Tables()
    for key in keys:
        values = _values(part[key].values)
        if key in chosen or len(values) == 1:
            fixed[key] = values[0] if values else chosen[key]
        else:
            axes[key] = values
    unfinished = _unfinished(part)
    return Selection(_as_grid(part, axes, fixed), axes, fixed, unfinished)


def same(one: Any, other: Any) -> bool:
    """Whether two values of a key are equal, numbers to rounding."""
    if is_number(one) and is_number(other):
        return math.isclose(one, other, rel_tol=_SAME, abs_tol=0.0)
    return _text(one) == _text(other)


def _text(value: object) -> str:
    """What is no number has its JSON text on an axis."""
    return value if isinstance(value, str) else json.dumps(value)


def listed(values: Sequence[object]) -> str:
    """Values for a message; long lists are shortened in the middle."""
    texts = [shown(value) for value in values]
    if len(texts) > _SHOWN:
        texts = [*texts[: _SHOWN - 3], "...", *texts[-2:]]
    return ", ".join(texts)


def only_axes(selection: Selection, allowed: Sequence[str], purpose: str) -> None:
    """Refuse axes that would have to be chosen first.

    Raises
    ------
    SceneError
        Naming each axis, its values and what to type.
    """
    mistakes = [
        Mistake(
            key,
            None,
            f"has {len(values)} values ({listed(values)}), {purpose}: choose one with --at {key}={shown(values[0])}",
        )
        for key, values in selection.axes.items()
        if key not in allowed
    ]
    if mistakes:
        raise SceneError(mistakes)


def _values(array: np.ndarray) -> list[Any]:
    """Different values as plain Python objects, numbers in rising order."""
    found = list(dict.fromkeys(np.atleast_1d(array).ravel().tolist()))
    return sorted(found) if all(is_number(value) for value in found) else found


def _list_at(dataset: Dataset, chosen: ReadTables) -> Dataset:
    keep = np.ones(dataset.sizes[LIST], dtype=bool)
    for key, value in chosen.items():
        keep &= np.array([same(one, value) for one in dataset[key].values.tolist()])
    if not keep.any():
        raise RacewayError(f"no point of the sweep has {', '.join(f'{k} = {shown(v)}' for k, v in chosen.items())} together")
    return dataset.isel({LIST: np.flatnonzero(keep)})


def _unfinished(dataset: Dataset) -> dict[str, int]:
    if "status" not in dataset:
        return {}
    states, counts = np.unique(dataset["status"].values.astype(str), return_counts=True)
    return {str(state): int(count) for state, count in zip(states, counts, strict=True) if state != DONE}


def _as_grid(part: Dataset, axes: ReadTables, fixed: ReadTables) -> Dataset:
    """Axes that do not vary dropped, the others sorted; a list becomes a grid where it fills one."""
    keys = list(axes)
    if LIST not in part.dims:
        part = part.isel({key: 0 for key in fixed if key in part.dims})
        return _ordered(part, axes)
    part = part.drop_vars([key for key in fixed if key in part.coords])
    if not keys:
        return part.isel({LIST: 0})
    points = list(zip(*(part[key].values.tolist() for key in keys), strict=True))
    if len(set(points)) != len(points) or len(points) != math.prod(len(values) for values in axes.values()):
        return part
    kept = {key: dict(part[key].attrs) for key in keys}
    part = part.drop_vars([LIST], errors="ignore")
    if len(keys) == 1:
        part = part.swap_dims({LIST: keys[0]})
    else:
        part = part.set_index(point=keys).unstack(LIST)
    part = _ordered(part, axes)
    for key, attributes in kept.items():
        part[key].attrs.update(attributes)
    return part


def _ordered(part: Dataset, axes: ReadTables) -> Dataset:
    """Values of the axes in their order, by place: a list of booleans would be a mask."""
    places = {key: [part[key].values.tolist().index(value) for value in values] for key, values in axes.items()}
    return part.isel(places).transpose(*axes, ...)
