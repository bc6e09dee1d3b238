"""A table of measured quantities over keys of a scene: ``load.axial [N], K [N/µm], K error [N/µm]`` and a line a measurement."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

import attrs
import numpy as np

from raceway.errors import SceneError
from raceway.framework.options import nearest
from raceway.framework.shown import read_in
from raceway.pipeline.gradient import UNITS
from raceway.scene.continuous import Key, continuous_keys, with_number
from raceway.scene.scene import Scene
from raceway.scene.units import number_in
from raceway.storage.number_table import NumberTable

#: Quantities that may be measured, with units: those of sensitivities, and the displacement across the axis at rest.
MEASURED = UNITS | {"y": "m", "z": "m"}
#: Half-width at 95 % over the standard error.
COVERAGE = 1.96
#: Measurements of one thing that differ by more than this many standard errors contradict each other.
_CONTRADICT = 6.0
IGNORE = "ignore"
_HEAD = re.compile(r"^\s*(?P<name>[^\[(]*?)\s*(?:[\[(](?P<unit>[^\])]*)[\])])?\s*$")


@attrs.frozen
class Column:
    """A head: key of the scene or measured quantity, and its factor.  ``kind``: "key", "value", "error" or "ignore"."""

    kind: str
    name: str
    factor: float


@attrs.frozen(eq=False)
class Observed:
    """Measurements, one a row.

    Attributes
    ----------
    source : file;  keys : path -> numbers (n,), in the unit of the key
    values : quantity -> numbers (n,), SI;  errors : quantity -> standard errors (n,), SI, of those whose errors are stated
    """

    source: str
    keys: dict[str, np.ndarray]
    values: dict[str, np.ndarray]
    errors: dict[str, np.ndarray]

    @property
    def stated(self) -> bool:
        """Whether every quantity has its errors."""
        return set(self.errors) == set(self.values)

    @property
    def weights(self) -> dict[str, np.ndarray]:
        """Standard errors (n,) by quantity; where none are stated, those of one relative size for all quantities."""
        if self.stated:
            return self.errors
        return {name: np.full(len(one), float(np.median(np.abs(one))) or 1.0) for name, one in self.values.items()}

    def scenes(self, scene: Scene) -> list[Scene]:
        """The scene of each row.

        Raises
        ------
        SceneError
            A number that a key of the scene cannot have.
        """
        count = len(next(iter(self.values.values())))
        out = []
        for row in range(count):
            here = scene
            for path, numbers in self.keys.items():
                try:
                    here = with_number(here, path, float(numbers[row]))
                except ValueError as why:
                    raise SceneError.at(
                        self.source, None, f"measurement {row + 1}: `{path}` = {numbers[row]:g}: {why}"
                    ) from None
            out.append(here)
        return out


def observed(table: NumberTable, source: str, scene: Scene, heads: Mapping[str, str] | None = None) -> Observed:
    """The measurements in a table.

    Parameters
    ----------
    heads : head -> what it is taken for, a head itself, or "ignore"

    Raises
    ------
    SceneError
        What is wrong with it, with the column or the row.
    """
    try:
        columns = columns_of(table.header, scene, heads)
        if not len(table.values):
            raise ValueError("has no measurements: a line of numbers each is needed below the heads")
        found = _taken(table, columns)
        _refuse_contradictions(found)
        return found if source == found.source else attrs.evolve(found, source=source)
    except ValueError as why:
        raise SceneError.at(source, None, str(why)) from None


def columns_of(header: Sequence[str], scene: Scene, heads: Mapping[str, str] | None = None) -> list[Column]:
    """What each head is.

    Raises
    ------
    ValueError
        A head that is nothing known, a unit that is missing or wrong, or heads without a measured quantity.
    """
    heads = dict(heads or {})
    if unknown := next((head for head in heads if head not in header), None):
        raise ValueError(f"no column '{unknown}' for --map; there are {', '.join(map(repr, header))}")
    keys = {key.path: key for key in continuous_keys(scene)}
    columns = [_column(heads.get(head, head), head, keys) for head in header]
    places = [(one.kind, one.name) for one in columns if one.kind != IGNORE]
    if twice := next((one for one in places if places.count(one) > 1), None):
        raise ValueError(f"'{twice[1]}' stands there twice: leave one of its columns out with --map \"HEAD={IGNORE}\"")
    values = [one.name for one in columns if one.kind == "value"]
    if not values:
        raise ValueError(
            f"no measured quantity among {', '.join(map(repr, header))}: name one of {', '.join(MEASURED)}, such as K [N/µm]"
        )
    if "kyy_tilts_follow" in values and scene.supports.tilt == "locked":
        raise ValueError(
            "kyy_tilts_follow is none of a scene with supports.tilt = 'locked': name it kyy, or let the tilts follow"
        )
    if lonely := next((one.name for one in columns if one.kind == "error" and one.name not in values), None):
        raise ValueError(f"'{lonely} error' has no column {lonely} beside it")
    return columns


def _column(text: str, head: str, keys: Mapping[str, Key]) -> Column:
    if text.strip() == IGNORE:
        return Column(IGNORE, head, 0.0)
    match = _HEAD.match(text)
    name, unit = (match["name"], match["unit"]) if match else (text, None)
    base, word = "_".join(name.removesuffix(" error").split()), name.endswith(" error")
    if base in MEASURED:
        if not unit:
            raise ValueError(f"'{head}' has no unit: write {name} [{read_in(1.0, MEASURED[base])[1]}]")
        return Column("error" if word else "value", base, _factor(head, MEASURED[base], unit))
    path = _path(name, keys)
    if path is None:
        known = [*MEASURED, *keys]
        what = f"{', '.join(MEASURED)}, each with a unit, '... error', keys of the scene"
        raise ValueError(
            f"unknown column '{head}'{nearest(name, known)}. Known are {what}; --map \"{head}=NAME\" says what it is, or {IGNORE}"
        )
    return Column("key", path, _factor(head, keys[path].unit, unit) if unit else 1.0)


def _path(name: str, keys: Mapping[str, Key]) -> str | None:
    """A key by its path, or by its last word where one key of the scene ends so."""
    if name in keys:
        return name
    ends = [path for path in keys if path.rpartition(".")[2] == name]
    return ends[0] if len(ends) == 1 else None


def _factor(head: str, unit: str, given: str) -> float:
    if not unit and given.strip() in ("", "1", "-"):
        return 1.0
    try:
        return number_in(unit, f"1 {given}")
    except ValueError as why:
        raise ValueError(f"'{head}': {why}") from None


def _taken(table: NumberTable, columns: Sequence[Column]) -> Observed:
    parts: dict[str, dict[str, np.ndarray]] = {"key": {}, "value": {}, "error": {}, IGNORE: {}}
    for place, column in enumerate(columns):
        parts[column.kind][column.name] = column.factor * table.values[:, place]
    for name, errors in parts["error"].items():
        if (errors <= 0.0).any():
            row = int(np.argmin(errors))
            raise ValueError(
                f"{table.word} {table.lines[row]}: '{name} error' must be greater than 0: half the width of its 95 %"
            )
    if parts["error"] and (rest := [name for name in parts["value"] if name not in parts["error"]]):
        raise ValueError(
            f"errors are stated of {', '.join(parts['error'])}, none of {', '.join(rest)}: state all of them or none"
        )
    return Observed("", parts["key"], parts["value"], {name: one / COVERAGE for name, one in parts["error"].items()})


def _refuse_contradictions(found: Observed) -> None:
    """Two measurements under one set of keys that their stated errors do not explain."""
    if not found.errors:
        return
    count = len(next(iter(found.values.values())))
    keys = np.column_stack([*found.keys.values(), np.zeros(count)])
    _, groups = np.unique(keys, axis=0, return_inverse=True)
    for name, values in found.values.items():
        for group in range(int(groups.max()) + 1):
            rows = np.flatnonzero(groups.ravel() == group)
            low, high = rows[np.argmin(values[rows])], rows[np.argmax(values[rows])]
            apart = (values[high] - values[low]) / np.hypot(found.errors[name][low], found.errors[name][high])
            if apart > _CONTRADICT:
                raise ValueError(
                    f"measurements {min(low, high) + 1} and {max(low, high) + 1} contradict each other: under the same keys {name} is "
                    f"{values[low]:.6g} and {values[high]:.6g} {MEASURED[name]}, {apart:.3g} of their stated standard errors apart"
                )


def refuse_few(points: int, free: int, source: str) -> None:
    """Fewer data than free numbers.

    Raises
    ------
    SceneError
        With both counts.
    """
    if points < free:
        numbers = "1 measured number" if points == 1 else f"{points} measured numbers"
        raise SceneError.at(
            source, None, f"{numbers} for {free} free ones: free fewer keys, or measure at more loads or speeds"
        )
